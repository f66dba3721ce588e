#include "tools/scenario_options.h"

#include <fmt/core.h>

#include <charconv>
#include <cmath>

#include "base/text.h"

namespace panwright::tools {

namespace {

// "N..M", "N.." or "N".
std::optional<std::pair<std::uint64_t, std::uint64_t>> frame_numbers(std::string_view text) {
  const auto read = [](std::string_view digits) -> std::optional<std::uint64_t> {
    std::uint64_t number = 0;
    const char* end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, number);
    if (error != std::errc() || stop != end) return std::nullopt;
    return number;
  };
  const std::size_t dots = text.find("..");
  const auto first = read(text.substr(0, dots));
  if (!first) return std::nullopt;
  if (dots == text.npos) return std::pair(*first, *first);
  const std::string_view rest = text.substr(dots + 2);
  if (rest.empty()) return std::pair(*first, ~std::uint64_t{0});
  const auto last = read(rest);
  if (!last || *last < *first) return std::nullopt;
  return std::pair(*first, *last);
}

}  // namespace

void declare(Arguments& arguments, ScenarioInput& input) {
  constexpr const char* kGroup = "Frames";
  arguments
      .add("input", input.file,
           "Scenario (.toml or .json, docs/scenarios.md), or a trajectory alone: .csv, .fli, .json "
           "(keyframes, views), .jsonl (views), CCSDS OEM or AEM")
      .required()
      .type("SCENARIO");
  arguments
      .add(
          "--owner", input.options.target,
          "Owner of the positions or attitudes of an OEM or AEM: a target's name (default: camera)")
      .type("NAME")
      .group(kGroup);
  arguments.add("--at", input.at, "Only the frame at this time, seconds; may be repeated")
      .type("SECONDS")
      .one_value()
      .group(kGroup);
  arguments
      .add("--every", input.every,
           "Seconds between frames (default: those of the scenario, or of its first source)")
      .positive()
      .type("SECONDS")
      .group(kGroup);
  arguments
      .add("--frames", input.numbers,
           "Only frames of these numbers, from 0: N, N..M or N.. to the end")
      .type("N..M")
      .group(kGroup);
  arguments
      .flag("--strict", input.options.strict,
            "Refuse deviations from formats and unknown members, which are warnings otherwise")
      .group(kGroup);
}

Result<ScenarioInput::Opened> ScenarioInput::open(DiagnosticLog& log) const {
  workspace::FrameChoice choice;
  choice.every = every;
  for (const std::string& text : at) {
    const auto time = parse_double(text);
    if (!time) {
      log.report(Code("E0201"), {}, fmt::format("--at is {}, expected seconds", in_quotes(text)));
      return failed;
    }
    choice.at.push_back(*time);
  }
  if (!numbers.empty()) {
    choice.numbers = frame_numbers(numbers);
    if (!choice.numbers) {
      log.report(Code("E0201"), {},
                 fmt::format("--frames is {}, expected N, N..M or N..", in_quotes(numbers)));
      return failed;
    }
  }
  auto scenario = workspace::open_scenario(file, options, log);
  if (!scenario) return failed;
  auto times = workspace::frame_times(*scenario, choice, log);
  if (!times) return failed;
  return Opened{*std::move(scenario), *std::move(times),
                choice.numbers ? choice.numbers->first : 0};
}

}  // namespace panwright::tools
