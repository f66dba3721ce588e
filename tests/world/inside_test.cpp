#include "world/inside.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/pan_sample.h"

namespace panwright::world::inside_test {
namespace {

// Sum of the solid angles of a mesh's triangles about a point, over 4 pi (Van Oosterom, Strackee).
double winding(const pan::MeshView& mesh, const Vec3& point) {
  double sum = 0;
  const auto corner = [&](std::size_t i) {
    const pan::layout::Float3& p = mesh.positions[mesh.indices[i]];
    return Vec3(p.x, p.y, p.z) - point;
  };
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vec3 a = corner(i), b = corner(i + 1), c = corner(i + 2);
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    sum += 2 * std::atan2(
                   glm::dot(a, glm::cross(b, c)),
                   la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return sum / (4 * kPi);
}

TEST(ClosedPartAround, AgreesWithSolidAngles) {
  DiagnosticLog log;
  auto opened = pan::Model::from_bytes(support::small_pan(), "small.pan", log);
  ASSERT_TRUE(opened && opened->check(log)) << to_text(log);
  const auto model = std::make_shared<const pan::Model>(std::move(*opened));
  World world;
  Pose pose{Vec3(3, -2, 1), glm::angleAxis(0.7, glm::normalize(Vec3(1, 2, 3)))};
  ASSERT_TRUE(world.add("t", model, pose, log));
  Evaluation evaluation;
  evaluation.update(world);
  std::mt19937 random(1);
  const auto share = [&] { return static_cast<double>(random() % 100000) / 1e5; };  // below 1
  int found = 0;
  for (int i = 0; i < 3000; ++i) {
    // around the tetrahedron of node 1, whose node mirrors it
    const Vec3 local(evaluation[0].model_from_nodes[1] *
                     Vec4(2.4 * share() - 1.2, 2.4 * share() - 1.2, 2.4 * share() - 1.2, 1));
    bool expected = false;
    for (const pan::layout::Instance& one : model->instances()) {
      const pan::layout::Mesh& mesh = model->meshes()[one.mesh];
      if ((mesh.flags & pan::layout::kMeshClosed) == 0) continue;
      const Vec3 origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
      const Vec3 in_mesh =
          Vec3(glm::inverse(evaluation[0].model_from_nodes[one.node]) * Vec4(local, 1)) - origin;
      expected = expected || std::fabs(winding(model->mesh(one.mesh), in_mesh)) > 0.5;
    }
    const auto part = closed_part_around(world, evaluation, Vec3(pose.matrix() * Vec4(local, 1)));
    EXPECT_EQ(part.has_value(), expected) << i;
    found += part ? 1 : 0;
  }
  EXPECT_NEAR(found / 3000.0, 8.0 / 3 / 13.824, 0.03);  // its volume, of the cube's
  EXPECT_FALSE(closed_part_around(world, evaluation, Vec3(100, 0, 0)));
  world.set_visible(0, false);
  evaluation.update(world);
  EXPECT_FALSE(closed_part_around(world, evaluation, pose.translation));
}

}  // namespace
}  // namespace panwright::world::inside_test
