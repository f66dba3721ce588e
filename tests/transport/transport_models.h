// Plates and boxes whose light is known, as worlds of one target.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tests/trace/trace_models.h"
#include "transport/lists.h"
#include "transport/transport.h"

namespace panwright::transport::testing_support {

using trace::testing_support::add;
using trace::testing_support::model_of;

// A rectangle from a corner along two sides; its front is that of their cross product.
inline geometry::Mesh sheet(const Vec3& corner, const Vec3& along, const Vec3& across) {
  geometry::Mesh mesh;
  mesh.positions = {corner, corner + along, corner + along + across, corner + across};
  mesh.normals.assign(4, glm::normalize(glm::cross(along, across)));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// A sphere of triangles; open, so that it has an inside.
inline geometry::Mesh ball(double radius, std::uint32_t rings) {
  geometry::Mesh mesh;
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t k = 0; k <= 2 * rings; ++k) {
      const double polar = kPi * i / rings, turn = kPi * k / rings;
      const Vec3 n(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                   std::cos(polar));
      mesh.positions.push_back(radius * n);
      mesh.normals.push_back(n);
    }
  const std::uint32_t row = 2 * rings + 1;
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t k = 0; k < 2 * rings; ++k) {
      const std::uint32_t a = i * row + k;
      if (i > 0) mesh.triangles.push_back({a, a + row, a + 1});
      if (i + 1 < rings) mesh.triangles.push_back({a + 1, a + row, a + row + 1});
    }
  return mesh;
}

// A world of one target with these meshes, all of one material.
inline world::World world_of(std::span<const geometry::Mesh> meshes,
                             const materials::Material& material) {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.materials.push_back(material);
  for (const geometry::Mesh& mesh : meshes) {
    contents.instances.push_back({0, static_cast<std::uint32_t>(contents.meshes.size()), 0, -1});
    contents.meshes.push_back(pan::packed(mesh, "mesh " + std::to_string(contents.meshes.size())));
  }
  world::World world;
  add(world, "target", contents);
  return world;
}

inline world::World world_of(std::span<const geometry::Mesh> meshes, double albedo) {
  materials::Material lambert;
  lambert.diffuse = Vec3(albedo);
  return world_of(meshes, lambert);
}

// Surfels and lists of a target, and their light from any sources.
struct Solved {
  Solved(const world::World& world, const SurfelOptions& options = {}) {
    scene.update(world);
    set.emplace(scene, 0, options, Job{});
    const std::uint32_t slots[] = {0};
    const SurfelSet* const sets[] = {&*set};
    lists = transport_lists(scene, 0, slots, sets, {}, {});
  }
  std::size_t size() const { return set->surfels().size(); }
  const light::Surfel& operator[](std::size_t i) const { return set->surfels()[i]; }
  double around(std::size_t i) const {  // share of surfaces in the view of a surfel
    double sum = 0;
    for (std::uint32_t e = lists.first[i]; e < lists.first[i + 1]; ++e)
      sum += lists.entries[e].share;
    return sum;
  }
  // sent: radiosity of a surfel without interreflections
  std::vector<double> light(double albedo, const std::function<double(std::size_t)>& sent,
                            unsigned bounces) const {
    std::vector<double> result;
    for (const Vec3& one : arriving(albedo, sent, bounces).irradiance) result.push_back(one.x);
    return result;
  }
  Arriving arriving(double albedo, const std::function<double(std::size_t)>& sent,
                    unsigned bounces) const {
    Sources sources;
    for (std::size_t i = 0; i < size(); ++i) {
      sources.albedo.emplace_back(albedo);
      sources.sent.emplace_back(sent(i));
    }
    const TransportLists* const all_lists[] = {&lists};
    const Sources* const all_sources[] = {&sources};
    const SurfelSet* const sets[] = {&*set};
    return interreflections(all_lists, all_sources, sets, bounces, {})[0];
  }
  // The same as displays read it.
  light::SurfelLight shown(const std::vector<double>& irradiance) const {
    light::SurfelLight light;
    light.grid =
        std::make_shared<light::SurfelGrid>(light::surfel_grid(set->surfels(), set->spacing()));
    for (std::size_t i = 0; i < size(); ++i) {
      const auto e = static_cast<float>(irradiance[i]);
      light.irradiance.push_back({e, e, e, static_cast<float>(1 / (*this)[i].radius)});
    }
    return light;
  }

  trace::Scene scene;
  std::optional<SurfelSet> set;
  TransportLists lists;
};

}  // namespace panwright::transport::testing_support
