#include "studio/details.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "world/evaluation.h"

namespace panwright::studio {
namespace {

// Okabe and Ito, "Color Universal Design" (2008): suited to colour blindness.
constexpr std::array<std::array<std::uint8_t, 3>, 7> kLevelColors = {{{240, 228, 66},
                                                                      {230, 159, 0},
                                                                      {213, 94, 0},
                                                                      {204, 121, 167},
                                                                      {0, 114, 178},
                                                                      {86, 180, 233},
                                                                      {0, 158, 115}}};

// Pixel footprint at the nearest point of a target's box, metres; 0: the camera is inside.
double pixel_footprint(const world::Camera& camera, const world::Instance& target,
                       const AxisBox& bounds) {
  const double focal = std::max(camera.focal.x, camera.focal.y);
  if (camera.projection == world::Projection::orthographic) return 1 / focal;
  const world::Pose& pose = target.pose();
  const Vec3 eye = glm::conjugate(pose.rotation) * (camera.position - pose.translation);
  return glm::length(eye - glm::clamp(eye, bounds.low, bounds.high)) / focal;
}

// Levels change at footprints of powers of two metres.
double footprint_octave(double pixel) { return pixel > 0 ? std::ldexp(1.0, std::ilogb(pixel)) : 0; }

void add_mesh_detail(const pan::Model& model, std::uint32_t index, double stretch, double pixel,
                     Detail& detail) {
  const auto& instance = model.instances()[index];
  std::uint32_t mesh = instance.mesh;
  double error = model.meshes()[mesh].error;
  int level = model.levels(index).empty() ? -1 : 0;
  int at = 0;
  for (const auto& each : model.levels(index)) {
    ++at;
    if (!(each.detail * stretch <= footprint_octave(pixel))) break;
    mesh = each.mesh;
    error = model.meshes()[instance.mesh].error + each.error;
    level = at;
  }
  detail.level = std::max(detail.level, level);
  detail.triangles += model.meshes()[mesh].triangle_count;
  detail.finest += model.meshes()[instance.mesh].triangle_count;
  detail.error = std::max(detail.error, error * stretch);
}

}  // namespace

std::vector<Detail> details_of(const world::World& world, const world::Camera& camera) {
  std::vector<Detail> out;
  for (std::size_t t = 0; t < world.size(); ++t) {
    const pan::Model& model = *world[t].model();
    const world::EvaluatedInstance state = world::evaluated(world[t]);
    const double pixel = state.bounds ? pixel_footprint(camera, world[t], *state.bounds) : 0;
    std::map<std::uint32_t, Detail> nodes;
    for (std::uint32_t i = 0; i < model.instances().size(); ++i) {
      const std::uint32_t node = model.instances()[i].node;
      Detail& detail = nodes[node];
      detail.target = t;
      detail.node = node;
      detail.visible = state.node_visible[node] != 0;
      add_mesh_detail(model, i, stretch_of(state.model_from_nodes[node]).largest, pixel, detail);
      if (pixel > 0) detail.pixels = detail.error / pixel;
    }
    for (const auto& [node, detail] : nodes) out.push_back(detail);
  }
  return out;
}

void level_color(int level, std::uint8_t* rgb) {
  if (level < 0) {
    std::fill_n(rgb, 3, std::uint8_t{120});
    return;
  }
  const auto& color =
      kLevelColors[std::min(static_cast<std::size_t>(level), kLevelColors.size() - 1)];
  std::copy(color.begin(), color.end(), rgb);
}

Pixels level_pixels(const image::Image& image, const std::vector<Detail>& details) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> levels;
  for (const Detail& each : details)
    levels[{static_cast<std::uint32_t>(each.target), each.node}] = each.level;
  Pixels out;
  out.rgba.assign(4 * image.pixels(), 0);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    std::uint8_t* rgba = &out.rgba[4 * i];
    rgba[3] = 255;
    if (image.target_id[i] == 0) continue;
    const auto found = levels.find({image.target_id[i] - 1, image.node_id[i] - 1});
    level_color(found == levels.end() ? -1 : found->second, rgba);
    // slight shading shows shapes
    const double facing = std::fabs(static_cast<double>(image.normal[3 * i + 2]));
    for (int k = 0; k < 3; ++k)
      rgba[k] = static_cast<std::uint8_t>(std::lround(rgba[k] * (0.7 + 0.3 * facing)));
  }
  return out;
}

}  // namespace panwright::studio
