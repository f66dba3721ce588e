// Views as JSON: a list of them in a file, or one alone.
#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "base/file.h"
#include "base/text.h"
#include "workspace/absent_options.h"
#include "workspace/internal/forward.h"
#include "workspace/internal/json_text.h"
#include "workspace/internal/setting_json.h"
#include "workspace/views.h"

namespace panwright::workspace {

namespace {

using nlohmann::json;

constexpr std::uint64_t kMaxViewsBytes = 256ull << 20;
constexpr std::size_t kMaxViews = 1'000'000;
constexpr std::size_t kMostOutputs = 16;
constexpr const char* kExample =
    "write a list of views, as [{\"camera\": [0, -5, 1], \"output\": \"a.png\"}] (docs/views.md)";

std::optional<SettingId> find_member(std::string_view name) {
  for (std::size_t i = 0; i < std::size(kSettings); ++i)
    if (kSettings[i].name == name) return static_cast<SettingId>(i);
  return std::nullopt;
}

// Reads the members of one view.
class OneViewReader {
 public:
  // streams: a line of a stream, with the members of one
  OneViewReader(std::size_t index, const std::string& file, bool streams, DiagnosticLog& log)
      : index_(index), streams_(streams), log_(log) {
    view_.file = file;
    view_.label = view_label(index, {});
  }
  bool ok() const { return ok_; }
  View take_with(const Settings& defaults) {
    view_.settings = with_defaults(std::move(view_.settings), defaults);
    return std::move(view_);
  }

  void repeated(const std::string& member) {
    fail(fmt::format("{} is given twice", in_quotes(member)));
  }

  // Before anything else: the name is part of the messages.
  void name(const json& item) {
    if (!item.is_object()) return;
    const auto found = item.find("name");
    if (found == item.end() || !found->is_string()) return;
    view_.label = view_label(index_, found->get<std::string>());
  }

  void read(const json& item) {
    if (!item.is_object())
      return fail(fmt::format("expected an object of options, found {}", json_type(item)));
    for (const auto& [key, value] : item.items()) {
      std::string member = key;
      std::replace(member.begin(), member.end(), '_', '-');
      const auto id = find_member(member);
      if (streams_ && key == "image")
        read_reply(value);
      else if (!id)
        unknown(key, member);
      else if (!given_.insert({*id, key}).second)
        fail(fmt::format("{} and {} are one option", in_quotes(given_[*id]), in_quotes(key)));
      else
        read_member(*id, key, value);
    }
    if (given_.contains(SettingId::output) && given_.contains(SettingId::outputs))
      fail("expected output or outputs, not both");
    if (view_.reply != ImageReply::files &&
        (given_.contains(SettingId::output) || given_.contains(SettingId::outputs)))
      fail("expected an output or image, not both");
  }

  void require_output() {
    if (!given_.contains(SettingId::output) && !given_.contains(SettingId::outputs))
      fail("no output, expected a file name, as \"output\": \"a.png\"");
  }

 private:
  void fail(const std::string& message, std::string hint = {}) {
    log_.report_file(Code("E0203"), view_.file, view_.label + ": " + message, std::move(hint));
    ok_ = false;
  }

  void unknown(const std::string& key, const std::string& member) {
    std::vector<std::string_view> names;
    for (const SettingInfo& each : kSettings) names.push_back(each.name);
    const std::string_view instead = instead_of(member);
    const auto near = nearest_name(member, names);
    fail(fmt::format("unknown option {}", in_quotes(key)),
         !instead.empty() ? std::string(instead)
         : near           ? fmt::format("did you mean '{}'?", *near)
                          : std::string());
  }

  void read_reply(const json& value) {
    if (value == "inline")
      view_.reply = ImageReply::inlined;
    else if (value == "shared")
      view_.reply = ImageReply::shared;
    else
      fail("'image' has another value than 'inline' or 'shared'");
  }

  void read_member(SettingId id, const std::string& key, const json& value) {
    if (const std::string wrong = wrong_type(id, value); !wrong.empty())
      return fail(in_quotes(key) + wrong);
    if (id == SettingId::outputs && value.size() > kMostOutputs)
      return fail(fmt::format("{} outputs, expected at most {}", value.size(), kMostOutputs));
    DiagnosticLog apart = log_.apart();
    ok_ = read_setting(id, value, view_.settings, apart) && ok_;
    forward(apart, view_.label, view_.file, log_);
  }

  std::size_t index_;
  bool streams_;
  DiagnosticLog& log_;
  View view_;
  std::map<SettingId, std::string> given_;  // and as it is written there
  bool ok_ = true;
};

// The second image of one file would replace the first.
bool distinct_outputs(const std::vector<View>& views, const std::string& file, DiagnosticLog& log) {
  std::map<std::filesystem::path, std::size_t> known;
  bool good = true;
  const auto check = [&](const std::string& output, std::size_t index) {
    const auto path = std::filesystem::path(output).lexically_normal();
    const auto [first, added] = known.emplace(path, index);
    if (added) return;
    good = false;
    log.report_file(
        Code("E0203"), file,
        first->second == index
            ? fmt::format("{} has the output {} twice", views[index].label, in_quotes(output))
            : fmt::format("{} and {} have the same output, {}", views[first->second].label,
                          views[index].label, in_quotes(output)));
  };
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const std::string& output : *views[i].settings.outputs) check(output, i);
  }
  return good;
}

}  // namespace

Result<std::vector<View>> read_views(const std::filesystem::path& path, const Settings& defaults,
                                     DiagnosticLog& log) {
  const auto text = read_file(path, kMaxViewsBytes, log);
  if (!text) return failed;
  return parse_views(*text, path.string(), defaults, log);
}

Result<std::vector<View>> parse_views(std::string_view text, const std::string& name,
                                      const Settings& defaults, DiagnosticLog& log) {
  const auto fail = [&](const std::string& message, const std::string& hint = {}) {
    log.report_file(Code("E0203"), name, message, hint);
    return failed;
  };
  JsonProblem problem;
  const bool lines = name.ends_with(".jsonl");
  const auto parsed = lines ? parse_json_lines(text, problem) : parse_json(text, problem);
  if (!parsed) return fail(problem.message, problem.other_format ? kExample : problem.hint);
  const json& list = parsed->value;
  if (lines && list.empty()) return fail("expected a view or more, one a line, found blank lines");
  if (!list.is_array() || list.empty())
    return fail(fmt::format("expected a list of at least one view, each an object, found {}",
                            json_type(list)),
                list.is_object() ? "put the view into a list: [{…}]" : "");
  if (list.size() > kMaxViews)
    return fail(fmt::format("{} views, expected at most {}", list.size(), kMaxViews));
  std::vector<View> views;
  bool good = true;
  std::size_t repeated = 0;
  for (const json& item : list) {
    OneViewReader reader(views.size(), name, false, log);
    reader.name(item);
    for (; repeated < parsed->repeated.size() && parsed->repeated[repeated].item == views.size();
         ++repeated)
      reader.repeated(parsed->repeated[repeated].member);
    reader.read(item);
    if (item.is_object() && reader.ok()) reader.require_output();
    views.push_back(reader.take_with(defaults));
    // contradictions too, so that one run reports every problem, view by view
    good = check(views.back(), log) && reader.ok() && good;
  }
  good = distinct_outputs(views, name, log) && good;
  if (!good) return failed;
  return views;
}

bool parse_view(std::string_view text, std::size_t index, const Settings& defaults, View& view,
                DiagnosticLog& log) {
  view = {};
  view.label = view_label(index, {});
  JsonProblem problem;
  const auto parsed = parse_json(text, problem);
  if (!parsed) {
    log.report_file(Code("E0203"), {}, view.label + ": " + problem.message, problem.hint);
    return false;
  }
  OneViewReader reader(index, {}, true, log);
  reader.name(parsed->value);
  for (const JsonText::Repeated& each : parsed->repeated) reader.repeated(each.member);
  reader.read(parsed->value);
  view = reader.take_with(defaults);
  return reader.ok();
}

}  // namespace panwright::workspace
