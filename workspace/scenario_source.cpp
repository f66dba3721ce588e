#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>

#include "base/text.h"
#include "scenario/aem.h"
#include "scenario/fli.h"
#include "scenario/kernels.h"
#include "scenario/keyframes.h"
#include "scenario/oem.h"
#include "scenario/simulators.h"
#include "workspace/internal/scenario_source.h"

namespace panwright::workspace {

std::string lower_extension(const std::filesystem::path& path) {
  std::string out = path.extension().string();
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

bool begins_with_keyword(std::string_view text, std::string_view keyword) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return first != text.npos && text.substr(first).starts_with(keyword);
}

Result<scenario::SourcePtr> read_source(const std::filesystem::path& path,
                                        const scenario::Text& text, const SourceOptions& options,
                                        DiagnosticLog& log) {
  const std::string extension = lower_extension(path);
  const std::string_view bytes = *text.bytes;
  if (extension == ".fli")
    return scenario::read_fli(text, {options.objects, options.frame_rate, options.strict}, log);
  if (extension == ".oem" || begins_with_keyword(bytes, "CCSDS_OEM_VERS"))
    return scenario::read_oem(text, {options.target, options.strict}, log);
  if (extension == ".aem" || begins_with_keyword(bytes, "CCSDS_AEM_VERS"))
    return scenario::read_aem(text, {options.target, options.strict}, log);
  if (extension == ".jsonl" || (extension == ".json" && begins_with_keyword(bytes, "[")))
    return scenario::read_views(text, {options.strict}, log);
  if (extension == ".json") return scenario::read_keyframes(text, {options.strict}, log);
  if (extension == ".csv") {
    scenario::CsvOptions csv = options.csv;
    csv.strict = options.strict;
    return scenario::read_csv(text, csv, log);
  }
  if (ephemeris::is_kernel(std::as_bytes(std::span(bytes))))
    log.report_file(Code("E0202"), path.string(), "a SPICE kernel, which does not say whose it is",
                    "[[source]] with kernels and body in a scenario: docs/ephemerides.md");
  else
    log.report_file(
        Code("E0202"), path.string(),
        "not a trajectory, expected .csv, .fli, .json (keyframes, views), .jsonl (views), or a "
        "message of CCSDS",
        "docs/scenarios.md");
  return failed;
}

bool given_once(const std::vector<scenario::Part>& parts, const std::vector<SourceSpan>& places,
                DiagnosticLog& log) {
  std::vector<scenario::Channel> given;
  bool once = true;
  for (std::size_t k = 0; k < places.size(); ++k)
    for (const scenario::Channel& channel : parts[k].source->info().channels) {
      if (std::ranges::find(given, channel) == given.end()) {
        given.push_back(channel);
        continue;
      }
      once = false;
      log.report(Code("E8008"), places[k],
                 "a source above gives " + channel_text(channel) + " as well",
                 "leave out one of the sources");
    }
  return once;
}

bool is_covered(const scenario::Sequence& sequence, const ConfigValue& root, DiagnosticLog& log) {
  const std::vector<scenario::TimeSpan>& spans = sequence.spans();
  for (const char* name : {"begin", "end"}) {
    const ConfigValue* value = root.find(name);
    const double* time = value == nullptr ? nullptr : std::get_if<double>(&value->data);
    if (time == nullptr) continue;
    if (sequence.ordered()) {
      log.report(Code("E8013"), value->where, "the frames have an order alone, and no times");
      return false;
    }
    if (spans.empty() || (*time >= spans.front().begin && *time <= spans.back().end)) continue;
    log.report(Code("E8003"), value->where,
               fmt::format("no frame at {:.9g} s; the sources cover {:.9g} s to {:.9g} s", *time,
                           spans.front().begin, spans.back().end));
    return false;
  }
  return true;
}

bool is_json_scenario(std::string_view text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  return json.is_object() && json.contains("source");
}

std::optional<scenario::SourcePtr> read_simulator(ConfigTable& part, const std::string& target,
                                                  const std::filesystem::path& folder,
                                                  std::vector<std::string>& files,
                                                  DiagnosticLog& log) {
  const std::string simulator = part.text("simulator").value_or("");
  const auto read = [&](std::string_view member) -> std::optional<scenario::Text> {
    const auto name = part.text(member);
    if (!name) return std::nullopt;
    files.push_back((folder / *name).string());
    auto text = scenario::read_text(files.back(), log);
    if (!text) return std::nullopt;
    return *std::move(text);
  };
  const auto made = [](Result<scenario::SourcePtr> source) {
    return source ? std::optional(*source) : std::nullopt;
  };
  if (simulator == "42") {
    if (part.find("position") == nullptr && part.find("rotation") == nullptr)
      part.fail(part.value(), "42 needs position or rotation: PosR.42, qbn.42");
    if (part.require("time") == nullptr || !part.ok()) return std::nullopt;
    scenario::FortyTwoTexts texts;
    const auto time = read("time");
    texts.position = read("position");
    texts.rotation = read("rotation");
    texts.target = target;
    if (!time || log.has_errors()) return std::nullopt;
    texts.time = *time;
    return made(scenario::read_42(texts, log));
  }
  if (simulator == "basilisk") {
    if (part.require("file") == nullptr) return std::nullopt;
    const auto text = read("file");
    if (!text) return std::nullopt;
    return made(scenario::read_basilisk(*text, target, log));
  }
  if (const ConfigValue* at = part.find("simulator"); at != nullptr && part.ok())
    part.fail(*at, fmt::format("simulator is {}, expected 42 or basilisk", in_quotes(simulator)));
  return std::nullopt;
}

}  // namespace panwright::workspace
