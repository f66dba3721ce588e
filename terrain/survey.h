// Statistics of an elevation file, and its hillshade, in one pass over its rows.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "terrain/dem.h"

namespace panwright::terrain {

// Height with its post.
struct Extreme {
  double height = 0;                  // metres over the sphere
  std::uint32_t column = 0, row = 0;  // the first from the top left
  std::uint64_t posts = 0;            // posts of this height
};

// Slopes between posts that are `posts` apart in a row or column.
struct SlopeStatistics {
  std::uint32_t posts = 1;
  double metres = 0;  // the distance, at the middle of the map
  std::uint64_t pairs = 0;
  double rms = 0;     // degrees, of the RMS tangent
  double median = 0;  // degrees, of the absolute slope, within 0.01
};

struct SurveyOptions {
  std::uint32_t hillshade = 0;  // longest side of the image, pixels; 0: none
  double sun_azimuth = 315;     // degrees from the top of the map, clockwise
  double sun_elevation = 45;    // degrees
};

struct Survey {
  std::uint64_t valid = 0;
  std::array<std::uint64_t, kVoidKinds> voids{};  // by VoidKind; [0] is 0
  Extreme least, largest;                         // expects: valid > 0
  double mean = 0, deviation = 0;                 // metres
  std::vector<SlopeStatistics> slopes;            // at 1, 2, 4 … 64 posts, where there are pairs
  std::uint32_t slope_rows = 1;                   // of these each n-th was taken

  // Hillshade of blocks of posts: 3·width·height, row 0 the top of the map; blue where void.
  std::uint32_t shade_width = 0, shade_height = 0;
  std::uint32_t block = 1;  // posts on a side of a pixel
  double exaggeration = 1;  // factor of heights
  std::vector<std::uint8_t> shade;

  std::uint64_t void_posts() const;
};

// Reads all rows of a file. Slopes are those on the ground: distances follow the map's scale at
// each row. Rows along which posts lie four times as close as rows do give none.
//
// Fails: E0001, E9601. Reports W9603 for a file of voids only, special values that the file does
// not state, and a plateau at its lowest height. Cost: O(posts); memory 64 rows, and the image.
Result<Survey> survey(const Dem& dem, const SurveyOptions& options, DiagnosticLog& log,
                      const Job& job = {});

}  // namespace panwright::terrain
