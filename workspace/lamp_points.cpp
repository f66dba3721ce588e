#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <variant>

#include "light/light.h"
#include "sky/sky.h"
#include "workspace/internal/lamp_points.h"
#include "world/lamps.h"

namespace panwright::workspace {
namespace {

constexpr double kPointsInPixel = 16;
constexpr double kMostPoints = 65536;
constexpr double kPointRadius = 0.1;  // pixels; smaller ones are a point
constexpr double kBeside = 1e-6;      // of the distance, for a lamp that lies on a surface

struct Face {
  Vec3 centre{0};
  std::optional<Vec3> axis;  // of a disc; none: towards the camera
  double radius = 0;
};

std::optional<Face> face_of(const light::Source& source) {
  return std::visit(
      [](const auto& one) -> std::optional<Face> {
        using Kind = std::decay_t<decltype(one)>;
        if constexpr (std::is_same_v<Kind, light::Sun>)
          return std::nullopt;
        else if constexpr (std::is_same_v<Kind, light::Disc>)
          return Face{one.position, one.axis, one.radius};
        else
          return Face{one.position, std::nullopt, one.radius};
      },
      source);
}

// Whether a body of the sky stands between two points.
bool body_hides(const sky::Sky& sky, const Vec3& eye, const Vec3& point) {
  for (std::size_t i = 0; i < sky.size(); ++i) {
    const sky::Ellipsoid& shape = sky.shape(i);
    const Vec3 from = shape.from(eye);
    const Vec3 along = shape.unit_from_world * (point - eye);
    const double square = std::max(glm::dot(along, along), 1e-300);
    const Vec3 nearest = from + std::clamp(-glm::dot(from, along) / square, 0.0, 1.0) * along;
    if (glm::dot(from, from) > 1 && glm::dot(nearest, nearest) < 1) return true;
  }
  return false;
}

}  // namespace

std::vector<LampPoint> lamp_points(const world::World& world, const world::Camera& camera,
                                   double margin, preview::Reference& reference, const Job& job) {
  std::vector<LampPoint> found;
  if (world.lamps().empty() || camera.projection != world::Projection::perspective) return found;
  std::vector<Vec3> places;
  std::vector<double> beside;
  for (const light::Source& source : world::placed_lamps(world, camera)) {
    const std::optional<Face> face = face_of(source);
    if (!face) continue;
    const Vec3 light = light::incidence(source, camera.position).irradiance;
    const Vec3 to_camera = camera.position - face->centre;
    const double distance = glm::length(to_camera);
    if (light == Vec3(0) || !(distance > face->radius)) continue;
    const double pixels = face->radius / distance * std::max(camera.focal.x, camera.focal.y);
    const auto count = static_cast<std::size_t>(
        pixels < kPointRadius
            ? 1.0
            : std::clamp(kPointsInPixel * kPi * pixels * pixels, 7.0, kMostPoints));
    const Vec3 z = glm::normalize(face->axis.value_or(to_camera));
    const Vec3 x =
        glm::normalize(glm::cross(z, std::fabs(z.z) < 0.8 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
    const Vec3 y = glm::cross(z, x);
    for (std::size_t k = 0; k < count; ++k) {
      // Vogel's spiral, even over a disc
      const double out = count == 1 ? 0
                                    : face->radius * std::sqrt((static_cast<double>(k) + 0.5) /
                                                               static_cast<double>(count));
      const double turn = 2.399963229728653 * static_cast<double>(k);
      const Vec3 place = face->centre + out * (det::cos(turn) * x + det::sin(turn) * y);
      const auto pixel = world::project(camera, place);
      if (!pixel || !(pixel->x >= -margin && pixel->x < camera.width + margin &&
                      pixel->y >= -margin && pixel->y < camera.height + margin))
        continue;
      found.push_back({*pixel, light / static_cast<double>(count)});
      places.push_back(place);
      beside.push_back(std::max(face->radius, kBeside * distance));
    }
  }
  if (found.empty()) return found;
  const std::vector<std::uint8_t> hidden = reference.hidden(world, camera, places, beside, job);
  std::optional<sky::Sky> sky;
  if (!world.bodies().empty()) sky.emplace(world);
  std::vector<LampPoint> seen;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (hidden[i] == 0 && !(sky && body_hides(*sky, camera.position, places[i])))
      seen.push_back(found[i]);
  return seen;
}

}  // namespace panwright::workspace
