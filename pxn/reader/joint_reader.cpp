// Joints: around nodes of the language, and on nodes of CAD files.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/pattern.h"
#include "pxn/reader/shapes.h"

namespace panwright::pxn {

using geometry::JointKind;
using schemas::Dimension;
using schemas::ElementId;

std::optional<Vec3> unit_vector(const Vec3& v) {
  const double scale = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  if (!(scale > 0)) return std::nullopt;
  // one that was made so comes back bit for bit
  if (std::fabs(glm::length(v) - 1) <= 1e-15) return v;
  return glm::normalize(v / scale);
}

namespace {

std::vector<Dimension> dimensions_of(JointKind kind) {
  std::vector<Dimension> out;
  for (std::size_t i = 0; i < geometry::value_count(kind); ++i) {
    const geometry::JointUnit unit = geometry::unit_of(kind, i);
    out.push_back(unit == geometry::JointUnit::radians  ? Dimension::angle
                  : unit == geometry::JointUnit::metres ? Dimension::length
                                                        : Dimension::ratio);
  }
  return out;
}

bool turns(JointKind kind) { return kind == JointKind::revolute || kind == JointKind::continuous; }

// "90deg", "0.5m", "2"
std::string in_words(JointKind kind, std::size_t index, double value) {
  switch (geometry::unit_of(kind, index)) {
    case geometry::JointUnit::radians:
      return fmt::format("{:.6g}deg", value / kDegree);
    case geometry::JointUnit::metres:
      return fmt::format("{:.6g}m", value);
    case geometry::JointUnit::factor:
      break;
  }
  return fmt::format("{:.6g}", value);
}

// What is wrong with the limits and the initial values; empty: nothing. Values that are not given
// come into the limits.
std::string limits_problem(scene::Joint& joint) {
  const bool needs = joint.kind == JointKind::revolute || joint.kind == JointKind::prismatic;
  if (joint.lower.empty() != joint.upper.empty())
    return fmt::format("has {} limit; lower and upper belong together",
                       joint.lower.empty() ? "no lower" : "no upper");
  if (needs && joint.lower.empty())
    return fmt::format("is {} and needs lower= and upper=", geometry::kind_name(joint.kind));
  if (joint.kind == JointKind::continuous && !joint.lower.empty())
    return "is continuous, which has no limits; a revolute joint has";
  geometry::JointValues values = scene::initial_values(joint);
  bool moved = false;
  for (std::size_t i = 0; i < joint.lower.size(); ++i) {
    const double lower = joint.lower[i], upper = joint.upper[i];
    if (!(lower <= upper))
      return fmt::format("has a lower limit of {} above the upper one of {}",
                         in_words(joint.kind, i, lower), in_words(joint.kind, i, upper));
    if (values[i] >= lower && values[i] <= upper) continue;
    if (!joint.value.empty())
      return fmt::format("has an initial value of {} outside its limits, {} to {}",
                         in_words(joint.kind, i, values[i]), in_words(joint.kind, i, lower),
                         in_words(joint.kind, i, upper));
    values[i] = std::min(std::max(values[i], lower), upper);
    moved = true;
  }
  if (moved) joint.value.assign(values.begin(), values.begin() + std::ssize(joint.lower));
  for (std::size_t i = 0; i < geometry::value_count(joint.kind); ++i)
    if (geometry::unit_of(joint.kind, i) == geometry::JointUnit::factor && values[i] == 0)
      return "has an initial factor of 0, which makes things flat";
  return {};
}

}  // namespace

// What a joint follows and what it aims at; the problem with it, or empty.
std::string Loader::aim_of(Work& work, std::uint32_t element, PartJoint& out) {
  Values& values = *work.file.values;
  const auto which = [&](std::string_view name) {
    return *attribute_of(work.file.document, element, name);
  };
  scene::Joint& joint = out.joint;
  if (values.has(element, which("mimic"))) {
    out.mimic = values.text(element, which("mimic")).value_or("");
    joint.multiplier = values.real_or_default(element, which("multiplier"));
    if (geometry::value_count(joint.kind) != 1)
      return fmt::format("is {} and cannot follow another: only joints of one value can",
                         geometry::kind_name(joint.kind));
    std::vector<double> offset;
    if (values.quantities(element, which("offset"), dimensions_of(joint.kind), offset))
      joint.offset = offset[0];
  }
  Vec3 pointing(0);
  if (values.numbers(element, which("pointing"), std::span(&pointing.x, 3))) {
    if (!turns(joint.kind))
      return fmt::format("is {} and cannot aim: revolute and continuous joints can",
                         geometry::kind_name(joint.kind));
    joint.pointing = unit_vector(pointing);
    if (!joint.pointing) return "has a pointing direction of length 0";
    out.gimbal = values.has(element, which("gimbal"))
                     ? values.text(element, which("gimbal")).value_or("")
                     : "";
    if (values.has(element, which("point_at")) && values.text(element, which("point_at")) == "sun")
      joint.point_at = scene::PointAt::sun;
  }
  return {};
}

std::optional<PartJoint> Loader::joint_of(Work& work, std::uint32_t element) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  const auto which = [&](std::string_view name) { return *attribute_of(document, element, name); };
  const auto name = values.text(element, which("name"));
  const auto type = values.text(element, which("type"));
  const auto kind = type ? geometry::kind_named(*type) : std::nullopt;
  if (!name || !kind) return std::nullopt;  // reported
  PartJoint out;
  scene::Joint& joint = out.joint;
  joint.name = *name;
  joint.kind = *kind;
  const auto [line, column] = work.file.positions[element];
  joint.source = {work.file.found.path, line, column};
  Vec3 axis(0, 0, 1);
  if (!values.is_word(element, which("axis")))
    values.numbers(element, which("axis"), std::span(&axis.x, 3));
  const std::vector<Dimension> dimensions = dimensions_of(joint.kind);
  bool wrong = false;
  for (auto [word, list] : {std::pair("lower", &joint.lower), std::pair("upper", &joint.upper),
                            std::pair("value", &joint.value)})
    if (values.has(element, which(word)) &&
        !values.quantities(element, which(word), dimensions, *list)) {
      list->clear();
      wrong = true;
    }
  if (wrong) return std::nullopt;  // reported
  std::string problem = limits_problem(joint);
  if (const auto unit = unit_vector(axis))
    joint.axis = *unit;
  else
    problem = "has an axis of length 0";
  if (problem.empty()) problem = aim_of(work, element, out);
  if (problem.empty()) return out;
  reporter_.report(Code("E1231"), document.tag_span(element), document, element, [&] {
    return Reporter::Text(fmt::format("joint {} {}", in_quotes(*name), problem));
  });
  return std::nullopt;
}

void Loader::read_joint(Work& work, std::uint32_t element, std::uint32_t depth) {
  const std::uint32_t properties = read_properties(work, element);
  auto joint = joint_of(work, element);
  if (!joint) return read_node(work, element, depth, properties);
  if (work.file.values->has(element, schemas::attribute::joint_node))
    joint->node = work.file.values->text(element, schemas::attribute::joint_node).value_or("");
  work.part.joints.push_back(*std::move(joint));
  const auto item = add_item(work, ItemKind::joint, element,
                             static_cast<std::uint32_t>(work.part.joints.size() - 1), properties);
  if (!item) return;
  walk_children(work, element, depth + 1);
  work.part.items[*item].end = static_cast<std::uint32_t>(work.part.items.size());
}

void Loader::read_import_joint(Work& work, std::uint32_t rule, PartImport& import) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  const ImportedModel& model = models_[import.model];
  const scene::Scene& scene = model.imported.scene;
  const auto pattern = values.text(rule, schemas::attribute::import_joint_nodes);
  auto joint = joint_of(work, rule);
  if (!pattern || !joint) return;
  const Pattern wanted(*pattern);
  // those of the pattern itself: what is below moves with them
  const std::vector<char> fitting = matching_nodes(scene, model.top, wanted);
  PartImport::Moved moved;
  moved.rule = rule;
  for (std::size_t i = model.top + 1; i < scene.nodes.size(); ++i)
    if (fitting[i] && !fitting[static_cast<std::size_t>(scene.nodes[i].parent)])
      moved.nodes.push_back(static_cast<std::uint32_t>(i));
  const SourceSpan where = values.value_place(rule, schemas::attribute::import_joint_nodes);
  if (moved.nodes.empty()) {
    reporter_.report(Code("W1501"), where, document, rule, [&] {
      std::set<std::string> names;
      for (std::size_t i = 1; i < scene.nodes.size(); ++i) names.insert(scene.nodes[i].name);
      return Reporter::Text(fmt::format("no node of the import fits {}; joint {} moves nothing",
                                        in_quotes(*pattern), in_quotes(joint->joint.name)),
                            near_names(*pattern, names));
    });
    return;
  }
  for (const PartImport::Moved& other : import.moved)
    for (const std::uint32_t node : other.nodes)
      if (std::ranges::binary_search(moved.nodes, node)) {
        reporter_.report(Code("E1231"), where, document, rule, [&] {
          return Reporter::Text(
              fmt::format("joint {} moves node {}, which an earlier joint of the import moves",
                          in_quotes(joint->joint.name), in_quotes(scene.nodes[node].name)));
        });
        return;
      }
  Vec3 origin(0);
  if (!values.is_word(rule, schemas::attribute::import_joint_origin) &&
      values.numbers(rule, schemas::attribute::import_joint_origin, std::span(&origin.x, 3)))
    moved.origin = origin;
  if (!axis_from_faces(work, rule, import, moved, *joint)) return;
  moved.joint = static_cast<std::uint32_t>(work.part.joints.size());
  work.part.joints.push_back(*std::move(joint));
  import.moved.push_back(std::move(moved));
}

}  // namespace panwright::pxn
