#include "importers/mjcf/internal/attributes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace panwright::importers::mjcf {

using pugi::xml_attribute;
using pugi::xml_node;

namespace {

constexpr const char* kOrientations[] = {"quat", "axisangle", "xyaxes", "zaxis", "euler"};
constexpr std::size_t kOutermost = 0;

// About an axis of length 1.
Quat turn(const Vec3& axis, double angle) {
  const auto [sine, cosine] = det::sincos(angle / 2);
  return {cosine, sine * axis.x, sine * axis.y, sine * axis.z};
}

}  // namespace

Quat z_towards(const Vec3& unit) {
  const Vec3 across(-unit.y, unit.x, 0);  // z × unit
  const double sine = glm::length(across);
  if (sine < 1e-10) return unit.z > 0 ? Quat(1, 0, 0, 0) : Quat(0, 1, 0, 0);
  return turn(across / sine, det::atan2(sine, unit.z));
}

void Attributes::read_compiler(const xml_node& element) {
  const std::size_t angle = compiler_.angle == 1 ? 1 : 0;
  compiler_.angle =
      word(element, "angle", kOutermost, {"degree", "radian"}, angle) == 1 ? 1 : kDegree;
  compiler_.limits_by_range = word(element, "autolimits", kOutermost, {"false", "true"},
                                   compiler_.limits_by_range ? 1 : 0) == 1;
  compiler_.strip_path =
      word(element, "strippath", kOutermost, {"false", "true"}, compiler_.strip_path ? 1 : 0) == 1;
  word(element, "coordinate", kOutermost, {"local"}, 0);
  if (const xml_attribute euler = element.attribute("eulerseq")) {
    const std::string_view letters = euler.value();
    if (letters.size() == 3 && letters.find_first_not_of("xyzXYZ") == letters.npos)
      compiler_.euler = letters;
    else
      wrong(text_.at(euler), fmt::format("eulerseq is {}, expected three letters of x, y, z (axes "
                                         "that turn along) and X, Y, Z (axes that stay)",
                                         in_quotes(letters)));
  }
  const auto folder = [&](const char* name, std::string& out) {
    if (const xml_attribute given = element.attribute(name)) out = given.value();
  };
  folder("assetdir", compiler_.mesh_folder);
  folder("assetdir", compiler_.texture_folder);
  folder("meshdir", compiler_.mesh_folder);
  folder("texturedir", compiler_.texture_folder);
}

std::optional<std::vector<double>> Attributes::numbers(const xml_node& element, const char* name,
                                                       std::size_t its_class, std::size_t least,
                                                       std::size_t most) {
  return XmlValues::numbers(element, classes_.find(element, name, its_class), least, most);
}

double Attributes::number_or(const xml_node& element, const char* name, std::size_t its_class,
                             double otherwise) {
  const auto found = numbers(element, name, its_class, 1, 1);
  return found ? (*found)[0] : otherwise;
}

std::optional<Vec3> Attributes::vector(const xml_node& element, const char* name,
                                       std::size_t its_class) {
  const auto found = numbers(element, name, its_class, 3, 3);
  if (!found) return std::nullopt;
  return Vec3((*found)[0], (*found)[1], (*found)[2]);
}

std::size_t Attributes::word(const xml_node& element, const char* name, std::size_t its_class,
                             std::initializer_list<std::string_view> words, std::size_t otherwise) {
  const xml_attribute attribute = classes_.find(element, name, its_class);
  if (!attribute) return otherwise;
  const auto found = std::ranges::find(words, std::string_view(attribute.value()));
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  wrong(text_.at(attribute), fmt::format("{} of <{}> is {}, expected {}", name, element.name(),
                                         in_quotes(attribute.value()), fmt::join(words, " or ")));
  return otherwise;
}

std::string Attributes::text(const xml_node& element, const char* name, std::size_t its_class) {
  return classes_.find(element, name, its_class).value();
}

SourceSpan Attributes::at(const xml_node& element, const char* name, std::size_t its_class) const {
  const xml_attribute attribute = classes_.find(element, name, its_class);
  return attribute ? text_.at(attribute) : text_.at(element);
}

std::optional<Vec3> Attributes::direction(const Vec3& v, SourceSpan where, std::string_view what) {
  const auto unit = unit_vector(v);
  if (!unit) wrong(where, fmt::format("{} has no length, expected a direction", what));
  return unit;
}

// ---- orientations

std::optional<Quat> Attributes::from_euler(const xml_node& element) {
  const auto angles = vector(element, "euler", kOutermost);
  if (!angles) return std::nullopt;
  Quat out(1, 0, 0, 0);
  for (int k = 0; k < 3; ++k) {
    const char letter = compiler_.euler[static_cast<std::size_t>(k)];
    const bool along = letter >= 'a';
    Vec3 axis(0);
    axis[letter - (along ? 'x' : 'X')] = 1;
    const Quat one = turn(axis, (*angles)[k] * compiler_.angle);
    out = along ? out * one : one * out;
  }
  return out;
}

std::optional<Quat> Attributes::from_axes(const xml_node& element) {
  const auto axes = numbers(element, "xyaxes", kOutermost, 6, 6);
  if (!axes) return std::nullopt;
  const SourceSpan where = text_.at(element.attribute("xyaxes"));
  const auto x = direction({(*axes)[0], (*axes)[1], (*axes)[2]}, where, "x of xyaxes");
  if (!x) return std::nullopt;
  const auto along = direction({(*axes)[3], (*axes)[4], (*axes)[5]}, where, "y of xyaxes");
  if (!along) return std::nullopt;
  const Vec3 rest = *along - glm::dot(*along, *x) * *x;
  if (!(glm::length(rest) > 1e-10)) {
    wrong(where, "x and y of xyaxes are parallel, expected two directions");
    return std::nullopt;
  }
  const Vec3 y = glm::normalize(rest);
  return glm::normalize(glm::quat_cast(Mat3(*x, y, glm::cross(*x, y))));
}

// Of an element's own attributes; it has one of them.
std::optional<Quat> Attributes::rotation(const xml_node& element) {
  if (element.attribute("quat")) {
    const auto q = numbers(element, "quat", kOutermost, 4, 4);
    if (!q) return std::nullopt;
    const double largest = std::max(std::max(std::fabs((*q)[0]), std::fabs((*q)[1])),
                                    std::max(std::fabs((*q)[2]), std::fabs((*q)[3])));
    if (largest > 0 && std::isfinite(1 / largest))
      return glm::normalize(
          Quat((*q)[0] / largest, (*q)[1] / largest, (*q)[2] / largest, (*q)[3] / largest));
    wrong(text_.at(element.attribute("quat")), "the quaternion is 0, expected w x y z");
    return std::nullopt;
  }
  if (element.attribute("axisangle")) {
    const auto v = numbers(element, "axisangle", kOutermost, 4, 4);
    if (!v) return std::nullopt;
    const auto axis = direction({(*v)[0], (*v)[1], (*v)[2]},
                                text_.at(element.attribute("axisangle")), "the axis of axisangle");
    if (!axis) return std::nullopt;
    return turn(*axis, (*v)[3] * compiler_.angle);
  }
  if (element.attribute("xyaxes")) return from_axes(element);
  if (element.attribute("zaxis")) {
    const auto v = vector(element, "zaxis", kOutermost);
    if (!v) return std::nullopt;
    const auto z = direction(*v, text_.at(element.attribute("zaxis")), "zaxis");
    if (!z) return std::nullopt;
    return z_towards(*z);
  }
  return from_euler(element);
}

Pose Attributes::pose(const xml_node& element, std::size_t its_class) {
  Pose out;
  if (const auto position = vector(element, "pos", its_class)) out.position = *position;
  for (const xml_node& level : classes_.levels(element, its_class)) {
    std::size_t count = 0;
    for (const char* name : kOrientations)
      if (level.attribute(name)) ++count;
    if (count == 0) continue;
    if (count > 1)
      wrong(text_.at(level), fmt::format("<{}> has {} orientations, expected one of quat, "
                                         "axisangle, xyaxes, zaxis and euler; the first of these "
                                         "is taken",
                                         level.name(), count));
    if (const auto turned = rotation(level)) out.rotation = *turned;
    break;
  }
  return out;
}

}  // namespace panwright::importers::mjcf
