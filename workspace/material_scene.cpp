#include "workspace/material_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "base/random.h"
#include "geometry/mesh/strip.h"

namespace panwright::workspace {
namespace {

constexpr double kDistance = 9;  // metres from the camera to the samples
constexpr double kPitch = 1.18;  // between samples
constexpr double kSide = 1.0;    // of the tiles
const Vec3 kToSun(-0.55, -0.75, 0.42);

// Heights of a wrinkled sheet: white noise, smoothed by repeated means over 3×3, scaled to an RMS
// slope. Cells of one unit; edge samples repeat.
std::vector<double> wrinkles(int side, int passes, double rms_slope) {
  const auto n = static_cast<std::size_t>(side);
  std::vector<double> heights(n * n), next(n * n);
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = in_unit(philox({static_cast<std::uint32_t>(i), 0, 0, 0}, {7, 0})[0]) - 0.5;
  const auto at = [&](int row, int column) {
    const auto r = static_cast<std::size_t>(std::clamp(row, 0, side - 1));
    return heights[r * n + static_cast<std::size_t>(std::clamp(column, 0, side - 1))];
  };
  for (int pass = 0; pass < passes; ++pass) {
    for (int row = 0; row < side; ++row)
      for (int column = 0; column < side; ++column) {
        double sum = 0;
        for (int r = -1; r <= 1; ++r)
          for (int c = -1; c <= 1; ++c) sum += at(row + r, column + c);
        next[static_cast<std::size_t>(row) * n + static_cast<std::size_t>(column)] = sum / 9;
      }
    heights.swap(next);
  }
  double squares = 0;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column + 1 < side; ++column) {
      const double step = at(row, column + 1) - at(row, column);
      squares += step * step;
    }
  const double slope = std::sqrt(squares / static_cast<double>(side * (side - 1)));
  for (double& height : heights) height *= rms_slope / slope;
  return heights;
}

// A tile in the plane of x and y that faces +z.
geometry::Mesh wrinkled_tile() {
  constexpr int kPoints = 161;
  const std::vector<double> heights = wrinkles(kPoints, 40, 0.16);
  const double cell = kSide / (kPoints - 1);
  geometry::Mesh mesh;
  for (int row = 0; row < kPoints; ++row)
    for (int column = 0; column < kPoints; ++column) {
      const double u = column * cell / kSide;
      const double v = row * cell / kSide;
      mesh.positions.emplace_back((u - 0.5) * kSide, (v - 0.5) * kSide,
                                  heights[static_cast<std::size_t>(row * kPoints + column)] * cell);
      mesh.texcoords.emplace_back(u, v);
    }
  for (std::uint32_t row = 0; row + 1 < kPoints; ++row)
    for (std::uint32_t column = 0; column + 1 < kPoints; ++column) {
      const std::uint32_t a = row * kPoints + column;
      mesh.triangles.push_back({a, a + 1, a + kPoints + 1});
      mesh.triangles.push_back({a, a + kPoints + 1, a + kPoints});
    }
  geometry::compute_normals(mesh, kPi);
  return mesh;
}

// The rotation that takes +z to a direction, +y as far upwards as can be.
Quat facing(const Vec3& normal) {
  const Vec3 z = glm::normalize(normal);
  const Vec3 x = glm::normalize(glm::cross(Vec3(0, 0, 1), z));
  return glm::quat_cast(Mat3(x, glm::cross(z, x), z));
}

// The textures of a material's maps, which are numbers of them then.
void take_textures(materials::Maps& maps, const pxn::DescribedMaterial& from, scene::Scene& scene) {
  std::map<std::int32_t, std::int32_t> taken;
  for (std::int32_t* map :
       {&maps.albedo, &maps.normal, &maps.roughness, &maps.reflectance, &maps.cutout}) {
    if (*map < 0 || !from.textures) continue;
    const auto [number, is_new] =
        taken.try_emplace(*map, static_cast<std::int32_t>(scene.textures.size()));
    if (is_new) scene.textures.push_back((*from.textures)[static_cast<std::size_t>(*map)]);
    *map = number->second;
  }
}

// A wall or a lamp of the studio: a glowing sheet that faces the origin.
struct Glow {
  const char* name;
  Vec3 place;
  double width, height;
  double brightness;  // of a white Lambert plate under the Sun at its normal: 1
};

// Nothing stands between the samples and the Sun or the camera. The window is where the tiles
// mirror the viewer's direction.
const Glow kStudio[] = {{"ceiling", {0, 1, 4.5}, 14, 9, 0.35},
                        {"floor", {0, 1, -4.5}, 14, 12, 0.06},
                        {"left", {-7.5, 0.5, 0}, 11, 7, 0.15},
                        {"left lamp", {-7.4, 1, 0.5}, 2.4, 4, 1.6},
                        {"right", {7.5, 0.5, 0}, 11, 7, 0.12},
                        {"right lamp", {7.4, -1, 1.5}, 0.7, 4.5, 1.2},
                        {"front", {0, -14, 0}, 20, 9, 0.10},
                        {"window 1", {-4.45, -13.9, 2.45}, 0.95, 0.95, 1.1},
                        {"window 2", {-3.3, -13.9, 2.45}, 0.95, 0.95, 1.1},
                        {"window 3", {-4.45, -13.9, 3.6}, 0.95, 0.95, 1.1},
                        {"window 4", {-3.3, -13.9, 3.6}, 0.95, 0.95, 1.1}};

void add_studio(scene::Scene& scene) {
  for (const Glow& glow : kStudio) {
    materials::Material material;
    material.name = glow.name;
    material.diffuse = Vec3(0);
    material.emissive = Vec3(1);
    material.weights = {0, 0, glow.brightness};
    const auto number = static_cast<std::int32_t>(scene.materials.size());
    scene.materials.push_back(std::move(material));
    // the normal along one axis, so that edges are level
    const Vec3 to = -glow.place;
    const Vec3 size = glm::abs(to);
    Vec3 normal(0);
    const int axis = size.y >= size.x && size.y >= size.z ? 1 : size.x >= size.z ? 0 : 2;
    normal[axis] = to[axis] > 0 ? 1 : -1;
    const Quat rotation =
        axis == 2 ? (normal.z > 0 ? Quat(1, 0, 0, 0) : Quat(0, 1, 0, 0)) : facing(normal);
    add_shape(scene, glow.name, geometry::Plane{glow.width, glow.height}, glow.place, rotation,
              number);
  }
}

}  // namespace

void add_shape(scene::Scene& scene, const char* name, geometry::Shape shape, const Vec3& place,
               const Quat& rotation, std::int32_t material) {
  scene::Node node;
  node.name = name;
  node.parent = 0;
  node.parent_from_node.translation = place;
  node.parent_from_node.rotation = rotation;
  scene::Instance instance;
  instance.node = static_cast<std::int32_t>(scene.nodes.size());
  instance.shape = static_cast<std::int32_t>(scene.shapes.size());
  instance.material = material;
  scene.nodes.push_back(std::move(node));
  scene.shapes.push_back(std::move(shape));
  scene.instances.push_back(std::move(instance));
}

scene::Scene sample_scene(const pxn::DescribedMaterial& material, SampleLight light) {
  scene::Scene scene;
  scene.materials.push_back(material.material);
  take_textures(scene.materials[0].maps, material, scene);
  scene.budget.tolerance = 2e-4;
  scene::Node root;
  root.name = "root";
  scene.nodes.push_back(root);
  add_shape(scene, "sphere", geometry::Sphere{.radius = kSide / 2, .counts = {}}, {-kPitch, 0, 0},
            Quat(1, 0, 0, 0), 0);
  // halfway between the Sun and the viewer, and 12 degrees back towards the viewer: a mirror's
  // glint misses the tile, a rough surface shows the flank of its highlight
  const Vec3 to_viewer(0, -1, 0);
  const Vec3 halfway = glm::normalize(glm::normalize(kToSun) + to_viewer);
  const Quat tilt = facing(halfway + 1.2 * to_viewer);
  add_shape(scene, "tile", geometry::Plane{kSide, kSide}, Vec3(0), tilt, 0);
  add_shape(scene, "wrinkled", std::make_shared<const geometry::Mesh>(wrinkled_tile()),
            {kPitch, 0, 0}, tilt, 0);
  if (light == SampleLight::studio) add_studio(scene);
  return scene;
}

world::Camera sample_camera(std::uint32_t width) {
  world::Camera camera;
  world::set_field_of_view(camera, width, width / 3, 2 * det::atan(1.83 / kDistance));
  camera.position = {0, -kDistance, 0};
  DiagnosticLog log;
  camera.world_from_camera = *world::looking_at(camera.position, Vec3(0), std::nullopt, log);
  return camera;
}

world::Sun sample_sun() {
  world::Sun sun;
  sun.direction = kToSun;
  return sun;
}

}  // namespace panwright::workspace
