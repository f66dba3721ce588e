#include "studio/window_state.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "studio/play.h"
#include "workspace/frame.h"

namespace panwright::studio {
namespace {

// The sphere around another and the points of tracks, about the middle of their box.
workspace::BoundingSphere around(const workspace::BoundingSphere& sphere,
                                 const std::vector<Track>& tracks) {
  Vec3 low = sphere.centre - sphere.radius, high = sphere.centre + sphere.radius;
  for (const Track& track : tracks)
    for (const Vec3& point : track.points) {
      low = glm::min(low, point);
      high = glm::max(high, point);
    }
  workspace::BoundingSphere out{0.5 * (low + high), 0, sphere.up};
  out.radius = glm::length(sphere.centre - out.centre) + sphere.radius;
  for (const Track& track : tracks)
    for (const Vec3& point : track.points)
      out.radius = std::max(out.radius, glm::length(point - out.centre));
  return out;
}

}  // namespace

WindowState::WindowState(const Options& from)
    : options(from),
      layout(from.layout),
      project(from.files, from.open, glfwPostEmptyEvent, from.owner, from.camera_file),
      renderer(from.context, glfwPostEmptyEvent) {}

world::World WindowState::posed() const {
  world::World out = *models.world;
  if (view.moment) {
    workspace::show(view.moment->frame, *models.world, out);
    return out;
  }
  for (const auto& [name, pose] : view.poses)
    if (const auto target = out.find(name)) out.set_pose(*target, {pose.position, pose.rotation()});
  workspace::JointSetter setter(out);
  DiagnosticLog ignored;
  for (const auto& [joint, value] : view.joints) setter.set({joint, value}, ignored);
  return out;
}

workspace::FrameMaker& WindowState::maker_of(const std::shared_ptr<const world::World>& world) {
  if (made_ != world) {
    made_ = world;
    maker_.emplace(*made_);
  }
  return *maker_;
}

void WindowState::take_scene() {
  if (!models.world) return;
  DiagnosticLog ignored;
  const workspace::Settings* const given = scene.read(*models.world, ignored);
  if (given == nullptr) return;
  if (*given->sun_distance != view.scene_distance)
    view.sun_distance = view.scene_distance = *given->sun_distance;
  const std::optional<Vec3> sun = given->sun ? std::optional(*given->sun) : std::nullopt;
  if (sun == scene_sun) return;
  scene_sun = sun;
  if (!sun) return;
  view.sun_azimuth = std::atan2(sun->y, sun->x) / kDegree;
  view.sun_elevation = std::atan2(sun->z, std::hypot(sun->x, sun->y)) / kDegree;
}

const sensor::Imager* WindowState::imager() const {
  if (const Moment* own = view.own()) return own->frame.imager.get();
  const bool has = models.camera && models.camera->imager && view.sized();
  return has ? &*models.camera->imager : nullptr;
}

void WindowState::take_camera() {
  const sensor::CameraFile* camera = models.camera.get();
  workspace::Settings& detector = view.detector;
  if (camera == nullptr)
    detector.camera_file = workspace::Settings().camera_file;
  else
    detector.camera_file = options.camera_file;
  view.has_detector = camera != nullptr && camera->imager;
  if (camera != nullptr && camera->width_m == 0)
    view.camera.fov = std::clamp(
        2 * std::atan(0.5 * camera->width / camera->lens.focal.x) / kDegree, 0.001, 170.0);
  const bool playing = models.play != nullptr;
  if (playing ? view.moment && view.moment->frame.imager == nullptr
              : camera == nullptr || !camera->imager) {
    workspace::Settings none;
    none.camera_file = detector.camera_file;
    detector = none;
  }
}

Vec2 WindowState::pixels() const {
  if (const Moment* own = view.own())
    return {own->frame.camera().width, own->frame.camera().height};
  if (models.camera && view.sized()) return {models.camera->width, models.camera->height};
  return image_size;
}

void WindowState::frame_targets() {
  if (!models.world) return;
  const Vec2 size = view.sized() && view.own() == nullptr ? pixels() : image_size;
  view.camera.frame_all(spheres.of(posed()), size.y / std::max(size.x, 1.0));
}

void WindowState::frame_all() {
  if (!models.world) return;
  workspace::BoundingSphere sphere = spheres.of(posed());
  if (models.play) sphere = around(sphere, models.play->tracks);
  const Vec2 size = view.sized() && view.own() == nullptr ? pixels() : image_size;
  view.camera.frame_all(sphere, size.y / std::max(size.x, 1.0));
}

std::filesystem::path WindowState::output_path(const std::string& file) const {
  return options.scripted ? options.script_folder / file : std::filesystem::path(file);
}

workspace::Settings WindowState::settings() const {
  return settings_of(view, static_cast<std::uint32_t>(image_size.x),
                     static_cast<std::uint32_t>(image_size.y));
}

}  // namespace panwright::studio
