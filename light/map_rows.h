// Maps of bodies from rows of pixels, averaged on the way to a size that fits.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/math.h"

namespace panwright::light {

// Equirectangular pixels, linear; row 0 the north, longitude 0 in the middle.
struct MapPixels {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgb;  // 3·width·height
};

// Meaning of the pixels of a file.
enum class MapValues : std::uint8_t {
  colour,  // sRGB; pixels without alpha are holes
  cover,   // shares: code / 255 times alpha
};

class MapRows {
 public:
  static constexpr std::uint32_t kMostWidth = 4096;

  //   turn     columns that the pixels are turned to the east
  //   no_data  code of holes in all channels
  // Expects: width = 2·height ≥ 2.
  MapRows(std::uint32_t width, std::uint32_t height, MapValues values, std::uint32_t turn = 0,
          std::optional<std::uint8_t> no_data = {});

  // Adds the next row, from the top: 4·width bytes.
  void add(std::span<const std::uint8_t> rgba);

  // Pixels along a side that one of the map stands for.
  std::uint32_t step() const { return step_; }
  struct Hole {
    std::uint32_t column, row;
  };
  std::uint64_t holes() const { return holes_; }
  const std::optional<Hole>& first_hole() const { return first_; }

  // Returns the map: means of blocks; blocks of holes have the mean of the sphere.
  MapPixels pixels() const;

 private:
  std::uint32_t width_, height_, step_, turn_;
  MapValues values_;
  std::optional<std::uint8_t> no_data_;
  std::uint32_t row_ = 0;
  MapPixels sums_;
  std::vector<float> counts_;
  std::uint64_t holes_ = 0;
  std::optional<Hole> first_;
};

// Returns the mean over the sphere.
Vec3 mean_of(const MapPixels& map);

// Puts clouds above a ground, each of its place: white of radiance factor kCloud, the ground scaled
// so that the mean of both is `albedo`. Both are finest kept; without a ground it is of one colour.
// `dimmed`: clouds alone reflect more, and are scaled.
inline constexpr double kCloud = 0.75;
MapPixels with_clouds(const MapPixels& ground, const MapPixels& clouds, const Vec3& albedo,
                      bool& dimmed);

}  // namespace panwright::light
