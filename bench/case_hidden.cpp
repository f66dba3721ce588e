// Removal of hidden parts: share, time, and whether anything changes.
#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "base/file_cache.h"
#include "base/parallel.h"
#include "bench/bench.h"
#include "compiler/compile.h"
#include "compiler/hidden.h"
#include "importers/clean.h"
#include "importers/import.h"
#include "tests/compiler/assemblies.h"
#include "tests/geometry/shapes.h"
#include "tests/support/ray_caster.h"

namespace panwright::bench::case_hidden {

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
  const AxisBox bounds = importers::bounds_of(scene);
  return {bounds.centre(), 0.5 * bounds.diagonal()};
}

// A scene, and what a pixel of it shows: the node and the material, as in the layers of an image.
struct Shown {
  support::RayCaster caster;
  std::vector<std::pair<std::int32_t, std::int32_t>> ids;  // node, material
};

Shown shown_of(const scene::Scene& scene) {
  Shown out;
  const std::vector<Mat4> world = scene::world_from_nodes(scene);
  for (const scene::Instance& instance : scene.instances) {
    const auto* mesh =
        std::get_if<MeshShape>(&scene.shapes[static_cast<std::size_t>(instance.shape)]);
    if (mesh == nullptr) continue;
    out.caster.add(**mesh, world[static_cast<std::size_t>(instance.node)]);
    out.ids.push_back({instance.node, instance.material});
  }
  out.caster.build();
  return out;
}

struct Seen {
  std::uint64_t rays = 0;  // that meet the model
  std::uint64_t changed = 0;
  std::uint64_t ids = 0;  // that are others
};

// Rays through the centres of pixels of so many views from random directions, three radii away.
Seen compared(const scene::Scene& before, const scene::Scene& after, int views, int side) {
  const Ball ball = ball_of(before);
  const Shown a = shown_of(before);
  const Shown b = shown_of(after);
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
        const auto first = a.caster.closest({from, to - from});
        const auto second = b.caster.closest({from, to - from});
        parts[view].rays += first.has_value();
        parts[view].changed +=
            first.has_value() != second.has_value() ||
            (first && std::fabs(first->distance - second->distance) > 2e-5 * ball.radius);
        parts[view].ids += first && second && a.ids[first->instance] != b.ids[second->instance];
      }
    }
  });
  Seen sum;
  for (const Seen& part : parts) {
    sum.rays += part.rays;
    sum.changed += part.changed;
    sum.ids += part.ids;
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
    options.max_rays = 100'000;
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

// ---- models in the open

// A lumpy ball.
scene::Scene skin(std::uint32_t rings, std::uint32_t quads) {
  compiler::assemblies::Builder builder("skin");
  geometry::Mesh mesh;
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t j = 0; j < quads; ++j) {
      const double a = kPi * i / rings;
      const double b = 2 * kPi * j / quads;
      const Vec3 d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
      const double lumps = std::sin(7 * d.x) * std::sin(9 * d.y) * std::cos(8 * d.z);
      mesh.positions.push_back((1 + 0.05 * lumps) * d);
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < quads; ++j) {
      const std::uint32_t next = (j + 1) % quads;
      const std::uint32_t low = (i + 1) * quads;
      if (i + 1 < rings) mesh.triangles.push_back({i * quads + j, low + j, low + next});
      if (i > 0) mesh.triangles.push_back({i * quads + j, low + next, i * quads + next});
    }
  mesh.closed = true;
  builder.add(builder.add_mesh(std::move(mesh)), Vec3(0), true);
  return builder.done().scene;
}

// Tufts of bent blades, of one mesh, side² of them.
scene::Scene field(std::uint32_t side, std::uint32_t blades) {
  compiler::assemblies::Builder builder("field");
  geometry::shapes::Random random(7);
  geometry::Mesh tuft;
  constexpr std::uint32_t kSteps = 3;
  for (std::uint32_t i = 0; i < blades; ++i) {
    const double turn = 2 * kPi * random();
    const Vec3 lean(std::cos(turn), std::sin(turn), 0);
    const Vec3 aside(-lean.y, lean.x, 0);
    const Vec3 foot(0.1 * random() - 0.05, 0.1 * random() - 0.05, 0);
    const double height = 0.2 + 0.2 * random();
    const auto base = static_cast<std::uint32_t>(tuft.positions.size());
    for (std::uint32_t k = 0; k <= kSteps; ++k) {
      const double t = static_cast<double>(k) / kSteps;
      const Vec3 at = foot + 0.1 * t * t * lean + Vec3(0, 0, height * t);
      const double width = 0.006 * (1 - t) + 0.0003;
      tuft.positions.push_back(at - width * aside);
      tuft.positions.push_back(at + width * aside);
    }
    for (std::uint32_t k = 0; k < kSteps; ++k) {
      const std::uint32_t q = base + 2 * k;
      tuft.triangles.push_back({q, q + 1, q + 3});
      tuft.triangles.push_back({q, q + 3, q + 2});
    }
  }
  const std::int32_t shape = builder.add_mesh(std::move(tuft));
  for (std::uint32_t i = 0; i < side * side; ++i)
    builder.add(shape, Vec3(0.08 * (i % side + random()), 0.08 * (i / side + random()), 0), true);
  return builder.done().scene;
}

// Balls with balls in them, of one mesh, strewn so that they hide each other and touch.
scene::Scene pots(std::uint32_t count) {
  compiler::assemblies::Builder builder("pots");
  geometry::shapes::Random random(11);
  geometry::Mesh pot = compiler::assemblies::round_bar(0.5, -0.5, 0.5, 48, 24).mesh;
  const geometry::Mesh within = compiler::assemblies::block(Vec3(0.4), 5);
  const auto base = static_cast<std::uint32_t>(pot.positions.size());
  pot.positions.insert(pot.positions.end(), within.positions.begin(), within.positions.end());
  for (const geometry::Triangle& t : within.triangles)
    pot.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  const std::int32_t shape = builder.add_mesh(std::move(pot));
  for (std::uint32_t i = 0; i < count; ++i)
    builder.add(shape, 12.0 * Vec3(random(), random(), random()), true);
  return builder.done().scene;
}

// hidden: triangles of the mesh, by construction
void run_open(Context& context, const char* name, const scene::Scene& before, std::uint64_t hidden,
              double seconds) {
  HiddenReport report;
  const Timing timing = timed(
      [&] {
        scene::Scene after = before;
        DiagnosticLog log;
        report = *compiler::prune_hidden(after, options_of(context), log);
      },
      3);
  Row row{.case_name = "hidden",
          .setting = fmt::format("{} {}", name, words(report)),
          .speed_unit = "s",
          .error = std::fabs(static_cast<double>(report.unique_before - report.unique_after) -
                             static_cast<double>(hidden)),
          .error_unit = "triangles of the mesh",
          .reference = "those that are hidden by construction",
          .must = seconds,
          .must_is_least = false,
          .must_error = 0.5};
  set_time(row, timing, 1);
  context.add(row);
}

// The same search once more, whose result was kept.
void run_cached(Context& context, const std::string& name, const scene::Scene& before,
                const scene::Scene& expected) {
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("panwright-bench-cache-{}", getpid());
  const WorkCache cache(folder);
  compiler::HiddenOptions options = options_of(context);
  options.cache = &cache;
  scene::Scene after;
  HiddenReport report;
  const auto search = [&] {
    after = before;
    DiagnosticLog log;
    report = *compiler::prune_hidden(after, options, log);
  };
  search();
  const Timing timing = timed(search, 3);
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  DiagnosticLog log;
  const bool same = *compiler::compiled(after, {}, log) == *compiler::compiled(expected, {}, log);
  Row row{.case_name = "hidden",
          .setting = fmt::format("{}, known from an earlier run", name),
          .speed_unit = "s",
          .error = same && report.cached ? 0.0 : 1.0,
          .error_unit = "pan files with other bytes",
          .reference = "the file without a cache",
          .must = 0.25,
          .must_is_least = false,
          .must_error = 0.5};
  set_time(row, timing, 1);
  context.add(row);
}

void run_model(Context& context, const std::string& name, double seconds) {
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
      compared(model->scene, after, context.quick() ? 2 : kViews, context.quick() ? 32 : 128);
  Row row{.case_name = "hidden",
          .setting = fmt::format("{} {}", name, words(report)),
          .speed_unit = "s",
          .error = static_cast<double>(seen.changed + seen.ids),
          .error_unit = fmt::format("pixels of {} with another distance or id", seen.rays),
          .reference = fmt::format("rays of {} random views of 128² of the whole model", kViews),
          .must = seconds,
          .must_is_least = false,
          .must_error = 0.5};
  set_time(row, timing, 1);
  context.add(row);
  if (!context.quick()) run_cached(context, name, model->scene, after);
}

void run(Context& context) {
  const bool quick = context.quick();
  run_assembly(context, compiler::assemblies::nested_boxes(5, quick ? 2 : 16));
  run_assembly(context, compiler::assemblies::tank_in_a_bus(quick ? 10 : 40, 0.05));
  run_assembly(context, compiler::assemblies::bolts_in_holes(quick ? 1 : 8, 16, 3));
  if (quick) return;
  run_open(context, "skin", skin(708, 707), 0, 1);
  run_open(context, "field of grass", field(78, 24), 0, 5);
  run_open(context, "pots", pots(1900), 300, 5);
  for (const auto& [name, seconds] :
       std::vector<std::pair<const char*, double>>{{"hubble-draco-webp", 5},
                                                   {"jwst-draco-webp", 2.5},
                                                   {"iss-draco-webp", 2.5},
                                                   {"hubble-meshopt", 5},
                                                   {"sentinel6-draco-webp", 5},
                                                   {"cassini-draco-webp", 5},
                                                   {"juno-draco-webp", 5},
                                                   {"mro-draco-webp", 5},
                                                   {"newhorizons-draco-webp", 5},
                                                   {"goes-blender", 5},
                                                   {"landsat8-blender", 5},
                                                   {"spitzer-blender", 5}})
    run_model(context, name, seconds);
}

const bool kAdded = add_case({"hidden", "removal of hidden parts", run});

}  // namespace

}  // namespace panwright::bench::case_hidden
