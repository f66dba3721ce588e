#include "studio/script.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "base/text.h"

namespace panwright::studio {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kMostBytes = 1 << 20;
constexpr int kDeepest = 8;
constexpr std::size_t kMostSteps = 100000;  // repeated ones counted each time

struct Wrong {
  std::string what;
};

std::string text_of(const Json& json, const char* what) {
  if (json.is_string()) return json.get<std::string>();
  if (json.is_number()) return json.dump();
  throw Wrong{fmt::format("{} is to be a text", what)};
}

Vec2 pair_of(const Json& json, const char* what) {
  if (!json.is_array() || json.size() != 2 || !json[0].is_number() || !json[1].is_number())
    throw Wrong{fmt::format("{} is to be two numbers", what)};
  return {json[0].get<double>(), json[1].get<double>()};
}

const Json& member(const Json& json, const char* name) {
  if (!json.is_object() || !json.contains(name))
    throw Wrong{fmt::format("'{}' is missing", name)};
  return json[name];
}

Step step_of(const std::string& kind, const Json& json) {
  Step step;
  if (kind == "click" || kind == "key" || kind == "screenshot") {
    step.kind = kind == "click" ? Step::Kind::click
                : kind == "key" ? Step::Kind::key
                                : Step::Kind::screenshot;
    step.name = text_of(json, kind.c_str());
  } else if (kind == "type" || kind == "expect") {
    step.kind = kind == "type" ? Step::Kind::type : Step::Kind::expect;
    if (!json.is_array() || json.size() != 2)
      throw Wrong{fmt::format("'{}' takes a name and a value, as [\"camera/range\", \"12\"]", kind)};
    step.name = text_of(json[0], "the name");
    step.value = text_of(json[1], "the value");
  } else if (kind == "drag") {
    step.kind = Step::Kind::drag;
    step.from = pair_of(member(json, "from"), "'from'");
    step.to = pair_of(member(json, "to"), "'to'");
    if (json.contains("button")) {
      const std::string button = text_of(json["button"], "'button'");
      const auto known = std::string_view("left right middle").find(button);
      if (known == std::string_view::npos || button.empty())
        throw Wrong{"'button' is left, right or middle"};
      step.button = button == "left" ? 0 : button == "right" ? 1 : 2;
    }
    step.amount = 12;
    if (json.contains("frames")) {
      const Json& frames = json["frames"];
      if (!frames.is_number_integer() || frames < 1 || frames > 100000)
        throw Wrong{"'frames' is 1 to 100000"};
      step.amount = frames.get<double>();
    }
  } else if (kind == "scroll") {
    step.kind = Step::Kind::scroll;
    if (!json.is_number()) throw Wrong{"'scroll' takes the wheel's steps, as 3 or -3"};
    step.amount = json.get<double>();
  } else if (kind == "wait") {
    step.kind = Step::Kind::wait;
    if (json.is_number())
      step.amount = json.get<double>();
    else
      step.name = text_of(json, "'wait'");
    if (!step.name.empty() && step.name != "exact" && step.name != "read" && step.name != "saved" &&
        step.name != "compared" && step.name != "sampled" && step.name != "video")
      throw Wrong{
          "'wait' takes exact, compared, sampled, read, saved, video or a number of frames"};
  } else if (kind == "resize") {
    step.kind = Step::Kind::resize;
    step.to = pair_of(json, "'resize'");
    if (!(step.to.x >= 320 && step.to.y >= 240 && step.to.x <= 16384 && step.to.y <= 16384))
      throw Wrong{"'resize' takes 320 to 16384 by 240 to 16384 pixels"};
  } else if (kind == "replace") {
    step.kind = Step::Kind::replace;
    step.name = text_of(member(json, "file"), "'file'");
    step.value = text_of(member(json, "text"), "'text'");
    step.with = text_of(member(json, "with"), "'with'");
  } else {
    throw Wrong{
        fmt::format("{} is no step; known are click, type, drag, scroll, key, wait, resize, "
                    "replace, screenshot, expect, repeat",
                    in_quotes(kind))};
  }
  return step;
}

// where: "step", or that of the repeated ones with " step" behind it
void add_steps(const Json& list, const std::string& where, std::vector<Step>& out, int depth = 0) {
  std::size_t number = 0;
  for (const Json& each : list) {
    const std::string here = fmt::format("{} {}", where, ++number);
    if (!each.is_object() || each.size() != 1)
      throw Wrong{here + " is not an object of one member, as {\"click\": \"tab/Sun\"}"};
    const std::string& kind = each.begin().key();
    const Json& json = each.begin().value();
    if (kind != "repeat") {
      if (out.size() >= kMostSteps)
        throw Wrong{fmt::format("there are more than {} steps", kMostSteps)};
      try {
        out.push_back(step_of(kind, json));
      } catch (const Wrong& what) {
        throw Wrong{here + ": " + what.what};
      }
      continue;
    }
    if (depth == kDeepest)
      throw Wrong{fmt::format("{}: steps are repeated {} deep at most", here, kDeepest)};
    if (!json.is_object() || !json.contains("times") || !json["times"].is_number_integer() ||
        json["times"] < 1 || json["times"] > kMostSteps || !json.contains("steps") ||
        !json["steps"].is_array() || json["steps"].empty())
      throw Wrong{fmt::format("{}: 'repeat' takes 'times', 1 to {}, and 'steps', a list", here,
                              kMostSteps)};
    for (auto left = json["times"].get<std::size_t>(); left > 0; --left)
      add_steps(json["steps"], here + ", step", out, depth + 1);
  }
}

}  // namespace

Result<std::vector<Step>> read_script(const std::filesystem::path& path, DiagnosticLog& log) {
  const auto bytes = read_file(path, kMostBytes, log);
  if (!bytes) return failed;
  const auto wrong = [&](const std::string& what) -> Result<std::vector<Step>> {
    log.report_file(Code::E0203, path.string(), what);
    return failed;
  };
  const Json json = Json::parse(*bytes, nullptr, false);
  if (json.is_discarded()) return wrong("the script is not JSON");
  const Json& list = json.is_object() && json.contains("steps") ? json["steps"] : json;
  if (!list.is_array()) return wrong("a script is a list of steps, or an object with 'steps'");
  std::vector<Step> out;
  try {
    add_steps(list, "step", out);
  } catch (const Wrong& what) {
    return wrong(what.what);
  }
  return out;
}

}  // namespace panwright::studio
