#include "server/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

namespace panwright::server {

Bytes okay() { return WireWriter().word(reply::kOkay).take(); }

Bytes error_reply(WireError error, std::string_view text) {
  constexpr std::size_t kMost = 1000;
  return WireWriter()
      .word(reply::kError)
      .word(static_cast<std::uint32_t>(error))
      .text(text.substr(0, kMost))
      .take();
}

void check_reply(std::uint64_t count, std::uint64_t bytes_each, std::uint64_t most) {
  if (count > most / bytes_each)
    throw RequestError{WireError::number,
                       fmt::format("{} results of {} bytes are above the limit of {} bytes", count,
                                   bytes_each, most)};
}

Reply Session::answer(std::span<const std::uint8_t> request, const Job& job) {
  WireReader in(request);
  const auto kind = static_cast<Request>(in.word());
  log_ = DiagnosticLog();
  try {
    Reply reply = answer_kind(kind, in, job);
    name_damaged(reply);
    return reply;
  } catch (const RequestError& error) {
    return {error_reply(error.code, error.text), Reply::Then::next, error.text};
  } catch (const Cancelled&) {
    return {error_reply(WireError::time, "the request takes longer than the limit of time"),
            Reply::Then::next, "cancelled"};
  } catch (const std::exception&) {
    DiagnosticLog log;
    report_exception(log);
    const std::string text = log.entries().empty() ? "internal error" : log.entries()[0].message;
    return {error_reply(WireError::drawing, text), Reply::Then::next, text};
  }
}

namespace {

// Replies that look-ups give, by the request.
enum class Group { session, image, object, surface, point, lidar, command };

Group group_of(Request kind) {
  switch (kind) {
    case Request::goodbye:
    case Request::quit:
    case Request::echo:
    case Request::get_time_tag:
      return Group::session;
    case Request::get_image:
    case Request::get_range_image:
    case Request::get_range_texture:
    case Request::get_viewpoint_by_degrees_s:
    case Request::get_viewpoint_by_quaternion_s:
    case Request::get_viewpoint_by_degrees_d:
    case Request::get_viewpoint_by_quaternion_d:
    case Request::get_viewpoint_by_radians:
    case Request::get_viewpoint_by_frame:
    case Request::get_viewpoint_by_camera:
    case Request::render_to_hold_buffer:
    case Request::display_hold_buffer:
      return Group::image;
    case Request::get_joints:
    case Request::get_joint_config:
    case Request::get_frames:
    case Request::get_frame:
    case Request::get_frame_as_radians:
    case Request::get_camera_properties:
      return Group::object;
    case Request::get_elevation:
    case Request::get_elevations:
    case Request::get_surface_elevation:
    case Request::get_surface_elevations:
    case Request::get_surface_patch:
    case Request::get_view_as_dem:
      return Group::surface;
    case Request::lookup_point:
    case Request::lookup_points:
    case Request::get_point:
    case Request::get_points:
      return Group::point;
    case Request::get_lidar_pulse_result:
    case Request::get_lidar_measurement:
    case Request::get_lidar_measurement_s:
    case Request::get_lidar_measurement_d:
    case Request::get_lidar_snapshot:
    case Request::get_radar_response:
      return Group::lidar;
    default:
      return Group::command;
  }
}

}  // namespace

Reply Session::answer_kind(Request kind, WireReader& in, const Job& job) {
  using Then = Reply::Then;
  switch (group_of(kind)) {
    case Group::image:
      return {image_request(kind, in, job), Then::next, {}};
    case Group::object:
      return {object_request(kind, in), Then::next, {}};
    case Group::surface:
      return {surface_request(kind, in, job), Then::next, {}};
    case Group::point:
      return {point_request(kind, in, job), Then::next, {}};
    case Group::lidar:
      switch (kind) {
        case Request::get_lidar_pulse_result:
          return {pulse(in, job), Then::next, {}};
        case Request::get_lidar_snapshot:
          return {snapshot(in, job), Then::next, {}};
        case Request::get_radar_response:
          return {radar(in, job), Then::next, {}};
        default:
          return {scan(kind == Request::get_lidar_measurement_d, in, job), Then::next, {}};
      }
    case Group::command: {
      // a command that is refused leaves the state as it is
      auto before = std::make_unique<State>(state());
      std::string note;
      try {
        (void)command(kind, in, note);
        if (!in.finite()) throw RequestError{WireError::number, "a number is not finite"};
      } catch (...) {
        *state_ = std::move(*before);
        throw;
      }
      return {okay(), Then::next, note};
    }
    case Group::session:
      break;
  }
  if (kind == Request::goodbye) return {{}, Then::close, {}};
  if (kind == Request::quit) return {okay(), Then::quit, {}};
  if (kind == Request::get_time_tag)
    return {WireWriter()
                .word(reply::kDouble)
                .real64(1e6 * state().image_time.value_or(0))
                .flag(state().image_time.has_value())
                .take(),
            Then::next,
            {}};
  const std::uint32_t count = in.word();
  check_reply(count, 1, options_.most_reply);
  return {
      WireWriter().word(reply::kEcho).word(count).bytes(in.bytes(count)).take(), Then::next, {}};
}

// Tiles that this request has met first.
void Session::name_damaged(Reply& reply) {
  stage_.report_damaged(log_);
  for (const Diagnostic& entry : log_.entries()) {
    if (entry.code != Code("W9615")) continue;
    if (!reply.note.empty()) reply.note += "; ";
    reply.note += entry.message;
    if (options_.log == nullptr) continue;
    const FileId file = entry.where.file;
    options_.log->report_file(entry.code,
                              file == kNoFile ? std::string() : log_.sources().file(file).name,
                              entry.message, entry.hint);
  }
}

const Lens* Session::lens_of(std::uint32_t camera) const {
  const auto found = state().lenses.find(own_camera(camera));
  return found == state().lenses.end() ? nullptr : &found->second;
}

}  // namespace panwright::server
