#include "tools/foil_scene.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "geometry/mesh/strip.h"
#include "mli/form.h"

namespace panwright::tools {
namespace {

constexpr double kDistance = 20;  // of the camera, in larger sides of the sheet
constexpr double kCrease = 30;    // degrees, as the language has it
const Vec3 kToSun(-0.50, 0.55, 0.67);

Vec2 sides(const mli::Sheet& sheet) {
  return {sheet.spacing.x * (sheet.columns - 1), sheet.spacing.y * (sheet.rows - 1)};
}

// A lamp or wall that faces the origin; lengths in larger sides of the sheet.
struct Glow {
  const char* name;
  Vec3 place;
  double width, height;
  double brightness;  // of a white Lambert plate under the Sun at its normal: 1
};

// note: a level mirror shows the viewer, thus the ceiling behind him
const Glow kStudio[] = {{"ceiling", {0, 0, 24}, 30, 30, 0.10},
                        {"near lamp", {-0.7, 1.3, 9.9}, 1.2, 1.5, 0.8},
                        {"soft lamp", {-2.6, 3.6, 8.8}, 4.2, 3.2, 1.2},
                        {"strip", {3.4, 0.6, 9.3}, 0.8, 6, 0.8},
                        {"far strip", {1.5, -5.4, 8.2}, 5, 0.7, 0.5},
                        {"left", {-12, 0, 8}, 20, 14, 0.12},
                        {"right", {12, 0, 8}, 20, 14, 0.04},
                        {"upper", {0, 12, 8}, 20, 14, 0.18},
                        {"lower", {0, -12, 8}, 20, 14, 0.03}};

Quat facing(const Vec3& normal) {
  const Vec3 z = glm::normalize(normal);
  const Vec3 across = std::fabs(z.y) < 0.9 ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  const Vec3 x = glm::normalize(glm::cross(across, z));
  return glm::quat_cast(Mat3(x, glm::cross(z, x), z));
}

}  // namespace

Result<scene::Scene> foil_scene(const mli::Sheet& sheet, const materials::Material& material,
                                workspace::SampleLight light, DiagnosticLog& log) {
  auto mesh = mli::formed(sheet, mli::Flat{}, log);
  if (!mesh) return failed;
  geometry::compute_normals(*mesh, kCrease * kDegree);
  scene::Scene scene;
  scene.materials.push_back(material);
  scene.materials[0].maps = {};
  scene::Node root;
  root.name = "root";
  scene.nodes.push_back(root);
  workspace::add_shape(scene, "sheet", std::make_shared<const geometry::Mesh>(*std::move(mesh)),
                       Vec3(0), Quat(1, 0, 0, 0), 0);
  if (light == workspace::SampleLight::sun) return scene;
  const Vec2 size = sides(sheet);
  const double unit = std::max(size.x, size.y);
  for (const Glow& glow : kStudio) {
    materials::Material lamp;
    lamp.name = glow.name;
    lamp.diffuse = Vec3(0);
    lamp.emissive = Vec3(1);
    lamp.weights = {0, 0, glow.brightness};
    const auto number = static_cast<std::int32_t>(scene.materials.size());
    scene.materials.push_back(std::move(lamp));
    workspace::add_shape(scene, glow.name, geometry::Plane{unit * glow.width, unit * glow.height},
                         unit * glow.place, facing(-glow.place), number);
  }
  return scene;
}

std::uint32_t foil_image_height(const mli::Sheet& sheet, std::uint32_t width) {
  const Vec2 size = sides(sheet);
  const double height = std::floor(width * size.y / size.x + 0.5);
  return static_cast<std::uint32_t>(std::clamp(height, 1.0, 1e9));
}

world::Camera foil_camera(const mli::Sheet& sheet, std::uint32_t width) {
  const Vec2 size = sides(sheet);
  const double distance = kDistance * std::max(size.x, size.y);
  world::Camera camera;
  world::set_field_of_view(camera, width, foil_image_height(sheet, width),
                           2 * det::atan(0.5 * size.x / distance));
  camera.position = {0, 0, distance};
  DiagnosticLog log;
  camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), Vec3(0, 1, 0), log);
  return camera;
}

world::Sun foil_sun() {
  world::Sun sun;
  sun.direction = kToSun;
  return sun;
}

}  // namespace panwright::tools
