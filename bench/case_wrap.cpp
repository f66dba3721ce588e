// Blankets over imported spacecraft: what wears one, how fast it is made, how high it lies, and
// whether it meets what is below or near.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "base/axis_box.h"
#include "bench/bench.h"
#include "geometry/ray/instances.h"
#include "mli/wrap.h"
#include "workspace/open.h"

namespace panwright::bench::case_wrap {
namespace {

// A mesh of the file where it stands, metres in the world.
struct Part {
  geometry::Mesh mesh;
  std::vector<std::uint32_t> faces;
};

std::vector<Part> parts_of(const scene::Scene& scene) {
  const std::vector<Mat4> worlds = scene::world_from_nodes(scene);
  std::vector<Part> out;
  for (const scene::Instance& one : scene.instances) {
    const auto* shape =
        std::get_if<geometry::MeshShape>(&scene.shapes[static_cast<std::size_t>(one.shape)]);
    if (!shape || (*shape)->triangles.empty()) continue;
    const Mat4& world = worlds[static_cast<std::size_t>(one.node)];
    Part part;
    for (const Vec3& p : (*shape)->positions)
      part.mesh.positions.push_back(Vec3(world * Vec4(p, 1)));
    part.mesh.triangles = (*shape)->triangles;
    if (glm::determinant(Mat3(world)) < 0)
      for (auto& t : part.mesh.triangles) std::swap(t[1], t[2]);
    for (std::uint32_t t = 0; t < part.mesh.triangles.size(); ++t) part.faces.push_back(t);
    out.push_back(std::move(part));
  }
  return out;
}

double area_of(const std::vector<Vec3>& at, const geometry::Triangle& t) {
  return glm::length(glm::cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]])) / 2;
}

// What rays from points of a blanket to the places below find.
struct Look {
  std::uint64_t rays = 0;
  std::uint64_t pierced = 0;  // that meet the faces of the same group
  std::uint64_t others = 0;   // or others
  double worst_mean = 0;      // of groups with enough rays that nothing holds down: relative
};

void look(std::uint32_t part, const mli::Wrap& wrap, const geometry::InstanceCaster& caster,
          double stand_off, double rays_a_square_metre, std::mt19937_64& random, Look& out) {
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (const mli::WrapGroup& group : wrap.groups) {
    if (!group.accepted) continue;
    double sum = 0, weight = 0;
    std::uint64_t rays = 0;
    for (std::size_t k = group.first; k < group.first + group.count; ++k) {
      const geometry::Triangle& t = wrap.blanket.triangles[k];
      // seams stand on the border's edges, over no faces
      const double whole = area_of(wrap.blanket.positions, t), below = area_of(wrap.roots, t);
      const double share = whole > 0 ? below / whole : 0;
      double left = rays_a_square_metre * whole;
      for (; left > 0; left -= 1) {
        if (left < 1 && uniform() > left) break;
        double a = uniform(), b = uniform();
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const auto between = [&](const std::vector<Vec3>& at) {
          return at[t[0]] + a * (at[t[1]] - at[t[0]]) + b * (at[t[2]] - at[t[0]]);
        };
        const Vec3 top = between(wrap.blanket.positions), root = between(wrap.roots);
        const double height = glm::length(top - root);
        if (!(height > 1e-3 * stand_off)) continue;  // the foot of a seam
        ++rays;
        const auto hit = caster.closest({top, root - top, 0, height});
        if (hit && hit->distance < height - 0.01 * stand_off) {
          const bool own =
              hit->instance == part &&
              std::binary_search(group.faces.begin(), group.faces.end(), hit->triangle);
          ++(own ? out.pierced : out.others);
        }
        sum += share * height;
        weight += share;
      }
    }
    out.rays += rays;
    if (rays >= 20'000 && group.held + group.cornered == 0)
      out.worst_mean = std::max(out.worst_mean, std::fabs(sum / weight / stand_off - 1));
  }
}

void spacecraft(Context& context, const std::string& name, std::uint64_t rays) {
  const auto path = context.source("../shared/data/spacecraft-gltf/" + name + ".glb");
  if (path.empty()) return context.note(name + ": not there");
  DiagnosticLog log;
  const auto imported = workspace::read_cad(path, {}, log);
  if (!imported) return context.note(name + ": not read");
  const std::vector<Part> parts = parts_of(imported->scene);
  geometry::InstanceCaster caster;
  AxisBox box;
  double whole = 0;
  for (const Part& part : parts) {
    caster.add(caster.add_mesh(part.mesh.positions, part.mesh.triangles), Mat4(1), false);
    for (const Vec3& p : part.mesh.positions) box.add(p);
    for (const auto& t : part.mesh.triangles) whole += area_of(part.mesh.positions, t);
  }
  caster.build();
  const double stand_off = box.diagonal() / 400;
  mli::Recipe recipe;
  recipe.xgrid = 1;
  recipe.width = recipe.height = stand_off;
  recipe.operations = {mli::Random{0.3 * stand_off}, mli::Smooth{2}};
  mli::WrapOptions options;
  options.stand_off = stand_off;
  options.tell = false;
  options.room = [&](const Vec3& from, const Vec3& along, double most) {
    const auto hit = caster.closest({from, along, 0.01 * stand_off, most});
    return hit ? hit->distance : most;
  };
  Look found;
  mli::WrapTally tally;
  std::size_t triangles = 0;
  std::chrono::duration<double> seconds{0};
  std::mt19937_64 random(3);
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    const auto start = std::chrono::steady_clock::now();
    DiagnosticLog said;
    const auto wrap = mli::wrapped(part.mesh, part.faces, mli::fitted(recipe), options, said);
    seconds += std::chrono::steady_clock::now() - start;
    if (!wrap) continue;
    tally.add(*wrap);
    triangles += wrap->blanket.triangles.size();
    look(i, *wrap, caster, stand_off, static_cast<double>(rays) / whole, random, found);
  }
  Row row;
  row.case_name = "wrap";
  row.setting = fmt::format(
      "{}: {} of {} groups, {:.1f} % of the area, {:.1f} % of that lower below other parts, {} "
      "triangles",
      name, tally.groups - tally.refused, tally.groups,
      100 * (tally.area - tally.area_refused) / whole,
      100 * tally.held / std::max(tally.area - tally.area_refused, 1e-300), triangles);
  row.speed = 1e-6 * static_cast<double>(triangles) / seconds.count();
  row.speed_unit = "M triangles/s";
  row.runs = 1;
  row.error = found.worst_mean;
  row.error_unit = "of the stand-off, the mean height of a group";
  row.must_error = 0.05;
  row.reference = "points of the blanket over the faces below";
  context.add(row);
  const auto share = [&](std::uint64_t part) {
    return static_cast<double>(part) / static_cast<double>(std::max<std::uint64_t>(1, found.rays));
  };
  row.setting = fmt::format("{}: {} rays to the faces below, other parts apart", name, found.rays);
  row.error = share(found.pierced);
  row.error_unit = "of the rays meet the faces before";
  row.must_error = 1e-12;
  row.reference = "rays among all parts of the file";
  context.add(row);
  row.setting = fmt::format("{}: the same, other parts", name);
  row.error = share(found.others);
  row.error_unit = "of the rays meet another part before";
  row.must_error = 0;
  context.add(row);
}

void run(Context& context) {
  const std::uint64_t rays = context.quick() ? 10'000 : 1'500'000;
  for (const char* name : {"cassini-draco-webp", "hubble-draco-webp", "mro-draco-webp",
                           "juno-draco-webp", "spitzer-blender"}) {
    spacecraft(context, name, rays);
    if (context.quick()) break;
  }
}

const bool kAdded = add_case({"wrap", "blankets over imported spacecraft", run});

}  // namespace
}  // namespace panwright::bench::case_wrap
