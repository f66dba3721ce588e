// Levels of detail of meshes: imported spacecraft as a camera comes closer, against every triangle.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "bench/bench.h"
#include "bench/scenes.h"
#include "compiler/compile.h"
#include "pan/model.h"
#include "preview/renderer.h"
#include "tests/support/view.h"
#include "workspace/open.h"

namespace panwright::bench::case_mesh_levels {
namespace {

constexpr double kIfov = 0.5e-3;
constexpr std::uint32_t kSide = 256;

struct Built {
  world::ModelPtr model;
  double seconds = 0;
};

Built built(const scene::Scene& scene, bool levels, DiagnosticLog& log) {
  Built out;
  compiler::Options options;
  options.mesh_levels = levels;
  const auto start = std::chrono::steady_clock::now();
  const auto bytes = compiler::compiled(scene, options, log);
  out.seconds = seconds_since(start);
  if (!bytes) return out;
  auto model = pan::Model::from_bytes(*bytes, "model", log);
  if (model && model->check(log)) out.model = std::make_shared<const pan::Model>(*std::move(model));
  return out;
}

std::size_t triangles_at(const pan::Model& model, double pixel) {
  std::size_t count = 0;
  const auto nodes = model.world_from_nodes();
  for (std::uint32_t i = 0; i < model.instances().size(); ++i) {
    const double stretch = stretch_of(nodes[model.instances()[i].node]).largest;
    std::uint32_t mesh = model.instances()[i].mesh;
    for (const pan::layout::Level& level : model.levels(i))
      if (level.detail * stretch <= pixel) mesh = level.mesh;
    count += model.meshes()[mesh].triangle_count;
  }
  return count;
}

struct Frame {
  std::vector<float> radiance;
  double seconds = 0;
  double flux = 0;
  Vec2 centre{0};  // pixels
};

// What is shown where a pixel sees so much: the levels for `begin` metres, and those for twice as
// much by their share. As preview/frame/level_states.h says.
struct Mix {
  double begin = 0;
  double share = 0;
};
Mix mix_of(double pixel, bool faded) {
  const double begin = std::exp2(std::floor(std::log2(pixel)));
  return {begin, faded ? std::max(2 * std::log2(pixel / begin) - 1, 0.0) : 0};
}

class Approach {
 public:
  Approach(preview::Renderer& renderer, world::ModelPtr model, int frames)
      : renderer_(renderer), model_(std::move(model)), box_(box_of(*model_)), frames_(frames) {}

  // From 16 pixels across to 250.
  double range(int i) const {
    const double share = static_cast<double>(i) / (frames_ - 1);
    return box_.diagonal() / kIfov / (16 * std::pow(250.0 / 16, share));
  }

  // What the nearest point of the box is under, metres.
  double pixel(int i) const {
    const Vec3 eye = position(i);
    return glm::length(eye - glm::clamp(eye, box_.low, box_.high)) * kIfov;
  }

  // pixel: 0: every triangle; none: as a user sees it
  Frame frame(int i, std::optional<double> pixel) const {
    DiagnosticLog log;
    preview::View view;
    world::set_pixel_angle(view.camera, kSide, kSide, kIfov);
    view.camera.position = position(i);
    if (const auto turn =
            world::looking_at(view.camera.position, box_.centre(), Vec3(0, 1, 0), log))
      view.camera.world_from_camera = *turn;
    view.to_sun = glm::normalize(Vec3(0.7, 0.5, 0.9));
    preview::RenderOptions options;
    options.samples = 4;
    options.level_pixel = pixel;
    const world::World world = preview::world_of(model_, view);
    const auto start = std::chrono::steady_clock::now();
    auto image = renderer_.render(world, view.camera, options, log);
    Frame out;
    if (!image) return out;
    out.seconds = seconds_since(start);
    out.radiance = std::move(image->radiance);
    measure(out);
    return out;
  }

  // Frame i with the levels of another one.
  Frame mixed(int i, const Mix& mix) const {
    Frame out = kept(i, mix.begin);
    if (!(mix.share > 0)) return out;
    const Frame& coarse = kept(i, 2 * mix.begin);
    const auto share = static_cast<float>(mix.share);
    for (std::size_t p = 0; p < out.radiance.size(); ++p)
      out.radiance[p] += share * (coarse.radiance[p] - out.radiance[p]);
    measure(out);
    return out;
  }

 private:
  // Frames of one camera, drawn once.
  const Frame& kept(int i, double pixel) const {
    if (i != camera_) kept_.clear();
    camera_ = i;
    const auto [found, added] = kept_.try_emplace(pixel);
    if (added) found->second = frame(i, pixel);
    return found->second;
  }

  static void measure(Frame& frame) {
    frame.flux = 0;
    frame.centre = Vec2(0);
    for (std::size_t p = 0; p < frame.radiance.size() / 3; ++p) {
      const double value = static_cast<double>(frame.radiance[3 * p + 1]);
      frame.flux += value;
      frame.centre += value * Vec2(static_cast<double>(p % kSide), static_cast<double>(p / kSide));
    }
    frame.centre /= frame.flux;
  }

  Vec3 position(int i) const {
    return box_.centre() + range(i) * glm::normalize(Vec3(0.3, 0.25, 0.9));
  }

  preview::Renderer& renderer_;
  world::ModelPtr model_;
  AxisBox box_;
  int frames_;
  mutable int camera_ = -1;
  mutable std::map<double, Frame> kept_;
};

// The radiance that is white: one lit pixel in a hundred is brighter.
float white_of(const Frame& frame) {
  std::vector<float> lit;
  for (std::size_t p = 1; p < frame.radiance.size(); p += 3)
    if (frame.radiance[p] > 0) lit.push_back(frame.radiance[p]);
  if (lit.empty()) return 1;
  const auto at = lit.begin() + static_cast<std::ptrdiff_t>(lit.size() * 99 / 100);
  std::nth_element(lit.begin(), at, lit.end());
  return *at;
}

// The largest change that a switch of levels makes from frame to frame: at each camera, the image
// with the levels of the frame before against that with its own.
struct Steps {
  double flux = 0;    // relative
  double centre = 0;  // pixels
  double codes = 0;   // of 8 bits, linear, of the pixel that changes most
};

void add_step(const Frame& a, const Frame& b, float white, Steps& steps) {
  steps.flux = std::max(steps.flux, std::fabs(b.flux / a.flux - 1));
  steps.centre = std::max(steps.centre, glm::length(b.centre - a.centre));
  const auto code = [&](float value) {
    return 255 * static_cast<double>(std::min(value / white, 1.0f));
  };
  for (std::size_t p = 0; p < a.radiance.size(); ++p)
    steps.codes = std::max(steps.codes, std::fabs(code(b.radiance[p]) - code(a.radiance[p])));
}

struct Speed {
  double median = 0, spread = 0;  // ms
};
Speed speed_of(std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  const std::size_t n = seconds.size();
  return {seconds[n / 2] * 1e3, (seconds[n * 3 / 4] - seconds[n / 4]) / 2 * 1e3};
}

// The row of what levels add to the time of a compilation.
void add_compilation(Context& context, const std::string& name, const Built& plain,
                     const Built& leveled) {
  double bound = 0;
  std::size_t stored = 0;
  for (const pan::layout::Mesh& mesh : leveled.model->meshes()) stored += mesh.triangle_count;
  for (const pan::layout::Level& level : leveled.model->levels())
    bound = std::max(bound, level.error);
  context.add({.case_name = "mesh_levels",
               .setting = fmt::format("{}; compile, {} triangles stored; {:.3g} s without levels",
                                      name, stored, plain.seconds),
               .speed = static_cast<double>(triangles_at(*leveled.model, 0)) /
                        (leveled.seconds - plain.seconds) * 1e-6,
               .speed_unit = "Mtri/s",
               .error = bound,
               .error_unit = "m, bound of the coarsest level",
               .reference = "its own two-sided Hausdorff interval",
               .runs = 1});
}

void run_model(Context& context, preview::Renderer& renderer, const std::string& name) {
  DiagnosticLog log;
  const auto path = context.source("../shared/data/spacecraft-gltf/" + name + ".glb");
  if (path.empty()) return context.note(name + " is not there");
  const auto scene = workspace::read_scene(path, {}, log);
  if (!scene) return context.note(name + " could not be read");
  const Built plain = built(*scene, false, log);
  const Built leveled = built(*scene, true, log);
  if (!plain.model || !leveled.model) return context.note(name + " was refused");
  const int frames = context.quick() ? 40 : 200;
  const Approach approach(renderer, leveled.model, frames);
  static_cast<void>(approach.frame(0, 0));
  const float white = white_of(approach.frame(frames - 1, 0));
  std::array<Steps, 2> steps;  // faded, unfaded
  std::vector<double> full_seconds, seconds;
  double flux_error = 0, centre_error = 0, mix_error = 0;
  for (int i = 0; i < frames; ++i) {
    const Frame full = approach.frame(i, 0);
    const Frame shown = approach.frame(i, {});
    if (full.radiance.empty() || shown.radiance.empty()) return context.note(name + ": no image");
    full_seconds.push_back(full.seconds);
    seconds.push_back(shown.seconds);
    flux_error = std::max(flux_error, std::fabs(shown.flux / full.flux - 1));
    centre_error = std::max(centre_error, glm::length(shown.centre - full.centre));
    for (const bool faded : {true, false}) {
      if (i == 0) continue;
      const Mix before = mix_of(approach.pixel(i - 1), faded);
      const Mix now = mix_of(approach.pixel(i), faded);
      if (before.begin == now.begin && before.share == now.share) continue;
      const Frame own = approach.mixed(i, now);
      if (faded) mix_error = std::max(mix_error, std::fabs(own.flux / shown.flux - 1));
      add_step(approach.mixed(i, before), own, white, steps[faded ? 0 : 1]);
    }
  }
  if (mix_error > 1e-4)
    context.note(
        fmt::format("{}: what is shown is no mean of two levels: {:.2g}", name, mix_error));
  const std::size_t far = triangles_at(*leveled.model, mix_of(approach.pixel(0), true).begin);
  const std::size_t all = triangles_at(*leveled.model, 0);
  const auto add = [&](const char* what, std::size_t triangles, const std::vector<double>& times,
                       const char* unit, double error, double must) {
    const Speed speed = speed_of(times);
    context.add({.case_name = "mesh_levels",
                 .setting = fmt::format("{}; approach of {} frames, 16 to 250 px; {}; {} of {} "
                                        "triangles at the farthest",
                                        name, frames, what, triangles, all),
                 .speed = speed.median,
                 .speed_unit = "ms/frame",
                 .error = error,
                 .error_unit = unit,
                 .reference = "every triangle, the same cameras",
                 .runs = frames,
                 .spread = speed.spread,
                 .must_is_least = false,
                 .must_error = context.quick() ? 0 : must});
  };
  add("every triangle", all, full_seconds, "flux, largest error", 0, 0);
  add("levels", far, seconds, "flux, largest error", flux_error, 0);
  add("levels", far, seconds, "px, largest photocentre error", centre_error, 0);
  for (const bool faded : {true, false}) {
    const Steps& s = steps[faded ? 0 : 1];
    const char* what = faded ? "levels" : "levels, unfaded";
    add(what, far, seconds, "flux step", s.flux, faded ? 1e-3 : 0);
    add(what, far, seconds, "px, photocentre step", s.centre, faded ? 0.01 : 0);
    add(what, far, seconds, "codes of 8 bits that a pixel steps", s.codes, faded ? 4 : 0);
  }
  add_compilation(context, name, plain, leveled);
}

void run(Context& context) {
  DiagnosticLog log;
  auto gl = preview::Device::create(preview::ContextKind::automatic, log);
  if (!gl) return context.note("no OpenGL context");
  context.set_renderer((*gl)->context().renderer());
  preview::Renderer renderer(*gl);
  const std::vector<std::string> names =
      context.quick()
          ? std::vector<std::string>{"spitzer-blender"}
          : std::vector<std::string>{"aqua-draco-webp", "landsat8-blender", "mro-draco-webp",
                                     "spitzer-blender", "jwst-draco-webp"};
  for (const std::string& name : names) run_model(context, renderer, name);
}

const bool kAdded =
    add_case({"mesh_levels", "levels of detail of meshes as a camera comes closer", run});

}  // namespace
}  // namespace panwright::bench::case_mesh_levels
