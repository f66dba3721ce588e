// Small models, a shared context, and measurements of images.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/tessellate/tessellate.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "preview/renderer.h"
#include "tests/support/model_renderer.h"
#include "tests/support/shapes.h"

namespace panwright::preview::testing_support {

// Returns OSMesa, so that every machine draws the same bits; PANWRIGHT_TEST_GL=egl tries a GPU
// instead.
inline ContextKind tested_context() {
  const char* name = std::getenv("PANWRIGHT_TEST_GL");
  if (!name || !*name) return ContextKind::osmesa;
  const auto kind = context_kind_from_name(name);
  EXPECT_TRUE(kind) << "PANWRIGHT_TEST_GL=" << name << ": auto, egl or osmesa";
  return kind.value_or(ContextKind::osmesa);
}

inline const std::shared_ptr<Device>& shared_device() {
  static const std::shared_ptr<Device> device = [] {
    DiagnosticLog log;
    auto created = Device::create(tested_context(), log);
    EXPECT_TRUE(created) << to_text(log);
    return created ? std::move(*created) : nullptr;
  }();
  return device;
}

// Returns the bound of the tested context. Hardware puts vertices on a grid of 1/256 pixel and
// interpolates from there, and weighs texels in steps of 1/256; Mesa's software does both in float.
inline double bound(double software, double hardware) {
  const auto& device = shared_device();
  return device && device->context().is_hardware() ? hardware : software;
}

inline geometry::Mesh sphere(std::uint32_t rings, std::uint32_t quads, bool texcoords = false) {
  DiagnosticLog log;
  geometry::TessellationOptions options;
  options.texcoords = texcoords;
  auto mesh = geometry::tessellated(geometry::Sphere{1.0, geometry::SphereCounts{rings, quads}},
                                    options, {}, log);
  EXPECT_TRUE(mesh) << to_text(log);
  return *mesh;
}

using support::box;
using support::plate;

inline materials::Material lambert(double albedo) {
  materials::Material material;
  material.diffuse = Vec3(albedo);
  return material;
}

// A model with one instance of one mesh at the root.
inline pan::Contents single(const geometry::Mesh& mesh, const materials::Material& material) {
  pan::Contents contents;
  contents.nodes.push_back({"root", -1, Vec3(0), Quat(1, 0, 0, 0), Vec3(1)});
  contents.meshes.push_back(pan::packed(mesh, "mesh"));
  contents.materials.push_back(material);
  contents.instances.push_back({0, 0, 0, -1});
  return contents;
}

inline pan::Model model_of(const pan::Contents& contents) {
  DiagnosticLog log;
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "test.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return std::move(*model);
}

inline image::Image rendered(const pan::Model& model, const View& view,
                             const RenderOptions& options = {},
                             const std::shared_ptr<Device>& device = shared_device()) {
  DiagnosticLog log;
  support::ModelRenderer renderer(device, model);
  auto image = renderer.render(view, options, log);
  EXPECT_TRUE(image) << to_text(log);
  return std::move(*image);
}

// Returns a camera that looks at the origin from a direction and a distance. The Sun is at a phase
// angle from it, towards the image's right.
inline View looking_from(const Vec3& direction, double distance, double fov, std::uint32_t size,
                         double phase = 0) {
  DiagnosticLog log;
  View view;
  set_field_of_view(view.camera, size, size, fov);
  view.camera.position = glm::normalize(direction) * distance;
  view.camera.world_from_camera = *world::looking_at(view.camera.position, Vec3(0), {}, log);
  view.to_sun = view.camera.world_from_camera * Vec3(std::sin(phase), 0, -std::cos(phase));
  return view;
}

// Returns Σ L·Ω·d² of the first channel: the intensity of the image, W/sr per unit irradiance.
inline double intensity(const image::Image& image, const world::Camera& camera, double distance) {
  double sum = 0;
  for (std::uint32_t j = 0; j < image.height; ++j)
    for (std::uint32_t i = 0; i < image.width; ++i) {
      const double radiance = image.radiance[3 * (std::size_t{j} * image.width + i)];
      if (radiance != 0) sum += radiance * pixel_solid_angle(camera, i, j);
    }
  return sum * distance * distance;
}

inline Vec2 photocentre(const image::Image& image) {
  double sum = 0;
  Vec2 moment(0);
  for (std::uint32_t j = 0; j < image.height; ++j)
    for (std::uint32_t i = 0; i < image.width; ++i) {
      const double radiance = image.radiance[3 * (std::size_t{j} * image.width + i)];
      sum += radiance;
      moment += radiance * Vec2(i + 0.5, j + 0.5);
    }
  return moment / sum;
}

inline void expect_no_nan(const image::Image& image) {
  std::size_t bad = 0;
  for (const float value : image.radiance) bad += !(value >= 0 && std::isfinite(value));
  for (const float value : image.coverage) bad += !(value >= 0 && value <= 1);
  for (const float value : image.depth) bad += std::isnan(value);
  for (const float value : image.range) bad += std::isnan(value);
  for (const float value : image.normal) bad += !std::isfinite(value);
  EXPECT_EQ(bad, 0u);
}

}  // namespace panwright::preview::testing_support
