#include "tools/mesh_report_page.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/axis_box.h"
#include "base/file.h"
#include "compiler/compile.h"
#include "importers/clean.h"
#include "pan/model.h"
#include "tools/html.h"
#include "workspace/drawer.h"

namespace panwright::tools {

namespace {

constexpr std::uint32_t kSide = 360;         // pixels of an image
constexpr std::size_t kTexturesOfAKind = 6;  // the worst
constexpr double kRing = 0.16;               // of the image: the ring's radius
constexpr std::size_t kMeshRows = 200;

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

void draw_ring(preview::Image& image) {
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
    auto drawer = workspace::Drawer::create(draw, log_);
    if (drawer && drawer->prepare(world_, log_, job_)) drawer_.emplace(*std::move(drawer));
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
    preview::Image& image = drawn->image;
    draw_ring(image);
    if (!preview::write_image(file_, image, 0.5, log_)) return {};
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

std::string head(const std::string& input) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<title>{0}: mesh report</title>\n<style>\n"
      "body {{ font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 72em; padding: "
      "0 1em; "
      "color: #1c2430; }}\n"
      "table {{ border-collapse: collapse; margin: 1em 0; }}\n"
      "td, th {{ padding: .25em .8em; text-align: right; border-bottom: 1px solid #dde2e8; }}\n"
      "td:first-child, th:first-child {{ text-align: left; }}\n"
      "figure {{ display: inline-block; margin: 0 1em 1em 0; width: {1}px; vertical-align: top; "
      "}}\n"
      "figcaption {{ font-size: 13px; }}\n"
      "</style></head>\n<body>\n<h1>{0}</h1>\n",
      html_escaped(std::filesystem::path(input).filename().string()), kSide);
}

std::string totals(const geometry::CleanReport& total) {
  std::string out = "<table>\n";
  const auto row = [&](const char* name, std::uint64_t count) {
    out += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", name, count);
  };
  row("triangles before", total.triangles_before);
  row("triangles after", total.triangles_after);
  row("vertices before", total.vertices_before);
  row("vertices after", total.vertices_after);
  row("faces without area", total.degenerate);
  row("duplicate faces", total.duplicates);
  row("faces flipped", total.flipped);
  row("components", total.components);
  row("closed components", total.closed_components);
  row("edges of three faces or more", total.non_manifold_edges);
  row("holes", total.holes);
  row("vertices on edges of other faces", total.t_junctions);
  return out + "</table>\n";
}

std::string mesh_rows(const importers::MeshReport& mesh_report) {
  std::string out =
      "<h2>Meshes</h2>\n<table>\n<tr><th>first location</th><th>triangles</th><th>holes</th>"
      "<th>non-manifold edges</th><th>T-junctions</th><th>flipped</th></tr>\n";
  std::size_t rows = 0;
  for (const importers::MeshQuality& mesh : mesh_report.meshes) {
    const geometry::CleanReport& r = mesh.report;
    if (r.holes + r.non_manifold_edges + r.t_junctions + r.flipped == 0) continue;
    if (++rows > kMeshRows) break;
    out +=
        fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                    html_escaped(mesh.path), r.triangles_after, r.holes, r.non_manifold_edges,
                    r.t_junctions, r.flipped);
  }
  if (rows == 0) return "<p>Every mesh is clean.</p>\n";
  return out + (rows > kMeshRows ? "</table>\n<p>and more.</p>\n" : "</table>\n");
}

}  // namespace

Result<std::string> mesh_report_page(const importers::MeshReport& mesh_report,
                                     const scene::Scene& scene, const std::string& input,
                                     const workspace::OpenOptions& options, DiagnosticLog& log,
                                     const Job& job) {
  std::string out = head(input) + totals(mesh_report.total);
  if (!mesh_report.spots.empty()) {
    Camera camera(scene, options, job);
    out += "<h2>Locations to inspect</h2>\n";
    if (!camera.works()) out += "<p>No images: no OpenGL context.</p>\n";
    std::array<std::size_t, 8> shown{};
    for (const importers::WorldSpot& spot : mesh_report.spots) {
      if (job.cancelled()) break;
      if (!camera.works() || shown[static_cast<std::size_t>(spot.kind)]++ >= kTexturesOfAKind)
        continue;
      const std::string image = camera.image(spot);
      if (image.empty()) continue;
      const bool flipped = spot.kind == geometry::SpotKind::flipped;
      out += fmt::format(
          "<figure><img width=\"{0}\" height=\"{0}\" alt=\"{1}\" src=\"data:image/png;base64,{2}\">"
          "<figcaption>{1}, {3:.3g} m, in {4}, at {5:.4g} {6:.4g} {7:.4g}</figcaption></figure>\n",
          kSide, flipped ? "flipped region" : importers::kind_name(spot.kind), image, spot.length,
          html_escaped(mesh_report.meshes[spot.mesh].path), spot.at.x, spot.at.y, spot.at.z);
    }
  }
  if (job.cancelled()) {
    report_cancelled(log);
    return failed;
  }
  return out + mesh_rows(mesh_report) + "</body></html>\n";
}

}  // namespace panwright::tools
