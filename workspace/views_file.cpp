// Views as JSON: a list of them in a file, or one alone.
#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "base/file.h"
#include "base/text.h"
#include "schemas/generated/views_schema.h"
#include "workspace/absent_options.h"
#include "workspace/internal/forward.h"
#include "workspace/internal/json_text.h"
#include "workspace/views.h"

namespace panwright::workspace {

namespace {

using nlohmann::json;
using schemas::ViewMember;
using schemas::ViewOption;

constexpr std::uint64_t kMaxViewsBytes = 256ull << 20;
constexpr std::size_t kMaxViews = 1'000'000;
constexpr std::size_t kMostOutputs = 16;
constexpr const char* kExample =
    "write a list of views, as [{\"camera\": [0, -5, 1], \"output\": \"a.png\"}] (docs/views.md)";

using Field = std::optional<std::string> ViewText::*;

// Where the value of a member is kept; null for what is no single text.
Field field_of(ViewOption option) {
  switch (option) {
    case ViewOption::size:
      return &ViewText::size;
    case ViewOption::ev:
      return &ViewText::ev;
    case ViewOption::tone:
      return &ViewText::tone;
    case ViewOption::layers:
      return &ViewText::layers;
    case ViewOption::compress:
      return &ViewText::compress;
    case ViewOption::camera:
      return &ViewText::camera;
    case ViewOption::look_at:
      return &ViewText::look_at;
    case ViewOption::up:
      return &ViewText::up;
    case ViewOption::quat:
      return &ViewText::quat;
    case ViewOption::camera_frame:
      return &ViewText::camera_frame;
    case ViewOption::fov:
      return &ViewText::fov;
    case ViewOption::ifov:
      return &ViewText::ifov;
    case ViewOption::intrinsics:
      return &ViewText::intrinsics;
    case ViewOption::ortho:
      return &ViewText::ortho;
    case ViewOption::sun:
      return &ViewText::sun;
    case ViewOption::sun_distance:
      return &ViewText::sun_distance;
    case ViewOption::sun_irradiance:
      return &ViewText::sun_irradiance;
    case ViewOption::white:
      return &ViewText::white;
    case ViewOption::limb_darkening:
      return &ViewText::limb_darkening;
    case ViewOption::engine:
      return &ViewText::engine;
    case ViewOption::quality:
      return &ViewText::quality;
    case ViewOption::samples:
      return &ViewText::samples;
    case ViewOption::pixel_error:
      return &ViewText::pixel_error;
    case ViewOption::adaptive:
      return &ViewText::adaptive;
    case ViewOption::flat:
      return &ViewText::flat;
    case ViewOption::specular_filter:
      return &ViewText::specular_filter;
    case ViewOption::shadows:
      return &ViewText::shadows;
    case ViewOption::sun_points:
      return &ViewText::sun_points;
    case ViewOption::shadow_side:
      return &ViewText::shadow_side;
    case ViewOption::levels:
      return &ViewText::levels;
    case ViewOption::imposters:
      return &ViewText::imposters;
    case ViewOption::flux_error:
      return &ViewText::flux_error;
    case ViewOption::psf:
      return &ViewText::psf;
    case ViewOption::until_error:
      return &ViewText::until_error;
    case ViewOption::max_samples:
      return &ViewText::max_samples;
    case ViewOption::bounces:
      return &ViewText::bounces;
    case ViewOption::seed:
      return &ViewText::seed;
    case ViewOption::no_sun_disc:
      return &ViewText::no_sun_disc;
    case ViewOption::max_image_memory:
      return &ViewText::max_image_memory;
    case ViewOption::name:
    case ViewOption::output:
    case ViewOption::outputs:
    case ViewOption::pose:
    case ViewOption::joint:
    case ViewOption::define:
    case ViewOption::targets:
      return nullptr;
  }
  return nullptr;
}

std::optional<ViewOption> find_member(std::string_view name) {
  for (std::size_t i = 0; i < std::size(schemas::kViewMembers); ++i)
    if (schemas::kViewMembers[i].name == name) return static_cast<ViewOption>(i);
  return std::nullopt;
}

const ViewMember& member_of(ViewOption option) {
  return schemas::kViewMembers[static_cast<std::size_t>(option)];
}

std::string number_text(const json& value) {
  if (value.is_number_unsigned()) return fmt::format("{}", value.get<std::uint64_t>());
  if (value.is_number_integer()) return fmt::format("{}", value.get<std::int64_t>());
  return format_double(value.get<double>());
}

// A JSON value as it would be typed; nothing where it has none of the forms.
std::optional<std::string> as_typed(const json& value, unsigned forms, const char* between = " ") {
  if (value.is_string() && (forms & schemas::kViewText) != 0) return value.get<std::string>();
  if (value.is_boolean() && (forms & schemas::kViewFlag) != 0)
    return value.get<bool>() ? "true" : "false";
  if (value.is_number() && (forms & schemas::kViewNumber) != 0) return number_text(value);
  if (!value.is_array() || value.empty()) return std::nullopt;
  std::string out;
  for (const json& item : value) {
    const bool number = item.is_number() && (forms & schemas::kViewNumbers) != 0;
    const bool text = item.is_string() && (forms & schemas::kViewTexts) != 0;
    if (!number && !text) return std::nullopt;
    out += (out.empty() ? "" : between) + (number ? number_text(item) : item.get<std::string>());
  }
  return out;
}

const char* type_of(const json& value) {
  if (value.is_array()) return value.empty() ? "an empty list" : "a list";
  if (value.is_object()) return "an object";
  if (value.is_string()) return "text";
  return value.is_null() ? "null" : value.is_boolean() ? "a truth value" : "a number";
}

// Reads the members of one view.
class OneViewReader {
 public:
  OneViewReader(std::size_t index, const std::string& file, DiagnosticLog& log)
      : index_(index), log_(log) {
    view_.file = file;
    view_.label = view_label(index, {});
  }
  bool ok() const { return ok_; }
  ViewText take() { return std::move(view_); }

  void repeated(const std::string& member) {
    fail(fmt::format("{} is given twice", in_quotes(member)));
  }

  // Before anything else: the name is part of the messages.
  void name(const json& item) {
    if (!item.is_object()) return;
    const auto found = item.find("name");
    if (found == item.end() || !found->is_string()) return;
    view_.name = found->get<std::string>();
    view_.label = view_label(index_, view_.name);
  }

  void read(const json& item) {
    if (!item.is_object())
      return fail(fmt::format("expected an object of options, found {}", type_of(item)));
    for (const auto& [key, value] : item.items()) {
      std::string member = key;
      std::replace(member.begin(), member.end(), '_', '-');
      const auto option = find_member(member);
      if (!option)
        unknown(key, member);
      else if (!given_.insert({*option, key}).second)
        fail(fmt::format("{} and {} are one option", in_quotes(given_[*option]), in_quotes(key)));
      else
        read_member(*option, key, value);
    }
    if (given_.contains(ViewOption::output) && given_.contains(ViewOption::outputs))
      fail("expected output or outputs, not both");
  }

  void require_output() {
    if (!view_.output && !given_.contains(ViewOption::output) &&
        !given_.contains(ViewOption::outputs))
      fail("no output, expected a file name, as \"output\": \"a.png\"");
  }

 private:
  void fail(const std::string& message, std::string hint = {}) {
    log_.report_file(Code::E0203, view_.file, view_.label + ": " + message, std::move(hint));
    ok_ = false;
  }

  void wrong_type(ViewOption option, const std::string& what, const json& value) {
    fail(fmt::format("{} has the wrong type, expected {}, found {}", what, member_of(option).expect,
                     type_of(value)));
  }

  void unknown(const std::string& key, const std::string& member) {
    std::vector<std::string_view> names;
    for (const ViewMember& each : schemas::kViewMembers) names.push_back(each.name);
    const std::string_view instead = instead_of(member);
    const auto near = nearest_name(member, names);
    fail(fmt::format("unknown option {}", in_quotes(key)),
         !instead.empty() ? std::string(instead)
         : near           ? fmt::format("did you mean '{}'?", *near)
                          : std::string());
  }

  void read_member(ViewOption option, const std::string& key, const json& value) {
    const ViewMember& member = member_of(option);
    const std::string what = in_quotes(key);
    if (const Field field = field_of(option)) {
      view_.*field = as_typed(value, member.forms, option == ViewOption::size ? "x" : " ");
      if (!(view_.*field)) wrong_type(option, what, value);
      return;
    }
    if (option == ViewOption::outputs || option == ViewOption::targets) {
      read_list(option, what, value);
    } else if (option == ViewOption::pose && !value.is_object()) {
      if (const auto text = as_typed(value, member.forms))
        view_.poses.push_back({{}, *text});
      else
        wrong_type(option, what, value);
    } else if (option == ViewOption::pose || option == ViewOption::joint ||
               option == ViewOption::define) {
      read_map(option, what, value);
    } else if (!value.is_string()) {
      wrong_type(option, what, value);
    } else if (option == ViewOption::output) {
      view_.output = value.get<std::string>();
    }
  }

  void read_list(ViewOption option, const std::string& what, const json& value) {
    const bool targets = option == ViewOption::targets;
    if (targets && value.is_object()) return read_map(option, what, value);
    if (!value.is_array() || value.empty()) return wrong_type(option, what, value);
    if (!targets && value.size() > kMostOutputs)
      return fail(fmt::format("{} outputs, expected at most {}", value.size(), kMostOutputs));
    for (const json& item : value) {
      if (!item.is_string())
        return wrong_type(option, what + " holds " + type_of(item) + " and", value);
      if (targets)
        view_.targets.push_back(item.get<std::string>());
      else if (!view_.output)
        view_.output = item.get<std::string>();
      else
        view_.more_outputs.push_back(item.get<std::string>());
    }
  }

  // Of targets, or of parameters.
  void read_map(ViewOption option, const std::string& what, const json& value) {
    if (!value.is_object()) return wrong_type(option, what, value);
    for (const auto& [name, item] : value.items()) {
      const auto text = as_typed(item, member_of(option).of);
      if (!text)
        wrong_type(option, what + " of " + in_quotes(name), item);
      else if (option == ViewOption::pose)
        view_.poses.push_back({name, *text});
      else if (option == ViewOption::joint)
        view_.joints.push_back({name, *text});
      else if (option == ViewOption::define)
        view_.defines.emplace_back(name, *text);
      else
        view_.targets.push_back(name + "=" + *text);
    }
  }

  std::size_t index_;
  DiagnosticLog& log_;
  ViewText view_;
  std::map<ViewOption, std::string> given_;  // and as it is written there
  bool ok_ = true;
};

// The second image of one file would replace the first.
bool check_outputs(const std::vector<ViewText>& views, const std::string& file,
                   DiagnosticLog& log) {
  std::map<std::filesystem::path, std::size_t> known;
  bool good = true;
  const auto check = [&](const std::string& output, std::size_t index) {
    const auto path = std::filesystem::path(output).lexically_normal();
    const auto [first, added] = known.emplace(path, index);
    if (added) return;
    good = false;
    log.report_file(
        Code::E0203, file,
        first->second == index
            ? fmt::format("{} has the output {} twice", views[index].label, in_quotes(output))
            : fmt::format("{} and {} have the same output, {}", views[first->second].label,
                          views[index].label, in_quotes(output)));
  };
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].output) check(*views[i].output, i);
    for (const std::string& output : views[i].more_outputs) check(output, i);
  }
  return good;
}

// Options of one group are alternatives: a view that gives one of them drops the default's others.
constexpr Field kGroups[][4] = {
    {&ViewText::camera, &ViewText::camera_frame, nullptr, nullptr},
    {&ViewText::look_at, &ViewText::quat, &ViewText::camera_frame, nullptr},
    {&ViewText::fov, &ViewText::ifov, &ViewText::intrinsics, &ViewText::ortho},
    {&ViewText::pixel_error, &ViewText::samples, nullptr, nullptr},
};
constexpr Field kOfGl[] = {&ViewText::quality,        &ViewText::pixel_error, &ViewText::adaptive,
                           &ViewText::shadow_side,    &ViewText::levels,      &ViewText::imposters,
                           &ViewText::flux_error,     &ViewText::shadows,     &ViewText::sun_points,
                           &ViewText::specular_filter};
constexpr Field kOfReference[] = {&ViewText::until_error, &ViewText::max_samples,
                                  &ViewText::bounces, &ViewText::seed, &ViewText::no_sun_disc};

}  // namespace

ViewText with_defaults(ViewText view, const ViewText& defaults) {
  ViewText base = defaults;
  for (const auto& group : kGroups) {
    bool any = false;
    for (const Field field : group) any = any || (field != nullptr && (view.*field).has_value());
    for (const Field field : group)
      if (any && field != nullptr) (base.*field).reset();
  }
  if (view.samples == "auto") base.adaptive.reset();
  if (view.shadows == "hard" || view.shadows == "off") base.sun_points.reset();
  if (view.shadows == "off") base.shadow_side.reset();
  if (base.shadows == "off" && (view.shadow_side || view.sun_points)) base.shadows.reset();
  if (view.engine && *view.engine != base.engine.value_or("gl")) {
    for (const Field field : kOfGl) (base.*field).reset();
    for (const Field field : kOfReference) (base.*field).reset();
    if (base.samples == "auto") base.samples.reset();
  }
  for (std::size_t i = 0; i < std::size(schemas::kViewMembers); ++i)
    if (const Field field = field_of(static_cast<ViewOption>(i)); field && !(view.*field))
      view.*field = base.*field;
  if (!view.output) {
    view.output = base.output;
    view.more_outputs = base.more_outputs;
  }
  if (view.targets.empty()) view.targets = base.targets;
  // the view's come later, so that they replace the default's
  view.poses.insert(view.poses.begin(), base.poses.begin(), base.poses.end());
  view.joints.insert(view.joints.begin(), base.joints.begin(), base.joints.end());
  for (const auto& define : base.defines)
    if (std::none_of(view.defines.begin(), view.defines.end(),
                     [&](const auto& own) { return own.first == define.first; }))
      view.defines.push_back(define);
  return view;
}

Result<std::vector<ViewText>> read_views(const std::filesystem::path& path,
                                         const ViewText& defaults, DiagnosticLog& log) {
  const auto text = read_file(path, kMaxViewsBytes, log);
  if (!text) return failed;
  return parse_views(*text, path.string(), defaults, log);
}

Result<std::vector<ViewText>> parse_views(std::string_view text, const std::string& name,
                                          const ViewText& defaults, DiagnosticLog& log) {
  const auto fail = [&](const std::string& message, const std::string& hint = {}) {
    log.report_file(Code::E0203, name, message, hint);
    return failed;
  };
  JsonProblem problem;
  const auto parsed = parse_json(text, problem);
  if (!parsed) return fail(problem.message, problem.other_format ? kExample : problem.hint);
  const json& list = parsed->value;
  if (!list.is_array() || list.empty())
    return fail(fmt::format("expected a list of at least one view, each an object, found {}",
                            type_of(list)),
                list.is_object() ? "put the view into a list: [{…}]" : "");
  if (list.size() > kMaxViews)
    return fail(fmt::format("{} views, expected at most {}", list.size(), kMaxViews));
  std::vector<ViewText> views;
  const auto read = [&](bool with_values, DiagnosticLog& to) {
    views.clear();
    bool good = true;
    std::size_t repeated = 0;
    for (const json& item : list) {
      OneViewReader reader(views.size(), name, to);
      reader.name(item);
      for (; repeated < parsed->repeated.size() && parsed->repeated[repeated].item == views.size();
           ++repeated)
        reader.repeated(parsed->repeated[repeated].member);
      reader.read(item);
      if (item.is_object() && reader.ok()) reader.require_output();
      good = good && reader.ok();
      views.push_back(with_defaults(reader.take(), defaults));
      if (with_values) check_values(views.back(), to);
    }
    return check_outputs(views, name, to) && good;
  };
  DiagnosticLog apart = log.apart();
  if (read(false, apart)) return views;
  // values too, so that one run reports every problem, view by view
  (void)read(true, log);
  return failed;
}

bool parse_view(std::string_view text, std::size_t index, const ViewText& defaults, ViewText& view,
                DiagnosticLog& log) {
  view = {};
  view.label = view_label(index, {});
  JsonProblem problem;
  const auto parsed = parse_json(text, problem);
  if (!parsed) {
    log.report_file(Code::E0203, {}, view.label + ": " + problem.message, problem.hint);
    return false;
  }
  OneViewReader reader(index, {}, log);
  reader.name(parsed->value);
  for (const JsonText::Repeated& each : parsed->repeated) reader.repeated(each.member);
  reader.read(parsed->value);
  view = with_defaults(reader.take(), defaults);
  return reader.ok();
}

}  // namespace panwright::workspace
