#include "studio/view_state.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "studio/play.h"
#include "workspace/lamp_text.h"

namespace panwright::studio {
namespace {

// The nearest number of so many digits, which may be typed; the image is drawn from it.
double rounded(double value, int digits) {
  if (value == 0 || !std::isfinite(value)) return value;
  const int exponent = digits - 1 - static_cast<int>(std::floor(std::log10(std::fabs(value))));
  // powers of ten are exact, so that quotient and product are the nearest to the decimal
  const double scale = std::pow(10.0, std::abs(exponent));
  return exponent < 0 ? std::round(value / scale) * scale : std::round(value * scale) / scale;
}
double typed(double value) { return rounded(value, 9); }
Vec3 typed(const Vec3& v) { return {typed(v.x), typed(v.y), typed(v.z)}; }
// Twelve digits.
Quat typed(const Quat& q) {
  const Quat out(rounded(q.w, 12), rounded(q.x, 12), rounded(q.y, 12), rounded(q.z, 12));
  return workspace::unit_quaternion(out).value_or(q);
}

std::string shell_quoted(const std::string& word) {
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view("-_./=:@%+,").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// What is not as in the detector's file.
workspace::Settings changes_of(workspace::Settings detector) {
  if (detector.exposure && detector.exposure->number)
    detector.exposure = typed(*detector.exposure->number);
  if (detector.gain) detector.gain = typed(*detector.gain);
  if (detector.temperature) detector.temperature = typed(*detector.temperature);
  return detector;
}

// The state of the world of a moment, from outside.
void add_moment(const Moment& moment, workspace::Settings& out) {
  const workspace::Settings& settings = moment.view.settings;
  out.pose = *settings.pose;
  out.joint = *settings.joint;
  out.sun = moment.frame.sun->direction;
  if (const double distance = moment.frame.sun->distance; distance != 1)
    out.sun_distance = distance;
  if (settings.sun_irradiance) out.sun_irradiance = *settings.sun_irradiance;
  if (settings.lamp) {
    // where they are in the scenario's own image; what is changed in the window comes behind
    std::vector<std::string> lamps = workspace::fixed_lamp_texts(
        *settings.lamp, moment.frame.lamps.value_or(std::vector<world::Lamp>()),
        moment.frame.camera());
    if (out.lamp) lamps.insert(lamps.end(), out.lamp->begin(), out.lamp->end());
    out.lamp = std::move(lamps);
  }
  if (settings.planet) out.planet = *settings.planet;
  if (settings.sky) out.sky = *settings.sky;
  if (settings.stars) out.stars = *settings.stars;
  if (settings.star_catalogue) out.star_catalogue = *settings.star_catalogue;
  if (settings.date) out.date = *settings.date;
  if (settings.orbit) out.orbit = *settings.orbit;
}

}  // namespace

Quat TargetPose::rotation() const {
  const Vec3 half = angles * (kDegree / 2);
  const auto about = [](double angle, const Vec3& axis) {
    return Quat(std::cos(angle), std::sin(angle) * axis);
  };
  return glm::normalize(about(half.z, {0, 0, 1}) * about(half.y, {0, 1, 0}) *
                        about(half.x, {1, 0, 0}));
}

Vec3 ViewState::sun() const { return direction_of(sun_azimuth, sun_elevation); }

double ViewState::phase() const {
  const Vec3 a = camera.direction(), b = sun();
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / kDegree;
}

void ViewState::turn_sun(double right, double down) {
  sun_azimuth = wrapped_degrees(sun_azimuth + right * 180);
  sun_elevation = std::clamp(sun_elevation - down * 180, -90.0, 90.0);
}

void ViewState::raise_sun(const Vec3& up) {
  if (glm::dot(sun(), up) > 0) return;
  const Vec3 back = camera.direction();
  // with the vertical upwards; straight down behind the camera alone
  const Vec3 aside = glm::cross(up, back);
  const double length = glm::length(aside);
  const Vec3 right = length > 1e-6 ? aside / length : Vec3(0);
  const Vec3 to_sun = glm::normalize(back + 0.6 * glm::cross(back, right) - 0.6 * right);
  sun_azimuth = std::atan2(to_sun.y, to_sun.x) / kDegree;
  sun_elevation = std::asin(to_sun.z) / kDegree;
}

workspace::Settings settings_of(const ViewState& view, std::uint32_t width, std::uint32_t height) {
  workspace::Settings out;
  // numbers of a detector have the exposure time of its panel, or its own
  const bool numbers = view.own() != nullptr ? view.own()->frame.imager != nullptr
                                             : view.sized() && view.has_detector;
  const auto expose = [&] {
    if (numbers)
      out.ev = workspace::Settings().ev;
    else if (view.auto_ev)
      out.ev = workspace::Settings::Ev::automatic;
    else
      out.ev = typed(view.ev);
  };
  if (const Moment* own = view.own()) {
    out = own->view.settings;
    expose();
    workspace::Settings changes = changes_of(view.detector);
    changes.camera_file = workspace::Settings().camera_file;
    return workspace::with_defaults(std::move(changes), out);
  }
  if (view.sized()) out = changes_of(view.detector);
  if (view.camera.frame.empty()) {
    out.camera = typed(view.camera.position());
    out.look_at = typed(view.camera.centre);
  } else {
    out.camera_frame = view.camera.frame;
  }
  if (!view.sized()) {
    out.fov = typed(view.camera.fov) * kDegree;
    out.size = {width, height};
  }
  out.sun = typed(view.sun());
  if (view.sun_distance != view.scene_distance) out.sun_distance = typed(view.sun_distance);
  expose();
  if (view.shadows != workspace::Settings::Shadows::automatic) out.shadows = view.shadows;
  if (view.imposters != workspace::Settings::Imposters::automatic) out.imposters = view.imposters;
  if (view.indirect != workspace::Settings::Indirect::off) out.indirect = view.indirect;
  std::vector<workspace::PoseSetting> poses;
  for (const auto& [target, pose] : view.poses)
    poses.push_back({target, {typed(pose.position), typed(pose.rotation())}});
  if (!poses.empty()) out.pose = std::move(poses);
  std::vector<workspace::JointText> joints;
  for (const auto& [joint, value] : view.joints) joints.push_back({joint, value});
  if (!joints.empty()) out.joint = std::move(joints);
  std::vector<std::string> lamps;
  for (const auto& [lamp, words] : view.sky.lamps) lamps.push_back(lamp + " " + words);
  if (view.sky.camera_lamp)
    lamps.push_back(fmt::format("spot on camera intensity {}", typed(*view.sky.camera_lamp)));
  if (!lamps.empty()) out.lamp = std::move(lamps);
  if (view.moment) add_moment(*view.moment, out);
  return workspace::with_defaults(std::move(out), view.sky.settings);
}

std::string command_line(const ViewState& view, std::uint32_t width, std::uint32_t height,
                         const std::vector<std::string>& files, const std::string& output) {
  using workspace::SettingId;
  workspace::Settings settings = settings_of(view, width, height);
  const workspace::Settings standard;  // what has no option
  settings.name = standard.name;
  settings.define = standard.define;
  settings.targets = standard.targets;
  std::string out = "panwright render";
  for (const std::string& file : files) out += " " + shell_quoted(file);
  out += " -o " + shell_quoted(output);
  for (const SettingId id : workspace::kCommandOrder)
    for (const std::string& value : workspace::setting_texts(id, settings))
      out += fmt::format(" {} {}", workspace::info_of(id).option, shell_quoted(value));
  return out;
}

}  // namespace panwright::studio
