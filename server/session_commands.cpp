// Commands: what changes the state of a session.
#include <algorithm>
#include <cmath>

#include "scenario/fli.h"
#include "server/session.h"
#include "workspace/settings.h"

namespace panwright::server {

namespace {

constexpr double kAstronomicalUnit = 149597870700.0;  // metres, IAU 2012 B2
constexpr double kMostMetres = 1e15;

Vec3 vec3_of(WireReader& in, bool doubles) {
  const double x = doubles ? in.real64() : in.real();
  const double y = doubles ? in.real64() : in.real();
  const double z = doubles ? in.real64() : in.real();
  return {x, y, z};
}

Vec3 position_of(WireReader& in, bool doubles) {
  const Vec3 out = vec3_of(in, doubles);
  if (!(std::abs(out.x) <= kMostMetres && std::abs(out.y) <= kMostMetres &&
        std::abs(out.z) <= kMostMetres))
    throw RequestError{WireError::number, "a position is beyond 1e15 m, or not finite"};
  return out;
}

// As clients have it: of any length that is not 0.
Quat attitude_of(WireReader& in, bool doubles) {
  const double w = doubles ? in.real64() : in.real();
  const Vec3 v = vec3_of(in, doubles);
  const double length = std::sqrt(w * w + glm::dot(v, v));
  if (!(length > 1e-6 && std::isfinite(length)))
    throw RequestError{WireError::number, "a quaternion has no length"};
  const Quat out(w, v);
  return std::abs(length - 1) < 1e-15 ? out : out / length;
}

world::Pose angles_pose(WireReader& in, bool doubles, double unit) {
  world::Pose out;
  out.translation = position_of(in, doubles);
  const Vec3 angles = vec3_of(in, doubles) * unit;
  if (!is_finite(angles)) throw RequestError{WireError::number, "an angle is not finite"};
  out.rotation = scenario::rotation_of({angles.x, angles.y, angles.z});
  return out;
}

world::Pose quaternion_pose(WireReader& in, bool doubles) {
  const Vec3 position = position_of(in, doubles);
  return {position, attitude_of(in, doubles)};
}

double in_range(double value, double least, double most, const char* what) {
  if (value >= least && value <= most) return value;
  throw RequestError{WireError::number, what};
}

Vec3 color_of(WireReader& in) {
  const Vec3 out = vec3_of(in, false);
  for (int k = 0; k < 3; ++k)
    (void)in_range(out[k], 0, 1e20, "a colour is negative, above 1e20 or not finite");
  return out;
}

world::Sun sun_of(WireReader& in, double unit, const world::Sun& before) {
  const Vec3 polar = vec3_of(in, true);
  if (!is_finite(polar)) throw RequestError{WireError::number, "a number is not finite"};
  const det::SinCos azimuth = det::sincos(polar.y * unit);
  const det::SinCos elevation = det::sincos(polar.z * unit);
  world::Sun out = before;
  out.direction = Vec3(elevation.cos * azimuth.cos, elevation.cos * azimuth.sin, elevation.sin);
  constexpr double kNearest = 1e9;  // metres; below it clients mean no distance
  if (polar.x >= kNearest) out.distance = polar.x / kAstronomicalUnit;
  return out;
}

Motion motion_of(WireReader& in, bool doubles, bool pairs) {
  Motion out;
  // linear and angular numbers of each order
  for (auto [linear, angular] :
       {std::pair(&out.velocity, &out.turn), std::pair(&out.acceleration, &out.turn_acceleration),
        std::pair(&out.jerk, &out.turn_jerk)}) {
    if (pairs) *linear = vec3_of(in, doubles);
    *angular = vec3_of(in, doubles);
  }
  return out;
}

}  // namespace

bool Session::command(Request kind, WireReader& in, std::string& note) {
  if (view_command(kind, in, note) || lens_command(kind, in, note) ||
      light_command(kind, in, note) || lamp_command(kind, in, note) ||
      object_command(kind, in, note) || lidar_command(kind, in, note))
    return true;
  note = "without effect";
  return false;
}

bool Session::view_command(Request kind, WireReader& in, std::string& note) {
  State& state = *state_;
  switch (kind) {
    case Request::set_viewpoint_by_degrees_s:
      state.viewpoint = angles_pose(in, false, 1);
      return true;
    case Request::set_viewpoint_by_degrees_d:
      state.viewpoint = angles_pose(in, true, 1);
      return true;
    case Request::set_viewpoint_by_radians:
      state.viewpoint = angles_pose(in, true, 1 / kDegree);
      return true;
    case Request::set_viewpoint_by_quaternion_s:
      state.viewpoint = quaternion_pose(in, false);
      return true;
    case Request::set_viewpoint_by_quaternion_d:
      state.viewpoint = quaternion_pose(in, true);
      return true;
    case Request::select_camera: {
      const std::uint32_t camera = in.word();
      if (own_camera(camera) == 0 || stage_.frame_of(state, camera))
        state.camera = camera;
      else
        note = "an unknown camera is ignored";
      return true;
    }
    case Request::set_global_time:
      state.time = in.real64();
      return true;
    default:
      return false;
  }
}

bool Session::lens_command(Request kind, WireReader& in, std::string& note) {
  State& state = *state_;
  const auto lens = [&](std::uint32_t camera) -> Lens& {
    if (own_camera(camera) != 0 && !stage_.frame_of(state, camera))
      note = "an unknown camera is ignored";
    static thread_local Lens ignored;
    return note.empty() ? state.lenses[own_camera(camera)] : ignored;
  };
  constexpr double kWidest = 179.999;  // degrees
  switch (kind) {
    case Request::set_field_of_view_by_degrees:
      lens(state.camera).field_of_view =
          in_range(in.real(), 1e-9, kWidest, "a field of view is not within 0 and 180 degrees") *
          kDegree;
      return true;
    case Request::set_field_of_view_by_radians:
      lens(state.camera).field_of_view = in_range(in.real(), 1e-11, kWidest * kDegree,
                                                  "a field of view is not within 0 and pi radians");
      return true;
    case Request::set_aspect_ratio:
      lens(state.camera).aspect =
          in_range(in.real(), 1e-3, 1e3, "an aspect ratio is not within 0.001 and 1000");
      return true;
    case Request::set_projection_mode: {
      const std::uint32_t camera = in.word();
      lens(camera).orthographic = in.word() == 1;
      return true;
    }
    case Request::set_ortho_field_of_view: {
      Lens& changed = lens(in.word());
      const char* const words = "a width in metres is not within 1e-9 and 1e12";
      const double width = in_range(in.real64(), 1e-9, 1e12, words);
      changed.ortho = Vec2(width, in_range(in.real64(), 1e-9, 1e12, words));
      return true;
    }
    case Request::set_camera_motion: {
      Lens& moved = lens(in.word());
      moved.motion = motion_of(in, true, true);
      return true;
    }
    default:
      return false;
  }
}

bool Session::light_command(Request kind, WireReader& in, std::string& note) {
  State& state = *state_;
  const world::Sun& base = stage_.initial().world.sun();
  switch (kind) {
    case Request::set_ambient_light:
      state.ambient = color_of(in);
      return true;
    case Request::set_sun_colour: {
      const Vec3 color = color_of(in);
      world::Sun sun = state.world.sun();
      sun.irradiance = color == Vec3(1) ? base.irradiance
                                        : std::optional(color * base.irradiance.value_or(Vec3(1)));
      if (!state.world.given_white()) state.world.set_white(state.world.white());
      state.world.set_sun(sun);
      return true;
    }
    case Request::set_sun_by_degrees:
      state.world.set_sun(sun_of(in, kDegree, state.world.sun()));
      return true;
    case Request::set_sun_by_radians:
      state.world.set_sun(sun_of(in, 1, state.world.sun()));
      return true;
    case Request::set_sky_type:
      state.sky.type = in.word();
      if (state.sky.type == 1 || state.sky.type > 9) note = "an unknown type of sky is black";
      return true;
    case Request::set_sky_rgb:
      state.sky.rgb = color_of(in);
      return true;
    case Request::set_sky_cie:
      state.sky.cie = color_of(in);
      return true;
    case Request::set_star_quaternion:
      state.world_from_icrs = attitude_of(in, true);
      return true;
    case Request::set_star_magnitudes:
      state.faintest = in_range(in.real64(), -30, 30, "a magnitude is not within -30 and 30");
      return true;
    case Request::set_global_fog_mode: {
      const std::uint32_t mode = in.word();
      if (mode > 3) note = "an unknown mode of fog is none";
      state.fog.mode = mode > 3 ? FogMode::none : static_cast<FogMode>(mode);
      return true;
    }
    case Request::set_global_fog_properties:
      state.fog.radius = in.real64();
      state.fog.density = in.real64();
      state.fog.begin = in.real64();
      state.fog.end = in.real64();
      return true;
    default:
      return false;
  }
}

bool Session::lamp_command(Request kind, WireReader& in, std::string& note) {
  State& state = *state_;
  switch (kind) {
    case Request::bind_light_to_camera:
      if (in.word() != 0) note = "a light other than 0 is ignored";
      state.light.camera = in.word();
      state.light.on = in.flag() && note.empty();
      return true;
    case Request::configure_light_by_degrees:
    case Request::configure_light_by_radians: {
      if (in.word() != 0) note = "a light other than 0 is ignored";
      const Vec3 intensity = color_of(in);
      const double unit = kind == Request::configure_light_by_degrees ? kDegree : 1;
      const double angle =
          in_range(in.real() * unit, 0, kPi + 1e-6, "a half-angle is not within 0 and 180 degrees");
      const double exponent = in_range(in.real(), 0, 128, "an exponent is not within 0 and 128");
      if (!note.empty()) return true;
      state.light.intensity = intensity;
      state.light.half_angle = std::clamp(angle, 1e-6, kPi);
      state.light.exponent = exponent;
      return true;
    }
    case Request::set_light_position_direction: {
      if (in.word() != 0) note = "a light other than 0 is ignored";
      const Vec3 position = position_of(in, true);
      const Vec3 axis = vec3_of(in, true);
      if (!(glm::length(axis) > 0)) throw RequestError{WireError::number, "a direction is 0"};
      if (!note.empty()) return true;
      state.light.position = position;
      state.light.axis = glm::normalize(axis);
      return true;
    }
    default:
      return false;
  }
}

bool Session::object_command(Request kind, WireReader& in, std::string& note) {
  State& state = *state_;
  switch (kind) {
    case Request::set_object_position_attitude: {
      const auto target = stage_.target_of(state, in.word());
      const world::Pose pose = quaternion_pose(in, true);
      if (target)
        state.world.set_pose(*target, pose);
      else
        note = "an unknown object is ignored";
      return true;
    }
    case Request::set_object_view: {
      const auto target = stage_.target_of(state, in.word());
      if (target)
        state.world.set_visible(*target, in.word() != 0);
      else
        note = "an unknown object is ignored";
      return true;
    }
    case Request::set_joint_config: {
      const auto target = stage_.target_of(state, in.word());
      const std::uint32_t joint = in.word();
      const std::uint32_t count = std::min<std::uint32_t>(in.word(), geometry::kMaxJointValues);
      if (!target || joint >= state.world[*target].model()->joints().size()) {
        note = "an unknown joint is ignored";
        return true;
      }
      const auto joint_kind =
          static_cast<geometry::JointKind>(state.world[*target].model()->joints()[joint].kind);
      geometry::JointValues values = state.world[*target].joint_values()[joint];
      for (std::uint32_t i = 0; i < count; ++i) {
        const double value = in.real64();
        if (!in.flag()) continue;
        if (i < geometry::value_count(joint_kind))
          values[i] = value;
        else
          note = "a number beyond the values of the joint is ignored";
      }
      const bool scales = joint_kind == geometry::JointKind::general;
      if (!in.finite() || (scales && values[0] * values[1] * values[2] == 0) ||
          (joint_kind == geometry::JointKind::scale && values[0] == 0))
        throw RequestError{WireError::number, "a value of a joint is not finite, or a scale is 0"};
      state.world.set_joint(*target, joint, values);
      return true;
    }
    default:
      return false;
  }
}

bool Session::lidar_command(Request kind, WireReader& in, std::string& note) {
  State& state = *state_;
  switch (kind) {
    case Request::set_lidar_parameters: {
      LidarParameters lidar;
      lidar.width = in.real(), lidar.height = in.real();
      lidar.columns = in.word(), lidar.rows = in.word();
      lidar.time_x = in.real(), lidar.time_y = in.real();
      lidar.samples_x = in.word(), lidar.samples_y = in.word();
      lidar.type = in.word(), lidar.flags = in.word();
      for (double& other : lidar.others) other = in.real();
      state.lidar = lidar;
      return true;
    }
    case Request::set_corner_cubes_s:
    case Request::set_corner_cubes_d: {
      const bool doubles = kind == Request::set_corner_cubes_d;
      const std::uint32_t count = in.word();
      if (in.word() != 0) note = "an unknown format is taken as 0";
      (void)in.word();  // bytes that follow
      state.cubes.clear();
      for (std::uint32_t i = 0; i < count; ++i) {
        CornerCube cube;
        cube.position = vec3_of(in, doubles);
        cube.normal = vec3_of(in, doubles);
        cube.radius = doubles ? in.real64() : in.real();
        state.cubes.push_back(cube);
      }
      return true;
    }
    case Request::set_corner_cube_attitude:
      state.cube_attitude = attitude_of(in, false);
      state.cube_motion = motion_of(in, false, false);
      return true;
    case Request::set_lidar_scan: {
      const std::uint32_t count = in.word();
      if (in.word() != 0) note = "an unknown format is taken as 0";
      (void)in.word();
      state.pulses.clear();
      for (std::uint32_t i = 0; i < count; ++i) {
        LidarPulse pulse;
        pulse.time = in.real64();
        pulse.direction = attitude_of(in, true);
        (void)vec3_of(in, true);  // spare
        state.pulses.push_back(pulse);
      }
      return true;
    }
    default:
      return false;
  }
}

}  // namespace panwright::server
