#include "scenario/kernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/text.h"
#include "scenario/internal/ccsds.h"

namespace panwright::scenario {

namespace {

namespace eph = panwright::ephemeris;

constexpr double kMetres = 1000;               // of a kilometre
constexpr double kAuKilometres = 149597870.7;  // km
constexpr double kWithoutEnd = 1e13;           // seconds: of frames that hold always
constexpr double kRounding = 1e-6;             // seconds, of ET and of times since an epoch
constexpr int kSun = 10;
constexpr double kTtMinusTai = 32.184;
constexpr double kHalfDay = 43200;

double tdb_minus_tt_at(double seconds) {
  const double m = 6.239996 + 1.99096871e-7 * seconds;
  return 1.657e-3 * det::sin(m + 1.671e-2 * det::sin(m));
}

// What is asked of kernels, as numbers.
struct Question {
  std::optional<int> body;
  int observer = 0;
  int frame = eph::kJ2000;
  std::optional<int> attitude;
  bool sun = false;
  eph::Aberration aberration = eph::Aberration::none;
  int sun_from() const { return body.value_or(observer); }
};

std::vector<eph::Interval> overlap(const std::vector<eph::Interval>& a,
                                   const std::vector<eph::Interval>& b) {
  std::vector<eph::Interval> out;
  std::size_t i = 0, k = 0;
  while (i < a.size() && k < b.size()) {
    const eph::Interval both{std::max(a[i].begin, b[k].begin), std::min(a[i].end, b[k].end)};
    if (both.begin <= both.end) out.push_back(both);
    (a[i].end < b[k].end ? i : k) += 1;
  }
  return out;
}

std::vector<eph::Interval> coverage_of(const eph::Kernels& kernels, const Question& asked) {
  std::vector<eph::Interval> out{{-kWithoutEnd, kWithoutEnd}};
  const auto states = [&](int target, int observer) {
    out = overlap(out, kernels.coverage(target, observer, asked.frame));
    if (asked.aberration == eph::Aberration::none) return;
    out = overlap(out, kernels.coverage(target, 0, asked.frame));
    out = overlap(out, kernels.coverage(observer, 0, asked.frame));
  };
  if (asked.body) states(*asked.body, asked.observer);
  if (asked.sun) states(kSun, asked.sun_from());
  if (asked.attitude) {
    out = overlap(out, kernels.attitude_coverage(*asked.attitude));
    out = overlap(out, kernels.attitude_coverage(asked.frame));
  }
  return out;
}

class KernelSource final : public Source {
 public:
  KernelSource(SourceInfo info, eph::Kernels kernels, const Question& asked, std::string target,
               std::vector<eph::Interval> spans, double begin)
      : Source(std::move(info)),
        kernels_(std::move(kernels)),
        asked_(asked),
        target_(std::move(target)),
        spans_(std::move(spans)),
        begin_(begin) {}

 private:
  const char* fill(double time, Frame& frame) const override {
    const double et = inside(begin_ + time);
    std::string problem;
    Placement& place = target_.empty() ? frame.camera : frame.target(target_).placement;
    if (asked_.body) {
      const auto found = kernels_.state(*asked_.body, asked_.observer, asked_.frame, et,
                                        asked_.aberration, problem);
      if (!found) return "the kernels give no position there: a gap, or a damaged segment";
      place.position = kMetres * found->state.position;
    }
    if (asked_.attitude) {
      const auto own = kernels_.attitude(*asked_.attitude, et, problem);
      const auto world = kernels_.attitude(asked_.frame, et, problem);
      if (!own || !world) return "the kernels give no attitude there: a gap, or a damaged segment";
      const Quat q = glm::quat_cast(world->from_j2000 * transpose(own->from_j2000));
      place.rotation = normalize(q);
    }
    if (asked_.sun) {
      const auto found =
          kernels_.state(kSun, asked_.sun_from(), asked_.frame, et, asked_.aberration, problem);
      const double distance = found ? length(found->state.position) : 0;
      if (!(distance > 0)) return "the kernels give no direction of the Sun there";
      frame.sun_direction = found->state.position / distance;
      frame.sun_distance = distance / kAuKilometres;
    }
    return nullptr;
  }

  // Times at bounds may be rounded across them.
  double inside(double et) const {
    for (const eph::Interval& span : spans_)
      if (et >= span.begin - kRounding && et <= span.end + kRounding)
        return std::clamp(et, span.begin, span.end);
    return et;
  }

  eph::Kernels kernels_;
  Question asked_;
  std::string target_;
  std::vector<eph::Interval> spans_;
  double begin_;
};

// Numbers of the names. False: E8013.
bool resolve(const std::string& name, const eph::Kernels& kernels, const KernelOptions& options,
             Question& out, DiagnosticLog& log) {
  const auto refuse = [&](std::string what, const char* hint) {
    log.report_file(Code("E8013"), name, std::move(what), hint);
    return false;
  };
  const auto body = [&](const std::string& text, int& number) {
    const auto found = kernels.body(text);
    if (!found)
      return refuse("no body has the name " + in_quotes(text),
                    "its number, as \"-82\", where the kernels do not name it");
    number = *found;
    return true;
  };
  const auto axes = [&](const std::string& text, int& number) {
    const auto found = kernels.frame(text);
    std::string problem;
    if (!found)
      return refuse("no frame has the name " + in_quotes(text), "load the kernel of frames (.tf)");
    number = *found;
    return true;
  };
  const auto aberration = eph::aberration_named(options.aberration);
  if (!aberration)
    return refuse(fmt::format("aberration is {}", in_quotes(options.aberration)),
                  "none, LT, LT+S, CN or CN+S");
  out.aberration = *aberration;
  out.sun = options.sun;
  int number = 0;
  if (!options.body.empty()) {
    if (!body(options.body, number)) return false;
    out.body = number;
  }
  if (!options.attitude.empty()) {
    if (!axes(options.attitude, number)) return false;
    out.attitude = number;
  }
  if (!out.body && !out.attitude && !out.sun)
    return refuse("nothing is asked of the kernels", "body, attitude or sun = true");
  if (options.observer.empty() && (out.body || out.sun))
    return refuse("no observer: the body in the origin", "observer = \"EARTH\"");
  if (!options.observer.empty() && !body(options.observer, out.observer)) return false;
  return axes(options.frame, out.frame);
}

std::string nothing_covered(const eph::Kernels& kernels, const Question& asked) {
  std::string problem;
  const auto infos = kernels.segments();
  double et = 0;  // in the midst of what is there
  for (const eph::SegmentInfo& info : infos)
    if (!info.in_ticks && (info.id == asked.body || info.id == asked.attitude))
      et = 0.5 * (info.begin + info.end);
  bool good = true;
  if (asked.body)
    good = kernels.state(*asked.body, asked.observer, asked.frame, et, asked.aberration, problem)
               .has_value();
  if (good && asked.attitude) good = kernels.attitude(*asked.attitude, et, problem).has_value();
  if (good && asked.sun)
    good = kernels.state(kSun, asked.sun_from(), asked.frame, et, asked.aberration, problem)
               .has_value();
  return "the kernels cover no time" + (good ? std::string() : ": " + problem);
}

}  // namespace

double et_of(const Epoch& epoch) {
  const double tt = seconds_between({43200, 0}, epoch) + kTtMinusTai;
  return tt + tdb_minus_tt_at(tt);
}

Epoch epoch_of(double et) {
  double tt = et;
  for (int i = 0; i < 3; ++i) tt = et - tdb_minus_tt_at(tt);
  // in parts: an ET of today has steps of 1e-7 s
  return later(later({0, 0}, et + kHalfDay), -kTtMinusTai - tdb_minus_tt_at(tt));
}

Result<SourcePtr> kernel_source(const std::string& name, eph::Kernels kernels,
                                const KernelOptions& options, DiagnosticLog& log) {
  Question asked;
  if (!resolve(name, kernels, options, asked, log)) return failed;
  std::vector<eph::Interval> spans = coverage_of(kernels, asked);
  if (spans.empty()) {
    log.report_file(Code("E8003"), name, nothing_covered(kernels, asked));
    return failed;
  }
  SourceInfo info;
  info.name = name;
  info.system = options.system;
  info.epoch = options.epoch;
  const bool bounded = spans.front().begin > -kWithoutEnd;
  if (!info.epoch && bounded) info.epoch = epoch_of(std::ceil(spans.front().begin));
  if (!info.epoch) {
    log.report_file(Code("E8009"), name, "it holds at all dates, and the scenario has none",
                    "epoch = \"2026-01-01T00:00:00 UTC\"");
    return failed;
  }
  const double begin = et_of(*info.epoch);
  const auto since = [&](double et) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (std::abs(et) >= kWithoutEnd) return et < 0 ? -kInfinity : kInfinity;
    return std::round((et - begin) / kRounding) * kRounding;
  };
  for (const eph::Interval& span : spans)
    info.spans.push_back({since(span.begin), since(span.end)});
  info.frame = frame_name(options.frame);
  if (asked.body) {
    info.centre = capitals(kernels.body_name(asked.observer));
    info.channels.push_back({Quantity::position, options.target, {}});
  }
  if (asked.attitude) info.channels.push_back({Quantity::rotation, options.target, {}});
  if (asked.sun) {
    info.channels.push_back({Quantity::sun_direction, {}, {}});
    info.channels.push_back({Quantity::sun_distance, {}, {}});
  }
  return SourcePtr(std::make_shared<KernelSource>(std::move(info), std::move(kernels), asked,
                                                  options.target, std::move(spans), begin));
}

}  // namespace panwright::scenario
