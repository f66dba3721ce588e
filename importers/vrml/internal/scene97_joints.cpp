// Joints of OpenHRP's and H-Anim's prototypes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/text.h"
#include "importers/vrml/internal/scene97.h"

namespace panwright::importers::vrml {

namespace {

std::span<const double> numbers_or_none(const Node& node, std::string_view field) {
  const Field* found = node.find(field);
  return found != nullptr && width_of(found->value.type) > 0 &&
                 found->value.type != FieldType::sf_int32 &&
                 found->value.type != FieldType::mf_int32 &&
                 found->value.type != FieldType::sf_bool && found->value.type != FieldType::mf_bool
             ? found->value.numbers()
             : std::span<const double>();
}

std::string_view string_or_none(const Node& node, std::string_view field) {
  const Field* found = node.find(field);
  return found != nullptr && found->value.type == FieldType::sf_string &&
                 !found->value.strings().empty()
             ? found->value.strings()[0]
             : std::string_view();
}

// jointAxis is a vector, or in older files "X", "Y" or "Z". Nothing: neither of them.
std::optional<Vec3> axis_of(const Node& instance) {
  const auto v = numbers_or_none(instance, "jointAxis");
  if (v.size() == 3) {
    const Vec3 axis(v[0], v[1], v[2]);
    const double length = glm::length(axis);
    if (length > 0 && std::isfinite(length)) return axis / length;
    return std::nullopt;
  }
  const std::string_view word = string_or_none(instance, "jointAxis");
  if (word == "X" || word == "x") return Vec3(1, 0, 0);
  if (word == "Y" || word == "y") return Vec3(0, 1, 0);
  if (word == "Z" || word == "z" || (word.empty() && v.empty())) return Vec3(0, 0, 1);
  return std::nullopt;
}

bool are_limits(std::span<const double> lower, std::span<const double> upper, std::size_t count) {
  if (lower.size() < count || upper.size() < count) return false;
  for (std::size_t i = 0; i < count; ++i)
    if (!(lower[i] <= upper[i])) return false;
  return true;
}

// A joint is at 0 in the file, which its limits may not hold.
template <class Report>
void begin_within_limits(scene::Joint& joint, const Report& report) {
  std::vector<double> begins;
  for (std::size_t i = 0; i < joint.lower.size(); ++i)
    begins.push_back(std::clamp(0.0, joint.lower[i], joint.upper[i]));
  if (std::ranges::all_of(begins, [](double x) { return x == 0; })) return;
  report(fmt::format("0 is outside its limits; it begins at {:g}", fmt::join(begins, " ")));
  joint.value = std::move(begins);
}

}  // namespace

bool Scene97::is_joint(const Node& instance) {
  const bool named = instance.type == "Joint" || instance.type == "HAnimJoint";
  return (named && instance.find("center") != nullptr) ||
         (instance.find("jointType") != nullptr && instance.find("jointAxis") != nullptr);
}

void Scene97::add_joint(const Node& instance, std::int32_t node) {
  scene::Joint joint;
  joint.name = string_or_none(instance, "name");
  if (joint.name.empty()) joint.name = instance.name;
  if (joint.name.empty()) joint.name = builder_.scene().nodes[static_cast<std::size_t>(node)].name;
  joint.node = node;
  joint.source = builder_.source_of(instance.where);
  const std::string_view type = string_or_none(instance, "jointType");
  const auto lower = numbers_or_none(instance, "llimit");
  const auto upper = numbers_or_none(instance, "ulimit");
  std::size_t count = 1;
  if (type == "free") {
    builder_.skipped("free joint");
    return;
  }
  if (type == "rotate" || type == "rotational" || type == "revolute") {
    joint.kind = scene::JointKind::revolute;
    if (!are_limits(lower, upper, count)) joint.kind = scene::JointKind::continuous;
  } else if (type == "slide" || type == "prismatic") {
    joint.kind = scene::JointKind::prismatic;
  } else if (type.empty() && instance.find("jointType") == nullptr) {
    joint.kind = scene::JointKind::ball;  // H-Anim: limits about x, y and z
    count = 3;
  } else {
    joint.kind = scene::JointKind::fixed;
    count = 0;
  }
  const auto tolerated = [&](const std::string& message) {
    builder_.context.log.report(Code("W6118"), instance.where,
                                fmt::format("the joint {}: {}", in_quotes(joint.name), message));
  };
  const auto axis = axis_of(instance);
  if (!axis && count == 1) tolerated("its jointAxis is no direction; it moves about z");
  joint.axis = axis.value_or(Vec3(0, 0, 1));
  if (count > 0 && are_limits(lower, upper, count)) {
    joint.lower.assign(lower.begin(), lower.begin() + static_cast<std::ptrdiff_t>(count));
    joint.upper.assign(upper.begin(), upper.begin() + static_cast<std::ptrdiff_t>(count));
    begin_within_limits(joint, tolerated);
  } else if (count > 0 && !(lower.empty() && upper.empty())) {
    tolerated("llimit is above ulimit, or one of them is missing; it moves without limits");
  }
  add_masses(instance, joint);
  builder_.scene().joints.push_back(std::move(joint));
}

// The segments of a joint are what moves with it.
void Scene97::add_masses(const Node& instance, scene::Joint& joint) {
  const Field* children = instance.find("children");
  if (children == nullptr || children->value.type != FieldType::mf_node) return;
  const auto pivot = numbers_or_none(instance, "center");
  const Vec3 centre = pivot.size() == 3 ? Vec3(pivot[0], pivot[1], pivot[2]) : Vec3(0);
  double total = 0;
  Vec3 moment(0);
  int segments = 0;
  std::optional<Mat3> inertia;
  for (const Node* child : children->value.nodes()) {
    if (child->prototype == nullptr) continue;
    const auto mass = numbers_or_none(*child, "mass");
    if (mass.size() != 1 || !(mass[0] > 0)) continue;
    ++segments;
    total += mass[0];
    const auto c = numbers_or_none(*child, "centerOfMass");
    if (c.size() == 3) moment += mass[0] * (Vec3(c[0], c[1], c[2]) - centre);
    const auto m = numbers_or_none(*child, "momentsOfInertia");
    if (m.size() == 9) inertia = Mat3(m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]);
  }
  if (segments == 0 || !std::isfinite(total)) return;
  const Vec3 at = moment / total;
  if (!is_finite(at)) return;
  joint.mass = total;
  joint.centre_of_mass = at;
  if (segments == 1) joint.inertia = inertia;  // of several, about centres that differ
}

}  // namespace panwright::importers::vrml
