// Small worlds to be labelled, and an independent caster over all their triangles.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "labels/compute.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "tests/support/shapes.h"
#include "world/world.h"

namespace panwright::labels::testing_support {

// Builder of a model: nodes with a mesh each.
struct ModelMaker {
  pan::Contents contents;
  std::vector<geometry::Mesh> meshes;
  std::vector<std::int32_t> node_of;

  ModelMaker() { contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)}); }
  std::int32_t node(const std::string& name, std::int32_t parent, const Vec3& at,
                    const Quat& rotation = {1, 0, 0, 0}) {
    contents.nodes.push_back({name, parent, at, rotation, Vec3(1)});
    return static_cast<std::int32_t>(contents.nodes.size()) - 1;
  }
  void add(std::int32_t node, const geometry::Mesh& mesh) {
    const auto index = static_cast<std::uint32_t>(contents.meshes.size());
    contents.meshes.push_back(pan::packed(mesh, "mesh"));
    if (contents.materials.empty()) contents.materials.emplace_back();
    contents.instances.push_back({static_cast<std::uint32_t>(node), index, 0, -1});
    meshes.push_back(mesh);
    node_of.push_back(node);
  }
  world::ModelPtr model() const {
    DiagnosticLog log;
    auto made = pan::Model::from_bytes(pan::write_to_memory(contents), "test.pan", log);
    EXPECT_TRUE(made && made->check(log)) << to_text(log);
    return std::make_shared<const pan::Model>(std::move(*made));
  }
};

inline FrameLabels labelled(const world::World& world, const world::Camera& camera,
                            const LabelOptions& options = {}, const FrameContext& context = {},
                            const Job& job = {}) {
  DiagnosticLog log;
  Labeller labeller(options);
  auto frame = labeller.label(world, camera, context, log, job);
  EXPECT_TRUE(frame) << to_text(log);
  return frame ? *std::move(frame) : FrameLabels{};
}

inline int coverage_at(const Mask& mask, std::uint32_t x, std::uint32_t y) {
  if (x < mask.left || y < mask.top || x >= mask.left + mask.width || y >= mask.top + mask.height)
    return 0;
  return mask.coverage[std::size_t{y - mask.top} * mask.width + (x - mask.left)];
}

// Uniform numbers, the same everywhere.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  Vec3 vector(double half) {
    const double x = between(-half, half), y = between(-half, half);
    return {x, y, between(-half, half)};
  }
  Quat rotation() {
    for (;;) {
      const Vec3 v = vector(1);
      const double w = between(-1, 1), square = w * w + glm::dot(v, v);
      if (square > 0.1 && square < 1) return glm::normalize(Quat(w, v.x, v.y, v.z));
    }
  }

 private:
  std::mt19937_64 engine_;
};

// All triangles of a world in its axes, and rays against each of them.
class BruteCaster {
 public:
  struct Surface {
    Vec3 a, b, c;
    std::uint32_t target = 0;
    std::int32_t node = 0;
    bool closed = false;
  };
  void add(const ModelMaker& maker, std::uint32_t target, const world::Pose& pose) {
    std::vector<Mat4> world_from;
    for (const auto& node : maker.contents.nodes) {
      const Mat4 local = matrix_from_trs(node.translation, node.rotation, node.scale);
      world_from.push_back(
          (node.parent < 0 ? pose.matrix() : world_from[static_cast<std::size_t>(node.parent)]) *
          local);
    }
    for (std::size_t k = 0; k < maker.meshes.size(); ++k)
      for (const auto& t : maker.meshes[k].triangles) {
        const auto at = [&](std::size_t corner) {
          return Vec3(world_from[static_cast<std::size_t>(maker.node_of[k])] *
                      Vec4(maker.meshes[k].positions[t[corner]], 1));
        };
        surfaces.push_back({at(0), at(1), at(2), target, maker.node_of[k], maker.meshes[k].closed});
      }
  }

  struct Found {
    double distance = std::numeric_limits<double>::infinity();
    const Surface* surface = nullptr;
  };
  // insides: backs of closed meshes stop rays too.
  template <class Counts>
  Found nearest(const Vec3& origin, const Vec3& direction, double from, bool insides,
                const Counts& counts) const {
    Found best;
    for (const Surface& s : surfaces) {
      const Vec3 ab = s.b - s.a, ac = s.c - s.a;
      const Vec3 across = glm::cross(direction, ac);
      const double volume = glm::dot(ab, across);
      if (std::fabs(volume) < 1e-14) continue;
      if (s.closed && !insides && volume < 0) continue;
      const Vec3 way = origin - s.a;
      const double u = glm::dot(way, across) / volume;
      const Vec3 q = glm::cross(way, ab);
      const double v = glm::dot(direction, q) / volume;
      if (u < 0 || v < 0 || u + v > 1) continue;
      const double distance = glm::dot(ac, q) / volume;
      if (distance > from && distance < best.distance && counts(s)) best = {distance, &s};
    }
    return best;
  }
  Found nearest(const Vec3& origin, const Vec3& direction, double from = 0,
                bool insides = false) const {
    return nearest(origin, direction, from, insides, [](const Surface&) { return true; });
  }

  std::vector<Surface> surfaces;
};

}  // namespace panwright::labels::testing_support
