// Small models and worlds for rays.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pan/model.h"
#include "pan/writer.h"
#include "trace/scene.h"
#include "world/world.h"

namespace panwright::trace::testing_support {

// A rectangle about the origin in z = 0, its normal +z.
inline geometry::Mesh plate(double width, double height) {
  geometry::Mesh mesh;
  const double x = width / 2, y = height / 2;
  mesh.positions = {{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}};
  mesh.normals.assign(4, Vec3(0, 0, 1));
  mesh.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// A closed box about the origin, its normals those of its faces.
inline geometry::Mesh box(const Vec3& sides) {
  geometry::Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        Vec3 p(0), n(0);
        p[axis] = sign * sides[axis] / 2;
        p[u] = a * sides[u] / 2;
        p[v] = b * sides[v] / 2;
        n[axis] = sign;
        mesh.positions.push_back(p);
        mesh.normals.push_back(n);
      }
      // counter-clockwise from outside
      for (std::uint32_t k = 1; k < 3; ++k)
        mesh.triangles.push_back(
            {first, first + (sign > 0 ? k : k + 1), first + (sign > 0 ? k + 1 : k)});
    }
  mesh.closed = true;
  return mesh;
}

inline pan::Contents single(const geometry::Mesh& mesh) {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.meshes.push_back(pan::packed(mesh, "mesh"));
  contents.materials.emplace_back();
  contents.instances.push_back({0, 0, 0, -1});
  return contents;
}

inline world::ModelPtr model_of(const pan::Contents& contents) {
  DiagnosticLog log;
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "test.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return std::make_shared<const pan::Model>(std::move(*model));
}

inline void add(world::World& world, const std::string& name, const pan::Contents& contents,
                const world::Pose& pose = {}) {
  DiagnosticLog log;
  EXPECT_TRUE(world.add(name, model_of(contents), pose, log)) << to_text(log);
}

inline Ray ray(const Vec3& origin, const Vec3& direction) {
  return {{origin, glm::normalize(direction)}};
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  Vec3 in_cube(double half) {
    const double x = between(-half, half), y = between(-half, half);
    return {x, y, between(-half, half)};
  }
  Quat rotation() {
    const Vec3 a = in_cube(1);
    return glm::normalize(Quat(between(0.1, 1), a.x, a.y, a.z));
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace panwright::trace::testing_support
