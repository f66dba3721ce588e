#include "tools/kernel_info.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>

#include "base/text.h"
#include "ephemeris/kernels.h"
#include "scenario/kernels.h"
#include "scenario/time.h"
#include "tools/print.h"

namespace panwright::tools {

namespace {

using KernelJson = nlohmann::ordered_json;
using ephemeris::SegmentInfo;

// A date in TDB; ticks where no clock kernel is there.
std::string time_text(double time, bool in_ticks) {
  constexpr double kMostSeconds = 1e11;  // years of four digits
  if (in_ticks) return fmt::format("tick {:.6f}", time);
  if (!(std::abs(time) < kMostSeconds)) return fmt::format("{:.6g} s", time);
  return scenario::epoch_text(scenario::epoch_of(time), scenario::TimeSystem::tdb);
}

// Whose state or attitude, and what it is relative to.
std::pair<std::string, std::string> names_of(const SegmentInfo& segment,
                                             const ephemeris::Kernels& kernels) {
  const auto body = [&](int id) {
    const std::string name = kernels.body_name(id), number = std::to_string(id);
    return name == number ? number : fmt::format("{} ({})", name, id);
  };
  if (segment.kind.starts_with("SPK")) return {body(segment.id), body(segment.relative)};
  return {segment.kind.starts_with("CK") ? fmt::format("instrument {}", segment.id)
                                         : fmt::format("frame class {}", segment.id),
          kernels.frame_name(segment.relative)};
}

}  // namespace

bool is_kernel_file(const std::filesystem::path& path) {
  std::array<char, 4096> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  return ephemeris::is_kernel(
      std::as_bytes(std::span(head.data(), static_cast<std::size_t>(file.gcount()))));
}

bool show_kernel(const std::filesystem::path& path, bool text, KernelJson& out,
                 DiagnosticLog& log) {
  const auto kernels = ephemeris::Kernels::load(std::span(&path, 1), log);
  if (!kernels) return false;
  const auto segments = kernels->segments();
  const auto variables = kernels->variables();
  out["file"] = path.string();
  out["kernel"] = true;
  auto& list = out["segments"] = KernelJson::array();
  if (text)
    print("{}: SPICE kernel, {}, {} of text\n", path.string(), counted(segments.size(), "segment"),
          counted(variables.size(), "variable"));
  for (const SegmentInfo& each : segments) {
    const auto [of, relative] = names_of(each, *kernels);
    const std::string begin = time_text(each.begin, each.in_ticks),
                      end = time_text(each.end, each.in_ticks);
    const bool orbit = each.kind.starts_with("SPK");
    const std::string frame = orbit ? kernels->frame_name(each.frame) : std::string();
    KernelJson line{{"kind", each.kind},       {"name", each.name}, {"file", each.file},
                    {"id", each.id},           {"of", of},          {"relative", each.relative},
                    {"relative_to", relative}, {"begin", begin},    {"end", end},
                    {"read", each.read}};
    if (orbit) line["frame"] = frame;
    list.push_back(std::move(line));
    if (text)
      print("{:<11} {} relative to {}{}, {} to {}{}{}\n", each.kind, of, relative,
            orbit ? " in " + frame : "", begin, end, each.in_ticks ? "" : " TDB",
            each.read ? "" : "; not read");
  }
  out["variables"] = variables;
  if (text)
    for (const std::string& name : variables) print("variable    {}\n", name);
  return true;
}

}  // namespace panwright::tools
