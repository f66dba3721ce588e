#include "workspace/internal/sky_words.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "light/air.h"
#include "sky/sky.h"

namespace panwright::workspace {
namespace {

std::string length_words(double metres) {
  return metres < 1e4 ? fmt::format("{:.4g} m", metres) : fmt::format("{:.6g} km", 1e-3 * metres);
}

std::string words_of_body(const sky::Sky& sky, std::size_t index, const Vec3& eye) {
  const sky::Ellipsoid& shape = sky.shape(index);
  const double apart = glm::length(shape.from(eye));
  const double distance = glm::length(eye - shape.centre);
  const std::string& name = sky.body(index).name;
  if (!(apart > 1)) return fmt::format("{}: not drawn, the camera is inside of it", name);
  const double height = distance * (1 - 1 / apart);
  std::string text = fmt::format("{}: {} above its ground, {:.3g} degrees wide", name,
                                 length_words(height), 2 * std::asin(1 / apart) / kDegree);
  if (sky.air(index) != nullptr && apart < sky.air(index)->top())
    text += ", the camera is in its air";
  return text;
}

}  // namespace

std::vector<std::string> sky_words(const Frame& frame, const world::World& world) {
  std::vector<std::string> out;
  if (!frame.sky || frame.sky->bodies.empty() || !frame.sun ||
      !std::holds_alternative<CameraInstrument>(frame.instrument))
    return out;
  world::World shown;
  shown.set_sky(frame.sky->bodies, frame.sky->sun_visible);
  shown.set_sun(*frame.sun);
  const sky::Sky sky(shown);
  const Vec3& eye = frame.camera().position;
  for (std::size_t i = 0; i < sky.size(); ++i) out.push_back(words_of_body(sky, i, eye));
  const auto eclipsed = [&](const std::string& what, const Vec3& at) {
    const Vec3 bands = sky.sunlight(at);
    const double share = bands.y;
    if (bands == Vec3(0))
      out.push_back(what + ": no Sun, bodies hide it");
    else if (bands.x != share || bands.z != share)
      out.push_back(
          fmt::format("{}: {:.3g}, {:.3g} and {:.3g} % of the Sun's light at 650, 550 and 450 nm, "
                      "beside bodies and through air",
                      what, 100 * bands.x, 100 * share, 100 * bands.z));
    else if (share < 1)
      out.push_back(
          fmt::format("{}: {:.3g} % of the Sun's light beside bodies", what, 100 * share));
  };
  for (const world::Instance& target : world.instances()) {
    const auto moved =
        std::find_if(frame.poses.rbegin(), frame.poses.rend(),
                     [&](const TargetPose& pose) { return pose.target == target.name(); });
    eclipsed("origin of " + in_quotes(target.name()),
             moved == frame.poses.rend() ? target.pose().translation : moved->pose.translation);
  }
  if (frame.sky->sun_visible) eclipsed("disc of the Sun in the image", eye);
  return out;
}

}  // namespace panwright::workspace
