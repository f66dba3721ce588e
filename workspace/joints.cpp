#include "workspace/joints.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/angle_text.h"
#include "base/file.h"
#include "base/text.h"
#include "workspace/internal/json_text.h"
#include "workspace/quantities.h"
#include "world/aim.h"

namespace panwright::workspace {

namespace {

using geometry::JointUnit;
using geometry::JointValues;
using nlohmann::json;

constexpr std::size_t kMaxBytes = 16u << 20;
// Of a value, in radians, metres or as a factor: what leaves a scene something to compute with.
constexpr double kLargest = 1e9;

std::optional<double> value_of(std::string_view text, JointUnit unit) {
  switch (unit) {
    case JointUnit::radians:
      return parse_angle(text);
    case JointUnit::metres:
      return parse_length(text);
    case JointUnit::factor:
      return parse_share(text);
  }
  return std::nullopt;
}

const char* expected_of(JointUnit unit) {
  switch (unit) {
    case JointUnit::radians:
      return "an angle, as 30deg, 0.5rad or 30 (degrees)";
    case JointUnit::metres:
      return "a length, as 0.2m, 20cm or 0.2 (metres)";
    case JointUnit::factor:
      return "a factor, as 0.5 or 50%";
  }
  return "";
}

std::string shown(JointUnit unit, double value) {
  switch (unit) {
    case JointUnit::radians:
      return fmt::format("{:.6g} deg", value / kDegree);
    case JointUnit::metres:
      return fmt::format("{:.6g} m", value);
    case JointUnit::factor:
      return fmt::format("{:.6g}", value);
  }
  return "";
}

const pan::layout::Joint& record_of(const world::World& world, const JointPlace& place) {
  return world[place.target].model()->joints()[place.joint];
}

std::string name_of(const world::World& world, const JointPlace& place) {
  const std::string joint(world[place.target].model()->joint_name(place.joint));
  return in_quotes(world.size() == 1 ? joint : world[place.target].name() + "/" + joint);
}

// The values of a text; nothing, and why in `problem`. An angle may look like radians.
std::optional<JointValues> values_of(const pan::layout::Joint& joint, const JointText& text,
                                     std::string& problem,
                                     std::optional<RadiansWarning>& suspicious) {
  const auto kind = static_cast<geometry::JointKind>(joint.kind);
  const std::size_t count = geometry::value_count(kind);
  const auto words = words_of(text.value);
  if (words.size() != count) {
    problem = count == 0 ? std::string("is fixed and takes no value")
                         : fmt::format("is {} and takes {}, found {}", geometry::kind_name(kind),
                                       counted(count, "value"), words.size());
    return std::nullopt;
  }
  JointValues out{};
  for (std::size_t i = 0; i < count; ++i) {
    const JointUnit unit = geometry::unit_of(kind, i);
    const auto value = value_of(words[i], unit);
    if (!value || !std::isfinite(*value)) {
      problem = fmt::format("is {}: {} is not {}", geometry::kind_name(kind), in_quotes(words[i]),
                            expected_of(unit));
      return std::nullopt;
    }
    out[i] = *value;
    if (unit == JointUnit::radians && !suspicious) suspicious = warning_of_radians(words[i]);
    const bool limited =
        (joint.flags & pan::layout::kJointLimited) != 0 && kind != geometry::JointKind::continuous;
    double low = limited ? joint.lower[i] : -kLargest, high = limited ? joint.upper[i] : kLargest;
    // what is meant as the limit is the limit: 90deg may be an ulp beyond 1.5707963267948966
    const double slack = 4e-16 * std::max(std::fabs(low), std::fabs(high));
    if (!(out[i] >= low - slack && out[i] <= high + slack)) {
      problem = fmt::format("goes from {} to {}, found {}", shown(unit, low), shown(unit, high),
                            shown(unit, out[i]));
      return std::nullopt;
    }
    out[i] = std::min(std::max(out[i], low), high);
    if (unit == JointUnit::factor && out[i] == 0) {
      problem = "takes a factor, which cannot be 0";
      return std::nullopt;
    }
  }
  return out;
}

}  // namespace

JointText joint_text(std::string_view text) {
  const std::size_t sign = text.find('=');
  if (sign == text.npos) return {std::string(text), {}};
  return {std::string(text.substr(0, sign)), std::string(text.substr(sign + 1))};
}

Result<std::vector<JointText>> read_joints(const std::filesystem::path& path, DiagnosticLog& log) {
  const auto text = read_file(path, kMaxBytes, log);
  if (!text) return failed;
  const auto fail = [&](const std::string& message, const std::string& hint = {}) {
    log.report_file(Code("E0203"), path.string(), message, hint);
    return failed;
  };
  JsonProblem problem;
  const auto parsed = parse_json(*text, problem);
  if (!parsed)
    return fail(problem.message, problem.other_format ? "write an object of joint values, as "
                                                        "{\"wing\": \"30deg\"}"
                                                      : problem.hint);
  if (!parsed->repeated.empty())
    return fail(fmt::format("{} is given twice", in_quotes(parsed->repeated[0].member)));
  if (!parsed->value.is_object())
    return fail("expected an object of joint values, as {\"wing\": \"30deg\"}");
  std::vector<JointText> out;
  for (const auto& [name, value] : parsed->value.items()) {
    std::string typed;
    if (value.is_string())
      typed = value.get<std::string>();
    else if (value.is_number())
      typed = format_double(value.get<double>());
    else if (value.is_array() && !value.empty() &&
             std::all_of(value.begin(), value.end(), [](const json& v) { return v.is_number(); }))
      for (const json& each : value) typed += format_double(each.get<double>()) + " ";
    else
      return fail(fmt::format("{} has the wrong type, expected a number, numbers or text",
                              in_quotes(name)));
    out.push_back({name, typed});
  }
  return out;
}

Result<JointPlace> find_joint(std::string_view name, const world::World& world,
                              DiagnosticLog& log) {
  const auto in = [&](std::size_t target, std::string_view joint) -> std::optional<JointPlace> {
    const auto found = world[target].model()->find_joint(joint);
    if (!found) return std::nullopt;
    return JointPlace{target, static_cast<std::uint32_t>(*found)};
  };
  // a joint of a used part has a slash in its name, and so may a target
  for (std::size_t at = name.find('/'); at != name.npos; at = name.find('/', at + 1))
    if (const auto target = world.find(name.substr(0, at)))
      if (const auto place = in(*target, name.substr(at + 1))) return *place;
  std::vector<JointPlace> having;
  for (std::size_t i = 0; i < world.size(); ++i)
    if (const auto place = in(i, name)) having.push_back(*place);
  if (having.size() == 1) return having[0];
  if (having.size() > 1) {
    std::string names;
    for (const JointPlace& place : having)
      names += (names.empty() ? "" : ", ") +
               in_quotes(world[place.target].name() + "/" + std::string(name));
    log.report(Code("E5013"), {},
               fmt::format("{} targets have a joint {}", having.size(), in_quotes(name)),
               "name one of " + names);
    return failed;
  }
  std::vector<std::string> known;
  for (const world::Instance& target : world.instances())
    for (std::size_t j = 0; j < target.model()->joints().size(); ++j)
      known.push_back((world.size() > 1 ? target.name() + "/" : "") +
                      std::string(target.model()->joint_name(j)));
  std::vector<std::string_view> names(known.begin(), known.end());
  const auto near = nearest_name(name, names);
  std::string message = fmt::format("unknown joint {}", in_quotes(name));
  if (known.empty()) {
    message += "; there are none";
  } else if (!near) {
    message += ", expected ";
    for (std::size_t i = 0; i < known.size() && i < 10; ++i)
      message += (i ? ", " : "") + in_quotes(known[i]);
    if (known.size() > 10) message += fmt::format(" and {} more", known.size() - 10);
  }
  log.report(Code("E5013"), {}, message, near ? fmt::format("did you mean '{}'?", *near) : "");
  return failed;
}

bool JointSetter::set(const JointText& text, DiagnosticLog& log) {
  if (text.joint.empty() || text.value.empty()) {
    log.report(Code("E0201"), {},
               fmt::format("--joint {}: NAME=VALUE is needed, as in --joint wing=30deg",
                           in_quotes(text.joint)));
    return false;
  }
  const auto place = find_joint(text.joint, world_, log);
  if (!place) return false;
  const pan::layout::Joint& record = record_of(world_, *place);
  const auto refuse = [&](const std::string& problem) {
    log.report(Code("E5014"), {}, fmt::format("joint {} {}", name_of(world_, *place), problem));
    return false;
  };
  if (record.mimic >= 0)
    return refuse(
        fmt::format("follows {}: give that one a value",
                    name_of(world_, {place->target, static_cast<std::uint32_t>(record.mimic)})));
  // what is given later replaces an aim
  std::erase_if(aims_, [&](const Aim& other) {
    return other.place.target == place->target && other.place.joint == place->joint;
  });
  if (text.value[0] == '@') {
    if (!world::can_aim(*world_[place->target].model(), place->joint))
      return refuse("has no pointing direction, and cannot be aimed");
    aims_.push_back({*place, text});
    return true;
  }
  std::string problem;
  std::optional<RadiansWarning> suspicious;
  const auto values = values_of(record, text, problem, suspicious);
  if (suspicious)
    log.report(Code("W1214"), {},
               fmt::format("joint {}: {}", name_of(world_, *place), suspicious->message),
               suspicious->hint);
  if (!values) return refuse(problem);
  world_.set_joint(place->target, place->joint, *values);
  return true;
}

bool JointSetter::aim(const Aim& aim, const std::optional<Vec3>& camera, DiagnosticLog& log) {
  const std::string what = aim.text.value.substr(1);
  const std::size_t target = aim.place.target;
  world::Aimed found;
  if (what == "sun") {
    found = world::aim(world_, target, aim.place.joint, world_.sun().direction);
  } else if (what == "camera" && camera) {
    found = world::aim_at_point(world_, target, aim.place.joint, *camera);
  } else if (const auto other = world_.find(what); other && *other != target) {
    found = world::aim_at_point(world_, target, aim.place.joint, world_[*other].pose().translation);
  } else if (const auto v = parse_numbers(what, 3); v && ((*v)[0] || (*v)[1] || (*v)[2])) {
    found = world::aim(world_, target, aim.place.joint, Vec3((*v)[0], (*v)[1], (*v)[2]));
  } else {
    log.report(Code("E5014"), {},
               fmt::format("joint {} cannot aim at {}, expected @sun, {}the name of another "
                           "target, or a direction, as \"@0 0 1\"",
                           name_of(world_, aim.place), in_quotes(what), camera ? "@camera, " : ""));
    return false;
  }
  if (found.limited())
    log.report(
        Code("W5015"), {},
        fmt::format("joint {} points {:.4g} deg past what it aims at, as close as its limits allow",
                    name_of(world_, aim.place), found.error / kDegree));
  return true;
}

bool JointSetter::set_aims(const std::optional<Vec3>& camera, DiagnosticLog& log) {
  bool good = true;
  // outer joints first: they carry the others along
  std::ranges::stable_sort(aims_, {},
                           [](const Aim& a) { return std::pair(a.place.target, a.place.joint); });
  for (const Aim& each : aims_) good = aim(each, camera, log) && good;
  world::aim_at_sun(world_, [&](std::size_t target, std::uint32_t joint, double error) {
    log.report(Code("W5015"), {},
               fmt::format("joint {} points {:.4g} deg past the Sun, as close as its limits allow",
                           name_of(world_, {target, joint}), error / kDegree));
  });
  return good;
}

std::string exact_value(geometry::JointKind kind, const JointValues& values) {
  std::string out;
  for (std::size_t i = 0; i < geometry::value_count(kind); ++i) {
    const JointUnit unit = geometry::unit_of(kind, i);
    out += (i ? " " : "") + format_double(values[i]) +
           (unit == JointUnit::radians  ? "rad"
            : unit == JointUnit::metres ? "m"
                                        : "");
  }
  return out;
}

std::string shown_value(geometry::JointKind kind, const JointValues& values) {
  std::string out;
  for (std::size_t i = 0; i < geometry::value_count(kind); ++i)
    out += (i ? ", " : "") + shown(geometry::unit_of(kind, i), values[i]);
  return out;
}

}  // namespace panwright::workspace
