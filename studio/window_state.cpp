#include "studio/window_state.h"

#include <GLFW/glfw3.h>

#include <algorithm>

namespace panwright::studio {

WindowState::WindowState(const Options& from)
    : options(from),
      layout(from.layout),
      project(from.files, from.open, glfwPostEmptyEvent),
      renderer(from.context, glfwPostEmptyEvent) {}

world::World WindowState::posed() const {
  world::World out = *models.world;
  for (const auto& [name, pose] : view.poses)
    if (const auto target = out.find(name)) out.set_pose(*target, {pose.position, pose.rotation()});
  workspace::JointSetter setter(out);
  DiagnosticLog ignored;
  for (const auto& [joint, value] : view.joints) setter.set({joint, value}, ignored);
  return out;
}

void WindowState::frame_all() {
  if (!models.world) return;
  view.camera.frame_all(spheres.of(posed()), image_size.y / std::max(image_size.x, 1.0));
}

std::filesystem::path WindowState::output_path(const std::string& file) const {
  return options.scripted ? options.script_folder / file : std::filesystem::path(file);
}

workspace::Settings WindowState::settings() const {
  return settings_of(view, static_cast<std::uint32_t>(image_size.x),
                     static_cast<std::uint32_t>(image_size.y));
}

}  // namespace panwright::studio
