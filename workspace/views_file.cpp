#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file.h"
#include "base/text.h"
#include "workspace/views.h"

namespace panwright::workspace {

namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kMaxBytes = 256ull << 20;
constexpr std::size_t kMaxViews = 1'000'000;

struct Field {
  std::string_view name;
  std::optional<std::string> ViewText::*member;
};

constexpr Field kFields[] = {
    {"camera", &ViewText::camera},
    {"look-at", &ViewText::look_at},
    {"up", &ViewText::up},
    {"quat", &ViewText::quat},
    {"camera-frame", &ViewText::camera_frame},
    {"sun", &ViewText::sun},
    {"sun-distance", &ViewText::sun_distance},
    {"sun-irradiance", &ViewText::sun_irradiance},
    {"fov", &ViewText::fov},
    {"ifov", &ViewText::ifov},
    {"intrinsics", &ViewText::intrinsics},
    {"ortho", &ViewText::ortho},
    {"size", &ViewText::size},
    {"ev", &ViewText::ev},
    {"output", &ViewText::output},
};

// Options of one group are alternatives: a view that gives one of them drops the default's others.
constexpr std::string_view kGroups[][4] = {
    {"camera", "camera-frame", "", ""},
    {"look-at", "quat", "camera-frame", ""},
    {"fov", "ifov", "intrinsics", "ortho"},
};

constexpr std::string_view kPose = "pose";

const Field* find_field(std::string_view name) {
  for (const Field& field : kFields)
    if (field.name == name) return &field;
  return nullptr;
}

// A JSON value as it would be typed: numbers and arrays of numbers become text.
std::optional<std::string> as_typed(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number()) return format_double(value.get<double>());
  if (!value.is_array() || value.empty()) return std::nullopt;
  std::string out;
  for (const Json& item : value) {
    if (!item.is_number()) return std::nullopt;
    out += (out.empty() ? "" : " ") + format_double(item.get<double>());
  }
  return out;
}

class ViewsReader {
 public:
  ViewsReader(const std::filesystem::path& path, const ViewText& defaults, DiagnosticLog& log)
      : path_(path), defaults_(defaults), log_(log) {}

  Result<std::vector<ViewText>> read() {
    const auto text = read_file(path_, kMaxBytes, log_);
    if (!text) return failed;
    Json json;
    try {
      json = Json::parse(*text, [&](int, Json::parse_event_t event, Json& parsed) {
        note_keys(event, parsed);
        return true;
      });
    } catch (const Json::parse_error& error) {
      return fail(not_json(*text, error.byte));
    } catch (const Json::exception& error) {
      return fail(fmt::format("the JSON text cannot be read: {}", error.what()));
    }
    if (!json.is_array() || json.empty())
      return fail("expected a list of at least one view, each an object");
    if (json.size() > kMaxViews)
      return fail(fmt::format("{} views, expected at most {}", json.size(), kMaxViews));
    std::vector<ViewText> views;
    for (const Json& item : json) views.push_back(one(item, views.size()));
    check_outputs(views);
    if (!ok_) return failed;
    return views;
  }

 private:
  // A repeated member of an object: JSON does not define which of them counts.
  void note_keys(Json::parse_event_t event, const Json& parsed) {
    if (event == Json::parse_event_t::object_start) {
      open_.emplace_back();
    } else if (event == Json::parse_event_t::object_end) {
      open_.pop_back();
      ended_ += open_.empty();
    } else if (event == Json::parse_event_t::key && !open_.back().insert(parsed).second) {
      fail(fmt::format("view {} gives {} twice", ended_, in_quotes(parsed.get<std::string>())));
    }
  }

  // The second image of one file would replace the first.
  void check_outputs(const std::vector<ViewText>& views) {
    std::map<std::filesystem::path, std::size_t> known;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!views[i].output) continue;
      const auto path = std::filesystem::path(*views[i].output).lexically_normal();
      if (const auto [first, added] = known.emplace(path, i); !added)
        fail(fmt::format("views {} and {} have the same output, {}", first->second, i,
                         in_quotes(*views[i].output)));
    }
  }

  static std::string not_json(const std::string& text, std::size_t byte) {
    const std::size_t end = std::min(byte, text.size());
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(end), '\n');
    return fmt::format("invalid JSON at line {}, byte {}", line, byte);
  }

  Failed fail(std::string message, std::string hint = {}) {
    log_.report_file(Code::E0203, path_.string(), std::move(message), std::move(hint));
    ok_ = false;
    return failed;
  }

  ViewText one(const Json& item, std::size_t index) {
    ViewText given;
    if (!item.is_object()) {
      fail(fmt::format("view {} is not an object of options", index));
      return given;
    }
    for (const auto& [key, value] : item.items()) {
      std::string name = key;
      std::replace(name.begin(), name.end(), '_', '-');
      if (name == kPose) {
        read_poses(value, index, given);
        continue;
      }
      const Field* field = find_field(name);
      if (field == nullptr) {
        unknown(index, key, name);
        continue;
      }
      given.*field->member = as_typed(value);
      if (!(given.*field->member))
        fail(fmt::format(
            "view {}: '{}' has the wrong type, expected text, a number or a list of numbers", index,
            key));
    }
    if (!given.output) fail(fmt::format("view {} has no output, expected a file name", index));
    inherit(given);
    return given;
  }

  // For the one target, or an object of targets.
  void read_poses(const Json& value, std::size_t index, ViewText& given) {
    if (value.is_object()) {
      for (const auto& [target, pose] : value.items()) {
        const auto text = as_typed(pose);
        if (text)
          given.poses.push_back({target, *text});
        else
          fail(fmt::format(
              "view {}: the pose of {} has the wrong type, expected text or a list of numbers",
              index, in_quotes(target)));
      }
    } else if (const auto text = as_typed(value)) {
      given.poses.push_back({{}, *text});
    } else {
      fail(fmt::format(
          "view {}: '{}' has the wrong type, expected text, a number or a list of numbers", index,
          kPose));
    }
  }

  void unknown(std::size_t index, const std::string& key, const std::string& name) {
    std::vector<std::string_view> names{kPose};
    for (const Field& field : kFields) names.push_back(field.name);
    const auto near = nearest_name(name, names);
    fail(fmt::format("view {} has the unknown option {}", index, in_quotes(key)),
         near ? fmt::format("did you mean '{}'?", *near) : std::string());
  }

  void inherit(ViewText& given) const {
    ViewText base = defaults_;
    for (const auto& group : kGroups) {
      bool any = false;
      for (const std::string_view name : group)
        any = any || (!name.empty() && (given.*find_field(name)->member).has_value());
      for (const std::string_view name : group)
        if (any && !name.empty()) (base.*find_field(name)->member).reset();
    }
    for (const Field& field : kFields)
      if (!(given.*field.member)) given.*field.member = base.*field.member;
    // the view's come later, so that they replace the default's
    given.poses.insert(given.poses.begin(), base.poses.begin(), base.poses.end());
  }

  const std::filesystem::path& path_;
  const ViewText& defaults_;
  DiagnosticLog& log_;
  std::vector<std::set<std::string>> open_;  // members of the objects that are being read
  std::size_t ended_ = 0;                    // views that have been read
  bool ok_ = true;
};

}  // namespace

Result<std::vector<ViewText>> read_views(const std::filesystem::path& path,
                                         const ViewText& defaults, DiagnosticLog& log) {
  return ViewsReader(path, defaults, log).read();
}

}  // namespace panwright::workspace
