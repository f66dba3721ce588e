#include "tests/fuzz/targets_scenario.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "scenario/aem.h"
#include "scenario/csv.h"
#include "scenario/fli.h"
#include "scenario/keyframes.h"
#include "scenario/oem.h"
#include "scenario/sequence.h"
#include "scenario/simulators.h"
#include "tests/fuzz/require.h"

namespace panwright::fuzz {

namespace {

namespace sc = panwright::scenario;

void require_unit(const std::optional<Quat>& q) {
  if (q) require(std::abs(dot(*q, *q) - 1) < 1e-9, "a unit rotation");
}

void require_sound(const sc::Frame& frame) {
  require_unit(frame.camera.rotation);
  for (const sc::TargetState& target : frame.targets) {
    require_unit(target.placement.rotation);
    for (const sc::JointValue& joint : target.joints)
      require(joint.count <= joint.values.size(), "values of a joint");
  }
  if (frame.sun_direction)
    require(std::abs(length(*frame.sun_direction) - 1) < 1e-9, "a unit direction");
}

bool read(const Result<sc::SourcePtr>& source, const DiagnosticLog& log) {
  require(source.ok() != log.has_errors(), "a source or an error: " + to_text(log));
  if (!source) return false;
  const sc::SourceInfo& info = (*source)->info();
  require((*source)->frames() > 0, "frames of its own");
  require(std::ranges::is_sorted(info.times) &&
              std::ranges::adjacent_find(info.times) == info.times.end(),
          "ascending times");
  for (std::size_t i = 1; i < info.spans.size(); ++i)
    require(info.spans[i - 1].end <= info.spans[i].begin, "spans that do not overlap");
  constexpr std::size_t kMost = 50;
  for (std::size_t i = 0; i < std::min((*source)->frames(), kMost); ++i) {
    sc::Frame frame;
    DiagnosticLog evaluation;
    require((*source)->frame(i, frame, evaluation), to_text(evaluation));
    require_sound(frame);
  }
  for (std::size_t i = 0; i < std::min(info.spans.size(), kMost); ++i)
    for (const double share : {0.0, 0.3, 0.77, 1.0}) {
      const sc::TimeSpan& span = info.spans[i];
      const double time = std::min(span.begin + share * (span.end - span.begin), span.end);
      sc::Frame frame;
      DiagnosticLog evaluation;
      // a camera may meet the point that it looks at
      if ((*source)->at(time, frame, evaluation)) require_sound(frame);
    }
  DiagnosticLog combining;
  const auto sequence = sc::Sequence::of({{*source}}, {}, combining);
  require(sequence.ok(), to_text(combining));
  return true;
}

}  // namespace

std::size_t scenario(std::span<const std::byte> input) {
  const sc::Text text = sc::memory_text(
      "fuzz", std::string(reinterpret_cast<const char*>(input.data()), input.size()));
  std::size_t sources = 0;
  const auto count = [&](const auto& reader) {
    DiagnosticLog log;
    sources += read(reader(log), log) ? 1 : 0;
    (void)to_text(log);
  };
  for (const bool strict : {false, true}) {
    count([&](DiagnosticLog& log) { return sc::read_oem(text, {"a", strict}, log); });
    count([&](DiagnosticLog& log) { return sc::read_aem(text, {"a", strict}, log); });
    count([&](DiagnosticLog& log) { return sc::read_fli(text, {{}, {}, strict}, log); });
    count([&](DiagnosticLog& log) { return sc::read_keyframes(text, {strict}, log); });
    count([&](DiagnosticLog& log) { return sc::read_views(text, {strict}, log); });
  }
  for (const sc::Method method : {sc::Method::linear, sc::Method::cubic, sc::Method::hermite})
    count([&](DiagnosticLog& log) { return sc::read_csv(text, {method, 5, false}, log); });
  count([&](DiagnosticLog& log) { return sc::read_basilisk(text, "a", log); });
  count([&](DiagnosticLog& log) { return sc::read_42({text, text, text, "a"}, log); });
  return sources;
}

}  // namespace panwright::fuzz
