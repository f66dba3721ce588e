#include "importers/gltf/joints.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "base/text.h"

namespace panwright::importers::gltf {

namespace {

const Json* articulations_of(const Document& document) {
  const Json* all = document.root.find("extensions");
  const Json* ours = all ? all->find("AGI_articulations") : nullptr;
  return ours ? ours->find("articulations") : nullptr;
}

constexpr double kLeastFactor = 1e-6;  // of a part that is scaled to nothing

std::optional<Vec3> pointing_of(const Json& articulation) {
  const Json* vector = articulation.find("pointingVector");
  if (!vector || vector->items.size() != 3) return std::nullopt;
  const Vec3 v(vector->items[0].number, vector->items[1].number, vector->items[2].number);
  const double length = glm::length(v);
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return v / length;
}

double number_or(const Json& object, std::string_view key, double otherwise) {
  const Json* found = object.find(key);
  return found ? found->number : otherwise;
}

// Reports what joint_of() and the use of an articulation change.
void report_changes(Document& document, const Json& articulation, std::size_t index) {
  const std::string at = fmt::format("/extensions/AGI_articulations/articulations/{}", index);
  const auto tolerated = [&](const Json* where, const std::string& place, std::string message) {
    document.report(Code("W6215"), where, place, std::move(message));
  };
  std::size_t turning = 0;
  const std::vector<Json>& stages = articulation.list("stages");
  for (std::size_t s = 0; s < stages.size(); ++s) {
    const Json& stage = stages[s];
    if (stage.broken) continue;
    const std::string place = fmt::format("{}/stages/{}", at, s);
    const std::string& type = stage.find("type")->text;
    const bool scales = type.ends_with("Scale");
    if (type.ends_with("Rotate")) ++turning;
    const Json* lower = stage.find("minimumValue");
    const Json* upper = stage.find("maximumValue");
    double initial = number_or(stage, "initialValue", scales ? 1 : 0);
    if (!lower != !upper) {
      tolerated(lower ? lower : upper, place, "a stage with one limit; it moves without limits");
    } else if (lower && lower->number > upper->number) {
      tolerated(lower, place,
                fmt::format("minimumValue {:g} is above maximumValue {:g}; the stage moves without "
                            "limits",
                            lower->number, upper->number));
    } else if (lower) {
      const double begins = std::clamp(initial, lower->number, upper->number);
      if (begins != initial)
        tolerated(stage.find("initialValue"), place,
                  fmt::format("the initial value {:g} is outside the limits of the stage, which "
                              "begins at {:g}",
                              initial, begins));
      initial = begins;
    }
    if (scales && initial == 0)
      tolerated(
          stage.find("initialValue"), place,
          fmt::format("a factor of 0 flattens the part; the stage begins at {:g}", kLeastFactor));
  }
  const Json* vector = articulation.find("pointingVector");
  if (!vector) return;
  if (!pointing_of(articulation))
    tolerated(vector, at, "pointingVector is no direction, and is left out");
  else if (turning == 0 || turning > 2)
    tolerated(vector, at,
              fmt::format("pointingVector is left out: {} turn, expected 1 or 2",
                          counted(turning, "stage")));
}

// The registered schema of AGI_articulations: angles in degrees, about axes of the node, stages in
// the order in which they move the part. A part stands as written at 0, or at a factor of 1.
scene::Joint joint_of(const Json& stage) {
  scene::Joint joint;
  const std::string& type = stage.find("type")->text;
  const char axis = type[0];
  const bool uniform = type == "uniformScale";
  joint.axis = uniform       ? glm::normalize(Vec3(1))
               : axis == 'x' ? Vec3(1, 0, 0)
               : axis == 'y' ? Vec3(0, 1, 0)
                             : Vec3(0, 0, 1);
  double unit = 1;
  if (type.ends_with("Rotate")) {
    joint.kind = scene::JointKind::revolute;
    unit = kDegree;
  } else if (type.ends_with("Translate")) {
    joint.kind = scene::JointKind::prismatic;
  } else {
    joint.kind = scene::JointKind::scale;
  }
  const double rest = joint.kind == scene::JointKind::scale ? 1 : 0;
  double initial = number_or(stage, "initialValue", rest / unit) * unit;
  bool moved = initial != rest;
  const Json* lower = stage.find("minimumValue");
  const Json* upper = stage.find("maximumValue");
  if (lower && upper && lower->number <= upper->number) {
    const double least = lower->number * unit, most = upper->number * unit;
    initial = std::clamp(initial, least, most);
    moved = moved || initial != rest;
    if (joint.kind == scene::JointKind::revolute && upper->number - lower->number >= 360)
      joint.kind = scene::JointKind::continuous;
    else
      joint.lower = {least}, joint.upper = {most};
  }
  if (joint.kind == scene::JointKind::scale && initial == 0) {
    const bool negative = !joint.upper.empty() && joint.upper[0] < kLeastFactor;
    initial = negative ? -kLeastFactor : kLeastFactor;
    // the limits hold it
    if (negative) joint.lower[0] = std::min(joint.lower[0], initial);
  }
  if (moved) joint.value = {initial};
  return joint;
}

bool turns(const scene::Joint& joint) {
  return joint.kind == scene::JointKind::revolute || joint.kind == scene::JointKind::continuous;
}

// Stages that are one joint of several values, as our own exporter writes it: each is called by its
// type. value: of the joint's, for each stage.
struct Whole {
  scene::JointKind kind;
  std::vector<std::string_view> stages;
  std::vector<std::size_t> value;
};
const Whole kWholes[] = {
    {scene::JointKind::ball, {"zRotate", "yRotate", "xRotate"}, {2, 1, 0}},
    {scene::JointKind::general,
     {"xTranslate", "yTranslate", "zTranslate", "zRotate", "yRotate", "xRotate", "xScale", "yScale",
      "zScale"},
     {6, 7, 8, 5, 4, 3, 0, 1, 2}},
};
constexpr double kFreeShift = 1000;  // metres and factors: the exporter's word for no limit

bool are_called(const std::vector<Json>& stages, std::span<const std::string_view> types) {
  return std::ranges::equal(stages, types, [](const Json& stage, std::string_view type) {
    return !stage.broken && stage.find("type")->text == type && stage.find("name")->text == type;
  });
}

// Whether a stage has no limits of its own.
bool is_free(const scene::Joint& stage) {
  return stage.lower.empty() || (stage.kind != scene::JointKind::revolute &&
                                 stage.lower[0] == -kFreeShift && stage.upper[0] == kFreeShift);
}

// A ball or general joint of all stages; nothing where they are stages of their own.
std::optional<scene::Joint> whole_of(const std::vector<Json>& stages) {
  for (const Whole& whole : kWholes) {
    if (!are_called(stages, whole.stages)) continue;
    scene::Joint out;
    out.kind = whole.kind;
    const std::size_t count = whole.value.size();
    std::vector<double> lower(count), upper(count), value(count);
    bool limited = false, moved = false;
    for (std::size_t k = 0; k < count; ++k) {
      const scene::Joint stage = joint_of(stages[k]);
      const std::size_t i = whole.value[k];
      const double rest = stage.kind == scene::JointKind::scale ? 1 : 0;
      const double most = stage.lower.empty() ? kPi : kFreeShift;
      lower[i] = stage.lower.empty() ? -most : stage.lower[0];
      upper[i] = stage.upper.empty() ? most : stage.upper[0];
      value[i] = stage.value.empty() ? rest : stage.value[0];
      limited = limited || !is_free(stage);
      moved = moved || value[i] != rest;
    }
    if (limited) out.lower = lower, out.upper = upper;
    if (limited || moved) out.value = value;
    return out;
  }
  return std::nullopt;
}

// One factor along two axes, which the exporter writes as two stages alike.
std::optional<scene::Joint> flat_scale_of(const std::vector<Json>& stages) {
  if (stages.size() != 2 || stages[0].broken || stages[1].broken) return std::nullopt;
  scene::Joint one = joint_of(stages[0]);
  const scene::Joint other = joint_of(stages[1]);
  if (one.kind != scene::JointKind::scale || other.kind != one.kind || one.lower != other.lower ||
      one.upper != other.upper || one.value != other.value || one.axis == other.axis)
    return std::nullopt;
  for (const Json& stage : stages)
    if (stage.find("name")->text != stage.find("type")->text) return std::nullopt;
  one.axis = glm::normalize(one.axis + other.axis);
  return one;
}

}  // namespace

void add_joints(Document& document, const tinygltf::Model& model,
                const std::map<int, std::int32_t>& places, const std::map<int, Quat>& axes,
                scene::Scene& scene) {
  const Json* articulations = articulations_of(document);
  std::map<std::string_view, const Json*> by_name;
  if (articulations)
    for (const Json& one : articulations->items) {
      if (one.broken) continue;
      by_name.emplace(one.find("name")->text, &one);
      report_changes(document, one, static_cast<std::size_t>(&one - articulations->items.data()));
    }
  std::map<std::string, std::size_t> users;
  for (const auto& [index, place] : places) {
    const auto& extensions = model.nodes[static_cast<std::size_t>(index)].extensions;
    const auto found = extensions.find("AGI_articulations");
    if (found != extensions.end() && found->second.Has("articulationName"))
      ++users[found->second.Get("articulationName").Get<std::string>()];
  }
  // by articulation and stage: of the first node
  std::map<std::pair<std::string, std::string>, std::int32_t> leaders;
  for (const auto& [index, place] : places) {
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(index)];
    const auto found = node.extensions.find("AGI_articulations");
    if (found == node.extensions.end() || !found->second.Has("articulationName")) continue;
    const std::string name = found->second.Get("articulationName").Get<std::string>();
    const auto articulation = by_name.find(name);
    if (articulation == by_name.end()) {
      document.report(Code("W6215"), nullptr, pointer("nodes", static_cast<std::size_t>(index)),
                      fmt::format("unknown articulation {}", in_quotes(name)));
      continue;
    }
    const auto axis = axes.find(index);
    const Quat turn = axis == axes.end() ? Quat(1, 0, 0, 0) : axis->second;
    std::vector<std::int32_t> turning;  // stages of this node that turn
    const auto& stages = articulation->second->list("stages");
    auto whole = users[name] == 1 ? whole_of(stages) : std::nullopt;
    if (!whole && users[name] == 1) whole = flat_scale_of(stages);
    if (whole) {
      whole->name = name;
      whole->node = place;
      whole->source.file = document.file.path;
      scene.joints.push_back(*std::move(whole));
      continue;
    }
    for (const Json& stage : stages) {
      if (stage.broken) continue;
      scene::Joint joint = joint_of(stage);
      const auto next = static_cast<std::int32_t>(scene.joints.size());
      const std::string& own = stage.find("name")->text;
      joint.name = stages.size() == 1 ? name : fmt::format("{} {}", name, own);
      joint.node = place;
      joint.axis = turn * joint.axis;
      joint.source.file = document.file.path;
      if (turns(joint)) turning.push_back(next);
      // one articulation may move many nodes, all alike
      const auto [leader, first] = leaders.try_emplace({name, own}, next);
      if (!first) {
        joint.mimic = leader->second;
        joint.value.clear();
      }
      scene.joints.push_back(std::move(joint));
    }
    const auto direction = pointing_of(*articulation->second);
    if (!direction || turning.empty() || turning.size() > 2) continue;
    scene::Joint& aims = scene.joints[static_cast<std::size_t>(turning.back())];
    if (aims.mimic != scene::kNone) continue;
    aims.pointing = turn * *direction;
    if (turning.size() == 2) aims.gimbal = turning.front();
  }
}

}  // namespace panwright::importers::gltf
