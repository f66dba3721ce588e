// Frames of a data set's plan: draws, cameras, Suns.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/file.h"
#include "base/hash.h"
#include "base/random.h"
#include "base/text.h"
#include "workspace/convex_outline.h"
#include "workspace/dataset.h"
#include "workspace/sky_settings.h"

namespace panwright::workspace {

namespace {

using nlohmann::json;
constexpr int kMostAttempts = 2000;  // at the constraints, for a frame

// Random numbers of one attempt at a frame: functions of the name of what is drawn.
class FrameDraws {
 public:
  FrameDraws(std::uint64_t seed, std::uint32_t frame, std::uint32_t attempt)
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        frame_(frame),
        attempt_(attempt) {}

  std::array<std::uint32_t, 4> words(std::string_view name) const {
    return philox({static_cast<std::uint32_t>(hash64(as_bytes(name))), frame_, attempt_, 0}, key_);
  }
  double unit(std::string_view name) const { return in_unit(words(name)[0]); }

  double number(const Distribution& law, std::string_view name) const {
    using Kind = Distribution::Kind;
    const auto word = words(name);
    const double u = in_unit(word[0]);
    switch (law.kind) {
      case Kind::uniform:
        return law.a + u * (law.b - law.a);
      case Kind::log_uniform:
        return law.a * det::exp(u * det::log(law.b / law.a));
      case Kind::normal:
        return law.a + law.b * std::sqrt(-2 * det::log(u)) * det::cos(2 * kPi * in_unit(word[1]));
      case Kind::choice:
        return json::parse(law.choices[index(law, u)]).get<double>();
    }
    return 0;
  }

  json value(const Recipe& recipe, const std::string& name) const {
    if (const auto* constant = std::get_if<std::string>(&recipe.of)) return json::parse(*constant);
    if (const auto* law = std::get_if<Distribution>(&recipe.of)) {
      if (law->kind == Distribution::Kind::choice)
        return json::parse(law->choices[index(*law, unit(name))]);
      return number(*law, name);
    }
    if (const auto* list = std::get_if<std::vector<Recipe>>(&recipe.of)) {
      json out = json::array();
      for (std::size_t k = 0; k < list->size(); ++k)
        out.push_back(value((*list)[k], fmt::format("{}.{}", name, k)));
      return out;
    }
    json out = json::object();
    for (const auto& [member, item] : std::get<3>(recipe.of))
      out[member] = value(item, name + "." + member);
    return out;
  }

  // Evenly over directions within a cone.
  Vec3 direction(const Cone& cone, std::string_view name) const {
    const auto word = words(name);
    const double c = 1 - in_unit(word[0]) * (1 - det::cos(cone.within));
    return around(cone.axis, c, 2 * kPi * in_unit(word[1]));
  }

  // The direction of a cosine to an axis, turned about it.
  static Vec3 around(const Vec3& axis, double cosine, double turn) {
    const Vec3 other = std::fabs(axis.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 a = glm::normalize(glm::cross(axis, other)), b = glm::cross(axis, a);
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const auto [s, c] = det::sincos(turn);
    return glm::normalize(cosine * axis + sine * (c * a + s * b));
  }

  // Evenly over all rotations. K. Shoemake, "Uniform random rotations", 1992.
  Quat rotation(std::string_view name) const {
    const auto word = words(name);
    const double u = in_unit(word[0]);
    const auto [s1, c1] = det::sincos(2 * kPi * in_unit(word[1]));
    const auto [s2, c2] = det::sincos(2 * kPi * in_unit(word[2]));
    const double a = std::sqrt(1 - u), b = std::sqrt(u);
    return glm::normalize(Quat(b * c2, a * s1, a * c1, b * s2));
  }

 private:
  static std::size_t index(const Distribution& law, double u) {
    return std::min(static_cast<std::size_t>(u * static_cast<double>(law.choices.size())),
                    law.choices.size() - 1);
  }
  std::array<std::uint32_t, 2> key_;
  std::uint32_t frame_, attempt_;
};

struct Rejections {
  std::size_t keep_out = 0, sun = 0, pixels = 0, near = 0, lens = 0;
};

class FramePlanner {
 public:
  FramePlanner(const DatasetPlan& plan, const Frame& base, const world::Instance& target,
               bool has_detector)
      : plan_(plan),
        camera_(base.camera()),
        mount_(base.camera().world_from_camera),
        points_(extreme_points(target)),
        pose_(target.pose()),
        sun_(base.sun ? base.sun->direction : Vec3(0)),
        has_detector_(has_detector),
        reference_(*base.settings.engine == Settings::Engine::reference) {
    for (const TargetPose& each : base.poses)
      if (each.target == plan.target) pose_ = each.pose;
  }

  std::optional<PlannedFrame> frame(std::uint32_t number) {
    for (std::uint32_t attempt = 0; attempt < kMostAttempts; ++attempt)
      if (auto out = tried(number, attempt)) return out;
    return std::nullopt;
  }
  const Rejections& rejections() const { return rejected_; }

 private:
  std::optional<PlannedFrame> tried(std::uint32_t number, std::uint32_t attempt) {
    const FrameDraws draws(plan_.seed, number, attempt);
    PlannedFrame out;
    const Vec3 from_target = draws.direction(plan_.direction, "direction");
    for (const Cone& cone : plan_.keep_out)
      if (angle_between(cone.axis, from_target) < cone.within) return refuse(rejected_.keep_out);
    world::Pose pose = pose_;
    if (plan_.turns) pose.rotation = draws.rotation("attitude");
    out.range = draws.number(plan_.range, "range");
    world::Camera camera = camera_;
    if (plan_.has_lens) {
      camera.focal *= draws.number(plan_.focal, "lens.focal");
      camera.principal += Vec2(draws.number(plan_.principal[0], "lens.right"),
                               draws.number(plan_.principal[1], "lens.down"));
    }
    const Vec3 away = pose.rotation * from_target;
    camera.position = pose.translation + pose.rotation * plan_.point + out.range * away;
    const auto word = draws.words("placement");
    const Vec2 size(camera.width, camera.height);
    out.place =
        0.5 * size + plan_.placement * (Vec2(in_unit(word[0]), in_unit(word[1])) - 0.5) * size;
    world::Camera level = camera;
    level.position = Vec3(0), level.world_from_camera = Quat(1, 0, 0, 0);
    const auto ray = world::distorted_ray(level, out.place);
    if (!ray) return refuse(rejected_.lens);
    camera.world_from_camera = turned(-away, ray->direction, draws.number(plan_.roll, "roll"));
    const Vec3 boresight = camera.world_from_camera * Vec3(0, 0, 1);
    Vec3 sun = sun_;
    if (plan_.has_sun) {
      const double u = draws.unit("phase");
      const double cosine =
          plan_.even_phase
              ? det::cos(plan_.phase.a) + u * (det::cos(plan_.phase.b) - det::cos(plan_.phase.a))
              : det::cos(draws.number(plan_.phase, "phase"));
      sun = FrameDraws::around(away, cosine, 2 * kPi * draws.unit("sun"));
      if (angle_between(sun, boresight) < plan_.sun_keep_out) return refuse(rejected_.sun);
    }
    out.phase = angle_between(sun, away) / kDegree;
    std::vector<Vec2> outline;
    for (const Vec3& point : points_) {
      const Vec3 at = pose.translation + pose.rotation * point;
      if (!(glm::dot(at - camera.position, boresight) > 0)) return refuse(rejected_.near);
      if (const auto pixel = world::project(camera, at)) outline.push_back(*pixel);
    }
    out.pixels = hull_area(std::move(outline), camera.width, camera.height).within;
    if (!(out.pixels >= plan_.pixels[0] && out.pixels <= plan_.pixels[1]))
      return refuse(rejected_.pixels);
    out.view = row_of(number, camera, pose, sun);
    return out;
  }

  // world_from_camera that has a direction of the world along one of the camera, and a roll.
  static Quat turned(const Vec3& world, const Vec3& camera, double roll) {
    const Vec3 up = std::fabs(world.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(0, 1, 0);
    const Vec3 right = glm::normalize(glm::cross(world, up));
    const Quat level = glm::quat_cast(Mat3(right, glm::cross(world, right), world));
    const auto [s, c] = det::sincos(0.5 * roll);
    // the shortest turn from the camera's direction to its axis
    const Vec3 z(0, 0, 1);
    const Vec3 axis = glm::cross(camera, z);
    const Quat swing = glm::normalize(Quat(1 + glm::dot(camera, z), axis.x, axis.y, axis.z));
    return glm::normalize(level * Quat(c, 0, 0, s) * swing);
  }

  std::string row_of(std::uint32_t number, const world::Camera& camera, const world::Pose& pose,
                     const Vec3& sun) const {
    const FrameDraws draws(plan_.seed, number, 0);
    const Quat attitude = glm::normalize(camera.world_from_camera * glm::conjugate(mount_));
    nlohmann::ordered_json row;
    row["name"] = fmt::format("{:06}", number);
    row["camera"] = {camera.position.x, camera.position.y, camera.position.z};
    row["quat"] = {attitude.w, attitude.x, attitude.y, attitude.z};
    if (plan_.turns) {
      const Vec3& t = pose.translation;
      const Quat& q = pose.rotation;
      row["pose"][plan_.target] = {t.x, t.y, t.z, q.w, q.x, q.y, q.z};
    }
    if (plan_.has_sun) row["sun"] = {sun.x, sun.y, sun.z};
    if (plan_.has_lens)
      row["intrinsics"] = {camera.focal.x, camera.focal.y, camera.principal.x, camera.principal.y};
    for (const auto& [member, recipe] : plan_.sample) row[member] = draws.value(recipe, member);
    if (has_detector_) row["noise-seed"] = draws.words("noise")[0];
    if (reference_) row["seed"] = draws.words("paths")[0];
    return row.dump();
  }

  static std::optional<PlannedFrame> refuse(std::size_t& count) {
    ++count;
    return std::nullopt;
  }

  const DatasetPlan& plan_;
  world::Camera camera_;
  Quat mount_;
  std::vector<Vec3> points_;
  world::Pose pose_;
  Vec3 sun_;
  bool has_detector_, reference_;
  Rejections rejected_;
};

// The reasons of frames that no attempt made.
void report_none(std::uint32_t number, const Rejections& of, DiagnosticLog& log) {
  std::vector<std::pair<std::size_t, std::string>> reasons = {
      {of.keep_out, "the camera is in a keep_out"},
      {of.sun, "the Sun is within keep_out of the boresight"},
      {of.pixels, "the target's pixels are out of bounds"},
      {of.near, "the target reaches behind the camera"},
      {of.lens, "the lens has no ray at the placement"}};
  std::ranges::stable_sort(reasons, std::greater(), &std::pair<std::size_t, std::string>::first);
  std::vector<std::string> words;
  for (const auto& [count, reason] : reasons)
    if (count > 0) words.push_back(fmt::format("{} ({} times)", reason, count));
  log.report_file(Code("E8017"), {},
                  fmt::format("frame {}: no camera keeps to the plan after {} attempts: {}", number,
                              kMostAttempts, fmt::join(words, "; ")),
                  "widen range, direction, phase or pixels");
}

}  // namespace

Result<Settings> dataset_settings(const std::string& text,
                                  const std::vector<std::pair<std::string, std::string>>& targets,
                                  const std::filesystem::path& folder, DiagnosticLog& log) {
  View view;
  if (!parse_view(text, 0, {}, view, log)) return failed;
  Settings settings = std::move(view.settings);
  std::vector<std::string> files;
  for (const auto& [name, file] : targets) files.push_back(name + "=" + (folder / file).string());
  settings.targets = std::move(files);
  place_sky_files(folder, settings);
  if (settings.camera_file) settings.camera_file = (folder / *settings.camera_file).string();
  return settings;
}

bool read_planned_view(std::string_view row, std::size_t number, const Settings& defaults,
                       View& view, DiagnosticLog& log) {
  if (!parse_view(row, number, defaults, view, log)) return false;
  view.settings.frame_number = static_cast<std::uint32_t>(number);
  return true;
}

Result<std::vector<PlannedFrame>> plan_frames(const DatasetPlan& plan,
                                              const std::filesystem::path& folder,
                                              ViewSession& session, std::string& text,
                                              DiagnosticLog& log, const Job& job) {
  const auto settings = dataset_settings(text, plan.targets, folder, log);
  if (!settings) return failed;
  // parameters, joints and the like of the first frame, seen from the origin
  const FrameDraws first(plan.seed, 0, 0);
  json row = {{"camera", {0, 0, 0}}, {"quat", {1, 0, 0, 0}}};
  for (const auto& [member, recipe] : plan.sample) row[member] = first.value(recipe, member);
  View view;
  if (!read_planned_view(row.dump(), 0, *settings, view, log)) return failed;
  if (!settings->fov && !settings->ifov && !settings->intrinsics && !settings->camera_file) {
    log.report_file(Code("E8017"), {},
                    "[view] has no lens, expected fov, ifov, intrinsics or camera_file");
    return failed;
  }
  const world::World* world = session.world(view, {}, log, job);
  if (world == nullptr) return failed;
  const auto base = session.frame(view, log);
  if (!base) return failed;
  // without a Sun, one shines over the camera's shoulder
  view.settings.quat = Quat(0, 1, 0, 0);
  const auto turned = session.frame(view, log);
  if (!turned || log.has_errors()) return failed;
  if (!plan.has_sun && turned->sun->direction != base->sun->direction) {
    log.report_file(Code("E8017"), {}, "the plan has no Sun", "[sun], or sun or date in [view]");
    return failed;
  }
  const auto target = std::ranges::find(world->instances(), plan.target, &world::Instance::name);
  if (plan.has_lens) {
    json whole = json::parse(text);
    whole.erase("camera_file"), whole.erase("camera-file");
    for (const char* lens : {"fov", "ifov", "intrinsics"}) whole.erase(lens);
    const Settings& made = base->settings;
    whole["size"] = {made.size->width, made.size->height};
    if (made.distortion) whole["distortion"] = *made.distortion;
    if (made.mount) whole["mount"] = {made.mount->w, made.mount->x, made.mount->y, made.mount->z};
    if (made.detector) whole["detector"] = *made.detector;
    text = whole.dump();
  }
  FramePlanner planner(plan, *base, *target, base->imager != nullptr);
  std::vector<PlannedFrame> frames;
  frames.reserve(plan.frames);
  for (std::uint32_t number = 0; number < plan.frames; ++number) {
    if (number % 256 == 0) job.poll();
    auto made = planner.frame(number);
    if (!made) {
      report_none(number, planner.rejections(), log);
      return failed;
    }
    frames.push_back(*std::move(made));
  }
  return frames;
}

}  // namespace panwright::workspace
