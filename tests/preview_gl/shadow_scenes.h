// Casters and receivers of shadows, for tests.
#pragma once

#include "textured.h"

namespace panwright::preview::testing_support {

// A view with and without shadows.
struct Pair {
  image::Image with;
  image::Image without;
  // visible share of the Sun at a pixel; -1 for unlit ones
  double sun(std::size_t pixel) const {
    const double whole = without.radiance[3 * pixel];
    return whole > 0 ? with.radiance[3 * pixel] / whole : -1;
  }
};

inline Pair both(const pan::Model& model, const View& view, RenderOptions options = {}) {
  DiagnosticLog log;
  support::ModelRenderer renderer(shared_device(), model);
  options.ground_truth = true;
  auto with = renderer.render(view, options, log);
  options.shadow_side = 0;
  auto without = renderer.render(view, options, log);
  EXPECT_TRUE(with && without) << to_text(log);
  expect_no_nan(*with);
  EXPECT_EQ(with->coverage, without->coverage);
  return {*std::move(with), *std::move(without)};
}

// Returns the Sun at an angle from +z, turned about it.
inline Vec3 sun_at(double degrees, double turn) {
  const double angle = degrees * kDegree;
  return {std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), std::cos(angle)};
}

// A plate in z = 0.
inline pan::Contents meadow() { return single(plate(8, 8), lambert(1)); }

inline void add(pan::Contents& contents, const geometry::Mesh& mesh, const Vec3& at,
                const Quat& turn = Quat(1, 0, 0, 0), const Vec3& scale = Vec3(1)) {
  contents.meshes.push_back(pan::packed(mesh, "mesh"));
  contents.nodes.push_back({"node", 0, at, turn, scale});
  contents.instances.push_back({static_cast<std::uint32_t>(contents.nodes.size() - 1),
                                static_cast<std::uint32_t>(contents.meshes.size() - 1), 0, -1});
}

}  // namespace panwright::preview::testing_support
