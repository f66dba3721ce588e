#include "scenario/formulas.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"

namespace panwright::scenario {

namespace {

// Stumpff's functions C(z) = (1 − cos √z)/z and S(z) = (√z − sin √z)/√z³, for negative z by
// hyperbolic functions.
struct Stumpff {
  double c = 0.5;
  double s = 1.0 / 6;
};

Stumpff stumpff(double z) {
  if (std::abs(z) < 1) {
    double c = 0, s = 0;
    for (int k = 12; k >= 0; --k) {  // Horner's scheme of Σ (−z)ᵏ/(2k + 2)! and /(2k + 3)!
      c = (1 - z * c) / ((2 * k + 1) * (2 * k + 2));
      s = (1 - z * s) / ((2 * k + 2) * (2 * k + 3));
    }
    return {c, s};
  }
  const double root = std::sqrt(std::abs(z));
  if (z > 0) {
    const double half = det::sin(root / 2);
    return {2 * half * half / z, (root - det::sin(root)) / (root * z)};
  }
  const double e = det::exp(root);
  const double cosh = 0.5 * (e + 1 / e), sinh = 0.5 * (e - 1 / e);
  return {(1 - cosh) / z, (root - sinh) / (root * z)};
}

// Kepler's equation in the universal anomaly: seconds times √mu, and the radius.
struct Kepler {
  double r0, rv, alpha;  // rv: position · velocity / √mu
  double seconds(double x, const Stumpff& f) const {
    return rv * x * x * f.c + (1 - alpha * r0) * x * x * x * f.s + r0 * x;
  }
  double radius(double x, const Stumpff& f) const {
    return x * x * f.c + rv * x * (1 - alpha * x * x * f.s) + r0 * (1 - alpha * x * x * f.c);
  }
};

// The root of a function that ascends, by Newton's method between bounds.
double universal_anomaly(const Kepler& kepler, double wanted) {
  double low = 0, high = wanted / kepler.r0 + 1e-300;
  const auto excess = [&](double x) {
    return kepler.seconds(x, stumpff(kepler.alpha * x * x)) - wanted;
  };
  for (int i = 0; i < 2000 && excess(high) < 0; ++i) {
    low = high;
    high *= 2;
  }
  double x = 0.5 * (low + high);
  double step = high - low, before = step;
  for (int i = 0; i < 300; ++i) {
    const Stumpff f = stumpff(kepler.alpha * x * x);
    const double off = kepler.seconds(x, f) - wanted;
    const double radius = kepler.radius(x, f);
    (off < 0 ? low : high) = x;
    double next = x - off / radius;
    // Newton's steps are taken while they halve: far up an exponential they do not
    if (!(next > low && next < high) || !(std::abs(2 * off) <= std::abs(before * radius)))
      next = 0.5 * (low + high);
    if (next == x || !(low < high)) break;
    before = step;
    step = next - x;
    x = next;
  }
  return x;
}

// u − sin u, accurate near 0.
double less_sine(double u) {
  if (std::abs(u) > 0.5) return u - det::sin(u);
  double sum = 0;
  for (int k = 9; k >= 1; --k) sum = (1 - sum) * u * u / ((2 * k) * (2 * k + 1));
  return sum * u;
}

class FixedSource final : public Source {
 public:
  FixedSource(SourceInfo info, Frame fixed) : Source(std::move(info)), fixed_(std::move(fixed)) {}

 private:
  static void set(const Placement& from, Placement& to) {
    if (from.position) to.position = from.position;
    if (from.rotation) to.rotation = from.rotation;
  }
  const char* fill(double, Frame& frame) const override {
    set(fixed_.camera, frame.camera);
    for (const TargetState& target : fixed_.targets) {
      set(target.placement, frame.target(target.name).placement);
      for (const JointValue& joint : target.joints) frame.joint(target.name, joint.joint) = joint;
    }
    if (fixed_.lens != Lens{}) frame.lens = fixed_.lens;
    if (fixed_.sun_direction) frame.sun_direction = fixed_.sun_direction;
    if (fixed_.sun_distance) frame.sun_distance = fixed_.sun_distance;
    return nullptr;
  }
  Frame fixed_;
};

constexpr const char* kFilled = nullptr;

// Source of one placement from a function of time.
template <class Function>
class PlacementSource final : public Source {
 public:
  PlacementSource(SourceInfo info, std::string target, Function function)
      : Source(std::move(info)), target_(std::move(target)), function_(std::move(function)) {}

 private:
  const char* fill(double time, Frame& frame) const override {
    return function_(time, target_.empty() ? frame.camera : frame.target(target_).placement);
  }
  std::string target_;
  Function function_;
};

template <class Function>
SourcePtr placement_source(SourceInfo info, const std::string& target, Quantity quantity,
                           Function function) {
  info.channels = {{quantity, target, {}}};
  if (info.spans.empty()) info.spans = {TimeSpan{}};
  return std::make_shared<PlacementSource<Function>>(std::move(info), target, std::move(function));
}

SourceInfo named(std::string name) {
  SourceInfo info;
  info.name = std::move(name);
  return info;
}

Vec3 held_position(const std::vector<HoldPoint>& points, double time) {
  auto next = std::ranges::upper_bound(points, time, {}, &HoldPoint::arrive);
  if (next == points.begin()) return next->position;
  const HoldPoint& last = *std::prev(next);
  if (next == points.end() || time <= last.leave) return last.position;
  const double s = (time - last.leave) / (next->arrive - last.leave);
  return last.position + (next->position - last.position) * (s * s * s * (10 + s * (6 * s - 15)));
}

}  // namespace

OrbitState clohessy_wiltshire(const OrbitState& start, double rate, double seconds) {
  const double u = rate * seconds;
  const det::SinCos angle = det::sincos(u);
  const double s = angle.sin, c = angle.cos;
  const double half = det::sin(u / 2);
  const double d = 2 * half * half;  // 1 − c
  const double l = less_sine(u);     // u − s
  const Vec3& p = start.position;
  const Vec3& v = start.velocity;
  OrbitState out;
  out.position = {(1 + 3 * d) * p.x + (s / rate) * v.x + (2 * d / rate) * v.y,
                  -6 * l * p.x + p.y - (2 * d / rate) * v.x + ((s - 3 * l) / rate) * v.y,
                  c * p.z + (s / rate) * v.z};
  out.velocity = {3 * rate * s * p.x + c * v.x + 2 * s * v.y,
                  -6 * rate * d * p.x - 2 * s * v.x + (1 - 4 * d) * v.y, -rate * s * p.z + c * v.z};
  return out;
}

std::optional<OrbitState> two_body(const OrbitState& start, double mu, double seconds) {
  if (seconds < 0) {  // the same orbit, run backwards
    auto back = two_body({start.position, -start.velocity}, mu, -seconds);
    if (back) back->velocity = -back->velocity;
    return back;
  }
  const double r0 = glm::length(start.position), root = std::sqrt(mu);
  if (!(r0 > 0)) return std::nullopt;
  const Kepler kepler{r0, dot(start.position, start.velocity) / root,
                      2 / r0 - dot(start.velocity, start.velocity) / mu};
  double left = seconds;
  if (kepler.alpha > 0) {
    const double period = 2 * kPi / (root * kepler.alpha * std::sqrt(kepler.alpha));
    if (period < left) left = std::fmod(left, period);
  }
  if (left == 0) return start;
  const double x = universal_anomaly(kepler, root * left);
  const Stumpff k = stumpff(kepler.alpha * x * x);
  const double f = 1 - x * x / r0 * k.c;
  const double g = left - x * x * x / root * k.s;
  OrbitState out;
  out.position = f * start.position + g * start.velocity;
  const double r = glm::length(out.position);
  if (!(r > 1e-9 * r0)) return std::nullopt;
  const double f_rate = root / (r * r0) * x * (kepler.alpha * x * x * k.s - 1);
  const double g_rate = 1 - x * x / r * k.c;
  out.velocity = f_rate * start.position + g_rate * start.velocity;
  if (!is_finite(out.position) || !is_finite(out.velocity)) return std::nullopt;
  return out;
}

SourcePtr fixed_source(std::string name, const Frame& frame) {
  SourceInfo info = named(std::move(name));
  info.spans = {TimeSpan{}};
  info.constant = true;
  const auto add = [&](Quantity quantity, const std::string& target, const std::string& joint) {
    info.channels.push_back({quantity, target, joint});
  };
  const auto add_placement = [&](const Placement& placement, const std::string& target) {
    if (placement.position) add(Quantity::position, target, {});
    if (placement.rotation) add(Quantity::rotation, target, {});
  };
  add_placement(frame.camera, {});
  for (const TargetState& target : frame.targets) {
    add_placement(target.placement, target.name);
    for (const JointValue& joint : target.joints) add(Quantity::joint, target.name, joint.joint);
  }
  if (frame.lens != Lens{}) add(Quantity::lens, {}, {});
  if (frame.sun_direction) add(Quantity::sun_direction, {}, {});
  if (frame.sun_distance) add(Quantity::sun_distance, {}, {});
  return std::make_shared<FixedSource>(std::move(info), frame);
}

SourcePtr clohessy_wiltshire_source(const std::string& target, const OrbitState& start,
                                    double rate) {
  SourceInfo info = named("Clohessy-Wiltshire motion");
  info.frame = kRtnFrame;
  return placement_source(std::move(info), target, Quantity::position,
                          [start, rate](double time, Placement& placement) {
                            placement.position = clohessy_wiltshire(start, rate, time).position;
                            return kFilled;
                          });
}

Result<SourcePtr> two_body_source(const std::string& target, const OrbitState& start, double mu,
                                  const TimeSpan& span, SourceSpan where, DiagnosticLog& log) {
  SourceInfo info = named("two-body motion");
  info.spans = {span};
  if (mu == kEarthGravity) info.centre = "EARTH";
  // a straight line meets the centre, sooner or later
  const double momentum = glm::length(cross(start.position, start.velocity));
  const bool straight =
      !(momentum > 1e-12 * glm::length(start.position) * glm::length(start.velocity));
  const bool finite = std::isfinite(span.begin) && std::isfinite(span.end);
  if (straight || !is_finite(start.position) || !is_finite(start.velocity) || !(mu > 0) ||
      (finite && (!two_body(start, mu, span.begin) || !two_body(start, mu, span.end)))) {
    log.report(Code("E8003"), where,
               "the motion meets its centre, or its start is no state of an orbit");
    return failed;
  }
  return placement_source(std::move(info), target, Quantity::position,
                          [start, mu](double time, Placement& placement) -> const char* {
                            const auto state = two_body(start, mu, time);
                            if (!state) return "the motion has met its centre";
                            placement.position = state->position;
                            return kFilled;
                          });
}

SourcePtr spin_source(const std::string& target, const Quat& start, const Vec3& rate) {
  return placement_source(named("even spin"), target, Quantity::rotation,
                          [start, rate](double time, Placement& placement) {
                            const double speed = glm::length(rate);
                            const det::SinCos half = det::sincos(speed * time / 2);
                            const Vec3 axis = speed > 0 ? rate * (half.sin / speed) : Vec3(0);
                            placement.rotation =
                                normalize(start * Quat(half.cos, axis.x, axis.y, axis.z));
                            return kFilled;
                          });
}

Result<SourcePtr> hold_point_source(const std::string& target, std::vector<HoldPoint> points,
                                    DiagnosticLog& log) {
  SourceInfo info = named("hold points");
  const std::size_t before = log.errors();
  if (points.empty()) log.report_file(Code("E8004"), info.name, "the list has no point");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const HoldPoint& point = points[i];
    if (!is_finite(point.position) || !std::isfinite(point.arrive) || !std::isfinite(point.leave))
      log.report_file(Code("E8001"), info.name, fmt::format("point {} is not finite", i + 1));
    else if (point.leave < point.arrive || (i > 0 && point.arrive <= points[i - 1].leave))
      log.report_file(Code("E8004"), info.name,
                      fmt::format("point {} holds from {} s to {} s; times must ascend", i + 1,
                                  point.arrive, point.leave));
    for (const double time : {point.arrive, point.leave})
      if (info.times.empty() || time > info.times.back()) info.times.push_back(time);
  }
  if (log.errors() > before) return failed;
  info.spans = {{points.front().arrive, points.back().leave}};
  return placement_source(std::move(info), target, Quantity::position,
                          [points = std::move(points)](double time, Placement& placement) {
                            placement.position = held_position(points, time);
                            return kFilled;
                          });
}

}  // namespace panwright::scenario
