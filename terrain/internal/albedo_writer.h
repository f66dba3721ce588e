// Albedo maps into tiles, from files of numbers. Private to terrain.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "terrain/albedo.h"
#include "terrain/tile_writer.h"

namespace panwright::terrain::internal {

// Takes the bytes of a tile and returns its offset in the section; nothing where that failed.
using BytesReceiver = std::function<std::optional<std::uint64_t>(std::span<const std::byte>)>;

// Writes the tiles of a map, in two passes over its file.
//
//   placed  whether it has to have places on a body; false: metres of a plane
//   maps, tiles  get its record and tiles
// Fails: E9601, E9612. Memory: 512 rows of floats.
bool write_albedo(const AlbedoPart& part, bool placed, std::vector<AlbedoRecord>& maps,
                  std::vector<AlbedoTile>& tiles, const BytesReceiver& to, DiagnosticLog& log,
                  const Job& job);

}  // namespace panwright::terrain::internal
