// Requests that images answer, and those of objects, frames and cameras.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/clock.h"
#include "scenario/fli.h"
#include "server/session.h"

namespace panwright::server {

namespace {

constexpr std::uint32_t kTextureWidth = 256;

Bytes empty_image() { return WireWriter().word(reply::kImage).word(0).take(); }

// Kinds of joints on the wire.
std::uint32_t wire_kind(geometry::JointKind kind) {
  switch (kind) {
    case geometry::JointKind::revolute:
    case geometry::JointKind::continuous:
      return 1;
    case geometry::JointKind::prismatic:
      return 2;
    default:
      return 0;
  }
}

WireWriter doubles_reply(std::span<const double> values, bool valid) {
  WireWriter out;
  out.word(reply::kDoubleArray).word(static_cast<std::uint32_t>(values.size()));
  for (const double value : values) out.real64(value).flag(valid);
  return out;
}

}  // namespace

void Session::draw(const world::Camera& camera, const Lens* lens, bool ranges,
                   const std::function<void(Drawing&)>& use, const Job& job) {
  if (stage_.draw(state(), camera, lens, ranges, use, log_, job)) return;
  if (job.cancelled()) throw Cancelled();
  throw RequestError{WireError::drawing, log_.entries().empty() ? "the image cannot be drawn"
                                                                : log_.entries()[0].message};
}

Bytes Session::image_at(const world::Camera& camera, const Lens* lens, const Job& job) {
  const auto begin = std::chrono::steady_clock::now();
  const bool fog = state().fog.mode != FogMode::none;
  state_->image_time = state().time;
  WireWriter out;
  const auto encode = [&](Drawing& drawing) {
    add_sky_and_fog(state(), drawing.white, drawing.image, job);
    append_image(drawing, options_.images, out, job);
    if (options_.shown)
      options_.shown(std::move(drawing), camera, state().world, state().time, seconds_since(begin));
  };
  draw(camera, lens, fog, encode, job);
  return out.take();
}

Bytes Session::image_of(std::uint32_t number, const Job& job) {
  const auto camera = stage_.camera_of(state(), number);
  return camera ? image_at(*camera, lens_of(number), job) : empty_image();
}

Bytes Session::range_image(double offset, double scale, const Job& job) {
  const auto camera = stage_.camera_of(state(), state().camera);
  if (!camera) return empty_image();
  WireWriter out;
  const auto encode = [&](Drawing& drawing) {
    std::vector<std::uint8_t> greys(drawing.image.pixels());
    for (std::size_t i = 0; i < greys.size(); ++i) {
      const double range = drawing.image.range[i];
      const double place =
          std::isfinite(range) ? std::clamp((range - offset) * scale, 0.0, 1.0) : 1;
      greys[i] = static_cast<std::uint8_t>(place * (kTextureWidth - 1));
    }
    append_greys(greys, camera->width, camera->height, options_.images, out);
  };
  draw(*camera, nullptr, true, encode, job);
  return out.take();
}

Bytes Session::image_request(Request kind, WireReader& in, const Job& job) {
  State& state = *state_;
  switch (kind) {
    case Request::get_image:
      if (state.shows_held && state.held) {
        state.shows_held = false;
        return *state.held;
      }
      return image_of(state.camera, job);
    case Request::get_range_image: {
      const double offset = in.real(), scale = in.real();
      if (!in.finite()) throw RequestError{WireError::number, "a number is not finite"};
      return range_image(offset, scale, job);
    }
    case Request::get_range_texture: {
      std::vector<std::uint8_t> greys(kTextureWidth);
      for (std::uint32_t i = 0; i < kTextureWidth; ++i) greys[i] = static_cast<std::uint8_t>(i);
      WireWriter out;
      append_greys(greys, kTextureWidth, 1, options_.images, out);
      return out.take();
    }
    case Request::get_viewpoint_by_frame: {
      const auto target = stage_.target_of(state, in.word());
      const std::uint32_t frame = in.word();
      if (!target || frame >= state.world[*target].model()->frames().size()) return empty_image();
      auto camera = stage_.camera_of(state, 0);
      const world::Pose pose = stage_.pose_of(state, {*target, frame});
      camera->position = pose.translation;
      camera->world_from_camera = pose.rotation;
      return image_at(*camera, nullptr, job);
    }
    case Request::get_viewpoint_by_camera:
      return image_of(in.word(), job);
    case Request::render_to_hold_buffer: {
      const std::uint32_t camera = in.word();
      state.held = std::make_shared<const Bytes>(image_of(camera, job));
      return okay();
    }
    case Request::display_hold_buffer:
      state.shows_held = state.held != nullptr;
      return okay();
    default:
      break;
  }
  // those that set the viewpoint first, as the command with the same fields
  std::string note;
  const auto setter =
      kind == Request::get_viewpoint_by_degrees_s      ? Request::set_viewpoint_by_degrees_s
      : kind == Request::get_viewpoint_by_degrees_d    ? Request::set_viewpoint_by_degrees_d
      : kind == Request::get_viewpoint_by_radians      ? Request::set_viewpoint_by_radians
      : kind == Request::get_viewpoint_by_quaternion_s ? Request::set_viewpoint_by_quaternion_s
                                                       : Request::set_viewpoint_by_quaternion_d;
  (void)view_command(setter, in, note);
  return image_of(state.camera, job);
}

Bytes Session::object_request(Request kind, WireReader& in) {
  if (kind == Request::get_camera_properties) return camera_properties(in.word());
  const auto target = stage_.target_of(state(), in.word());
  const pan::Model* const model = target ? state().world[*target].model().get() : nullptr;
  if (kind == Request::get_joints) {
    const std::size_t count = model != nullptr ? model->joints().size() : 0;
    WireWriter out;
    out.word(reply::kJointList).word(static_cast<std::uint32_t>(count));
    for (std::size_t i = 0; i < count; ++i)
      out.word(static_cast<std::uint32_t>(i))
          .text(model->joint_name(i))
          .word(wire_kind(static_cast<geometry::JointKind>(model->joints()[i].kind)));
    return out.take();
  }
  if (kind == Request::get_frames) {
    const std::size_t count = model != nullptr ? model->frames().size() : 0;
    WireWriter out;
    out.word(reply::kFrameList).word(static_cast<std::uint32_t>(count));
    for (std::size_t i = 0; i < count; ++i)
      out.word(static_cast<std::uint32_t>(i)).text(model->frame_name(i));
    return out.take();
  }
  const std::uint32_t index = in.word();
  if (kind == Request::get_joint_config) {
    const bool known = model != nullptr && index < model->joints().size();
    const geometry::JointValues values =
        known ? state().world[*target].joint_values()[index] : geometry::JointValues{};
    return doubles_reply(values, known).take();
  }
  const bool known = model != nullptr && index < model->frames().size();
  const world::Pose pose =
      known ? stage_.pose_of(state(), {*target, index}) : world::Pose{Vec3(0), Quat(1, 0, 0, 0)};
  if (kind == Request::get_frame) {
    std::array<double, 12> values{};
    const Vec3 axes[] = {pose.rotation * Vec3(0, 0, 1), pose.rotation * Vec3(0, -1, 0),
                         pose.rotation * Vec3(1, 0, 0), pose.translation};
    for (std::size_t i = 0; known && i < values.size(); ++i)
      values[i] = axes[i / 3][static_cast<int>(i % 3)];
    return doubles_reply(values, known).take();
  }
  std::array<double, 6> values{};
  if (known) {
    const scenario::FlightAngles angles = scenario::angles_of(pose.rotation);
    values = {angles.yaw * kDegree, angles.pitch * kDegree, angles.roll * kDegree,
              pose.translation.x,   pose.translation.y,     pose.translation.z};
  }
  return doubles_reply(values, known).take();
}

Bytes Session::camera_properties(std::uint32_t number) const {
  WireWriter out;
  out.word(reply::kCameraProperties);
  const auto camera = stage_.camera_of(state(), number);
  if (!camera) return out.word(0).take();
  constexpr std::uint32_t kBytes = 2 * 4 + 9 * 8;
  out.word(kBytes).word(camera->width).word(camera->height);
  // of the pinhole about the middle of the image
  out.real64(2 * det::atan2(0.5 * camera->width, camera->focal.x));
  out.real64(2 * det::atan2(0.5 * camera->height, camera->focal.y));
  for (int k = 0; k < 3; ++k) out.real64(camera->position[k]);
  const Quat& q = camera->world_from_camera;
  for (const double value : {q.w, q.x, q.y, q.z}) out.real64(value);
  return out.take();
}

}  // namespace panwright::server
