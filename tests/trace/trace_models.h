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
#include "tests/support/shapes.h"
#include "trace/scene.h"
#include "world/world.h"

namespace panwright::trace::testing_support {

using support::box;
using support::plate;

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
