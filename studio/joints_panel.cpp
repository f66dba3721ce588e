#include <fmt/core.h>
#include <imgui.h>

#include <cmath>

#include "studio/panels.h"

namespace panwright::studio {
namespace {

constexpr double kPlaySeconds = 6;  // from one end of the range to the other and back

// Display of a joint value.
struct JointDisplay {
  double factor = 1;  // of the stored value
  const char* format = "%.6g";
  double reach = 1;  // of the slider to both sides, where the joint has no limits
};

JointDisplay joint_display(geometry::JointUnit unit) {
  switch (unit) {
    case geometry::JointUnit::radians:
      return {1 / kDegree, "%.3f deg", 180};
    case geometry::JointUnit::metres:
      return {1, "%.4f m", 10};
    case geometry::JointUnit::factor:
      return {1, "%.4f", 4};
  }
  return {};
}

// Label of one value of a joint that has several.
const char* joint_value_label(geometry::JointKind kind, std::size_t index) {
  constexpr const char* kBall[] = {"about x", "about y", "about z"};
  constexpr const char* kGeneral[] = {"scale x", "scale y", "scale z", "about x", "about y",
                                      "about z", "along x", "along y", "along z"};
  return kind == geometry::JointKind::ball ? kBall[index] : kGeneral[index];
}

}  // namespace

void JointsPanel::draw() {
  if (!state_.models.world) return;
  // current values, within limits, with those of mimic joints
  const world::World posed = state_.posed();
  const bool given = state_.view.moment != nullptr;
  if (given) ImGui::TextDisabled("The scenario gives poses and joints.");
  ImGui::BeginDisabled(given);
  controls(posed);
  ImGui::EndDisabled();
}

void JointsPanel::controls(const world::World& posed) {
  poses();
  std::size_t count = 0;
  for (std::size_t i = 0; i < posed.size(); ++i) {
    const auto values = posed[i].joint_values();
    for (std::size_t k = 0; k < values.size(); ++k, ++count) joint_row(i, k, values[k]);
  }
  if (count == 0) {
    ImGui::TextDisabled("no joints");
    return;
  }
  if (state_.widgets.button("joints/reset all")) {
    state_.view.joints.clear();
    playing_.clear();
  }
  if (state_.widgets.button("joints/copy", "As a JSON object that --joints reads")) copy_joints();
}

void JointsPanel::copy_joints() const {
  std::string json = "{";
  for (const auto& [joint, value] : state_.view.joints)
    json += fmt::format("{}\n  \"{}\": \"{}\"", json.size() > 1 ? "," : "", joint, value);
  ImGui::SetClipboardText((json + "\n}\n").c_str());
}

void JointsPanel::joint_row(std::size_t target, std::size_t index,
                            const geometry::JointValues& now) {
  Widgets& widgets = state_.widgets;
  const world::Instance& instance = (*state_.models.world)[target];
  const pan::layout::Joint& joint = instance.model()->joints()[index];
  const auto kind = static_cast<geometry::JointKind>(joint.kind);
  const std::size_t count = geometry::value_count(kind);
  const std::string name = instance.name() + "/" + std::string(instance.model()->joint_name(index));
  if (count == 0 || joint.mimic >= 0) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextWrapped("%s: %s%s", name.c_str(), std::string(geometry::kind_name(kind)).c_str(),
                       joint.mimic >= 0 ? ", follows another joint" : "");
    ImGui::PopStyleColor();
    return;
  }
  ImGui::TextUnformatted(name.c_str());
  ImGui::PushID(name.c_str());
  for (std::size_t k = 0; k < count; ++k) {
    const JointDisplay display = joint_display(geometry::unit_of(kind, k));
    const bool limited = joint.upper[k] > joint.lower[k];
    const bool factor = geometry::unit_of(kind, k) == geometry::JointUnit::factor;
    double value = now[k] * display.factor;
    const double low = limited ? joint.lower[k] * display.factor : factor ? 0 : -display.reach;
    const double high = limited ? joint.upper[k] * display.factor : display.reach;
    const std::string widget =
        count == 1 ? "joint/" + name + "="
                   : fmt::format("joint/{}/{}={}", name, k, joint_value_label(kind, k));
    // without limits, values beyond the ends of the slider may be typed
    if (widgets.slider(widget, value, low, high, display.format, false, nullptr, limited)) {
      geometry::JointValues values = now;
      values[k] = value / display.factor;
      state_.view.joints[name] = workspace::exact_value(kind, values);
      playing_.clear();
    }
  }
  if (count == 1) {
    ImGui::SameLine();
    bool plays = playing_ == name;
    if (widgets.check("play/" + name + "=play", plays, "Through its range and back in 6 s")) {
      playing_ = plays ? name : "";
      play_start_ = ImGui::GetTime();
    }
    ImGui::SameLine();
  }
  if (widgets.button("reset/" + name + "=reset")) {
    state_.view.joints.erase(name);
    if (playing_ == name) playing_.clear();
  }
  ImGui::PopID();
}

void JointsPanel::advance() {
  if (state_.view.moment) playing_.clear();
  if (playing_.empty() || !state_.models.world) return;
  DiagnosticLog ignored;
  const auto place = workspace::find_joint(playing_, *state_.models.world, ignored);
  if (!place) return;
  const pan::layout::Joint& joint =
      (*state_.models.world)[place->target].model()->joints()[place->joint];
  const double low = joint.upper[0] > joint.lower[0] ? joint.lower[0] : -kPi;
  const double high = joint.upper[0] > joint.lower[0] ? joint.upper[0] : kPi;
  const double share =
      0.5 - 0.5 * std::cos(2 * kPi * (ImGui::GetTime() - play_start_) / kPlaySeconds);
  geometry::JointValues values{};
  values[0] = low + share * (high - low);
  state_.view.joints[playing_] =
      workspace::exact_value(static_cast<geometry::JointKind>(joint.kind), values);
}

void JointsPanel::poses() {
  const world::World& world = *state_.models.world;
  const bool several = world.size() > 1;
  ImGui::SetNextItemOpen(several, ImGuiCond_Once);
  const bool open = ImGui::CollapsingHeader("Poses of targets");
  state_.widgets.record("poses");
  if (!open) return;
  for (const world::Instance& target : world.instances()) pose(target);
  if (several &&
      state_.widgets.button("poses/side by side", "Along +y, with gaps of a tenth of their sizes"))
    side_by_side();
  ImGui::Separator();
}

void JointsPanel::pose(const world::Instance& target) {
  Widgets& widgets = state_.widgets;
  const std::string& name = target.name();
  TargetPose pose;
  if (const auto at = state_.view.poses.find(name); at != state_.view.poses.end())
    pose = at->second;
  const TargetPose before = pose;
  ImGui::TextUnformatted(name.c_str());
  ImGui::SameLine();
  if (widgets.button("reset/" + name + "/pose=reset", "To the origin")) pose = {};
  for (int k = 0; k < 3; ++k)
    widgets.drag(fmt::format("pose/{}/{}", name, "xyz"[k]), pose.position[k],
                 2e-3 * state_.view.camera.range, "%.6g m", "World axes");
  static constexpr const char* kAngles[] = {"roll", "pitch", "yaw"};
  static constexpr const char* kHelp[] = {"About world x, applied first", "About world y, second",
                                          "About world z, last"};
  for (int k = 0; k < 3; ++k)
    widgets.slider(fmt::format("pose/{}/{}", name, kAngles[k]), pose.angles[k], -180, 180,
                   "%.4f deg", false, kHelp[k]);
  if (pose == before) return;
  if (pose == TargetPose{})
    state_.view.poses.erase(name);
  else
    state_.view.poses[name] = pose;
}

void JointsPanel::side_by_side() {
  const world::World& world = *state_.models.world;
  auto& poses = state_.view.poses;
  double edge = 0;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const world::Instance& target = world[i];
    const workspace::BoundingSphere sphere = state_.spheres.of(target);
    TargetPose& pose = poses[target.name()];
    pose = {};
    if (i > 0) pose.position.y = edge + 1.1 * sphere.radius - sphere.centre.y;
    edge = pose.position.y + sphere.centre.y + 1.1 * sphere.radius;
    if (i == 0) poses.erase(target.name());
  }
  state_.frame_all();
}

}  // namespace panwright::studio
