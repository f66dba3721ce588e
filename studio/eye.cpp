#include "studio/eye.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace panwright::studio {
namespace {

constexpr double kSteepest = 89.9;  // straight up and down have no azimuth

// degrees
Vec3 along(double azimuth, double elevation) {
  azimuth *= kDegree;
  elevation *= kDegree;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

double turned(double angle) { return std::remainder(angle, 360); }

// What is drawn is what the words say: few enough digits to be typed.
std::string words(double value) { return fmt::format("{:.9g}", value); }
std::string words(const Vec3& v) {
  return fmt::format("{} {} {}", words(v.x), words(v.y), words(v.z));
}

// A word for a shell.
std::string quoted(const std::string& word) {
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

Vec3 Eye::direction() const { return along(azimuth, elevation); }
Vec3 Eye::sun() const { return along(sun_azimuth, sun_elevation); }
double Eye::phase() const {
  const Vec3 a = direction(), b = sun();
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / kDegree;
}

void Eye::turn(double right, double down) {
  azimuth = turned(azimuth - right * 180);
  elevation = std::clamp(elevation + down * 180, -kSteepest, kSteepest);
}

void Eye::turn_sun(double right, double down) {
  sun_azimuth = turned(sun_azimuth + right * 180);
  sun_elevation = std::clamp(sun_elevation - down * 180, -90.0, 90.0);
}

void Eye::shift(double right, double down) {
  const double height = 2 * range * std::tan(fov * kDegree / 2);
  fly(0, -right * height / range, down * height / range);
}

void Eye::fly(double ahead, double right, double up) {
  const Vec3 back = direction();
  const Vec3 side = glm::normalize(glm::cross(Vec3(0, 0, 1), back));
  centre += range * (right * side + up * glm::cross(back, side) - ahead * back);
}

void Eye::zoom(double factor) { range = std::clamp(range * factor, kNearest, kFarthest); }

void Eye::frame_all(const workspace::BoundingSphere& sphere, double aspect) {
  centre = sphere.centre;
  const double across = std::atan(std::tan(fov * kDegree / 2) * std::min(1.0, aspect));
  range = std::clamp(1.05 * sphere.radius / std::sin(across), kNearest, kFarthest);
  frame.clear();
}

Quat Standing::rotation() const {
  const Vec3 half = turned * (kDegree / 2);
  const auto about = [](double angle, const Vec3& axis) {
    return Quat(std::cos(angle), std::sin(angle) * axis);
  };
  return glm::normalize(about(half.z, {0, 0, 1}) * about(half.y, {0, 1, 0}) *
                        about(half.x, {1, 0, 0}));
}

workspace::ViewText view_text(const Eye& eye, std::uint32_t width, std::uint32_t height) {
  workspace::ViewText text;
  if (eye.frame.empty()) {
    text.camera = words(eye.centre + eye.range * eye.direction());
    text.look_at = words(eye.centre);
  } else {
    text.camera_frame = eye.frame;
  }
  text.fov = words(eye.fov);
  text.sun = words(eye.sun());
  if (eye.sun_distance != 1) text.sun_distance = words(eye.sun_distance);
  text.size = fmt::format("{}x{}", width, height);
  text.ev = eye.auto_ev ? "auto" : words(eye.ev);
  if (eye.shadows != "auto") text.shadows = eye.shadows;
  if (eye.imposters != "auto") text.imposters = eye.imposters;
  for (const auto& [target, place] : eye.poses) {
    const Quat q = place.rotation();
    text.poses.push_back({target, fmt::format("{} {:.12g} {:.12g} {:.12g} {:.12g}",
                                              words(place.position), q.w, q.x, q.y, q.z)});
  }
  for (const auto& [joint, value] : eye.joints) text.joints.push_back({joint, value});
  return text;
}

std::string command_line(const Eye& eye, std::uint32_t width, std::uint32_t height,
                         const std::vector<std::string>& files, const std::string& output) {
  const workspace::ViewText text = view_text(eye, width, height);
  std::string out = "panwright render";
  for (const std::string& file : files) out += " " + quoted(file);
  const auto add = [&](const char* option, const std::optional<std::string>& value) {
    if (value) out += fmt::format(" {} {}", option, quoted(*value));
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
