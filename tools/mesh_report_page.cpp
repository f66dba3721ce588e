#include "tools/mesh_report_page.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/axis_box.h"
#include "base/file.h"
#include "compiler/compile.h"
#include "importers/clean.h"
#include "pan/model.h"
#include "tools/report_page.h"
#include "tools/words.h"
#include "workspace/drawer.h"

namespace panwright::tools {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kSide = 360;         // pixels of an image
constexpr std::size_t kTexturesOfAKind = 6;  // the worst
constexpr double kRing = 0.16;               // of the image: the ring's radius

void draw_ring(image::Image& image) {
  const double middle = kSide / 2.0, radius = kRing * kSide;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const double r = std::hypot(x + 0.5 - middle, y + 0.5 - middle);
      if (std::fabs(r - radius) > 1.5) continue;
      const std::size_t pixel = std::size_t{y} * kSide + x;
      image.radiance[3 * pixel] = static_cast<float>(0.8 / kPi);
      image.radiance[3 * pixel + 1] = static_cast<float>(0.03 / kPi);
      image.radiance[3 * pixel + 2] = static_cast<float>(0.03 / kPi);
      image.coverage[pixel] = 1;
    }
}

// Images of places on one model.
class Camera {
 public:
  Camera(const scene::Scene& scene, const workspace::OpenOptions& options, const Job& job)
      : job_(job), bounds_(importers::bounds_of(scene)) {
    compiler::Options compile;
    compile.max_error = options.max_error;
    const auto bytes = compiler::compiled(scene, compile, log_, job_);
    if (!bytes) return;
    auto model = pan::Model::from_bytes(*bytes, "model", log_);
    if (!model || !model->check(log_, job_)) return;
    if (!world_.add("model", std::make_shared<const pan::Model>(*std::move(model)), log_)) return;
    workspace::DrawOptions draw;
    draw.gl.samples = 2;
    draw.gl.shadow_side = 0;
    workspace::Drawer drawer(draw);
    if (drawer.prepare(world_, log_, job_)) drawer_.emplace(std::move(drawer));
    file_ = std::filesystem::temp_directory_path() /
            fmt::format("panwright-report-{}.png", static_cast<long>(::getpid()));
  }
  ~Camera() {
    std::error_code ignored;
    if (!file_.empty()) std::filesystem::remove(file_, ignored);
  }
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  bool works() const { return drawer_.has_value() && !bounds_.empty(); }

  // A PNG, as base64; empty when it cannot be had.
  std::string image(const importers::WorldSpot& spot) {
    const Vec3 middle = bounds_.centre();
    const double size = bounds_.diagonal();
    Vec3 outwards = spot.at - middle + Vec3(0.13, -0.29, 0.17) * (0.05 * size);
    outwards = glm::normalize(outwards);
    world::Camera camera;
    world::set_orthographic(camera, kSide, kSide,
                            std::clamp(spot.length / kRing, 0.02 * size, size));
    camera.position = spot.at + outwards * size;
    const auto rotation = world::looking_at(camera.position, spot.at, std::nullopt, log_);
    if (!rotation) return {};
    camera.world_from_camera = *rotation;
    world::Sun sun;
    sun.direction = outwards + Vec3(0.3, -0.2, 0.5);
    world_.set_sun(sun);
    auto drawn = drawer_->draw(world_, camera, false, log_, job_);
    if (!drawn) return {};
    image::Image& image = drawn->image;
    draw_ring(image);
    if (!image::write_image(file_, image, 0.5, log_)) return {};
    const auto bytes = read_file(file_, 1u << 24, log_);
    return bytes ? base64(*bytes) : std::string();
  }

 private:
  const Job& job_;
  DiagnosticLog log_;  // what the report cannot show is no error of the import
  AxisBox bounds_;
  world::World world_;
  std::optional<workspace::Drawer> drawer_;
  std::filesystem::path file_;
};

// The members of a mesh or of the total that the page shows.
Json shown_of(const Json& report) {
  Json out;
  for (const char* name : {"path", "triangles_before", "triangles_after", "vertices_before",
                           "vertices_after", "degenerate", "duplicates", "flipped", "components",
                           "closed_components", "non_manifold_edges", "holes", "t_junctions"})
    if (report.contains(name)) out[name] = report[name];
  return out;
}

}  // namespace

Result<std::string> mesh_report_page(const importers::MeshReport& mesh_report,
                                     const scene::Scene& scene, const std::string& input,
                                     const workspace::OpenOptions& options, DiagnosticLog& log,
                                     const Job& job) {
  const Json all = Json::parse(importers::to_json(mesh_report));
  Json out{{"total", shown_of(all["total"])}};
  if (!mesh_report.spots.empty()) {
    Camera camera(scene, options, job);
    Json images = Json::array();
    std::array<std::size_t, 8> shown{};
    for (const importers::WorldSpot& spot : mesh_report.spots) {
      if (job.cancelled() || !camera.works()) break;
      if (shown[static_cast<std::size_t>(spot.kind)]++ >= kTexturesOfAKind) continue;
      const std::string image = camera.image(spot);
      if (image.empty()) continue;
      const bool flipped = spot.kind == geometry::SpotKind::flipped;
      images.push_back(
          {{"image", "data:image/png;base64," + image},
           {"caption",
            fmt::format("{}, {:.3g} m, in {}, at {:.4g} {:.4g} {:.4g}",
                        flipped ? "flipped region" : importers::kind_name(spot.kind), spot.length,
                        mesh_report.meshes[spot.mesh].path, spot.at.x, spot.at.y, spot.at.z)}});
    }
    out["locations_to_inspect"] =
        camera.works() ? std::move(images) : Json("No images: no OpenGL context.");
  }
  if (job.cancelled()) {
    report_cancelled(log);
    return failed;
  }
  Json& meshes = out["meshes"] = Json::array();
  for (std::size_t i = 0; i < mesh_report.meshes.size(); ++i) {
    const geometry::CleanReport& r = mesh_report.meshes[i].report;
    if (r.holes + r.non_manifold_edges + r.t_junctions + r.flipped > 0)
      meshes.push_back(shown_of(all["meshes"][i]));
  }
  if (meshes.empty()) meshes = "Every mesh is clean.";
  return report_page(std::filesystem::path(input).filename().string() + ": mesh report", out);
}

}  // namespace panwright::tools
