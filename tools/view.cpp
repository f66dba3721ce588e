#include "tools/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "world/evaluation.h"

namespace panwright::tools {

namespace {

constexpr double kDefaultFieldOfView = 30 * kDegree;
constexpr double kMargin = 1.1;        // of the model's radius, around it in the image
constexpr double kWidestDefault = 90;  // degrees
constexpr std::uint32_t kMaxSide = 16384;

// Reads options one by one and remembers whether any of them failed.
class Reader {
 public:
  explicit Reader(DiagnosticLog& log) : log_(log) {}
  bool ok() const { return ok_; }

  void fail(const char* name, const std::string& value, const char* accepted) {
    log_.report(Code::E0201, {},
                fmt::format("--{} is {}: it takes {}", name, in_quotes(value), accepted));
    ok_ = false;
  }

  std::optional<Vec3> vector(const char* name, const std::optional<std::string>& text,
                             bool direction) {
    if (!text) return std::nullopt;
    const auto numbers = parse_numbers(*text, 3);
    if (!numbers) {
      fail(name, *text, "three numbers, as \"0 -5 1\"");
      return std::nullopt;
    }
    const Vec3 v((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    if (!direction) return v;
    // squares of the largest and the smallest numbers have no place in a double
    const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
    if (largest > 0) return v / largest;
    fail(name, *text, "a direction, not all zeros");
    return std::nullopt;
  }

  std::optional<Quat> quaternion(const char* name, const std::string& text,
                                 const std::vector<double>& numbers, std::size_t first) {
    const Quat q(numbers[first], numbers[first + 1], numbers[first + 2], numbers[first + 3]);
    const double length = glm::length(q);
    if (!(std::abs(length - 1) <= 1e-3)) {
      fail(name, text, "a unit quaternion w x y z");
      return std::nullopt;
    }
    return q / length;
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

void read_size(const ViewOptions& options, Reader& reader, world::Camera& camera) {
  if (!options.size) return;
  const std::string& text = *options.size;
  const std::size_t cross = text.find_first_of("xX");
  const auto side = [&](std::string_view digits) -> std::uint32_t {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool whole = error == std::errc() && end == digits.data() + digits.size();
    return whole && value <= kMaxSide ? value : 0;
  };
  const std::string_view view = text;
  const std::uint32_t width = side(view.substr(0, std::min(cross, view.size())));
  const std::uint32_t height = cross == std::string::npos ? width : side(view.substr(cross + 1));
  if (width == 0 || height == 0)
    reader.fail("size", text, "WIDTHxHEIGHT, each from 1 to 16384 pixels");
  camera.width = std::max(width, 1u);
  camera.height = std::max(height, 1u);
}

// Focal lengths and principal point, when the options give them.
bool read_lens(const ViewOptions& options, Reader& reader, world::Camera& camera) {
  const int given = int(options.fov.has_value()) + int(options.ifov.has_value()) +
                    int(options.intrinsics.has_value()) + int(options.ortho.has_value());
  if (given > 1)
    reader.fail("fov", options.fov.value_or("given with another"),
                "its place alone: one of --fov, --ifov, --intrinsics and --ortho");
  if (options.fov) {
    const auto angle = parse_angle(*options.fov);
    if (!angle || !(*angle > 0 && *angle < kPi))
      reader.fail("fov", *options.fov, "an angle above 0 and below 180 degrees");
    else
      world::set_field_of_view(camera, camera.width, camera.height, *angle);
  } else if (options.ifov) {
    const auto angle = parse_angle(*options.ifov);
    if (!angle || !(*angle > 0))
      reader.fail("ifov", *options.ifov, "an angle above 0, as 0.2mrad (a bare number is degrees)");
    else
      world::set_pixel_angle(camera, camera.width, camera.height, *angle);
  } else if (options.intrinsics) {
    const auto numbers = parse_numbers(*options.intrinsics, 4);
    if (!numbers || !((*numbers)[0] > 0) || !((*numbers)[1] > 0)) {
      reader.fail("intrinsics", *options.intrinsics, "fx,fy,cx,cy in pixels, fx and fy above 0");
    } else {
      camera.projection = world::Projection::perspective;
      camera.focal = Vec2((*numbers)[0], (*numbers)[1]);
      camera.principal = Vec2((*numbers)[2], (*numbers)[3]);
    }
  } else if (options.ortho) {
    if (const auto width = reader.positive("ortho", options.ortho, "a width in metres above 0"))
      world::set_orthographic(camera, camera.width, camera.height, *width);
  }
  return given > 0;
}

// The model's sphere fills the image, less a margin.
void fit_lens(const BoundingSphere& sphere, world::Camera& camera) {
  const double distance = glm::length(sphere.centre - camera.position);
  const double sine = std::min(1.0, kMargin * sphere.radius / std::max(distance, 1e-300));
  const double widest = 0.5 * kWidestDefault * kDegree;
  const double half = std::min(widest, std::asin(sine));
  // the shorter side decides
  const double aspect = double(camera.width) / std::min(camera.width, camera.height);
  const double fov = std::min(2 * std::atan(aspect * std::tan(half)), 0.99 * kPi);
  world::set_field_of_view(camera, camera.width, camera.height, fov);
}

void read_pose(const ViewOptions& options, Reader& reader, world::Pose& pose) {
  if (!options.pose) return;
  const auto numbers = parse_numbers(*options.pose, 7);
  if (!numbers) {
    reader.fail("pose", *options.pose, "seven numbers: a position and a quaternion w x y z");
    return;
  }
  if (const auto q = reader.quaternion("pose", *options.pose, *numbers, 3))
    pose = {Vec3((*numbers)[0], (*numbers)[1], (*numbers)[2]), *q};
}

// Position and attitude. `sphere` stands in the world, the pose applied.
void read_attitude(const ViewOptions& options, const BoundingSphere& sphere, Reader& reader,
                   world::Camera& camera, DiagnosticLog& log) {
  const auto position = reader.vector("camera", options.camera, false);
  const auto target = reader.vector("look-at", options.look_at, false);
  const auto up = reader.vector("up", options.up, true);
  if (!reader.ok()) return;
  const double distance = kMargin * sphere.radius / std::sin(0.5 * kDefaultFieldOfView);
  camera.position =
      position.value_or(sphere.centre + distance * glm::normalize(Vec3(-0.5, -1, 0.4)));
  if (options.quat) {
    const auto numbers = parse_numbers(*options.quat, 4);
    if (!numbers) {
      reader.fail("quat", *options.quat, "four numbers w x y z");
    } else if (const auto q = reader.quaternion("quat", *options.quat, *numbers, 0)) {
      camera.world_from_camera = *q;
    }
    if (options.look_at)
      reader.fail("quat", *options.quat, "its place alone: --quat or --look-at, not both");
    return;
  }
  const Vec3 aim = target.value_or(position ? Vec3(0) : sphere.centre);
  if (auto attitude = world::looking_at(camera.position, aim, up, log))
    camera.world_from_camera = *attitude;
}

void read_sun(const ViewOptions& options, Reader& reader, preview::View& view) {
  const Quat& q = view.camera.world_from_camera;
  // behind the camera, over its left shoulder: camera axes are x right, y down
  view.to_sun = q * glm::normalize(Vec3(-0.6, -0.6, -1));
  if (const auto sun = reader.vector("sun", options.sun, true)) view.to_sun = *sun;
  if (const auto au = reader.positive("sun-distance", options.sun_distance, "AU above 0"))
    view.sun_distance = *au;
  if (!options.sun_irradiance) return;
  const std::string& text = *options.sun_irradiance;
  const auto one = parse_numbers(text, 1);
  const auto three = parse_numbers(text, 3);
  // what a float holds, with room for glints
  const auto fits = [](double e) { return e >= 0 && e <= 1e20; };
  if (one && fits((*one)[0]))
    view.sun_irradiance = Vec3((*one)[0]);
  else if (three && std::all_of(three->begin(), three->end(), fits))
    view.sun_irradiance = Vec3((*three)[0], (*three)[1], (*three)[2]);
  else
    reader.fail("sun-irradiance", text, "one number or three, W/m², 0 to 1e20");
}

}  // namespace

std::optional<std::vector<double>> parse_numbers(const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  constexpr const char* kSeparators = " \t\n\r,";
  for (std::size_t at = text.find_first_not_of(kSeparators); at != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, at), text.size());
    const auto value = parse_double(std::string_view(text).substr(at, end - at));
    if (!value || numbers.size() == count) return std::nullopt;
    numbers.push_back(*value);
    at = text.find_first_not_of(kSeparators, end);
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

std::optional<double> parse_angle(const std::string& text) {
  constexpr std::pair<std::string_view, double> kUnits[] = {
      {"deg", kDegree}, {"mrad", 1e-3},           {"urad", 1e-6},
      {"rad", 1.0},     {"arcmin", kDegree / 60}, {"arcsec", kDegree / 3600}};
  std::string_view number = text;
  double unit = kDegree;
  for (const auto& [name, size] : kUnits) {
    if (!number.ends_with(name)) continue;
    number.remove_suffix(name.size());
    unit = size;
    break;
  }
  const auto value = parse_double(number);
  if (!value) return std::nullopt;
  return *value * unit;
}

BoundingSphere bounding_sphere(const pan::Model& model) {
  const auto bounds = model.world_bounds();
  if (!bounds) return {};
  return {0.5 * (bounds->min + bounds->max),
          std::max(0.5 * glm::length(bounds->max - bounds->min), 1e-30)};
}

Result<preview::View> make_view(const ViewOptions& options, const pan::Model& model,
                                DiagnosticLog& log) {
  Reader reader(log);
  const std::size_t errors = log.errors();
  preview::View view;
  read_size(options, reader, view.camera);
  read_pose(options, reader, view.world_from_model);
  world::set_field_of_view(view.camera, view.camera.width, view.camera.height, kDefaultFieldOfView);
  const bool lens = read_lens(options, reader, view.camera);
  if (!reader.ok()) return failed;
  BoundingSphere sphere = bounding_sphere(model);
  sphere.centre = Vec3(view.world_from_model.matrix() * Vec4(sphere.centre, 1));
  if (options.camera_frame) {
    if (options.camera || options.quat || options.look_at)
      reader.fail("camera-frame", *options.camera_frame,
                  "its place alone: not with --camera, --quat or --look-at");
    // note: the model is only looked at
    const world::World world = preview::world_of({world::ModelPtr(), &model}, view);
    world::place_in_frame(view.camera, world, 0, *options.camera_frame, log);
  } else {
    read_attitude(options, sphere, reader, view.camera, log);
  }
  if (!lens && !options.camera_frame) fit_lens(sphere, view.camera);
  read_sun(options, reader, view);
  if (log.errors() != errors) return failed;
  return view;
}

}  // namespace panwright::tools
