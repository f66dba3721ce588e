#include "pxn/reader/obstacles.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/axis_box.h"
#include "geometry/mesh/check.h"
#include "geometry/tessellate/tessellate.h"

namespace panwright::pxn {

namespace {

// of the reach: how far facets of a curved shape may lie from it
constexpr double kObstacleFacetShare = 0.02;

AxisBox box_of(const geometry::Mesh& mesh, const Mat4& world) {
  AxisBox box;
  for (const Vec3& p : mesh.positions) box.add(Vec3(world * Vec4(p, 1)));
  return box;
}

double size_of(const geometry::Mesh& mesh) {
  const AxisBox box = box_of(mesh, Mat4(1));
  return mesh.positions.empty() ? 0 : box.diagonal();
}

Hash128 hash_of(const geometry::Mesh& mesh) {
  KeyHasher key;
  key.list(mesh.positions);
  key.list(mesh.triangles);
  return key.key();
}

struct Self {
  std::uint32_t instance;
};

bool is_other(const void* data, const geometry::InstanceHit& hit) {
  return static_cast<const Self*>(data)->instance != hit.instance;
}

}  // namespace

geometry::MeshShape mesh_of(const geometry::Shape& shape, double error) {
  if (const auto* mesh = std::get_if<geometry::MeshShape>(&shape)) return *mesh;
  DiagnosticLog ignored;
  auto made = geometry::tessellated(shape, {.max_error = error}, {}, ignored);
  return made ? std::make_shared<const geometry::Mesh>(*std::move(made)) : nullptr;
}

Obstacles::Obstacles(const scene::Scene& scene, std::span<const std::int32_t> wrapped, double reach,
                     const Job& job) {
  const std::vector<Mat4> worlds = scene::world_from_nodes(scene);
  const std::size_t count = scene.instances.size();
  std::map<std::int32_t, geometry::MeshShape> meshes;  // of shapes, as the largest place asks
  std::vector<double> largest(scene.shapes.size(), 0);
  for (const scene::Instance& one : scene.instances) {
    const Mat4& world = worlds[static_cast<std::size_t>(one.node)];
    double& most = largest[static_cast<std::size_t>(one.shape)];
    for (int k = 0; k < 3; ++k) most = std::max(most, glm::length(Vec3(world[k])));
  }
  std::vector<AxisBox> boxes(count);
  for (std::size_t i = 0; i < count; ++i) {
    job.poll();
    const scene::Instance& one = scene.instances[i];
    const auto shape = static_cast<std::size_t>(one.shape);
    const auto [mesh, fresh] = meshes.try_emplace(one.shape);
    if (fresh && largest[shape] > 0) {
      // note: a planet beside a blanket is no finer than itself needs
      mesh->second = mesh_of(scene.shapes[shape], 1e300);
      const double size = mesh->second ? size_of(*mesh->second) : 0;
      const double error = std::max(kObstacleFacetShare * reach / largest[shape], kFinest * size);
      if (mesh->second && !std::holds_alternative<geometry::MeshShape>(scene.shapes[shape]))
        mesh->second = mesh_of(scene.shapes[shape], error);
    }
    if (mesh->second) boxes[i] = box_of(*mesh->second, worlds[static_cast<std::size_t>(one.node)]);
  }
  std::map<std::int32_t, std::uint32_t> added;
  std::map<std::int32_t, Hash128> hashes;
  for (std::size_t i = 0; i < count; ++i) {
    const scene::Instance& one = scene.instances[i];
    const geometry::MeshShape& mesh = meshes.at(one.shape);
    if (!mesh || mesh->triangles.empty() || std::ranges::none_of(wrapped, [&](std::int32_t w) {
          return boxes[i].meets(boxes[static_cast<std::size_t>(w)], reach);
        }))
      continue;
    const auto [known, fresh] = added.try_emplace(one.shape, 0);
    if (fresh) {
      known->second = caster_.add_mesh(mesh->positions, mesh->triangles);
      hashes[one.shape] = hash_of(*mesh);
    }
    const bool exact = !std::holds_alternative<geometry::MeshShape>(
        scene.shapes[static_cast<std::size_t>(one.shape)]);
    const Mat4& world = worlds[static_cast<std::size_t>(one.node)];
    caster_.add(known->second, world, true);
    standing_.push_back({hashes[one.shape], world, boxes[i]});
    instances_.push_back(static_cast<std::int32_t>(i));
    exact_.push_back(exact ? 1 : 0);
  }
}

void Obstacles::build(const Job& job) {
  if (!built_) caster_.build(job);
  built_ = true;
}

double Obstacles::room(std::int32_t of, const Vec3& from, const Vec3& along, double least,
                       double most) const {
  const auto at = std::ranges::lower_bound(instances_, of);
  const auto index = static_cast<std::size_t>(at - instances_.begin());
  const bool own = at != instances_.end() && *at == of && exact_[index] != 0;
  const Self self{own ? static_cast<std::uint32_t>(index) : ~std::uint32_t{0}};
  const auto hit = caster_.closest({from, along, least, most}, {is_other, &self});
  return hit ? hit->distance : most;
}

bool Obstacles::add_near(std::int32_t of, std::span<const AxisBox> boxes, KeyHasher& key) const {
  AxisBox all;
  for (const AxisBox& box : boxes) all.add(box);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < standing_.size(); ++i) {
    const AxisBox& there = standing_[i].box;
    const bool own = instances_[i] == of && exact_[i] != 0;
    if (!own && all.meets(there) &&
        std::ranges::any_of(boxes, [&](const AxisBox& box) { return box.meets(there); }))
      near.push_back(i);
  }
  key.number(near.size());
  for (const std::size_t i : near) {
    key.hash(standing_[i].mesh);
    for (int k = 0; k < 16; ++k) key.real(standing_[i].world[k / 4][k % 4]);
  }
  return !near.empty();
}

}  // namespace panwright::pxn
