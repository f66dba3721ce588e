// Terrain of pxn files, made of their elevation files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "pxn/terrain.h"
#include "terrain/tile_writer.h"
#include "world/world.h"

namespace panwright::workspace {

struct TerrainMade {
  terrain::TilesReport tiles;
  std::vector<std::string> files;  // read, labels first
};

// Writes the terrain of a text as a pan file, as a stream. Diagnostics of a part begin with its
// place in the text.
//
//   folder  of the text, which names of files are relative to
// Fails: as terrain::Dem::open(), terrain::DemPart::of() and terrain::write_parts().
Result<TerrainMade> write_terrain(const pxn::TerrainText& text, const std::filesystem::path& folder,
                                  const std::filesystem::path& output, DiagnosticLog& log,
                                  const Job& job = {});

// The same as a model, of a file without a name in the folder for temporary ones.
//
// Fails: also E0103.
Result<world::ModelPtr> terrain_model(const pxn::TerrainText& text,
                                      const std::filesystem::path& folder, DiagnosticLog& log,
                                      const Job& job = {});

}  // namespace panwright::workspace
