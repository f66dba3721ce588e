#include "studio/view_state.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace panwright::studio {
namespace {

// Few enough digits to be typed; the image is drawn from these.
std::string option_text(double value) { return fmt::format("{:.9g}", value); }
std::string option_text(const Vec3& v) {
  return fmt::format("{} {} {}", option_text(v.x), option_text(v.y), option_text(v.z));
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

workspace::ViewText view_text(const ViewState& view, std::uint32_t width, std::uint32_t height) {
  workspace::ViewText text;
  if (view.camera.frame.empty()) {
    text.camera = option_text(view.camera.position());
    text.look_at = option_text(view.camera.centre);
  } else {
    text.camera_frame = view.camera.frame;
  }
  text.fov = option_text(view.camera.fov);
  text.sun = option_text(view.sun());
  if (view.sun_distance != 1) text.sun_distance = option_text(view.sun_distance);
  text.size = fmt::format("{}x{}", width, height);
  text.ev = view.auto_ev ? "auto" : option_text(view.ev);
  if (view.shadows != "auto") text.shadows = view.shadows;
  if (view.imposters != "auto") text.imposters = view.imposters;
  for (const auto& [target, pose] : view.poses) {
    const Quat q = pose.rotation();
    text.poses.push_back({target, fmt::format("{} {:.12g} {:.12g} {:.12g} {:.12g}",
                                              option_text(pose.position), q.w, q.x, q.y, q.z)});
  }
  for (const auto& [joint, value] : view.joints) text.joints.push_back({joint, value});
  return text;
}

std::string command_line(const ViewState& view, std::uint32_t width, std::uint32_t height,
                         const std::vector<std::string>& files, const std::string& output) {
  const workspace::ViewText text = view_text(view, width, height);
  std::string out = "panwright render";
  for (const std::string& file : files) out += " " + shell_quoted(file);
  const auto add = [&](const char* option, const std::optional<std::string>& value) {
    if (value) out += fmt::format(" {} {}", option, shell_quoted(*value));
  };
  add("-o", output);
  add("--camera", text.camera);
  add("--look-at", text.look_at);
  add("--camera-frame", text.camera_frame);
  add("--fov", text.fov);
  add("--sun", text.sun);
  add("--sun-distance", text.sun_distance);
  add("--size", text.size);
  add("--ev", text.ev);
  add("--shadows", text.shadows);
  add("--imposters", text.imposters);
  for (const workspace::PoseText& pose : text.poses) add("--pose", pose.target + "=" + pose.value);
  for (const workspace::JointText& joint : text.joints)
    add("--joint", joint.joint + "=" + joint.value);
  return out;
}

}  // namespace panwright::studio
