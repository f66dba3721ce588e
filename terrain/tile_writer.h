// Writer of terrain tiles: elevation files into one pan file, as a stream.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "materials/material.h"
#include "terrain/dem.h"
#include "terrain/part.h"
#include "terrain/tiles.h"

namespace panwright::terrain {

// Map of albedos or other brightness of the ground.
struct AlbedoPart {
  std::vector<Dem> bands;  // one, or red, green and blue: linear numbers, Quantity::plain
  // Number that leaves the colour of the material as it is; none: their mean by area.
  std::optional<double> white;
  double scale = 1;   // from the numbers to radiance factors, with white
  std::string place;  // of its text; empty: none
};

struct TilesOptions {
  // Metres, the most by which a stored height may differ from its source. Steps between stored
  // heights are the largest power of two within it, the same in all tiles, so that tiles meet.
  // 0: floats, which hold the heights of most files exactly.
  double error = 0;
  std::optional<materials::Material> material{};  // of the ground; none: regolith
  std::vector<AlbedoPart> albedo{};               // the first that has a value counts
};

struct TilesReport {
  std::uint64_t bytes = 0;  // of the file
  std::uint64_t tiles = 0;
  std::uint64_t float_tiles = 0;  // those whose relief is too large for codes included
  double error = 0;               // metres, measured: the largest of all charts
  std::uint64_t albedo_tiles = 0;
  double largest_albedo = 1;  // factor of the material's colour
};

// Writes one chart for each elevation file, in their order: where charts overlap, the first that
// has a height gives it. Files name the same body, or none.
//
// Fails: E0001, E0103, E9601; E9612 (other bodies, a file of voids only, heights that steps of this
// error do not hold, albedo maps without values or of planes where terrain is of a body). Reports
// N9604 for relative albedos, W9603 for negative ones. Nothing appears under the name before the
// file is whole and checked. Cost: O(posts); memory 257 rows of doubles and twice as many floats,
// and the records of tiles.
Result<TilesReport> write_tiles(std::span<const Dem> dems, const std::filesystem::path& path,
                                const TilesOptions& options, DiagnosticLog& log,
                                const Job& job = {});

// The same of parts. Within the band of a part that blends, heights lead from those of the
// triangles below it, at its border, to its own: the weight of its own is 3t² - 2t³ at a share t of
// the band. Posts further inside are those of write_tiles() without a band. Where there is nothing
// below, a part keeps its heights.
//
// Fails: also E9613 for a blend of which more than 2^27 posts below would be held. Reports W9614
// for one that bends the ground by more than 6 degrees, or leads to nothing. Memory: also the posts
// below, within the rectangle about each band.
Result<TilesReport> write_parts(std::span<const DemPart> parts, const std::filesystem::path& path,
                                const TilesOptions& options, DiagnosticLog& log,
                                const Job& job = {});

}  // namespace panwright::terrain
