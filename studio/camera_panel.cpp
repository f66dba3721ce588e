#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "studio/panels.h"
#include "studio/play.h"

namespace panwright::studio {

void CameraPanel::draw() {
  Widgets& widgets = state_.widgets;
  if (state_.models.play) scenario();
  ImGui::BeginDisabled(state_.view.own() != nullptr);
  OrbitCamera& camera = state_.view.camera;
  const double width = std::max(state_.pixels().x, 1.0);
  widgets.slider("camera/range", camera.range, kNearest, kFarthest, "%.6g m", true,
                 "Distance from the centre. Mouse wheel over the image; Ctrl + click to type");
  widgets.slider("camera/azimuth", camera.azimuth, -180, 180, "%.3f deg", false,
                 "From +x about +z. Left button over the image");
  widgets.slider("camera/elevation", camera.elevation, -89.9, 89.9, "%.3f deg");
  ImGui::BeginDisabled(state_.view.sized());
  widgets.slider("camera/field of view", camera.fov, 0.001, 170, "%.5g deg", true,
                 "Full horizontal angle");
  double pixel = 2e3 * std::tan(camera.fov * kDegree / 2) / width;
  if (widgets.slider("camera/pixel=pixel angle", pixel, 1e-5, 20, "%.5g mrad", true,
                     "IFOV: angle of the pixel on the axis"))
    camera.fov = 2 * std::atan(pixel * 1e-3 * width / 2) / kDegree;
  ImGui::EndDisabled();
  if (const sensor::CameraFile* file = state_.models.camera.get())
    ImGui::TextDisabled("%s: %u x %u pixels%s", state_.options.camera_file.c_str(), file->width,
                        file->height, file->imager ? ", with a detector" : "");
  ImGui::TextDisabled("pixel footprint at the centre: %.4g m",
                      2 * camera.range * std::tan(camera.fov * kDegree / 2) / width);
  for (int k = 0; k < 3; ++k)
    widgets.drag(fmt::format("camera/look at {}", "xyz"[k]), camera.centre[k], 1e-3 * camera.range,
                 "%.6g m", "World axes. Right or middle button over the image");
  if (widgets.button("camera/all of it=frame all", "Key F")) state_.frame_all();
  if (state_.models.play) {
    ImGui::SameLine();
    if (widgets.button("camera/targets=frame the targets", "Without the tracks"))
      state_.frame_targets();
  }
  ImGui::Separator();
  frames();
  ImGui::EndDisabled();
}

// Of the moment: whose view, and where its camera is.
void CameraPanel::scenario() {
  static constexpr const char* kViews[] = {"camera=its camera", "outside=from outside"};
  Widgets& widgets = state_.widgets;
  ImGui::TextUnformatted("Scenario");
  std::string view = state_.view.from_outside ? "outside" : "camera";
  if (widgets.choice("view", view, kViews, std::size(kViews), "Key C"))
    state_.view.from_outside = view == "outside";
  widgets.slider("scenario/frames a second=frames per second", state_.playback.rate, 0.1, 120,
                 "%.3g", true, "While it plays; frames that take longer to draw are left out");
  ImGui::BeginDisabled(!state_.view.from_outside);
  widgets.check("scenario/tracks=tracks and field of view", state_.playback.tracks);
  ImGui::EndDisabled();
  if (const Moment* moment = state_.view.moment.get()) {
    const world::Camera& camera = moment->frame.camera();
    ImGui::TextDisabled("%u x %u pixels%s", camera.width, camera.height,
                        camera.distortion ? ", a lens with distortion" : "");
    const world::World posed = state_.posed();
    for (const world::Instance& target : posed.instances()) {
      const Vec3 way = camera.position - target.pose().translation;
      const Vec3 sun = moment->frame.sun->direction;
      const double phase =
          std::atan2(glm::length(glm::cross(way, sun)), glm::dot(way, sun)) / kDegree;
      ImGui::TextDisabled("%s: range %.6g m, phase %.2f deg", target.name().c_str(),
                          glm::length(way), phase);
    }
  }
  ImGui::Separator();
}

void CameraPanel::frames() {
  std::string& chosen = state_.view.camera.frame;
  ImGui::TextUnformatted("Camera frame");
  if (chosen.empty())
    ImGui::TextDisabled("none: the camera orbits the centre");
  else if (state_.widgets.button("camera/leave the frame"))
    chosen.clear();
  const auto& world = state_.models.world;
  for (std::size_t i = 0; world && i < world->size(); ++i) {
    const world::Instance& target = (*world)[i];
    for (std::size_t k = 0; k < target.model()->frames().size(); ++k) {
      const std::string name = target.name() + "/" + std::string(target.model()->frame_name(k));
      if (ImGui::Selectable(name.c_str(), chosen == name)) chosen = name;
      state_.widgets.record("frame/" + name);
    }
  }
}

}  // namespace panwright::studio
