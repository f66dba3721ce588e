// Removal of hidden parts: share, time, and whether anything changes.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "base/parallel.h"
#include "bench/bench.h"
#include "compiler/hidden.h"
#include "importers/clean.h"
#include "importers/import.h"
#include "tests/compiler/assemblies.h"
#include "tests/geometry/shapes.h"
#include "tests/support/ray_caster.h"

namespace panwright::bench {

namespace {

using compiler::HiddenReport;
using compiler::assemblies::Assembly;
using geometry::MeshShape;

constexpr int kViews = 200;

struct Ball {
  Vec3 centre{0};
  double radius = 1;
};

Ball ball_of(const scene::Scene& scene) {
  const importers::Bounds bounds = importers::bounds_of(scene);
  return {0.5 * bounds.low + 0.5 * bounds.high, 0.5 * glm::length(bounds.high - bounds.low)};
}

support::RayCaster caster_of(const scene::Scene& scene) {
  support::RayCaster caster;
  const std::vector<Mat4> world = scene::world_from_nodes(scene);
  for (const scene::Instance& instance : scene.instances)
    if (const auto* mesh =
            std::get_if<MeshShape>(&scene.shapes[static_cast<std::size_t>(instance.shape)]))
      caster.add(**mesh, world[static_cast<std::size_t>(instance.node)]);
  caster.build();
  return caster;
}

struct Seen {
  std::uint64_t rays = 0;  // that meet the model
  std::uint64_t changed = 0;
};

// Rays through the centres of pixels of so many views from random directions, three radii away.
Seen compared(const scene::Scene& before, const scene::Scene& after, int views, int side) {
  const Ball ball = ball_of(before);
  const support::RayCaster a = caster_of(before);
  const support::RayCaster b = caster_of(after);
  std::vector<Seen> parts(static_cast<std::size_t>(views));
  parallel_for(parts.size(), [&](std::size_t view) {
    geometry::shapes::Random random(4242 + view);
    const Vec3 d = random.direction();
    const Vec3 x =
        glm::normalize(glm::cross(std::fabs(d.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0), d));
    const Vec3 y = glm::cross(d, x);
    const Vec3 from = ball.centre + 3 * ball.radius * d;
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < side; ++column) {
        const Vec3 to = ball.centre + ball.radius * ((2 * (column + 0.5) / side - 1) * x +
                                                     (2 * (row + 0.5) / side - 1) * y);
        const auto first = a.closest({from, to - from});
        const auto second = b.closest({from, to - from});
        parts[view].rays += first.has_value();
        parts[view].changed +=
            first.has_value() != second.has_value() ||
            (first && std::fabs(first->distance - second->distance) > 2e-5 * ball.radius);
      }
    }
  });
  Seen sum;
  for (const Seen& part : parts) {
    sum.rays += part.rays;
    sum.changed += part.changed;
  }
  return sum;
}

using Corners = std::array<double, 9>;
Corners corners(const geometry::Mesh& mesh, const geometry::Triangle& t) {
  Corners out;
  for (std::size_t i = 0; i < 9; ++i) out[i] = mesh.positions[t[i / 3]][static_cast<int>(i % 3)];
  return out;
}

struct Known {
  std::uint64_t hidden = 0;  // by construction
  std::uint64_t left = 0;    // of them, afterwards
  std::uint64_t lost = 0;    // visible ones
};

Known known(const Assembly& assembly, const scene::Scene& after) {
  std::map<std::int32_t, std::set<Corners>> kept;
  for (const scene::Instance& instance : after.instances) {
    const auto& mesh = *std::get<MeshShape>(after.shapes[static_cast<std::size_t>(instance.shape)]);
    for (const geometry::Triangle& t : mesh.triangles) kept[instance.node].insert(corners(mesh, t));
  }
  Known out;
  for (std::size_t i = 0; i < assembly.scene.instances.size(); ++i) {
    const scene::Instance& instance = assembly.scene.instances[i];
    const auto& mesh =
        *std::get<MeshShape>(assembly.scene.shapes[static_cast<std::size_t>(instance.shape)]);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const bool there = kept[instance.node].count(corners(mesh, mesh.triangles[t])) > 0;
      out.hidden += assembly.visible[i][t] == 0;
      out.left += assembly.visible[i][t] == 0 && there;
      out.lost += assembly.visible[i][t] == 1 && !there;
    }
  }
  return out;
}

std::string words(const HiddenReport& report) {
  return fmt::format("triangles={}->{} unseen={} ambiguous={} rays={:.2f}M",
                     report.triangles_before, report.triangles_after, report.hidden,
                     report.ambiguous, 1e-6 * static_cast<double>(report.rays));
}

compiler::HiddenOptions options_of(const Context& context) {
  compiler::HiddenOptions options;
  if (context.quick()) {
    options.rays_from_outside = 20'000;
    options.max_probes = 100'000;
  }
  return options;
}

void run_assembly(Context& context, const Assembly& assembly) {
  scene::Scene after;
  HiddenReport report;
  const Timing timing = timed(
      [&] {
        after = assembly.scene;
        DiagnosticLog log;
        report = *compiler::prune_hidden(after, options_of(context), log);
      },
      context.quick() ? 1 : 3);
  const Known share = known(assembly, after);
  Row row{.case_name = "hidden",
          .setting = fmt::format("{} {}", assembly.name, words(report)),
          .speed_unit = "s",
          .error = static_cast<double>(share.left + share.lost) /
                   static_cast<double>(std::max<std::uint64_t>(1, share.hidden)),
          .error_unit = "of the hidden",
          .reference = "triangles that are hidden by construction",
          .must_error = 0.02};
  set_time(row, timing, 1);
  context.add(row);
  const Seen seen = compared(assembly.scene, after, context.quick() ? 4 : 64, 128);
  context.note(
      fmt::format("{}: {} of {} hidden triangles left, {} visible ones lost, {} of {} rays "
                  "changed",
                  assembly.name, share.left, share.hidden, share.lost, seen.changed, seen.rays));
}

void run_model(Context& context, const std::string& name) {
  const auto path = context.source("../shared/data/spacecraft-gltf/" + name + ".glb");
  if (path.empty()) {
    context.note(name + " is not at hand");
    return;
  }
  DiagnosticLog log;
  importers::Options reading;
  reading.textures = false;
  auto model = importers::import_file(path, reading, log);
  if (!model) {
    context.note(name + " could not be read");
    return;
  }
  (void)importers::clean_up(model->scene, {}, log);
  scene::Scene after;
  HiddenReport report;
  const Timing timing = timed(
      [&] {
        after = model->scene;
        report = *compiler::prune_hidden(after, options_of(context), log);
      },
      1);
  const Seen seen =
      compared(model->scene, after, context.quick() ? 2 : kViews, context.quick() ? 32 : 256);
  Row row{.case_name = "hidden",
          .setting = fmt::format("{} {}", name, words(report)),
          .speed_unit = "s",
          .error = static_cast<double>(seen.changed),
          .error_unit = fmt::format("of {} pixels", seen.rays),
          .reference = fmt::format("rays of {} random views of 256² of the whole model", kViews)};
  set_time(row, timing, 1);
  context.add(row);
}

void run(Context& context) {
  const bool quick = context.quick();
  run_assembly(context, compiler::assemblies::nested_boxes(5, quick ? 2 : 16));
  run_assembly(context, compiler::assemblies::tank_in_a_bus(quick ? 10 : 40, 0.05));
  run_assembly(context, compiler::assemblies::bolts_in_holes(quick ? 1 : 8, 16, 3));
  if (quick) return;
  for (const char* name : {"hubble-draco-webp", "jwst-draco-webp", "iss-draco-webp"})
    run_model(context, name);
}

const bool kAdded = add_case({"hidden", "removal of hidden parts", run});

}  // namespace

}  // namespace panwright::bench
