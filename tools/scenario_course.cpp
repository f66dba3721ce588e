#include "tools/scenario_course.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sky/sky.h"
#include "workspace/convex_outline.h"
#include "workspace/targets.h"

namespace panwright::tools {

namespace {

Course& course_of(std::vector<Course>& courses, const std::string& name) {
  const auto found = std::ranges::find(courses, name, &Course::name);
  return found != courses.end() ? *found : courses.emplace_back(Course{.name = name});
}

}  // namespace

void add(const scenario::Frame& frame, double time, std::vector<Course>& courses) {
  if (!frame.camera.position) return;
  const auto add_to = [&](const std::string& name, const Vec3& place) {
    Course& course = course_of(courses, name);
    const Vec3 to_camera = *frame.camera.position - place;
    course.range.emplace_back(time, glm::length(to_camera));
    if (frame.sun_direction && glm::length(to_camera) > 0)
      course.phase.emplace_back(time, angle_between(*frame.sun_direction, to_camera) / kDegree);
  };
  bool any = false;
  for (const scenario::TargetState& target : frame.targets) {
    any = any || target.placement.position.has_value();
    if (target.placement.position) add_to(target.name, *target.placement.position);
  }
  if (!any) add_to("the origin", Vec3(0));
}

SeenTargets::SeenTargets(const workspace::Scenario& scenario, world::World world)
    : scenario_(&scenario),
      world_(std::make_unique<const world::World>(std::move(world))),
      maker_(std::make_unique<workspace::FrameMaker>(*world_)),
      shown_(*world_) {}

Result<SeenTargets> SeenTargets::of(const workspace::Scenario& scenario, DiagnosticLog& log,
                                    const Job& job) {
  std::vector<workspace::TargetFile> files;
  for (const std::string& target : *scenario.settings.targets)
    files.push_back(workspace::target_file(target));
  auto world = workspace::open_world(files, {}, log, job);
  if (!world) return failed;
  return SeenTargets(scenario, *std::move(world));
}

bool SeenTargets::check(const scenario::Frame& frame, std::uint64_t number, DiagnosticLog& log) {
  const auto view = workspace::view_of(*scenario_, frame, number, *world_, log);
  return view && maker_->frame(*view, log);
}

bool SeenTargets::add(const scenario::Frame& frame, std::uint64_t number, double time,
                      std::vector<Course>& courses, DiagnosticLog& log) {
  auto view = workspace::view_of(*scenario_, frame, number, *world_, log);
  if (!view) return false;
  // an instant
  const workspace::Settings standard;
  view->motion = {};
  view->settings.exposure = standard.exposure;
  view->settings.line_time = standard.line_time;
  view->settings.tdi = standard.tdi;
  const auto made = maker_->frame(*view, log);
  if (!made) return false;
  workspace::show(*made, *world_, shown_);
  const world::Camera& camera = made->camera();
  const sky::Sky sky(shown_);
  for (const world::Instance& target : shown_.instances()) {
    if (!target.visible()) continue;
    const world::Pose pose = target.pose();
    std::vector<Vec2> places;
    Vec3 low(HUGE_VAL), high(-HUGE_VAL);
    auto [known, fresh] = points_.try_emplace(target.shape_stamp());
    if (fresh) known->second = workspace::extreme_points(target);
    for (const Vec3& point : known->second) {
      const Vec3 at = pose.translation + pose.rotation * point;
      low = glm::min(low, at), high = glm::max(high, at);
      if (const auto pixel = world::project(camera, at)) places.push_back(*pixel);
    }
    if (!(low.x <= high.x)) continue;
    const auto area = workspace::hull_area(std::move(places), camera.width, camera.height);
    Course& course = course_of(courses, target.name());
    course.pixels.emplace_back(time, area.within);
    course.in_image.emplace_back(time, area.whole > 0 ? area.within / area.whole : 0);
    if (sky.size() > 0) course.sun.emplace_back(time, sky.sun_share(0.5 * (low + high)));
  }
  return true;
}

}  // namespace panwright::tools
