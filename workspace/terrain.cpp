#include "workspace/terrain.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <system_error>

#include "materials/sample.h"
#include "preview/reference/ground_layer.h"
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

// Radiance factor of the ground's material at angles of incidence, emission and phase, mean of the
// channels. None: there are no such angles.
std::optional<double> radiance_factor(const materials::Material& material,
                                      const std::array<double, 3>& angles) {
  const auto& [incidence, emission, phase] = angles;
  const auto [si, ci] = det::sincos(incidence);
  const auto [se, ce] = det::sincos(emission);
  const Vec3 to_light(si, 0, ci);
  // cos phase = ci ce + si se cos azimuth
  const double across = si * se, rest = det::cos(phase) - ci * ce;
  constexpr double kSlack = 1e-9;
  if (std::fabs(rest) > across + kSlack || !(ci > 0) || !(ce > 0)) return {};
  const double azimuth = across > 0 ? std::clamp(rest / across, -1.0, 1.0) : 1;
  const Vec3 to_viewer(se * azimuth, se * std::sqrt(1 - azimuth * azimuth), ce);
  const Vec3 f =
      materials::Scattering(material).brdf(to_light, to_viewer, Vec3(0, 0, 1), Vec3(0), Vec3(1));
  return kPi * ci * (f.x + f.y + f.z) / 3;
}

Result<terrain::AlbedoPart> albedo_part(const pxn::AlbedoText& text,
                                        const std::optional<materials::Material>& material,
                                        const terrain::DemInfo& ground, const fs::path& folder,
                                        std::vector<std::string>& files, DiagnosticLog& log,
                                        const Job& job) {
  terrain::AlbedoPart out;
  out.place = place_of_dem(text.source);
  terrain::DemOptions reading;
  reading.quantity = terrain::Quantity::plain;
  reading.radius = text.radius;
  if (ground.map.is_placed()) reading.body_radius = ground.map.radius;
  reading.spacing = text.spacing;
  reading.missing = text.no_value;
  const bool grey = text.bands[0] == text.bands[1] && text.bands[1] == text.bands[2];
  for (std::size_t k = 0; k < (grey ? 1u : 3u); ++k) {
    reading.band = text.bands[k];
    DiagnosticLog apart = log.apart();
    auto band = terrain::Dem::open(folder / text.file, reading, apart, job);
    // what is said of the first is said of all
    if (k == 0 || !band) forward(apart, out.place, {}, log);
    if (!band) return failed;
    out.bands.push_back(*std::move(band));
  }
  for (const std::string& file : out.bands[0].info().files) files.push_back(file);
  out.scale = text.scale;
  const terrain::DemInfo& info = out.bands[0].info();
  if (grey && info.bands == 3 && text.bands[0] == 1)
    log.report(Code("N9604"), {},
               fmt::format("{}: {}: the first of three bands is taken as grey", out.place,
                           in_quotes(info.files.front())),
               "bands=\"1 2 3\" takes colours");
  if (!text.reflectance) {
    if (text.scale != 1)
      log.report(Code("W9603"), {},
                 fmt::format("{}: scale has no effect on relative numbers", out.place),
                 "reflectance= says that they are radiance factors");
    return out;
  }
  if ((*text.reflectance)[0] >= kPi / 2 || (*text.reflectance)[1] >= kPi / 2) {
    log.report(
        Code("E9612"), {},
        fmt::format("{}: incidence and emission of reflectance lie below 90 degrees", out.place));
    return failed;
  }
  const auto factor =
      radiance_factor(material.value_or(preview::lunar_regolith()), *text.reflectance);
  if (!factor || !(*factor > 0)) {
    log.report(
        Code("E9612"), {},
        fmt::format(
            "{}: {}", out.place,
            factor
                ? "the material is black at these angles"
                : fmt::format("there are no such angles: the phase lies between "
                              "{:.4g} and {:.4g} degrees, the difference and the "
                              "sum of incidence and emission",
                              std::fabs((*text.reflectance)[0] - (*text.reflectance)[1]) / kDegree,
                              ((*text.reflectance)[0] + (*text.reflectance)[1]) / kDegree)));
    return failed;
  }
  out.white = *factor / text.scale;
  return out;
}

// A diffuse law of 1 returns all light.
void warn_of_brightness(const pxn::TerrainText& text, double largest, DiagnosticLog& log) {
  if (!text.material ||
      materials::brdf_model_of(*text.material).diffuse == materials::DiffuseModel::hapke)
    return;
  const double most = text.material->weights.x * max_component(text.material->diffuse) * largest;
  if (!(most > 1.001)) return;
  log.report(
      Code("W9603"), {},
      fmt::format("{}: where its map is brightest the ground reflects {:.3g} times the light "
                  "that it gets",
                  place_of_dem(text.source), most),
      "a darker material, or reflectance=");
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
  terrain::TilesOptions options{text.error, text.material, {}};
  for (const pxn::AlbedoText& albedo : text.albedo) {
    auto part = albedo_part(albedo, text.material, parts[0].info(), folder, out.files, log, job);
    if (!part) return failed;
    options.albedo.push_back(*std::move(part));
  }
  const auto written = terrain::write_parts(parts, output, options, log, job);
  if (!written) return failed;
  out.tiles = *written;
  warn_of_brightness(text, written->largest_albedo, log);
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
  // of a name of its own: a run that makes several knows files by their names
  const fs::path file = fs::path(own.path()) / (fs::path(own.path()).filename().string() + ".pan");
  if (!write_terrain(text, folder, file, log, job)) return failed;
  auto model = pan::Model::open(file, log);
  if (!model || !model->check(log, job, terrain::kTilesSection)) return failed;
  return world::ModelPtr(std::make_shared<const pan::Model>(*std::move(model)));
}

}  // namespace panwright::workspace
