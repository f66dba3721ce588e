#include "scenario/fli.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text.h"
#include "scenario/internal/input.h"
#include "scenario/interpolate.h"

namespace panwright::scenario {

namespace {

constexpr double kSunAu = 149597870700.0;
constexpr std::array<std::string_view, 8> kCommands = {
    "start", "quaternion", "update", "pause", "set_time", "view", "dynamic_object", "sun_position"};

// A state from a frame on.
template <class Value>
struct Change {
  std::size_t frame = 0;
  Value value;
};

template <class Value>
const Value* value_of(const std::vector<Change<Value>>& changes, std::size_t frame) {
  const auto next = std::ranges::upper_bound(changes, frame, {}, &Change<Value>::frame);
  return next == changes.begin() ? nullptr : &std::prev(next)->value;
}

template <class Value>
void set_value(std::vector<Change<Value>>& changes, std::size_t frame, const Value& value) {
  if (!changes.empty() && changes.back().frame == frame)
    changes.back().value = value;
  else
    changes.push_back({frame, value});
}

struct FliSun {
  Vec3 direction{0, 0, 1};
  double distance = 1;  // AU
};

struct FliObject {
  std::string target;
  std::vector<Change<world::Pose>> poses;
};

struct Flight {
  std::vector<world::Pose> cameras;
  std::vector<FliObject> objects;
  std::vector<Change<FliSun>> suns;
};

world::Pose between(const world::Pose& a, const world::Pose& b, double s) {
  return {a.translation * (1 - s) + b.translation * s, slerp(a.rotation, b.rotation, s)};
}

class FliSource final : public Source {
 public:
  FliSource(SourceInfo info, Flight flight) : Source(std::move(info)), flight_(std::move(flight)) {}

 private:
  static void set(const world::Pose& pose, Placement& placement) {
    placement.position = pose.translation;
    placement.rotation = pose.rotation;
  }

  // The state at a share of the way from a frame to the next one.
  void fill_between(std::size_t index, double s, Frame& frame) const {
    const std::size_t next = s > 0 ? index + 1 : index;
    set(s > 0 ? between(flight_.cameras[index], flight_.cameras[next], s) : flight_.cameras[index],
        frame.camera);
    for (const FliObject& object : flight_.objects) {
      const world::Pose* const a = value_of(object.poses, index);
      if (a == nullptr) continue;
      const world::Pose* const b = value_of(object.poses, next);
      set(a == b ? *a : between(*a, *b, s), frame.target(object.target).placement);
    }
    const FliSun* const a = value_of(flight_.suns, index);
    if (a == nullptr) return;
    const FliSun* const b = value_of(flight_.suns, next);
    const Vec3 direction = a->direction * (1 - s) + b->direction * s;
    const double length = glm::length(direction);
    frame.sun_direction = a == b || !(length > 0) ? a->direction : direction / length;
    frame.sun_distance = a->distance * (1 - s) + b->distance * s;
  }

  const char* fill(double time, Frame& frame) const override {
    const std::vector<double>& times = info().times;
    const auto next = std::ranges::upper_bound(times, time);
    const auto index = static_cast<std::size_t>(next - times.begin()) - 1;
    const double s =
        next == times.end() ? 0 : (time - times[index]) / (times[index + 1] - times[index]);
    fill_between(index, s, frame);
    return nullptr;
  }
  void fill_ordered(std::size_t index, Frame& frame) const override {
    fill_between(index, 0, frame);
  }

  Flight flight_;
};

Quat about_x(double degrees) {
  const det::SinCos half = det::sincos(degrees * kDegree / 2);
  return Quat(half.cos, half.sin, 0, 0);
}
Quat about_z(double degrees) {
  const det::SinCos half = det::sincos(degrees * kDegree / 2);
  return Quat(half.cos, 0, 0, half.sin);
}
Quat without_roll(const FlightAngles& a) {
  return about_z(a.yaw) * about_x(a.pitch) * about_x(-90);
}

}  // namespace

Quat rotation_of(const FlightAngles& angles) {
  return without_roll(angles) * about_z(-angles.roll);
}

FlightAngles angles_of(const Quat& world_from_camera) {
  const Quat& q = world_from_camera;
  const Vec3 bore = q * Vec3(0, 0, 1);
  FlightAngles out;
  out.pitch = det::asin(std::clamp(bore.z, -1.0, 1.0)) / kDegree;
  if (bore.x * bore.x + bore.y * bore.y > 1e-20) out.yaw = det::atan2(-bore.x, bore.y) / kDegree;
  const Quat roll = conjugate(without_roll(out)) * q;
  // either sign of a quaternion is the same attitude
  const double sign = roll.w < 0 ? -1 : 1;
  out.roll = -2 * det::atan2(sign * roll.z, sign * roll.w) / kDegree;
  return out;
}

namespace {

class FliReader {
 public:
  FliReader(const FliOptions& options, Input& input) : options_(options), input_(input) {}

  Result<SourcePtr> read() {
    std::string_view line;
    while (input_.next_line(line)) {
      const std::size_t hash = std::min(line.find('#'), line.size());
      if (hash < line.size()) read_comment(line.substr(hash + 1));
      split_words(line.substr(0, hash), words_);
      if (!words_.empty()) read_command();
    }
    if (flight_.cameras.empty() && input_.errors() == 0)
      input_.error(Code("E8001"), input_.bytes().substr(0, 0),
                   "the flight has no frame: expected start or quaternion");
    if (input_.errors() > 0) return failed;
    return source();
  }

 private:
  // Writers state the rate of a movie in a comment.
  void read_comment(std::string_view comment) {
    comment = trimmed(comment);
    constexpr std::string_view kRate = "Frame rate:";
    if (!comment.starts_with(kRate)) return;
    split_words(comment.substr(kRate.size()), words_);
    const auto rate = words_.empty() ? std::nullopt : parse_double(words_[0]);
    if (!rate || !(*rate > 0)) return;
    comment_rate_ = *rate;
    rate_place_ = comment;
  }

  void read_command() {
    const std::string_view command = words_[0];
    if (parse_double(command)) return read_change();
    if (command == "start") {
      if (const auto n = numbers(1, 6)) {
        angles_ = {(*n)[3], (*n)[4], (*n)[5]};
        set_camera(world::Pose{Vec3((*n)[0], (*n)[1], (*n)[2]), rotation_of(angles_)});
      }
    } else if (command == "quaternion") {
      if (const auto pose = pose_after(1)) {
        set_camera(*pose);
        angles_ = angles_of(pose->rotation);
      }
    } else if (command == "update") {
      if (numbers(1, 0)) set_camera(last_camera());
    } else if (command == "pause") {
      (void)numbers(1, 1);
    } else if (command == "set_time") {
      if (const auto n = numbers(1, 1)) set_value(times_, flight_.cameras.size(), (*n)[0]);
    } else if (command == "dynamic_object") {
      read_object();
    } else if (command == "sun_position") {
      read_sun();
    } else {
      skip(command);
    }
  }

  void skip(std::string_view command) {
    const bool view = command == "view";
    const std::string message = view ? std::string("the command 'view' is skipped")
                                     : "unknown command " + in_quotes(command) + " is skipped";
    const auto near = view ? std::nullopt : nearest_name(command, kCommands);
    const std::string hint = near ? fmt::format("did you mean '{}'?", *near) : std::string();
    if (options_.strict && !view)
      input_.error(Code("E8001"), command, message, hint);
    else
      input_.report(Code("W8002"), command, message, hint);
  }

  // Numbers of a line from a word on; reports another count.
  std::optional<std::array<double, 7>> numbers(std::size_t from, std::size_t count) {
    std::array<double, 7> out{};
    if (words_.size() != from + count) {
      input_.error(
          Code("E8001"), words_[0],
          fmt::format("{} takes {}, found {}",
                      from == 0 ? std::string("a change of the camera") : in_quotes(words_[0]),
                      counted(from + count - (from == 0 ? 0 : 1), "value"),
                      words_.size() - (from == 0 ? 0 : 1)));
      return std::nullopt;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const auto number = input_.number(words_[from + i], "a flight file");
      if (!number) return std::nullopt;
      out[i] = *number;
    }
    return out;
  }

  std::optional<world::Pose> pose_after(std::size_t from) {
    const auto n = numbers(from, 7);
    if (!n) return std::nullopt;
    const auto q =
        unit_quaternion(Quat((*n)[3], (*n)[4], (*n)[5], (*n)[6]), input_, words_[from + 3]);
    if (!q) return std::nullopt;
    return world::Pose{Vec3((*n)[0], (*n)[1], (*n)[2]), *q};
  }

  void set_camera(const std::optional<world::Pose>& camera) {
    if (!camera) {
      input_.error(Code("E8001"), words_[0],
                   "no start or quaternion stands before " + in_quotes(words_[0]));
      return;
    }
    flight_.cameras.push_back(*camera);
  }

  std::optional<world::Pose> last_camera() const {
    return flight_.cameras.empty() ? std::nullopt : std::optional(flight_.cameras.back());
  }

  void read_change() {
    const auto n = numbers(0, 6);
    if (!n) return;
    auto camera = last_camera();
    if (camera) {
      angles_ = {angles_.yaw + (*n)[3], angles_.pitch + (*n)[4], angles_.roll + (*n)[5]};
      *camera = {camera->translation + Vec3((*n)[0], (*n)[1], (*n)[2]), rotation_of(angles_)};
      note(changes_said_, "a line of six numbers is taken as a change of the camera before");
    }
    set_camera(camera);
  }

  void note(bool& said, const char* message) {
    if (!said) input_.report(Code("N8010"), words_[0], message);
    said = true;
  }

  void read_object() {
    const auto pose = pose_after(2);
    if (!pose) return;
    const std::string id(words_[1]);
    const auto named = options_.targets.find(id);
    const std::string target = named == options_.targets.end() ? id : named->second;
    auto found = std::ranges::find(flight_.objects, target, &FliObject::target);
    if (found == flight_.objects.end()) {
      flight_.objects.push_back({target, {}});
      found = std::prev(flight_.objects.end());
    }
    set_value(found->poses, flight_.cameras.size(), *pose);
  }

  void read_sun() {
    const auto n = numbers(1, 3);
    if (!n) return;
    if (!((*n)[0] > 0)) {
      input_.error(Code("E8001"), words_[1], "the distance of the Sun is not above 0");
      return;
    }
    const det::SinCos azimuth = det::sincos((*n)[1] * kDegree);
    const det::SinCos elevation = det::sincos((*n)[2] * kDegree);
    note(sun_said_, "the azimuth of the Sun is counted from +x towards +y, its distance in metres");
    set_value(flight_.suns, flight_.cameras.size(),
              {Vec3(elevation.cos * azimuth.cos, elevation.cos * azimuth.sin, elevation.sin),
               (*n)[0] / kSunAu});
  }

  // Times of set_time, or none.
  std::vector<double> set_times() {
    std::vector<double> out;
    for (std::size_t i = 0; i < flight_.cameras.size(); ++i) {
      const double* const time = value_of(times_, i);
      if (time == nullptr || (!out.empty() && !(*time > out.back()))) return {};
      out.push_back(*time);
    }
    return out;
  }

  SourcePtr source() {
    SourceInfo info;
    info.name = input_.name();
    info.channels = {{Quantity::position, {}, {}}, {Quantity::rotation, {}, {}}};
    for (const FliObject& object : flight_.objects) {
      info.channels.push_back({Quantity::position, object.target, {}});
      info.channels.push_back({Quantity::rotation, object.target, {}});
    }
    if (!flight_.suns.empty()) {
      info.channels.push_back({Quantity::sun_direction, {}, {}});
      info.channels.push_back({Quantity::sun_distance, {}, {}});
    }
    info.times = set_times();
    if (info.times.empty() && !times_.empty())
      input_.report(Code("W8012"), input_.bytes().substr(0, 0),
                    "not every frame has a later set_time than the one before: these are not used");
    const double rate = options_.frame_rate.value_or(comment_rate_);
    if (info.times.empty() && rate > 0) {
      for (std::size_t i = 0; i < flight_.cameras.size(); ++i)
        info.times.push_back(static_cast<double>(i) / rate);
      if (!options_.frame_rate)
        input_.report(Code("N8010"), rate_place_,
                      fmt::format("frames are taken 1/{} s apart, as this comment says", rate));
    }
    if (info.times.empty())
      info.ordered = flight_.cameras.size();
    else
      info.spans = {{info.times.front(), info.times.back()}};
    return std::make_shared<FliSource>(std::move(info), std::move(flight_));
  }

  const FliOptions& options_;
  Input& input_;
  std::vector<std::string_view> words_;
  Flight flight_;
  std::vector<Change<double>> times_;
  FlightAngles angles_;
  double comment_rate_ = 0;
  std::string_view rate_place_;
  bool changes_said_ = false;
  bool sun_said_ = false;
};

}  // namespace

Result<SourcePtr> read_fli(const Text& text, const FliOptions& options, DiagnosticLog& log) {
  Input input(text, log);
  return FliReader(options, input).read();
}

}  // namespace panwright::scenario
