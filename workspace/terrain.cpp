#include "workspace/terrain.h"

#include <fmt/core.h>

#include <cstdlib>
#include <system_error>

#include "terrain/tiles.h"
#include "workspace/internal/forward.h"

namespace panwright::workspace {

namespace fs = std::filesystem;

namespace {

std::string place_of_dem(const scene::Source& source) {
  return fmt::format("{}:{}:{}", source.file, source.line, source.column);
}

terrain::DemOptions reading_of(const pxn::DemText& dem) {
  terrain::DemOptions out;
  out.unit = dem.unit;
  if (dem.radii) out.quantity = *dem.radii ? terrain::Quantity::radius : terrain::Quantity::height;
  out.radius = dem.radius;
  out.spacing = dem.spacing;
  out.missing = dem.no_height;
  return out;
}

// A folder that goes with all it holds.
class OwnFolder {
 public:
  explicit OwnFolder(const fs::path& within) : path_((within / "panwright-XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) path_.clear();
  }
  ~OwnFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;
  const std::string& path() const { return path_; }  // empty: it could not be made

 private:
  std::string path_;
};

}  // namespace

Result<TerrainMade> write_terrain(const pxn::TerrainText& text, const fs::path& folder,
                                  const fs::path& output, DiagnosticLog& log, const Job& job) {
  TerrainMade out;
  std::vector<terrain::DemPart> parts;
  for (const pxn::DemText& dem : text.dems) {
    const std::string place = place_of_dem(dem.source);
    DiagnosticLog apart = log.apart();
    auto opened = terrain::Dem::open(folder / dem.file, reading_of(dem), apart, job);
    forward(apart, place, {}, log);
    if (!opened) return failed;
    for (const std::string& file : opened->info().files) out.files.push_back(file);
    auto part = terrain::DemPart::of(
        *std::move(opened), {dem.pixels, dem.bounds, dem.reduce, dem.raise, dem.blend}, place, log);
    if (!part) return failed;
    parts.push_back(*std::move(part));
  }
  const auto written = terrain::write_parts(parts, output, {text.error}, log, job);
  if (!written) return failed;
  out.tiles = *written;
  return out;
}

Result<world::ModelPtr> terrain_model(const pxn::TerrainText& text, const fs::path& folder,
                                      DiagnosticLog& log, const Job& job) {
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  const OwnFolder own(error ? fs::path("/tmp") : temporary);
  if (own.path().empty()) {
    log.report_file(Code("E0103"), temporary.string(), "no folder can be made here");
    return failed;
  }
  const fs::path file = fs::path(own.path()) / "terrain.pan";
  if (!write_terrain(text, folder, file, log, job)) return failed;
  auto model = pan::Model::open(file, log);
  if (!model || !model->check(log, job, terrain::kTilesSection)) return failed;
  return world::ModelPtr(std::make_shared<const pan::Model>(*std::move(model)));
}

}  // namespace panwright::workspace
