#include "workspace/frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <variant>

#include "base/file.h"
#include "base/text.h"
#include "light/light.h"
#include "preview/lens_renderer.h"
#include "preview/reference/ground_layer.h"
#include "workspace/internal/forward.h"
#include "workspace/internal/setting_bounds.h"
#include "workspace/lamp_text.h"
#include "world/evaluation.h"

namespace panwright::workspace {

namespace {

constexpr double kDefaultFieldOfView = 30 * kDegree;
constexpr double kMargin = 1.1;        // of the targets' radius, around it in the image
constexpr double kFilled = 0.85;       // of the image, by targets before a default camera
constexpr double kWidestDefault = 90;  // degrees
// of focal lengths, pixels; orthographic: pixels per metre
constexpr double kLeastFocal = 1e-30;
constexpr double kMostFocal = 1e15;
constexpr double kLargestModel = 1e30;  // metres, as coordinates of models

// Focal lengths and principal point, where they are given.
bool set_lens(const Settings& settings, world::Camera& camera) {
  std::tie(camera.width, camera.height) = std::pair(settings.size->width, settings.size->height);
  if (settings.fov) {
    world::set_field_of_view(camera, camera.width, camera.height, *settings.fov);
  } else if (settings.ifov) {
    world::set_pixel_angle(camera, camera.width, camera.height, *settings.ifov);
  } else if (settings.intrinsics) {
    camera.projection = world::Projection::perspective;
    camera.focal = Vec2(settings.intrinsics->x, settings.intrinsics->y);
    camera.principal = Vec2(settings.intrinsics->z, settings.intrinsics->w);
    if (settings.distortion)
      if (const auto distortion = sensor::parse_distortion(*settings.distortion))
        camera.distortion = std::make_shared<sensor::DistortionMap>(*distortion);
  } else if (settings.ortho) {
    world::set_orthographic(camera, camera.width, camera.height, *settings.ortho);
  } else {
    world::set_field_of_view(camera, camera.width, camera.height, kDefaultFieldOfView);
    return false;
  }
  return true;
}

bool check_lens(const Settings& settings, DiagnosticLog& log) {
  if (settings.distortion) {
    const char* wrong = !sensor::parse_distortion(*settings.distortion)
                            ? "a model and its numbers, as \"brown -0.2 0.1 0 0\""
                        : settings.intrinsics ? nullptr
                                              : "--intrinsics beside it";
    if (wrong != nullptr) {
      log.report(
          Code("E0201"), {},
          fmt::format("--distortion is {}, expected {}", in_quotes(*settings.distortion), wrong),
          "docs/cameras.md");
      return false;
    }
  }
  constexpr double kWidePixel = kDegree;
  if (settings.ifov && *settings.ifov > kWidePixel && !log.contains(Code("W0270")))
    log.report(
        Code("W0270"), {},
        fmt::format("--ifov is {:.4g} degrees, the angle of each pixel", *settings.ifov / kDegree),
        fmt::format("--fov {:.4g} is the field of view of the image", *settings.ifov / kDegree));
  world::Camera camera;
  if (!set_lens(settings, camera)) return true;
  if (const char* why = preview::LensRenderer::refused(camera);
      why != nullptr && *settings.engine == Settings::Engine::gl) {
    log.report(Code("E0201"), {}, why, "docs/cameras.md");
    return false;
  }
  for (int k = 0; k < 2; ++k) {
    if (camera.focal[k] >= kLeastFocal && camera.focal[k] <= kMostFocal) continue;
    const SettingId id = settings.fov     ? SettingId::fov
                         : settings.ifov  ? SettingId::ifov
                         : settings.ortho ? SettingId::ortho
                                          : SettingId::intrinsics;
    log.report(Code("E0201"), {},
               fmt::format("--{} is {}, expected {}", info_of(id).name,
                           in_quotes(setting_text(id, settings)),
                           settings.ortho ? "a width with pixels of 1e-15 to 1e30 m"
                                          : "a focal length of at most 1e15 pixels"));
    return false;
  }
  return true;
}

// Checks what settings mean for one kind of instrument: an overload for each kind.
//
//   bounded  each alone is within its bounds
void check_kind(const CameraInstrument& kind, const Settings& settings, bool bounded,
                DiagnosticLog& log) {
  if (bounded) (void)check_lens(settings, log);
  for (const std::string& output : *settings.outputs) {
    check_output(kind, output, log);
    const auto format = image::image_format(output);
    if ((format == image::ImageFormat::tiff || format == image::ImageFormat::fits) &&
        !settings.detector && !settings.camera_file)
      log.report(Code("E0202"), {},
                 fmt::format("{} holds numbers of a detector, and the camera has none; expected "
                             ".png, .exr, .npy or .npz",
                             in_quotes(output)),
                 "docs/detector.md");
  }
}

// The kind of instrument that settings choose.
Instrument kind_of(const Settings&) { return CameraInstrument(); }

bool is_sound(const Settings& settings, DiagnosticLog& log) {
  const std::size_t errors = log.errors();
  const bool bounded = check(settings, log) && check_sky(settings, log);
  std::visit([&](const auto& kind) { check_kind(kind, settings, bounded, log); },
             kind_of(settings));
  return log.errors() == errors;
}

// The sphere fills the image, less a margin.
void fit_lens(const BoundingSphere& sphere, world::Camera& camera) {
  const double distance = glm::length(sphere.centre - camera.position);
  const double sine = std::min(1.0, kMargin * sphere.radius / std::max(distance, 1e-300));
  const double widest = 0.5 * kWidestDefault * kDegree;
  const double half = std::min(widest, std::asin(sine));
  // the shorter side decides, or a fourth of the longer one: in a line of pixels the targets would
  // be a dot
  const double shorter = std::max(double(std::min(camera.width, camera.height)),
                                  0.25 * std::max(camera.width, camera.height));
  const double aspect = camera.width / shorter;
  const double fov = std::min(2 * std::atan(aspect * std::tan(half)), 0.99 * kPi);
  world::set_field_of_view(camera, camera.width, camera.height, fov);
}

// Turns a default camera to the middle of what is visible, which then fills
// kFilled of the image. Returns false where nothing has an outline.
bool fit_outline(const world::World& world, world::Camera& camera) {
  auto seen = outline(world, camera);
  for (int turn = 0; seen && turn < 2; ++turn) {
    const Vec2 middle = 0.5 * (seen->low + seen->high);
    const Quat& q = camera.world_from_camera;
    DiagnosticLog ignored;
    const auto aimed = world::looking_at(camera.position, camera.position + q * Vec3(middle, 1),
                                         q * Vec3(0, -1, 0), ignored);
    if (!aimed) break;
    camera.world_from_camera = *aimed;
    seen = outline(world, camera);
  }
  if (!seen) return false;
  const Vec2 half = glm::max(glm::abs(seen->low), glm::abs(seen->high));
  // in a line of pixels the targets would be a dot
  const double least = 0.25 * std::max(camera.width, camera.height);
  const Vec2 image(std::max<double>(camera.width, least), std::max<double>(camera.height, least));
  const double focal = 0.5 * kFilled * std::min(image.x / half.x, image.y / half.y);
  if (!(focal >= kLeastFocal && focal <= kMostFocal)) return false;
  world::set_field_of_view(camera, camera.width, camera.height,
                           2 * std::atan(0.5 * camera.width / focal));
  return true;
}

// A pose of the world's targets, into the frame and into the world as it is shown.
bool set_pose(const PoseSetting& given, world::World& world, Frame& frame, DiagnosticLog& log) {
  std::size_t target = 0;
  if (!given.target.empty()) {
    const auto found = world.require(given.target, log);
    if (!found) return false;
    target = *found;
  } else if (world.size() != 1) {
    const auto& [at, q] = given.pose;
    log.report(Code("E0201"), {},
               fmt::format("--pose is '{} {} {} {} {} {} {}', expected the name of one of several "
                           "targets, as NAME=\"X Y Z QW QX QY QZ\"",
                           at.x, at.y, at.z, q.w, q.x, q.y, q.z));
    return false;
  }
  const auto rotation = unit_quaternion(given.pose.rotation);
  if (!rotation) {
    log.report(Code("E0201"), {}, "--pose has another quaternion than a unit one w x y z");
    return false;
  }
  const world::Pose pose{given.pose.translation, *rotation};
  world.set_pose(target, pose);
  frame.poses.push_back({world[target].name(), pose});
  return true;
}

// Position and attitude; `sphere` returns what is around the targets.
template <class Sphere>
bool place_camera(const Settings& settings, const Sphere& sphere, bool has_ground,
                  world::Camera& camera, DiagnosticLog& log) {
  if (settings.camera) {
    camera.position = *settings.camera;
  } else {
    const BoundingSphere around = sphere();
    if (!(around.radius <= kLargestModel)) {
      log.report(Code("E0201"), {},
                 fmt::format("the targets reach further than {} m, where a --camera must be given",
                             kLargestModel));
      return false;
    }
    const double distance = kMargin * around.radius / std::sin(0.5 * kDefaultFieldOfView);
    // ground is looked upon from higher up
    camera.position =
        around.centre + distance * from_local(around.up, {-0.5, -1, around.ground ? 1 : 0.4});
  }
  if (settings.quat) {
    camera.world_from_camera = *unit_quaternion(*settings.quat);
    return true;
  }
  std::optional<Vec3> up = settings.up ? scaled_direction(*settings.up) : std::nullopt;
  Vec3 aim(0);
  if (settings.look_at) {
    aim = *settings.look_at;
  } else if (!settings.camera || has_ground) {
    const BoundingSphere around = sphere();
    aim = around.centre;
    if (!settings.up && has_ground) {
      // straight down the north is up
      const Vec3 line = glm::normalize(aim - camera.position);
      const bool down = glm::length(glm::cross(line, around.up)) < 1e-3;
      up = down ? from_local(around.up, {0, 1, 0}) : around.up;
    }
  }
  const auto attitude = world::looking_at(camera.position, aim, up, log);
  if (attitude) camera.world_from_camera = *attitude;
  return bool(attitude);
}

// Which of the scene's settings a view has taken over.
void note_scene(const Settings& own, const Settings& scene, Frame& frame) {
  for (std::size_t i = 0; i < std::size(kSettings); ++i) {
    const auto id = static_cast<SettingId>(i);
    if (id == SettingId::planet || !has_value(id, scene) || has_value(id, own)) continue;
    frame.of_scene.push_back(fmt::format("{} {}", info_of(id).name, setting_text(id, scene)));
  }
  for (const auto& [name, text] : *scene.planet)
    if (std::ranges::find(*own.planet, name, &std::pair<std::string, std::string>::first) ==
        own.planet->end())
      frame.of_scene.push_back(fmt::format("planet {}={}", name, text));
}

// "TARGET/FRAME", or "FRAME" of the one target that has it.
bool place_in_frame(const std::string& text, const world::World& world, world::Camera& camera,
                    DiagnosticLog& log) {
  // a frame may have a slash in its name, and so may a target
  for (std::size_t at = text.find('/'); at != text.npos; at = text.find('/', at + 1))
    if (const auto target = world.find(std::string_view(text).substr(0, at)))
      return world::place_in_frame(camera, world, *target, std::string_view(text).substr(at + 1),
                                   log);
  if (world.size() == 1) return world::place_in_frame(camera, world, 0, text, log);
  std::vector<std::size_t> having;
  for (std::size_t i = 0; i < world.size(); ++i)
    if (world[i].model()->find_frame(text)) having.push_back(i);
  if (having.size() == 1) return world::place_in_frame(camera, world, having[0], text, log);
  std::string names;
  for (const std::size_t i : having)
    names += (names.empty() ? "" : ", ") + in_quotes(world[i].name() + "/" + text);
  log.report(Code("E5005"), {},
             having.empty()
                 ? fmt::format("unknown frame {}, expected TARGET/FRAME", in_quotes(text))
                 : fmt::format("{} targets have a frame {}", having.size(), in_quotes(text)),
             having.empty() ? std::string() : "name one of " + names);
  return false;
}

void set_sun(const Settings& settings, const std::optional<scenario::DatedSky>& dated,
             const Quat& world_from_camera, Frame& frame) {
  world::Sun sun;
  // behind the camera, over its left shoulder: camera axes are x right, y down
  const Vec3 shoulder = world_from_camera * glm::normalize(Vec3(-0.6, -0.6, -1));
  const Vec3 otherwise = dated ? dated->sun_direction : shoulder;
  sun.direction = *scaled_direction(settings.sun ? *settings.sun : otherwise);
  sun.distance = dated && !settings.sun_distance ? dated->sun_distance : *settings.sun_distance;
  sun.limb_darkening = *settings.limb_darkening;
  if (settings.sun_irradiance) {
    // by date it is given at 1 AU
    const double square = settings.orbit ? sun.distance * sun.distance : 1;
    sun.irradiance = *settings.sun_irradiance / square;
  }
  if (settings.white) frame.white = *settings.white;
  frame.sun = sun;
}

}  // namespace

bool check(const View& view, DiagnosticLog& log) {
  DiagnosticLog apart = log.apart();
  const bool good = is_sound(view.settings, apart);
  forward(apart, view.label, view.file, log);
  return good;
}

Result<Frame> FrameMaker::frame(const View& view, DiagnosticLog& log) {
  DiagnosticLog apart = log.apart();
  auto frame = made(view, apart);
  forward(apart, view.label, view.file, log);
  if (frame && view.labels && !set_labels(*view.labels, *frame, log)) return failed;
  return frame;
}

bool FrameMaker::set_labels(const ViewLabels& of, Frame& frame, DiagnosticLog& log) {
  if (*frame.settings.tdi > 0 && of.labelling->flow) {
    log.report(Code("E0201"), {},
               "--tdi and flow cannot be combined: frames of a line scanner show other places",
               "leave out flow in [labels]");
    return false;
  }
  FrameLabelling labels{of.labelling, of.name, of.number, of.time, nullptr, nullptr};
  const auto make = [&](const std::shared_ptr<const View>& from, std::shared_ptr<const Frame>& to) {
    if (from == nullptr) return true;
    auto made = this->frame(*from, log);
    if (made) to = std::make_shared<const Frame>(*std::move(made));
    return to != nullptr;
  };
  if (!make(of.previous, labels.previous) || !make(of.next, labels.next)) return false;
  frame.labels = std::make_shared<const FrameLabelling>(std::move(labels));
  return true;
}

// Size, intrinsics, distortion, mount and detector in place of the file's name.
bool FrameMaker::use_camera_file(Settings& settings, DiagnosticLog& log) {
  if (!settings.camera_file) return true;
  constexpr std::uint64_t kMostBytes = 1 << 20;
  const std::string path = *settings.camera_file;
  auto known = cameras_.find(path);
  if (known == cameras_.end()) {
    const auto text = read_file(path, kMostBytes, log);
    if (!text) return false;
    const auto camera = sensor::read_camera(*text, path, log);
    if (!camera) return false;
    known = cameras_.emplace(path, *camera).first;
  }
  const sensor::CameraFile& camera = known->second;
  const sensor::Lens& lens = camera.lens;
  settings.camera_file = Settings().camera_file;
  if (camera.mount_from_camera != Quat(1, 0, 0, 0)) settings.mount = camera.mount_from_camera;
  settings.size = ImageSize{camera.width, camera.height};
  if (camera.width_m > 0)
    settings.ortho = camera.width_m;
  else
    settings.intrinsics = Vec4(lens.focal, lens.principal);
  if (const std::string text = sensor::distortion_text(lens.distortion); !text.empty())
    settings.distortion = text;
  if (camera.imager) settings.detector = sensor::imager_text(*camera.imager);
  // once, not for each of many views
  if (DiagnosticLog apart; !check_lens(settings, apart)) {
    if (refused_.insert(path).second)
      for (const Diagnostic& each : apart.entries())
        log.report_file(Code("E0220"), path, each.message, each.hint);
    return false;
  }
  return true;
}

// The imager of the text, and the Sun's light in W/m² where none is given. A gain and a temperature
// become those of the text.
bool FrameMaker::use_detector(Settings& settings, Frame& frame, DiagnosticLog& log) {
  if (!settings.detector) {
    if (!settings.gain && !settings.temperature) return true;
    log.report(Code("E0201"), {},
               fmt::format("--{} needs a detector, expected a camera file with a [detector]",
                           settings.gain ? "gain" : "temperature"));
    return false;
  }
  auto& known = imagers_[*settings.detector];
  if (known == nullptr) {
    DiagnosticLog apart = log.apart();
    const auto imager = sensor::parse_imager(*settings.detector, apart);
    if (!imager) {
      for (const Diagnostic& each : apart.entries())
        log.report(Code("E0201"), {}, "--detector: " + each.message, each.hint);
      return false;
    }
    known = std::make_shared<const sensor::Imager>(*imager);
  }
  frame.imager = known;
  // the exposure of a real camera is its time
  if (!settings.ev->number && !settings.exposure) settings.exposure = Settings::Exposure::automatic;
  if (settings.ev.given() && settings.ev->number.value_or(0) != 0 && refused_.insert("--ev").second)
    log.report(Code("N0205"), {}, "--ev has no effect on the numbers of a detector",
               "--exposure SECONDS sets the time of its exposure, --ev auto chooses it");
  if (settings.gain || settings.temperature) {
    auto changed = std::make_shared<sensor::Imager>(*known);
    sensor::Detector& detector = changed->detector;
    detector.dn_per_e = settings.gain ? *settings.gain : detector.dn_per_e;
    detector.temperature_k = settings.temperature ? *settings.temperature : detector.temperature_k;
    settings.gain = Settings().gain;
    settings.temperature = Settings().temperature;
    settings.detector = sensor::imager_text(*changed);
    frame.imager = std::move(changed);
  }
  sensor::Imager exposed = *frame.imager;
  if (const auto seconds = settings.exposure->number; seconds && *seconds > 0)
    exposed.detector.exposure_s = *seconds;
  if (const std::string why =
          sensor::check_imager(exposed, settings.size->width, settings.size->height);
      !why.empty()) {
    log.report(Code("E0201"), {}, why, "docs/detector.md");
    return false;
  }
  const double distance = *settings.sun_distance;
  if (!settings.white) settings.white = light::kSolarIrradiance;
  if (!settings.sun_irradiance)
    settings.sun_irradiance = light::kSolarIrradiance / (distance * distance);
  return true;
}

Result<Frame> FrameMaker::made(const View& view, DiagnosticLog& log) {
  auto frame = at_once(view, log);
  if (!frame) return failed;
  // each kind of instrument says what its frames are over time
  const auto over_time = [&](const CameraInstrument&) {
    return expose(view, *frame, log) && switch_lamps(view, *frame, log);
  };
  if (!std::visit(over_time, frame->instrument)) return failed;
  return frame;
}

Result<Frame> FrameMaker::at_once(const View& view, DiagnosticLog& log) {
  const Settings* const scene = scene_.read(world_, log);
  if (scene == nullptr) return failed;
  Settings settings = with_defaults(view.settings, *scene);
  if (!check(settings, log) || !use_camera_file(settings, log)) return failed;
  bool good = is_sound(settings, log);
  const std::size_t errors = log.errors();
  Frame frame;
  frame.label = view.label;
  if (!use_detector(settings, frame, log)) return failed;
  note_scene(view.settings, *scene, frame);
  frame.scene_target = scene_.target();
  frame.settings = with_presets(settings);
  frame.outputs = *settings.outputs;
  world::World posed = world_;
  for (const PoseSetting& pose : *settings.pose) good = set_pose(pose, posed, frame, log) && good;
  JointSetter joints(posed);
  for (const JointText& joint : *settings.joint) good = joints.set(joint, log) && good;
  if (!good) return failed;
  world::Camera camera;
  const bool lens = set_lens(settings, camera);
  if (posed.empty()) {
    if (!lens) {
      log.report(Code("E0201"), {},
                 "no lens and no target that it fits, expected --fov, --ifov, --intrinsics or "
                 "--camera-file");
      return failed;
    }
    if (!settings.quat && !settings.look_at) {
      log.report(Code("E0201"), {},
                 "no direction and no target to look at, expected --quat or --look-at");
      return failed;
    }
    if (!settings.camera) settings.camera = Vec3(0);
  }
  const auto sphere = [&] { return spheres_.of(posed); };
  good = settings.camera_frame
             ? place_in_frame(*settings.camera_frame, posed, camera, log)
             : place_camera(settings, sphere, preview::has_ground(posed), camera, log);
  if (!good) return failed;
  const bool placed = settings.camera || settings.look_at || settings.quat || settings.camera_frame;
  if (!lens && !settings.camera_frame && (placed || !fit_outline(posed, camera)))
    fit_lens(sphere(), camera);
  if (settings.mount)
    camera.world_from_camera =
        glm::normalize(camera.world_from_camera * *unit_quaternion(*settings.mount));
  const auto dated = dated_sky_of(settings, log);
  if (!dated) return failed;
  set_sun(settings, *dated, camera.world_from_camera, frame);
  posed.set_sun(*frame.sun);
  auto sky = sky_.read(settings, *dated, log);
  if (!sky) return failed;
  frame.sky = *std::move(sky);
  if (auto lamps = lamps_of(settings, posed, {}, log)) frame.lamps = *std::move(lamps);
  const bool has_lamps = frame.lamps ? !frame.lamps->empty() : !posed.lamps().empty();
  warn_of_ground(posed, has_lamps, spheres_, log);
  joints.set_aims(camera.position, log);
  if (log.errors() != errors) return failed;
  for (const world::Instance& target : posed.instances())
    for (const world::JointState& state : target.joint_states())
      frame.joints.push_back({target.name(), state.joint, state.values});
  frame.instrument = CameraInstrument(
      camera, view.field_of_view || !(settings.ifov || settings.intrinsics || settings.ortho));
  return frame;
}

namespace {

// Those of the frame; all others as in the world.
void place_joints(const WorldState& state, const world::Instance& target, std::size_t index,
                  world::World& shown) {
  const std::size_t count = target.model()->joints().size();
  if (count == 0) return;
  std::vector<std::optional<geometry::JointValues>> values(count);
  for (const world::JointState& own : target.joint_states()) values[own.joint] = own.values;
  for (const TargetJoint& each : state.joints)
    if (each.target == target.name()) values[each.joint] = each.values;
  for (std::size_t j = 0; j < count; ++j)
    shown.set_joint(index, static_cast<std::uint32_t>(j), values[j]);
}

}  // namespace

void show(const WorldState& state, const world::World& world, world::World& shown) {
  std::vector<world::Pose> poses;
  for (const world::Instance& target : world.instances()) poses.push_back(target.pose());
  for (const TargetPose& each : state.poses) poses[*world.find(each.target)] = each.pose;
  for (std::size_t i = 0; i < poses.size(); ++i) shown.set_pose(i, poses[i]);
  for (std::size_t i = 0; i < world.size(); ++i) place_joints(state, world[i], i, shown);
  shown.set_sun(state.sun.value_or(world.sun()));
  shown.set_lamps(state.lamps ? *state.lamps
                              : std::vector(world.lamps().begin(), world.lamps().end()));
  shown.set_white(state.white ? state.white : world.given_white());
  if (state.sky)
    shown.set_sky(state.sky->bodies, state.sky->sun_visible);
  else
    shown.set_sky({world.bodies().begin(), world.bodies().end()}, world.sun_visible());
  shown.set_stars(state.sky ? state.sky->stars : world.stars());
}

}  // namespace panwright::workspace
