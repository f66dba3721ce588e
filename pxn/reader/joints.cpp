#include "pxn/reader/joints.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "base/text.h"

namespace panwright::pxn {

namespace {

void sort_by_node(std::vector<scene::Joint>& joints) {
  std::vector<std::size_t> order(joints.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return joints[i].node; });
  std::vector<std::int32_t> place(joints.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<std::int32_t>(k);
  std::vector<scene::Joint> sorted;
  for (const std::size_t i : order) {
    sorted.push_back(std::move(joints[i]));
    for (std::int32_t* other : {&sorted.back().mimic, &sorted.back().gimbal})
      if (*other != scene::kNone) *other = place[static_cast<std::size_t>(*other)];
  }
  joints = std::move(sorted);
}

}  // namespace

bool Joints::add(const PartJoint& joint, std::int32_t node, const std::string& prefix,
                 SourceSpan where, const xml::Document& document, std::uint32_t element,
                 scene::Scene& scene) {
  const auto index = static_cast<std::int32_t>(scene.joints.size());
  scene::Joint made = joint.joint;
  made.name = prefix + made.name;
  made.node = node;
  if (!by_name_.try_emplace(made.name, index).second) return false;
  scene.joints.push_back(std::move(made));
  known_.push_back({index, prefix, joint.mimic, joint.gimbal, where, &document, element});
  return true;
}

PartJoint Joints::follower(const PartJoint& joint, const std::string& leader) {
  PartJoint out = joint;
  out.joint.name = fmt::format("{}#{}", leader, 2 + copies_[leader]++);
  out.joint.pointing.reset();
  out.joint.point_at = scene::PointAt::nothing;
  out.gimbal.clear();
  if (geometry::value_count(joint.joint.kind) != 1) return out;
  out.mimic = leader;
  out.joint.multiplier = 1;
  out.joint.offset = 0;
  out.joint.value.clear();
  return out;
}

std::int32_t Joints::find(const Known& from, const std::string& name) const {
  std::string prefix = from.prefix;
  for (;;) {
    if (const auto found = by_name_.find(prefix + name); found != by_name_.end())
      return found->second;
    if (prefix.empty()) return scene::kNone;
    prefix.pop_back();  // the '/' of the innermost use
    const std::size_t slash = prefix.rfind('/');
    prefix.erase(slash == std::string::npos ? 0 : slash + 1);
  }
}

void Joints::connect(scene::Scene& scene, Reporter& reporter) const {
  const auto joint_of = [&](const Known& known) -> scene::Joint& {
    return scene.joints[static_cast<std::size_t>(known.index)];
  };
  const auto refuse = [&](const Known& known, const std::string& problem, std::string hint = {}) {
    reporter.report(Code("E1232"), known.where, *known.document, known.element, [&] {
      return Reporter::Text(fmt::format("joint {} {}", in_quotes(joint_of(known).name), problem),
                            hint);
    });
  };
  const auto hint_for = [&](const std::string& name) {
    std::vector<std::string_view> names;
    for (const auto& [other, index] : by_name_) names.push_back(other);
    const auto near = nearest_name(name, names);
    return near ? fmt::format("did you mean '{}'?", *near) : std::string();
  };
  for (const Known& known : known_) {
    scene::Joint& joint = joint_of(known);
    if (!known.mimic.empty()) {
      joint.mimic = find(known, known.mimic);
      const bool there = joint.mimic != scene::kNone;
      if (!there)
        refuse(known, fmt::format("follows {}, which is not a joint", in_quotes(known.mimic)),
               hint_for(known.mimic));
      else if (const scene::Joint& leader = scene.joints[static_cast<std::size_t>(joint.mimic)];
               geometry::value_count(leader.kind) != 1) {
        refuse(known, fmt::format("follows {}, which is {}: only joints of one value are followed",
                                  in_quotes(known.mimic), geometry::kind_name(leader.kind)));
        joint.mimic = scene::kNone;
      }
    }
    if (known.gimbal.empty()) continue;
    joint.gimbal = find(known, known.gimbal);
    if (joint.gimbal == scene::kNone) {
      refuse(known, fmt::format("aims with {}, which is not a joint", in_quotes(known.gimbal)),
             hint_for(known.gimbal));
      continue;
    }
    const scene::Joint& outer = scene.joints[static_cast<std::size_t>(joint.gimbal)];
    std::int32_t node = scene.nodes[static_cast<std::size_t>(joint.node)].parent;
    while (node != scene::kNone && node != outer.node)
      node = scene.nodes[static_cast<std::size_t>(node)].parent;
    const bool turns = outer.kind == geometry::JointKind::revolute ||
                       outer.kind == geometry::JointKind::continuous;
    if (turns && node != scene::kNone && outer.mimic == scene::kNone && known.mimic.empty())
      continue;
    refuse(known, fmt::format("aims with {}, which {}", in_quotes(known.gimbal),
                              !turns                 ? "does not turn"
                              : node == scene::kNone ? "does not enclose it"
                                                     : "follows another joint"));
    joint.gimbal = scene::kNone;
  }
  // one loop at a time is cut open
  for (;;) {
    std::vector<geometry::Joint> joints;
    for (const scene::Joint& joint : scene.joints) joints.push_back(scene::kinematic(joint));
    std::size_t wrong = 0;
    if (geometry::JointSet::of(std::move(joints), &wrong)) break;
    for (const Known& known : known_)
      if (static_cast<std::size_t>(known.index) == wrong)
        refuse(known, "follows itself through others");
    scene.joints[wrong].mimic = scene::kNone;
    // note: what it begins with was for a follower
    if (!scene.joints[wrong].lower.empty() && scene.joints[wrong].value.empty()) {
      const double low = scene.joints[wrong].lower[0], high = scene.joints[wrong].upper[0];
      scene.joints[wrong].value = {std::min(std::max(0.0, low), high)};
    }
  }
  sort_by_node(scene.joints);
}

}  // namespace panwright::pxn
