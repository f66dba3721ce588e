#include "workspace/views.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <tuple>

#include "base/angle_text.h"
#include "base/text.h"
#include "image/image.h"
#include "workspace/internal/forward.h"
#include "world/evaluation.h"

namespace panwright::workspace {

namespace {

constexpr double kDefaultFieldOfView = 30 * kDegree;
constexpr double kMargin = 1.1;        // of the targets' radius, around it in the image
constexpr double kFilled = 0.85;       // of the image, by targets before a default camera
constexpr double kWidestDefault = 90;  // degrees
constexpr std::uint32_t kMaxSide = 16384;
// of focal lengths, pixels; orthographic: pixels per metre
constexpr double kLeastFocal = 1e-30;
constexpr double kMostFocal = 1e15;
constexpr double kLargestModel = 1e30;  // metres, as coordinates of models

// Reads texts one by one and remembers whether any of them failed.
class ViewReader {
 public:
  explicit ViewReader(DiagnosticLog& log) : log_(log) {}
  bool ok() const { return ok_; }

  void fail(const std::string& name, const std::string& value, const char* accepted) {
    // "20m" where an angle belongs, "20deg" where metres do
    const bool bare = parse_double(value).has_value();
    const char* kind = bare                  ? ""
                       : parse_length(value) ? ", a length"
                       : parse_angle(value)  ? ", an angle"
                                             : "";
    log_.report(Code::E0201, {},
                fmt::format("--{} is {}{}, expected {}", name, in_quotes(value), kind, accepted));
    ok_ = false;
  }
  // Options that exclude each other.
  void conflict(const char* message) {
    log_.report(Code::E0201, {}, message);
    ok_ = false;
  }
  void failed_elsewhere() { ok_ = false; }
  void check_angle(const char* name, const std::string& text) {
    if (const auto warning = warning_of_radians(text))
      log_.report(Code::W1214, {}, fmt::format("{}: {}", name, warning->message), warning->hint);
  }

  std::optional<Vec3> irradiance(const char* name, const std::optional<std::string>& text) {
    if (!text) return std::nullopt;
    const auto one = parse_numbers(*text, 1);
    const auto three = parse_numbers(*text, 3);
    // what a float holds, with room for glints
    const auto fits = [](double e) { return e >= 0 && e <= 1e20; };
    if (one && fits((*one)[0])) return Vec3((*one)[0]);
    if (three && std::all_of(three->begin(), three->end(), fits))
      return Vec3((*three)[0], (*three)[1], (*three)[2]);
    fail(name, *text, "one number or three, W/m², 0 to 1e20");
    return std::nullopt;
  }

  std::optional<Vec3> vector(const char* name, const std::optional<std::string>& text,
                             bool direction) {
    if (!text) return std::nullopt;
    const auto numbers = direction ? parse_numbers(*text, 3) : parse_lengths(*text, 3);
    if (!numbers) {
      fail(name, *text,
           direction ? "three numbers, as \"0 -5 1\""
                     : "three lengths, as \"0 -5 1\" (metres) or \"0 -2km 10m\"");
      return std::nullopt;
    }
    const Vec3 v((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    if (!direction) return v;
    // squares of the largest and the smallest numbers overflow or underflow a double
    const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
    if (largest > 0) return v / largest;
    fail(name, *text, "a direction, not all zeros");
    return std::nullopt;
  }

  // "w x y z"
  std::optional<Quat> attitude(const std::optional<std::string>& text) {
    if (!text) return std::nullopt;
    if (const auto numbers = parse_numbers(*text, 4)) return quaternion("quat", *text, *numbers, 0);
    fail("quat", *text, "four numbers w x y z");
    return std::nullopt;
  }

  std::optional<Quat> quaternion(const std::string& name, const std::string& text,
                                 const std::vector<double>& numbers, std::size_t first) {
    const Quat q(numbers[first], numbers[first + 1], numbers[first + 2], numbers[first + 3]);
    const double length = glm::length(q);
    if (!(std::abs(length - 1) <= 1e-3)) {
      fail(name, text, "a unit quaternion w x y z");
      return std::nullopt;
    }
    // what is unit to a few roundings stays: the record of an image is read back to the same bits
    return std::abs(length - 1) <= 1e-15 ? q : q / length;
  }

  std::optional<double> positive(const char* name, const std::optional<std::string>& text,
                                 const char* accepted) {
    if (!text) return std::nullopt;
    const auto value = parse_double(*text);
    if (!value || !(*value > 0)) {
      fail(name, *text, accepted);
      return std::nullopt;
    }
    return value;
  }

 private:
  DiagnosticLog& log_;
  bool ok_ = true;
};

}  // namespace

std::optional<std::pair<std::uint32_t, std::uint32_t>> image_size(std::string_view size) {
  const std::size_t cross = size.find_first_of("xX, ");
  const auto side = [&](std::string_view digits) -> std::uint32_t {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool whole = error == std::errc() && end == digits.data() + digits.size();
    return whole && value <= kMaxSide ? value : 0;
  };
  const std::uint32_t width = side(size.substr(0, std::min(cross, size.size())));
  const std::size_t second = cross == size.npos ? cross : size.find_first_not_of(", ", cross + 1);
  const std::uint32_t height =
      cross == size.npos ? width : side(second == size.npos ? "" : size.substr(second));
  if (width == 0 || height == 0) return std::nullopt;
  return std::pair(width, height);
}

namespace {

void read_size(const ViewText& text, ViewReader& reader, world::Camera& camera) {
  if (!text.size) return;
  const auto size = image_size(*text.size);
  if (!size) reader.fail("size", *text.size, "WIDTHxHEIGHT, each from 1 to 16384 pixels");
  std::tie(camera.width, camera.height) = size.value_or(std::pair(1u, 1u));
}

// Focal lengths and principal point, when the text gives them.
bool read_lens(const ViewText& text, ViewReader& reader, world::Camera& camera) {
  const int given = int(text.fov.has_value()) + int(text.ifov.has_value()) +
                    int(text.intrinsics.has_value()) + int(text.ortho.has_value());
  if (given > 1) reader.conflict("--fov, --ifov, --intrinsics and --ortho cannot be combined");
  if (text.fov) {
    const auto angle = parse_angle(*text.fov);
    if (!angle || !(*angle > 0 && *angle < kPi))
      reader.fail("fov", *text.fov,
                  "an angle above 0 and below 180 degrees, as 20deg, 0.35rad or 20 (degrees)");
    else
      world::set_field_of_view(camera, camera.width, camera.height, *angle);
  } else if (text.ifov) {
    const auto angle = parse_angle(*text.ifov);
    if (!angle || !(*angle > 0))
      reader.fail("ifov", *text.ifov, "an angle above 0, as 0.2mrad, 40arcsec or 0.01 (degrees)");
    else
      world::set_pixel_angle(camera, camera.width, camera.height, *angle);
  } else if (text.intrinsics) {
    const auto numbers = parse_numbers(*text.intrinsics, 4);
    if (!numbers || !((*numbers)[0] > 0) || !((*numbers)[1] > 0)) {
      reader.fail("intrinsics", *text.intrinsics,
                  "four numbers fx fy cx cy in pixels, fx and fy above 0");
    } else {
      camera.projection = world::Projection::perspective;
      camera.focal = Vec2((*numbers)[0], (*numbers)[1]);
      camera.principal = Vec2((*numbers)[2], (*numbers)[3]);
    }
  } else if (text.ortho) {
    if (const auto width = reader.positive("ortho", text.ortho, "a width in metres above 0"))
      world::set_orthographic(camera, camera.width, camera.height, *width);
  }
  for (int k = 0; k < 2 && reader.ok() && given > 0; ++k) {
    if (camera.focal[k] >= kLeastFocal && camera.focal[k] <= kMostFocal) continue;
    const char* name = text.fov ? "fov" : text.ifov ? "ifov" : text.ortho ? "ortho" : "intrinsics";
    const std::string& value = text.fov     ? *text.fov
                               : text.ifov  ? *text.ifov
                               : text.ortho ? *text.ortho
                                            : *text.intrinsics;
    reader.fail(name, value,
                text.ortho ? "a width with pixels of 1e-15 to 1e30 m"
                           : "a focal length of at most 1e15 pixels");
  }
  return given > 0;
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

// Three lengths and four numbers.
std::optional<std::vector<double>> position_and_attitude(std::string_view text) {
  constexpr const char* kSeparators = " \t\n\r,";
  std::size_t end = 0;
  for (int word = 0; word < 3 && end < text.size(); ++word)
    end = std::min(text.find_first_of(kSeparators, text.find_first_not_of(kSeparators, end)),
                   text.size());
  auto out = parse_lengths(text.substr(0, end), 3);
  const auto quaternion = parse_numbers(text.substr(end), 4);
  if (!out || !quaternion) return std::nullopt;
  out->insert(out->end(), quaternion->begin(), quaternion->end());
  return out;
}

std::optional<world::Pose> pose_of(const PoseText& text, ViewReader& reader) {
  const std::string option = text.target.empty() ? "pose" : "pose " + text.target;
  const auto numbers = position_and_attitude(text.value);
  if (!numbers) {
    reader.fail(option, text.value,
                "seven numbers: a position x y z, with or without units, and a quaternion w x y z");
    return std::nullopt;
  }
  const auto q = reader.quaternion(option, text.value, *numbers, 3);
  if (!q) return std::nullopt;
  return world::Pose{Vec3((*numbers)[0], (*numbers)[1], (*numbers)[2]), *q};
}

// A pose of the world's targets, into the view and into the world as it is seen.
void read_pose(const PoseText& text, ViewReader& reader, world::World& world, View& view,
               DiagnosticLog& log) {
  std::size_t target = 0;
  if (!text.target.empty()) {
    const auto found = world.require(text.target, log);
    if (!found) return reader.failed_elsewhere();
    target = *found;
  } else if (world.size() != 1) {
    return reader.fail("pose", text.value,
                       "the name of one of several targets, as NAME=\"X Y Z QW QX QY QZ\"");
  }
  if (const auto pose = pose_of(text, reader)) {
    world.set_pose(target, *pose);
    view.poses.push_back({world[target].name(), *pose});
  }
}

// Position and attitude; `sphere` returns what is around the targets.
template <class Sphere>
void read_attitude(const ViewText& text, const Sphere& sphere, ViewReader& reader,
                   world::Camera& camera, DiagnosticLog& log) {
  const auto position = reader.vector("camera", text.camera, false);
  const auto target = reader.vector("look-at", text.look_at, false);
  const auto up = reader.vector("up", text.up, true);
  if (!reader.ok()) return;
  if (position) {
    camera.position = *position;
  } else {
    const BoundingSphere around = sphere();
    if (!(around.radius <= kLargestModel)) {
      log.report(Code::E0201, {},
                 fmt::format("the targets reach further than {} m, where a --camera must be given",
                             kLargestModel));
      return reader.failed_elsewhere();
    }
    const double distance = kMargin * around.radius / std::sin(0.5 * kDefaultFieldOfView);
    camera.position = around.centre + distance * glm::normalize(Vec3(-0.5, -1, 0.4));
  }
  if (text.quat) {
    if (const auto q = reader.attitude(text.quat)) camera.world_from_camera = *q;
    if (text.look_at) reader.conflict("--quat cannot be combined with --look-at");
    return;
  }
  const Vec3 aim = target ? *target : position ? Vec3(0) : sphere().centre;
  if (auto attitude = world::looking_at(camera.position, aim, up, log))
    camera.world_from_camera = *attitude;
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
  log.report(Code::E5005, {},
             having.empty()
                 ? fmt::format("unknown frame {}, expected TARGET/FRAME", in_quotes(text))
                 : fmt::format("{} targets have a frame {}", having.size(), in_quotes(text)),
             having.empty() ? std::string() : "name one of " + names);
  return false;
}

void read_sun(const ViewText& text, ViewReader& reader, View& view) {
  const Quat& q = view.camera.world_from_camera;
  world::Sun sun;
  // behind the camera, over its left shoulder: camera axes are x right, y down
  const Vec3 shoulder = q * glm::normalize(Vec3(-0.6, -0.6, -1));
  // scaled as a direction that is typed
  sun.direction =
      shoulder / std::max({std::fabs(shoulder.x), std::fabs(shoulder.y), std::fabs(shoulder.z)});
  if (const auto direction = reader.vector("sun", text.sun, true)) sun.direction = *direction;
  if (const auto au = reader.positive("sun-distance", text.sun_distance, "AU above 0"))
    sun.distance = *au;
  if (text.limb_darkening) {
    const auto u = parse_double(*text.limb_darkening);
    if (u && *u >= 0 && *u <= 1)
      sun.limb_darkening = *u;
    else
      reader.fail("limb-darkening", *text.limb_darkening, "a number from 0 to 1");
  }
  view.sun = sun;
  view.sun->irradiance = reader.irradiance("sun-irradiance", text.sun_irradiance);
  view.white = reader.irradiance("white", text.white);
}

void read_output(const ViewText& text, View& view, DiagnosticLog& log) {
  const auto ev = parse_numbers(text.ev.value_or("0"), 1);
  if (text.ev == "auto")
    view.auto_ev = true;
  else if (ev)
    view.ev = (*ev)[0];
  else
    log.report(Code::E0201, {},
               fmt::format("--ev is {}, expected a number of stops, or auto", in_quotes(*text.ev)));
  view.output = text.output.value_or("");
  view.more_outputs = text.more_outputs;
  const auto check = [&](const std::string& output) {
    if (!image::image_format(output))
      log.report(Code::E0202, {},
                 fmt::format("unknown image format of {}, expected .png, .exr, .npy or .npz",
                             in_quotes(output)));
  };
  if (text.output) check(view.output);
  for (const std::string& output : view.more_outputs) check(output);
}

}  // namespace

PoseText pose_text(std::string_view text) {
  const std::size_t sign = text.find('=');
  if (sign == text.npos) return {{}, std::string(text)};
  return {std::string(text.substr(0, sign)), std::string(text.substr(sign + 1))};
}

void check_values(const ViewText& text, DiagnosticLog& log) {
  DiagnosticLog apart = log.apart();
  ViewReader reader(apart);
  View view;
  read_size(text, reader, view.camera);
  for (const PoseText& pose : text.poses) (void)pose_of(pose, reader);
  world::set_field_of_view(view.camera, view.camera.width, view.camera.height, kDefaultFieldOfView);
  (void)read_lens(text, reader, view.camera);
  (void)reader.vector("camera", text.camera, false);
  (void)reader.vector("look-at", text.look_at, false);
  (void)reader.vector("up", text.up, true);
  (void)reader.attitude(text.quat);
  if (text.quat && text.look_at) reader.conflict("--quat cannot be combined with --look-at");
  if (text.camera_frame && (text.camera || text.quat || text.look_at))
    reader.conflict("--camera-frame cannot be combined with --camera, --quat or --look-at");
  read_sun(text, reader, view);
  read_output(text, view, apart);
  forward(apart, text.label, text.file, log);
  (void)draw_options(text, preview::ContextKind::automatic, log);
}

Result<View> ViewMaker::view(const ViewText& text, DiagnosticLog& log) {
  DiagnosticLog apart = log.apart();
  auto view = made(text, apart);
  forward(apart, text.label, text.file, log);
  return view;
}

Result<View> ViewMaker::made(const ViewText& text, DiagnosticLog& log) {
  ViewReader reader(log);
  const std::size_t errors = log.errors();
  View view;
  view.label = text.label;
  view.field_of_view = text.field_of_view || !(text.ifov || text.intrinsics || text.ortho);
  world::World posed = world_;
  read_size(text, reader, view.camera);
  for (const PoseText& pose : text.poses) read_pose(pose, reader, posed, view, log);
  JointSetter joints(posed);
  for (const JointText& joint : text.joints)
    if (!joints.set(joint, log)) reader.failed_elsewhere();
  world::set_field_of_view(view.camera, view.camera.width, view.camera.height, kDefaultFieldOfView);
  const bool lens = read_lens(text, reader, view.camera);
  if (text.fov) reader.check_angle("fov", *text.fov);
  if (!reader.ok()) {
    read_output(text, view, log);  // every problem is reported at once
    return failed;
  }
  const auto sphere = [&] { return spheres_.of(posed); };
  if (text.camera_frame) {
    if (text.camera || text.quat || text.look_at)
      reader.conflict("--camera-frame cannot be combined with --camera, --quat or --look-at");
    place_in_frame(*text.camera_frame, posed, view.camera, log);
  } else {
    read_attitude(text, sphere, reader, view.camera, log);
  }
  const bool placed = text.camera || text.look_at || text.quat || text.camera_frame;
  if (!lens && !text.camera_frame && reader.ok() && (placed || !fit_outline(posed, view.camera)))
    fit_lens(sphere(), view.camera);
  read_sun(text, reader, view);
  if (reader.ok()) {
    posed.set_sun(*view.sun);
    joints.set_aims(view.camera.position, log);
    for (const world::Instance& target : posed.instances())
      for (const world::JointState& state : target.joint_states())
        view.joints.push_back({target.name(), state.joint, state.values});
  }
  read_output(text, view, log);
  if (log.errors() != errors) return failed;
  return view;
}

namespace {

// Those of the view; all others as in the world.
void place_joints(const View& view, const world::Instance& target, std::size_t index,
                  world::World& shown) {
  const std::size_t count = target.model()->joints().size();
  if (count == 0) return;
  std::vector<std::optional<geometry::JointValues>> values(count);
  for (const world::JointState& state : target.joint_states()) values[state.joint] = state.values;
  for (const TargetJoint& each : view.joints)
    if (each.target == target.name()) values[each.joint] = each.values;
  for (std::size_t j = 0; j < count; ++j)
    shown.set_joint(index, static_cast<std::uint32_t>(j), values[j]);
}

}  // namespace

void show(const View& view, const world::World& world, world::World& shown) {
  std::vector<world::Pose> poses;
  for (const world::Instance& target : world.instances()) poses.push_back(target.pose());
  for (const TargetPose& each : view.poses) poses[*world.find(each.target)] = each.pose;
  for (std::size_t i = 0; i < poses.size(); ++i) shown.set_pose(i, poses[i]);
  for (std::size_t i = 0; i < world.size(); ++i) place_joints(view, world[i], i, shown);
  shown.set_sun(view.sun.value_or(world.sun()));
  shown.set_white(view.white ? view.white : world.given_white());
}

}  // namespace panwright::workspace
