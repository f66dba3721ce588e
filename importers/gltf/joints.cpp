#include "importers/gltf/joints.h"

#include <fmt/format.h>

#include "base/text.h"

namespace panwright::importers::gltf {

namespace {

const Json* articulations_of(const Document& document) {
  const Json* all = document.root.find("extensions");
  const Json* ours = all ? all->find("AGI_articulations") : nullptr;
  return ours ? ours->find("articulations") : nullptr;
}

double number_or(const Json& object, std::string_view key, double otherwise) {
  const Json* found = object.find(key);
  return found ? found->number : otherwise;
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
    joint.value = 1;
  }
  const Json* lower = stage.find("minimumValue");
  const Json* upper = stage.find("maximumValue");
  if (lower && upper) {
    joint.lower = {lower->number * unit};
    joint.upper = {upper->number * unit};
    if (joint.kind == scene::JointKind::revolute && upper->number - lower->number >= 360)
      joint.kind = scene::JointKind::continuous;
  }
  return joint;
}

}  // namespace

void add_joints(Document& document, const tinygltf::Model& model,
                const std::map<int, std::int32_t>& places, scene::Scene& scene) {
  const Json* articulations = articulations_of(document);
  std::map<std::string_view, const Json*> by_name;
  if (articulations)
    for (const Json& one : articulations->items)
      if (!one.broken) by_name.emplace(one.find("name")->text, &one);
  std::size_t elsewhere = 0, pointing = 0;
  for (const auto& [index, place] : places) {
    const tinygltf::Node& node = model.nodes[static_cast<std::size_t>(index)];
    const auto found = node.extensions.find("AGI_articulations");
    if (found == node.extensions.end() || !found->second.Has("articulationName")) continue;
    const std::string name = found->second.Get("articulationName").Get<std::string>();
    const auto articulation = by_name.find(name);
    if (articulation == by_name.end()) {
      document.report(Code::W6215, nullptr, pointer("nodes", static_cast<std::size_t>(index)),
                      fmt::format("unknown articulation {}", in_quotes(name)));
      continue;
    }
    if (articulation->second->find("pointingVector")) ++pointing;
    for (const Json& stage : articulation->second->list("stages")) {
      if (stage.broken) continue;
      scene::Joint joint = joint_of(stage);
      joint.name = fmt::format("{} {}", name, stage.find("name")->text);
      joint.node = place;
      joint.source.file = document.file.path;
      if (number_or(stage, "initialValue", joint.value) != joint.value) ++elsewhere;
      scene.joints.push_back(std::move(joint));
    }
  }
  if (elsewhere > 0)
    document.report(Code::N6007, nullptr, "/extensions/AGI_articulations",
                    fmt::format("the initial values of {} are left out: the nodes keep their "
                                "transforms",
                                counted(elsewhere, "joint")));
  if (pointing > 0)
    document.report(Code::N6007, nullptr, "/extensions/AGI_articulations",
                    fmt::format("{} left out", counted(pointing, "pointing vector")));
}

}  // namespace panwright::importers::gltf
