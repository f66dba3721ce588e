// Values of the script step `expect`.
#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "studio/main_window.h"
#include "studio/play.h"

namespace panwright::studio {
namespace {

std::string boolean(bool value) { return value ? "true" : "false"; }

std::string triangles_of(const RenderResult* result) {
  std::uint64_t sum = 0;
  if (result != nullptr)
    for (const Detail& each : result->details)
      if (each.visible) sum += each.triangles;
  return std::to_string(sum);
}

std::string pose_of(const ViewState& view, const std::string& target) {
  const auto at = view.poses.find(target);
  if (at == view.poses.end()) return "";
  const Vec3 &p = at->second.position, &t = at->second.angles;
  return fmt::format("{} {} {} {} {} {}", p.x, p.y, p.z, t.x, t.y, t.z);
}

std::string joint_of(const ViewState& view, const std::string& joint) {
  const auto at = view.joints.find(joint);
  return at == view.joints.end() ? "" : at->second;
}

}  // namespace

std::optional<std::string> MainWindow::state(const std::string& name) const {
  const RenderResult* result = state_.result.get();
  const Project::State& models = state_.models;
  // of the models
  if (name == "readings") return std::to_string(models.readings);
  if (name == "failed") return boolean(models.failed);
  if (name == "targets")
    return std::to_string(models.world ? models.world->size() : std::size_t{0});
  if (name == "errors")
    return std::to_string(
        std::count_if(models.messages.begin(), models.messages.end(),
                      [](const Message& each) { return each.severity == Severity::error; }));
  // of the image
  if (name == "exact") return boolean(result != nullptr && result->exact && !result->failed);
  if (name == "edges")
    return std::to_string(
        result != nullptr ? std::count(result->edges.begin(), result->edges.end(), 255) : 0);
  if (name == "reference samples")
    return result != nullptr && result->reference ? std::to_string(result->reference_samples) : "";
  if (name == "triangles") return triangles_of(result);
  if (name == "white") return std::to_string(state_.histogram.saturated);
  if (name == "exposure")
    return result != nullptr && result->imager ? fmt::format("{}", result->detected.exposure_s)
                                               : "";
  if (name == "problem") return state_.renderer.status().problem;
  if (name == "pixels")
    return result != nullptr && result->image.width > 0
               ? fmt::format("{}x{}", result->image.width, result->image.height)
               : "";
  // of the view
  if (name == "range") return fmt::format("{}", state_.view.camera.range);
  if (name == "fov") return fmt::format("{}", state_.view.camera.fov);
  if (name.starts_with("pose/")) return pose_of(state_.view, name.substr(5));
  if (name.starts_with("joint/")) return joint_of(state_.view, name.substr(6));
  if (name.starts_with("lamp/")) {
    const auto at = state_.view.sky.lamps.find(name.substr(5));
    return at == state_.view.sky.lamps.end() ? "" : at->second;
  }
  // of the scenario
  if (name == "frame" || name == "time") {
    const Moment* moment = state_.view.moment.get();
    if (moment == nullptr) return "";
    return name == "frame" ? std::to_string(moment->number) : fmt::format("{}", moment->time);
  }
  if (name == "playing") return boolean(playing());
  if (name == "outside") return boolean(state_.view.from_outside);
  // of the panels
  if (name == "selected") return state_.parts.selected;
  if (name == "hidden") return std::to_string(state_.parts.hidden.size());
  if (name == "layer") return state_.layout.layer;
  if (name == "compare") return state_.image.comparison;
  if (name == "sample") return panels_.materials.sample_name();
  if (name == "edits") return std::to_string(panels_.materials.edit_count());
  if (name == "saved") return panels_.save.message();
  if (name == "video") return panels_.save.video_message();
  if (name == "limited") return state_.widgets.limited();
  if (name == "panel")
    return state_.layout.panel_shown ? fmt::format("{}", state_.layout.panel) : "hidden";
  return std::nullopt;
}

}  // namespace panwright::studio
