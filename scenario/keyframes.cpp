#include "scenario/keyframes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "base/text.h"
#include "scenario/internal/json.h"
#include "scenario/internal/track.h"
#include "scenario/internal/tracks.h"

namespace panwright::scenario {

namespace {

constexpr std::array<std::string_view, 11> kMembers = {"time", "camera", "quat", "look_at",
                                                       "pose", "joint",  "sun",  "sun_distance",
                                                       "fov",  "name",   "seed"};

template <class Value>
struct Curve {
  std::string target;
  std::string joint;
  std::size_t component = 0;
  Samples<Value> samples;
};

struct Curves {
  std::vector<Curve<Vec3>> positions;  // empty target: the camera
  std::vector<Curve<Quat>> rotations;
  std::vector<Curve<double>> joints;
  Curve<Vec3> look_at;
  Curve<Vec3> sun;
  Curve<double> sun_distance;
  Curve<double> fov;
  std::array<Curve<double>, 4> intrinsics;  // of views alone
  std::vector<std::string> names;           // one for each keyframe
  std::vector<std::optional<std::uint64_t>> seeds;
};

// Constant before the first key and after the last.
template <class Value>
Value curve_at(const Curve<Value>& curve, double time) {
  const auto& times = curve.samples.times;
  return value_at(curve.samples, std::clamp(time, times.front(), times.back()));
}

class KeyframeSource final : public Source {
 public:
  KeyframeSource(SourceInfo info, Curves curves)
      : Source(std::move(info)), curves_(std::move(curves)) {}

 private:
  const char* fill(double time, Frame& frame) const override {
    const auto placement = [&](const std::string& target) -> Placement& {
      return target.empty() ? frame.camera : frame.target(target).placement;
    };
    for (const auto& curve : curves_.positions)
      placement(curve.target).position = curve_at(curve, time);
    for (const auto& curve : curves_.rotations)
      placement(curve.target).rotation = curve_at(curve, time);
    for (const auto& curve : curves_.joints) {
      JointValue& joint = frame.joint(curve.target, curve.joint);
      joint.values[curve.component] = curve_at(curve, time);
      joint.count = std::max(joint.count, curve.component + 1);
    }
    if (!curves_.look_at.samples.times.empty()) {
      DiagnosticLog ignored;
      const auto turn = world::looking_at(frame.camera.position.value_or(Vec3(0)),
                                          curve_at(curves_.look_at, time), std::nullopt, ignored);
      if (!turn) return "the camera stands on the point that it looks at";
      frame.camera.rotation = *turn;
    }
    if (!curves_.sun.samples.times.empty()) {
      const Vec3 direction = curve_at(curves_.sun, time);
      const double length = glm::length(direction);
      frame.sun_direction = length > 0 ? direction / length : curves_.sun.samples.values[0];
    }
    if (!curves_.sun_distance.samples.times.empty())
      frame.sun_distance = curve_at(curves_.sun_distance, time);
    if (!curves_.fov.samples.times.empty()) frame.lens.fov = curve_at(curves_.fov, time);
    const auto own = std::ranges::lower_bound(info().times, time);
    if (own == info().times.end() || *own != time) return nullptr;
    const auto index = static_cast<std::size_t>(own - info().times.begin());
    if (!curves_.names[index].empty()) frame.name = curves_.names[index];
    if (curves_.seeds[index]) frame.seed = curves_.seeds[index];
    return nullptr;
  }
  Curves curves_;
};

class KeyframeReader {
 public:
  KeyframeReader(const KeyframeOptions& options, Input& input) : options_(options), input_(input) {}

  Result<SourcePtr> read() {
    const auto document = parse_json(input_);
    if (!document || !read_document(*document)) return failed;
    info_.name = input_.name();
    info_.spans = {{info_.times.front(), info_.times.back()}};
    set_channels();
    return SourcePtr(std::make_shared<KeyframeSource>(std::move(info_), std::move(curves_)));
  }

  Result<SourcePtr> read_views() {
    views_ = true;
    method_ = Method::linear;
    const auto list = parse_json_lines(input_);
    if (!list) return failed;
    if (list->items.empty()) fail(*list, "expected views, one a line or a list of them");
    for (const JsonValue& item : list->items) {
      if (!input_.more()) break;
      read_view(item);
    }
    if (input_.errors() > 0) return failed;
    info_.name = input_.name();
    Tracks all = tracks();
    return track_source(std::move(info_), std::move(all));
  }

 private:
  void fail(const JsonValue& at, std::string message, std::string hint = {}) {
    input_.error(Code("E8001"), at.at, std::move(message), std::move(hint));
  }

  void unknown(const JsonValue::Member& member) {
    if (views_ && !unknown_.insert(member.name).second) return;
    const auto near = nearest_name(member.name, kMembers);
    const std::string hint = near ? fmt::format("did you mean '{}'?", *near) : std::string();
    const std::string message = "unknown member " + in_quotes(member.name) + " is skipped";
    if (options_.strict)
      input_.error(Code("E8001"), member.at, message, hint);
    else
      input_.report(Code("W8002"), member.at, message, hint);
  }

  bool read_document(const JsonValue& document) {
    if (document.kind != JsonKind::object) {
      fail(document, "expected an object with keyframes",
           "write {\"keyframes\": [{\"time\": 0, \"camera\": [0, -5, 1]}]}");
      return false;
    }
    const JsonValue* list = nullptr;
    for (const JsonValue::Member& member : document.members) {
      if (member.name == "keyframes")
        list = &member.value;
      else if (member.name == "epoch")
        read_date(member.value);
      else if (member.name == "interpolation")
        read_interpolation(member.value);
      else
        unknown(member);
    }
    if (list == nullptr || list->kind != JsonKind::list || list->items.empty())
      fail(list ? *list : document, "\"keyframes\" is no list of one or more objects");
    else
      for (const JsonValue& item : list->items)
        if (input_.more()) read_keyframe(item);
    if (input_.errors() == 0 && look_at_place_.data() != nullptr) check_look_at();
    return input_.errors() == 0;
  }

  void read_date(const JsonValue& value) {
    const std::size_t blank = value.string.rfind(' ');
    const auto system = blank == value.string.npos
                            ? std::nullopt
                            : time_system_named(std::string_view(value.string).substr(blank + 1));
    if (!system) {
      input_.error(Code("E8007"), value.at,
                   "expected an epoch and its time system: \"2026-01-01T00:00:00 UTC\"");
      return;
    }
    std::string problem;
    info_.system = *system;
    info_.epoch = parse_epoch(std::string_view(value.string).substr(0, blank), *system, problem);
    if (!info_.epoch) fail(value, problem);
  }

  void read_interpolation(const JsonValue& value) {
    if (value.string == "linear")
      method_ = Method::linear;
    else if (value.string != "cubic")
      fail(value, "\"interpolation\" is \"cubic\" or \"linear\"");
  }

  void read_view(const JsonValue& item) {
    if (item.kind != JsonKind::object) return fail(item, "a view is an object of its members");
    const auto time =
        std::ranges::find(item.members, std::string("time"), &JsonValue::Member::name);
    const bool timed = time != item.members.end();
    const std::size_t number = curves_.names.size();
    if (number > 0 && timed != !info_.times.empty())
      return fail(item, "\"time\" stands in some views and not in others");
    if (timed)
      read_keyframe(item);
    else
      read_members(item, static_cast<double>(number));
    if (input_.errors() > 0) return;
    if (!curves_.look_at.samples.values.empty()) aim(item);
    const auto check = [&](const auto& curve, const Channel& channel) {
      const std::size_t count = curve.samples.values.size();
      if (count > 0 && count != number + 1 && input_.errors() == 0)
        fail(item, channel_text(channel) + " stands in some views and not in others");
    };
    for (const auto& each : curves_.positions) check(each, {Quantity::position, each.target, {}});
    for (const auto& each : curves_.rotations) check(each, {Quantity::rotation, each.target, {}});
    for (const auto& each : curves_.joints) check(each, {Quantity::joint, each.target, each.joint});
    check(curves_.fov, {Quantity::lens, {}, {}});
    check(curves_.intrinsics[0], {Quantity::lens, {}, {}});
    check(curves_.sun, {Quantity::sun_direction, {}, {}});
    check(curves_.sun_distance, {Quantity::sun_distance, {}, {}});
    if (curves_.seeds.back().has_value() != curves_.seeds.front().has_value())
      fail(item, "the seed stands in some views and not in others");
  }

  // The attitude of a view that looks at a point.
  void aim(const JsonValue& item) {
    const auto camera = std::ranges::find(curves_.positions, std::string(), &Curve<Vec3>::target);
    DiagnosticLog ignored;
    const auto turn =
        camera == curves_.positions.end()
            ? failed
            : world::looking_at(camera->samples.values.back(),
                                curves_.look_at.samples.values.back(), std::nullopt, ignored);
    if (!turn)
      return fail(item, "\"look_at\" needs \"camera\", a position that is not the point itself");
    add(curve(curves_.rotations, {}, {}, 0), *turn);
    curves_.look_at.samples = {};
  }

  Tracks tracks() {
    Tracks out;
    out.times = info_.times;
    out.frames = curves_.names.size();
    out.method = Method::linear;
    for (auto& each : curves_.positions)
      out.positions.push_back({each.target, std::move(each.samples.values), {}});
    for (auto& each : curves_.rotations)
      out.rotations.push_back({each.target, std::move(each.samples.values)});
    for (auto& each : curves_.joints)
      out.joints.push_back({each.target, each.joint, each.component, each.samples.values});
    if (!curves_.fov.samples.values.empty())
      out.lens.push_back({LensNumber::fov, curves_.fov.samples.values});
    constexpr LensNumber kNumbers[] = {LensNumber::focal_x, LensNumber::focal_y,
                                       LensNumber::principal_x, LensNumber::principal_y};
    for (std::size_t k = 0; k < 4; ++k)
      if (auto& values = curves_.intrinsics[k].samples.values; !values.empty())
        out.lens.push_back({kNumbers[k], values});
    out.sun_directions = curves_.sun.samples.values;
    out.sun_distances = curves_.sun_distance.samples.values;
    if (std::ranges::any_of(curves_.names, [](const auto& name) { return !name.empty(); }))
      out.names = curves_.names;
    if (curves_.seeds.front())
      for (const auto& seed : curves_.seeds) out.seeds.push_back(*seed);
    return out;
  }

  void read_keyframe(const JsonValue& item) {
    const auto time =
        std::ranges::find(item.members, std::string("time"), &JsonValue::Member::name);
    if (item.kind != JsonKind::object || time == item.members.end() ||
        time->value.kind != JsonKind::number)
      return fail(item, "a keyframe is an object with \"time\", a number of seconds");
    if (!info_.times.empty() && !(time->value.number > info_.times.back())) {
      input_.error(Code("E8004"), time->value.at,
                   fmt::format("time {} is not after that of the {} before", time->value.number,
                               views_ ? "view" : "keyframe"));
      return;
    }
    info_.times.push_back(time->value.number);
    read_members(item, time->value.number);
  }

  void read_members(const JsonValue& item, double time) {
    time_ = time;
    curves_.names.emplace_back();
    curves_.seeds.emplace_back();
    for (const JsonValue::Member& member : item.members) read_member(member);
  }

  void read_member(const JsonValue::Member& member) {
    std::string name = member.name;
    if (views_) std::ranges::replace(name, '-', '_');
    const JsonValue& value = member.value;
    if (name == "time") return;
    if (name == "camera") {
      if (const auto p = vector(value)) add(curve(curves_.positions, {}, {}, 0), *p);
    } else if (name == "look_at") {
      look_at_place_ = member.at;
      if (const auto p = vector(value)) add(curves_.look_at, *p);
    } else if (name == "quat") {
      quat_place_ = member.at;
      std::array<double, 7> n{};
      if (numbers(value, 4, n)) add_rotation({}, Quat(n[0], n[1], n[2], n[3]), value);
    } else if (name == "pose") {
      read_poses(value);
    } else if (name == "joint") {
      read_joints(value);
    } else if (name == "sun") {
      read_sun(value);
    } else if (name == "sun_distance") {
      if (value.kind != JsonKind::number || !(value.number > 0))
        return fail(value, "\"sun_distance\" is a number above 0, in AU");
      add(curves_.sun_distance, value.number);
    } else if (name == "fov") {
      const auto angle = value.kind == JsonKind::number ? std::optional(value.number * kDegree)
                                                        : quantity(value.string, false);
      if (!angle || !(*angle > 0 && *angle < kPi))
        return fail(value, "\"fov\" is an angle above 0 and below 180 degrees");
      add(curves_.fov, *angle);
    } else if (name == "intrinsics" && views_) {
      std::array<double, 7> n{};
      if (!numbers(value, 4, n)) return;
      if (!(n[0] > 0 && n[1] > 0)) return fail(value, "focal lengths are above 0 pixels");
      for (std::size_t k = 0; k < 4; ++k) add(curves_.intrinsics[k], n[k]);
    } else if (name == "name") {
      if (value.kind != JsonKind::string) return fail(value, "\"name\" is a string");
      curves_.names.back() = value.string;
    } else if (name == "seed") {
      constexpr double kMostExact = 9007199254740992.0;
      if (value.kind != JsonKind::number || !(value.number >= 0 && value.number <= kMostExact) ||
          value.number != std::floor(value.number))
        return fail(value, "\"seed\" is a whole number from 0 to 2^53");
      curves_.seeds.back() = static_cast<std::uint64_t>(value.number);
    } else {
      unknown(member);
    }
  }

  bool numbers(const JsonValue& value, std::size_t count, std::array<double, 7>& out) {
    if (views_ && value.kind == JsonKind::string) return text_numbers(value, count, out);
    bool sound = value.kind == JsonKind::list && value.items.size() == count;
    for (std::size_t i = 0; sound && i < count; ++i) {
      sound = value.items[i].kind == JsonKind::number;
      out[i] = value.items[i].number;
    }
    if (!sound) fail(value, fmt::format("expected a list of {} numbers", count));
    return sound;
  }

  // "0 -40 5", as on a command line.
  bool text_numbers(const JsonValue& value, std::size_t count, std::array<double, 7>& out) {
    constexpr std::string_view kBetween = " ,\t";
    std::string_view rest = value.string;
    std::size_t found = 0;
    for (; found <= count; ++found) {
      rest.remove_prefix(std::min(rest.find_first_not_of(kBetween), rest.size()));
      if (rest.empty()) break;
      const std::string_view word = rest.substr(0, rest.find_first_of(kBetween));
      const auto number = parse_double(word);
      if (!number || found == count) break;
      out[found] = *number;
      rest.remove_prefix(word.size());
    }
    const bool sound = found == count && rest.empty();
    if (!sound) fail(value, fmt::format("expected {} numbers", count));
    return sound;
  }

  std::optional<Vec3> vector(const JsonValue& value) {
    std::array<double, 7> n{};
    return numbers(value, 3, n) ? std::optional(Vec3(n[0], n[1], n[2])) : std::nullopt;
  }

  template <class Value>
  Curve<Value>& curve(std::vector<Curve<Value>>& all, const std::string& target,
                      const std::string& joint, std::size_t component) {
    for (Curve<Value>& each : all)
      if (each.target == target && each.joint == joint && each.component == component) return each;
    all.push_back({target, joint, component, {}});
    return all.back();
  }

  template <class Value>
  void add(Curve<Value>& curve, const Value& value) {
    curve.samples.method = method_;
    curve.samples.times.push_back(time_);
    curve.samples.values.push_back(value);
  }

  void add_rotation(const std::string& target, const Quat& q, const JsonValue& at) {
    if (const auto unit = unit_quaternion(q, input_, at.at))
      add(curve(curves_.rotations, target, {}, 0), *unit);
  }

  void read_poses(const JsonValue& value) {
    if (value.kind != JsonKind::object)
      return fail(value, "\"pose\" is an object: {\"TARGET\": [x, y, z, qw, qx, qy, qz]}");
    for (const JsonValue::Member& member : value.members) {
      if (member.name.empty()) return fail(member.value, "a target has a name");
      std::array<double, 7> n{};
      const bool position_only =
          member.value.kind == JsonKind::list && member.value.items.size() == 3;
      if (!numbers(member.value, position_only ? 3 : 7, n)) continue;
      add(curve(curves_.positions, member.name, {}, 0), Vec3(n[0], n[1], n[2]));
      if (!position_only) add_rotation(member.name, Quat(n[3], n[4], n[5], n[6]), member.value);
    }
  }

  // "30deg": a number and its unit; metres, radians, or a factor.
  static std::optional<double> quantity(std::string_view text, bool lengths) {
    struct Unit {
      std::string_view name;
      double factor;
      bool angle;
    };
    constexpr Unit kUnits[] = {{"deg", kDegree, true}, {"rad", 1, true}, {"cm", 0.01, false},
                               {"mm", 0.001, false},   {"m", 1, false},  {"x", 1, false}};
    for (const Unit& unit : kUnits) {
      if (!text.ends_with(unit.name) || (!unit.angle && !lengths)) continue;
      const auto number = parse_double(trimmed(text.substr(0, text.size() - unit.name.size())));
      return number ? std::optional(*number * unit.factor) : std::nullopt;
    }
    return std::nullopt;
  }

  void read_joints(const JsonValue& value) {
    if (value.kind != JsonKind::object)
      return fail(value, "\"joint\" is an object: {\"TARGET/JOINT\": \"30deg\"}");
    for (const JsonValue::Member& member : value.members) {
      const std::size_t slash = member.name.find('/');
      if (slash == member.name.npos || slash == 0 || slash + 1 == member.name.size()) {
        input_.error(Code("E8001"), member.at, "a joint is named as TARGET/JOINT");
        continue;
      }
      const bool list = member.value.kind == JsonKind::list;
      const std::size_t count = list ? member.value.items.size() : 1;
      if (count < 1 || count > geometry::kMaxJointValues) {
        fail(member.value, fmt::format("a joint has 1 to {} values", geometry::kMaxJointValues));
        continue;
      }
      for (std::size_t i = 0; i < count; ++i) {
        const JsonValue& item = list ? member.value.items[i] : member.value;
        const auto read = quantity(item.string, true);
        if (!read)
          fail(item, "expected a number with a unit in quotes",
               "write \"30deg\", \"0.5rad\", \"0.2m\", or \"1.5x\" for a factor");
        else
          add(curve(curves_.joints, member.name.substr(0, slash), member.name.substr(slash + 1), i),
              *read);
      }
    }
  }

  void read_sun(const JsonValue& value) {
    const auto direction = vector(value);
    if (!direction) return;
    const double length = glm::length(*direction);
    if (!(length > 0) || !std::isfinite(length))
      return fail(value, "the direction of the Sun has no length");
    add(curves_.sun, *direction / length);
  }

  // A camera that looks at a point has a position, and no rotation.
  void check_look_at() {
    if (quat_place_.data() != nullptr)
      input_.error(Code("E8008"), look_at_place_,
                   "\"look_at\" and \"quat\" both give the rotation of the camera");
    if (std::ranges::find(curves_.positions, std::string(), &Curve<Vec3>::target) ==
        curves_.positions.end())
      input_.error(Code("E8001"), look_at_place_, "\"look_at\" needs \"camera\", its position");
    if (input_.errors() > 0) return;
    for (const double time : info_.times) {
      const Vec3 from = curve_at(curve(curves_.positions, {}, {}, 0), time);
      if (from == curve_at(curves_.look_at, time))
        input_.error(Code("E8001"), look_at_place_,
                     fmt::format("at {} s the camera stands on the point that it looks at", time));
    }
  }

  void set_channels() {
    const auto add_channel = [&](Quantity quantity, const std::string& target,
                                 const std::string& joint) {
      const Channel channel{quantity, target, joint};
      if (std::ranges::find(info_.channels, channel) == info_.channels.end())
        info_.channels.push_back(channel);
    };
    for (const auto& each : curves_.positions) add_channel(Quantity::position, each.target, {});
    for (const auto& each : curves_.rotations) add_channel(Quantity::rotation, each.target, {});
    for (const auto& each : curves_.joints) add_channel(Quantity::joint, each.target, each.joint);
    if (!curves_.look_at.samples.times.empty()) add_channel(Quantity::rotation, {}, {});
    if (!curves_.sun.samples.times.empty()) add_channel(Quantity::sun_direction, {}, {});
    if (!curves_.sun_distance.samples.times.empty()) add_channel(Quantity::sun_distance, {}, {});
    if (!curves_.fov.samples.times.empty()) add_channel(Quantity::lens, {}, {});
    if (std::ranges::any_of(curves_.names, [](const auto& name) { return !name.empty(); }))
      add_channel(Quantity::name, {}, {});
    if (std::ranges::any_of(curves_.seeds, [](const auto& seed) { return seed.has_value(); }))
      add_channel(Quantity::seed, {}, {});
  }

  const KeyframeOptions& options_;
  Input& input_;
  bool views_ = false;
  std::set<std::string> unknown_;  // members of views that are reported
  Method method_ = Method::cubic;
  double time_ = 0;
  std::string_view look_at_place_;
  std::string_view quat_place_;
  SourceInfo info_;
  Curves curves_;
};

}  // namespace

Result<SourcePtr> read_keyframes(const Text& text, const KeyframeOptions& options,
                                 DiagnosticLog& log) {
  Input input(text, log);
  return KeyframeReader(options, input).read();
}

Result<SourcePtr> read_views(const Text& text, const KeyframeOptions& options, DiagnosticLog& log) {
  Input input(text, log);
  return KeyframeReader(options, input).read_views();
}

}  // namespace panwright::scenario
