#include "scenario/internal/columns.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <span>

#include "base/text.h"
#include "geometry/kinematics/joint.h"
#include "scenario/internal/tracks.h"

namespace panwright::scenario {

namespace {

constexpr double kAu = 149597870700.0;  // metres

struct Unit {
  std::string_view name;
  double factor;
};
constexpr Unit kTimes[] = {{"s", 1},     {"ms", 1e-3}, {"us", 1e-6},
                           {"ns", 1e-9}, {"min", 60},  {"h", 3600}};
constexpr Unit kLengths[] = {{"m", 1}, {"km", 1000}, {"cm", 0.01}, {"mm", 0.001}};
constexpr Unit kSpeeds[] = {{"m/s", 1}, {"km/s", 1000}, {"cm/s", 0.01}, {"mm/s", 0.001}};
constexpr Unit kAngles[] = {{"deg", kDegree}, {"rad", 1}};
constexpr Unit kJoints[] = {{"deg", kDegree}, {"rad", 1},    {"m", 1}, {"km", 1000},
                            {"cm", 0.01},     {"mm", 0.001}, {"1", 1}};
constexpr Unit kPixels[] = {{"px", 1}};
constexpr Unit kDistances[] = {{"AU", 1}, {"km", 1000 / kAu}, {"m", 1 / kAu}};

// Parser of one header.
class HeaderParser {
 public:
  HeaderParser(std::string_view header, Input& input, bool strict)
      : input_(input), strict_(strict) {
    column_.header = header;
    const std::size_t bracket = header.find('[');
    name_ = trimmed(header.substr(0, bracket));
    if (bracket != header.npos) {
      closed_ = header.ends_with(']');
      unit_ = trimmed(header.substr(bracket + 1, header.size() - bracket - (closed_ ? 2 : 1)));
    }
  }

  std::optional<Column> parse() {
    if (!closed_) {
      fail("has a bracket that is not closed");
      return std::nullopt;
    }
    const std::size_t before = input_.errors();
    if (name_ == "time")
      time();
    else if (name_ == "name" || name_ == "frame")
      column_.kind = ColumnKind::name;
    else if (name_ == "seed")
      column_.kind = ColumnKind::seed;
    else if (name_.starts_with("sun."))
      sun(name_.substr(4));
    else
      member();
    if (input_.errors() != before) return std::nullopt;
    return column_;
  }

 private:
  void fail(std::string_view problem, std::string hint = {}) {
    input_.error(Code("E8001"), column_.header,
                 fmt::format("column {} {}", in_quotes(column_.header), problem), std::move(hint));
  }

  void unknown() {
    const std::string message =
        fmt::format("unknown column {} is ignored", in_quotes(column_.header));
    const std::string hint = "columns are time, T.x, T.qw, T.joint.NAME, camera.x, sun.x, name…";
    if (strict_)
      input_.error(Code("E8001"), column_.header, message, hint);
    else
      input_.report(Code("W8002"), column_.header, message, hint);
  }

  void unit(std::span<const Unit> units) {
    std::string names;
    for (const Unit& each : units) {
      if (each.name == unit_) {
        column_.factor = each.factor;
        return;
      }
      names += fmt::format("{}{}", names.empty() ? "" : ", ", each.name);
    }
    const std::string hint = fmt::format("write {}[{}]", name_, units[0].name);
    if (unit_.empty())
      fail("has no unit, expected one of " + names, hint);
    else
      fail(fmt::format("has unit {}, expected one of {}", in_quotes(unit_), names), hint);
  }

  void time() {
    column_.kind = ColumnKind::time;
    if (const auto system = time_system_named(unit_)) {
      column_.kind = ColumnKind::epoch;
      column_.system = *system;
      return;
    }
    const std::size_t since = unit_.find(" since ");
    if (since == unit_.npos) return unit(kTimes);
    const std::string_view epoch = trimmed(unit_.substr(since + 7));
    unit_ = trimmed(unit_.substr(0, since));
    unit(kTimes);
    const std::size_t blank = epoch.rfind(' ');
    const auto system =
        blank == epoch.npos ? std::nullopt : time_system_named(epoch.substr(blank + 1));
    if (!system) {
      input_.error(Code("E8007"), column_.header,
                   fmt::format("{} names no time system, expected UTC, TAI, TT, TDB or GPS",
                               in_quotes(epoch)),
                   "write time[s since 2026-01-01T00:00:00 UTC]");
      return;
    }
    column_.system = *system;
    std::string problem;
    column_.epoch = parse_epoch(trimmed(epoch.substr(0, blank)), *system, problem);
    if (!column_.epoch) input_.error(Code("E8001"), column_.header, problem);
  }

  void sun(std::string_view member) {
    if (member == "distance") {
      column_.kind = ColumnKind::sun_distance;
      return unit(kDistances);
    }
    if (!is_one_of(member, "xyz")) return unknown();
    column_.kind = ColumnKind::sun_direction;
  }

  // One letter of a list; sets the component.
  bool is_one_of(std::string_view member, std::string_view letters) {
    if (member.size() != 1 || letters.find(member[0]) == letters.npos) return false;
    column_.component = letters.find(member[0]);
    return true;
  }

  void member() {
    if (const std::size_t at = name_.find(".joint."); at != name_.npos && at > 0)
      return joint(name_.substr(0, at), name_.substr(at + 7));
    const std::size_t dot = name_.rfind('.');
    if (dot == name_.npos || dot == 0) return unknown();
    const std::string_view target = name_.substr(0, dot);
    const std::string_view member = name_.substr(dot + 1);
    const bool camera = target == "camera";
    if (!camera) column_.target = target;
    if (is_one_of(member, "xyz")) {
      column_.kind = ColumnKind::position;
      unit(kLengths);
    } else if (member.starts_with('v') && is_one_of(member.substr(1), "xyz")) {
      column_.kind = ColumnKind::velocity;
      unit(kSpeeds);
    } else if (member.starts_with('q') && is_one_of(member.substr(1), "wxyz")) {
      column_.kind = ColumnKind::rotation;
      direction(camera);
    } else if (camera) {
      lens(member);
    } else {
      unknown();
    }
  }

  void direction(bool camera) {
    const std::string_view thing = camera ? "camera" : "model";
    if (unit_ == fmt::format("world_from_{}", thing) || (!camera && unit_ == "world_from_body"))
      return;
    if (unit_ == fmt::format("{}_from_world", thing) || (!camera && unit_ == "body_from_world")) {
      column_.inverse = true;
      return;
    }
    fail(unit_.empty()
             ? fmt::format("does not say its direction, world_from_{0} or {0}_from_world", thing)
             : fmt::format("has direction {0}, expected world_from_{1} or {1}_from_world",
                           in_quotes(unit_), thing),
         fmt::format("write {}[world_from_{}]", name_, thing));
  }

  void lens(std::string_view member) {
    constexpr std::array<std::string_view, 5> kNumbers = {"fov", "fx", "fy", "cx", "cy"};
    for (std::size_t i = 0; i < kNumbers.size(); ++i) {
      if (member != kNumbers[i]) continue;
      column_.kind = ColumnKind::lens;
      column_.component = i;
      return i == 0 ? unit(kAngles) : unit(kPixels);
    }
    unknown();
  }

  void joint(std::string_view target, std::string_view joint) {
    column_.kind = ColumnKind::joint;
    column_.target = target;
    if (const std::size_t colon = joint.rfind(':'); colon != joint.npos) {
      const std::string_view digits = joint.substr(colon + 1);
      std::size_t number = 0;
      const auto [end, error] =
          std::from_chars(digits.data(), digits.data() + digits.size(), number);
      if (error == std::errc() && end == digits.data() + digits.size()) {
        if (number < 1 || number > geometry::kMaxJointValues)
          return fail(fmt::format("names value {} of a joint, expected 1 to {}", number,
                                  geometry::kMaxJointValues));
        column_.component = number - 1;
        joint = joint.substr(0, colon);
      }
    }
    column_.joint = joint;
    if (joint.empty()) return fail("names no joint");
    unit(kJoints);
  }

  Input& input_;
  const bool strict_;
  Column column_;
  std::string_view name_;
  std::string_view unit_;
  bool closed_ = true;
};

}  // namespace

std::optional<Column> column_of(std::string_view header, Input& input, bool strict) {
  return HeaderParser(header, input, strict).parse();
}

}  // namespace panwright::scenario
