#include "studio/script.h"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "base/text.h"

namespace panwright::studio {
namespace {

using ScriptJson = nlohmann::json;

constexpr std::uint64_t kMaxScriptBytes = 1 << 20;
constexpr int kMaxRepeatDepth = 8;
constexpr std::size_t kMaxSteps = 100000;  // unrolled
constexpr int kMaxAmount = 100000;         // frames, pixels, steps of the wheel

struct ScriptError {
  std::string what;
};

std::string script_text(const ScriptJson& json, const char* what) {
  if (json.is_string()) return json.get<std::string>();
  if (json.is_number()) return json.dump();
  throw ScriptError{fmt::format("{} must be a string", what)};
}

Vec2 script_pair(const ScriptJson& json, const char* what) {
  if (!json.is_array() || json.size() != 2 || !json[0].is_number() || !json[1].is_number())
    throw ScriptError{fmt::format("{} must be two numbers", what)};
  const Vec2 pair(json[0].get<double>(), json[1].get<double>());
  if (!(std::fabs(pair.x) <= kMaxAmount && std::fabs(pair.y) <= kMaxAmount))
    throw ScriptError{fmt::format("{} must be two numbers of at most {}", what, kMaxAmount)};
  return pair;
}

const ScriptJson& script_member(const ScriptJson& json, const char* name) {
  if (!json.is_object() || !json.contains(name))
    throw ScriptError{fmt::format("'{}' is missing", name)};
  return json[name];
}

Step parsed_step(const std::string& kind, const ScriptJson& json) {
  Step step;
  if (kind == "click" || kind == "key" || kind == "screenshot") {
    step.kind = kind == "click" ? Step::Kind::click
                : kind == "key" ? Step::Kind::key
                                : Step::Kind::screenshot;
    step.name = script_text(json, kind.c_str());
    if (step.name.empty()) throw ScriptError{fmt::format("{} is without a name", in_quotes(kind))};
  } else if (kind == "type" || kind == "expect") {
    step.kind = kind == "type" ? Step::Kind::type : Step::Kind::expect;
    if (!json.is_array() || json.size() != 2)
      throw ScriptError{
          fmt::format("'{}' takes a name and a value, as [\"camera/range\", \"12\"]", kind)};
    step.name = script_text(json[0], "the name");
    step.value = script_text(json[1], "the value");
  } else if (kind == "drag") {
    step.kind = Step::Kind::drag;
    step.from = script_pair(script_member(json, "from"), "'from'");
    step.to = script_pair(script_member(json, "to"), "'to'");
    if (json.contains("button")) {
      const std::string button = script_text(json["button"], "'button'");
      const auto known = std::string_view("left right middle").find(button);
      if (known == std::string_view::npos || button.empty())
        throw ScriptError{"'button' is left, right or middle"};
      step.button = button == "left" ? 0 : button == "right" ? 1 : 2;
    }
    step.amount = 12;
    if (json.contains("frames")) {
      const ScriptJson& frames = json["frames"];
      if (!frames.is_number_integer() || frames < 1 || frames > kMaxAmount)
        throw ScriptError{fmt::format("'frames' is 1 to {}", kMaxAmount)};
      step.amount = frames.get<double>();
    }
  } else if (kind == "scroll") {
    step.kind = Step::Kind::scroll;
    step.amount = json.is_number() ? json.get<double>() : HUGE_VAL;
    if (!(std::fabs(step.amount) <= kMaxAmount))
      throw ScriptError{"'scroll' takes the wheel's steps, as 3 or -3"};
  } else if (kind == "wait") {
    step.kind = Step::Kind::wait;
    if (json.is_number())
      step.amount = json.get<double>();
    else
      step.name = script_text(json, "'wait'");
    if (!(step.amount >= 0 && step.amount <= kMaxAmount))
      throw ScriptError{fmt::format("'wait' takes 0 to {} frames", kMaxAmount)};
    if (!json.is_number() && step.name != "exact" && step.name != "read" && step.name != "saved" &&
        step.name != "compared" && step.name != "sampled" && step.name != "video" &&
        step.name != "played")
      throw ScriptError{
          "'wait' takes exact, compared, sampled, read, saved, video, played or a number of "
          "frames"};
  } else if (kind == "resize") {
    step.kind = Step::Kind::resize;
    step.to = script_pair(json, "'resize'");
    if (!(step.to.x >= 320 && step.to.y >= 240 && step.to.x <= 16384 && step.to.y <= 16384))
      throw ScriptError{"'resize' takes 320 to 16384 by 240 to 16384 pixels"};
  } else if (kind == "replace") {
    step.kind = Step::Kind::replace;
    step.name = script_text(script_member(json, "file"), "'file'");
    step.value = script_text(script_member(json, "text"), "'text'");
    step.with = script_text(script_member(json, "with"), "'with'");
  } else {
    throw ScriptError{fmt::format(
        "unknown step {}; expected click, type, drag, scroll, key, wait, resize, replace, "
        "screenshot, expect or repeat",
        in_quotes(kind))};
  }
  return step;
}

// where: "step", or of repeated steps that of the repetition with ", step"
void add_steps(const ScriptJson& list, const std::string& where, std::vector<Step>& out,
               int depth = 0) {
  std::size_t number = 0;
  for (const ScriptJson& each : list) {
    const std::string here = fmt::format("{} {}", where, ++number);
    if (!each.is_object() || each.size() != 1)
      throw ScriptError{here + " is not an object of one member, as {\"click\": \"tab/Sun\"}"};
    const std::string& kind = each.begin().key();
    const ScriptJson& json = each.begin().value();
    if (kind != "repeat") {
      if (out.size() >= kMaxSteps) throw ScriptError{fmt::format("more than {} steps", kMaxSteps)};
      try {
        out.push_back(parsed_step(kind, json));
      } catch (const ScriptError& what) {
        throw ScriptError{here + ": " + what.what};
      }
      continue;
    }
    if (depth == kMaxRepeatDepth)
      throw ScriptError{
          fmt::format("{}: repetitions are nested more than {} deep", here, kMaxRepeatDepth)};
    if (!json.is_object() || !json.contains("times") || !json["times"].is_number_integer() ||
        json["times"] < 1 || json["times"] > kMaxSteps || !json.contains("steps") ||
        !json["steps"].is_array() || json["steps"].empty())
      throw ScriptError{
          fmt::format("{}: 'repeat' takes 'times', 1 to {}, and 'steps', a list", here, kMaxSteps)};
    for (auto left = json["times"].get<std::size_t>(); left > 0; --left)
      add_steps(json["steps"], here + ", step", out, depth + 1);
  }
}

}  // namespace

Result<std::vector<Step>> read_script(const std::filesystem::path& path, DiagnosticLog& log) {
  const auto bytes = read_file(path, kMaxScriptBytes, log);
  if (!bytes) return failed;
  const auto wrong = [&](const std::string& what) -> Result<std::vector<Step>> {
    log.report_file(Code("E0203"), path.string(), what);
    return failed;
  };
  const ScriptJson json = ScriptJson::parse(*bytes, nullptr, false);
  if (json.is_discarded()) return wrong("the script is not JSON");
  const ScriptJson& list = json.is_object() && json.contains("steps") ? json["steps"] : json;
  if (!list.is_array()) return wrong("a script is a list of steps, or an object with 'steps'");
  std::vector<Step> out;
  try {
    add_steps(list, "step", out);
  } catch (const ScriptError& what) {
    return wrong(what.what);
  }
  return out;
}

}  // namespace panwright::studio
