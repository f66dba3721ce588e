#include "geometry/tessellate/internal/tube_plan.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/axis_box.h"
#include "geometry/internal/limits.h"
#include "geometry/tessellate/internal/circle.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/tube_sections.h"

namespace panwright::geometry::internal {

namespace {

// sections stay this much clear of folding
constexpr double kClear = 0.98;
// of what vertices may stand out by; the rest is for what measuring adds
constexpr double kShiftShare = 0.96;

class Planner {
 public:
  Planner(const Tube& tube, const TessellationOptions& options)
      : tube_(tube), options_(options), surfaces_(tube.inner_radius > 0 ? 2 : 1) {}

  TubePlan run() {
    const bool counted = tube_.counts.around != 0 && (tube_.counts.along != 0 || !tube_.spline);
    allowed_ = options_.max_error - rounding_bound(reach());
    if (!(allowed_ > 0) && !counted) {
      plan_.state = TubePlan::State::too_fine;
      return std::move(plan_);
    }
    exact_ = tube_.counts.around != 0 || tube_.counts.along != 0 || options_.edge_segments > 0;
    tube_.spline ? plan_spline() : plan_straights();
    return std::move(plan_);
  }

 private:
  double reach() const {
    AxisBox box;
    for (const Vec3& p : tube_.path) box.add(p);
    // a spline leaves the bounds of its points by less than their diagonal's half, a mitre by
    // less than the shorter straight
    return box.diagonal() + 2 * tube_.radius;
  }

  void count_triangles(double bands) {
    const double n = plan_.segments;
    plan_.triangles = 2 * n * bands * surfaces_;
    if (tube_.closed || tube_.caps == Caps::none) return;
    const double caps = tube_.caps == Caps::both ? 2 : 1;
    plan_.triangles += caps * (surfaces_ == 2 ? 2 * n : n - 2);
  }

  double half() const { return kPi / plan_.segments; }
  // how far vertices stand out, and sides dip inside, for a radius of 1
  double outside() const { return plan_.factor - 1; }
  double inside() const {
    const double s = det::sin(0.5 * half());
    return 1 - plan_.factor + 2 * plan_.factor * s * s;
  }

  void set_segments(std::uint32_t segments, bool on_shape) {
    plan_.segments = segments;
    plan_.factor = on_shape ? 1 : area_factor(half());
  }
  bool given_segments() {
    const std::uint32_t given =
        tube_.counts.around != 0 ? tube_.counts.around : options_.edge_segments;
    if (given != 0) set_segments(given, true);
    return given != 0;
  }

  // ---- straights between mitres

  void plan_straights() {
    const Straights straights = straights_of(tube_);
    const std::size_t count = straights.frame.size();
    leans(straights);
    if (!given_segments()) {
      const double relative = allowed_ / tube_.radius;
      const std::uint32_t exact = segments_within(relative, Sector{}, true);
      // what stands out of both sides of an edge stands out further at it
      const std::uint32_t area = segments_within(relative / sharpness_, Sector{}, false);
      const bool on_shape =
          exact_ || exact < area || area_factor(kPi / area) * tube_.radius >= clear_radius_;
      set_segments(on_shape ? exact : area, on_shape);
    }
    plan_.error = tube_.radius * std::max(outside() * sharpness_, inside());
    count_triangles(static_cast<double>(count));
    if (too_many()) return;
    const double twist = closing_twist(straights);
    add_straights(straights, twist);
  }

  bool too_many() {
    if (plan_.triangles <= static_cast<double>(options_.max_triangles) && plan_.segments < 1u << 31)
      return false;
    refuse();
    return true;
  }
  void refuse() {
    plan_.state = TubePlan::State::too_many;
    plan_.triangles = std::max(plan_.triangles, static_cast<double>(options_.max_triangles) + 1);
  }

  std::size_t before(std::size_t i, std::size_t count) const { return i > 0 ? i - 1 : count - 1; }

  // Leans at the begins and ends of straights.
  void leans(const Straights& straights) {
    const std::size_t count = straights.frame.size();
    begin_lean_.assign(count, Vec3(0));
    end_lean_.assign(count, Vec3(0));
    for (std::size_t i = 0; i < count; ++i) {
      if (i == 0 && !tube_.closed) continue;
      const std::size_t h = before(i, count);
      const Vec3& in = straights.frame[h].tangent;
      const Vec3& out = straights.frame[i].tangent;
      end_lean_[h] = lean_of(in, out);
      begin_lean_[i] = lean_of(out, in);
      sharpness_ = std::max(sharpness_, std::sqrt(1 + glm::dot(end_lean_[h], end_lean_[h])));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const double slope = glm::length(end_lean_[i] - begin_lean_[i]);
      if (slope > 0) clear_radius_ = std::min(clear_radius_, kClear * straights.length[i] / slope);
    }
  }

  // The angle that frames have left after a closed path, without whole segments: those are a shift.
  double closing_twist(const Straights& straights) {
    if (!tube_.closed) return 0;
    const Frame& first = straights.frame.front();
    const Frame& last = straights.frame.back();
    const Vec3 right = carried({last.centre, last.tangent, last.right}, last.centre, first.tangent);
    return without_shift(det::atan2(glm::dot(right, first.up()), glm::dot(right, first.right)));
  }
  double without_shift(double twist) {
    const double step = 2 * kPi / plan_.segments;
    const double whole = std::round(twist / step);
    const auto n = static_cast<std::int64_t>(plan_.segments);
    const std::int64_t shift = static_cast<std::int64_t>(whole) % n;
    shift_ = static_cast<std::uint32_t>((shift + n) % n);
    const double rest = twist - whole * step;
    // frames turn back by it
    plan_.turning = rest < 0;
    return rest;
  }

  void add_straights(const Straights& straights, double twist) {
    const std::size_t count = straights.frame.size();
    double whole = 0;
    for (const double length : straights.length) whole += length;
    double along = 0;
    plan_.rings.reserve(count + 1);
    plan_.rows.reserve(2 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const Frame begin = turned(straights.frame[i], -twist * along / whole);
      if (i == 0) add_ring(begin, begin_lean_[i]);
      add_row(static_cast<std::uint32_t>(i), 0, begin, along / whole);
      along += straights.length[i];
      const bool last = i + 1 == count;
      Frame end = turned(straights.frame[i], last ? -twist : -twist * along / whole);
      end.centre =
          last && !tube_.closed ? tube_.path.back() : straights.frame[(i + 1) % count].centre;
      const bool closing = last && tube_.closed;
      if (!closing) add_ring(end, end_lean_[i]);
      add_row(closing ? 0 : static_cast<std::uint32_t>(i + 1), closing ? shift_ : 0, end,
              last ? 1 : along / whole);
      const auto row = static_cast<std::uint32_t>(plan_.rows.size() - 1);
      plan_.bands.push_back({row - 1, row, 0});
    }
  }

  void add_ring(const Frame& frame, const Vec3& lean) {
    const Vec3 up = frame.up();
    plan_.rings.push_back({frame.centre, frame.right - glm::dot(frame.right, lean) * frame.tangent,
                           up - glm::dot(up, lean) * frame.tangent});
  }
  void add_row(std::uint32_t ring, std::uint32_t shift, const Frame& frame, double v) {
    plan_.rows.push_back({ring, shift, frame.right, frame.up(), v});
  }

  // ---- a spline

  void plan_spline() {
    const SplinePath path(tube_.path, tube_.closed);
    const double sharpest = path.sharpest().curvature;
    if (!given_segments()) choose_segments(path, sharpest);
    const double twist = tube_.closed ? without_shift(path.twist()) : 0;
    const SectionPlacer placer(
        path, {tube_.closed, allowances(), det::sin(half()), shift_allowed(), twist});
    const double most = static_cast<double>(options_.max_triangles) / (2.0 * plan_.segments) + 1;
    const std::vector<Section> sections =
        tube_.counts.along != 0 ? even_sections(path, placer, most) : placer.placed(most);
    count_triangles(static_cast<double>(sections.size()) - 1);
    if (too_many()) return;
    if (sections.empty() || sections.back().t < path.end()) return refuse();
    add_sections(path, placer, sections);
  }

  std::vector<Section> even_sections(const SplinePath& path, const SectionPlacer& placer,
                                     double most) const {
    std::vector<Section> sections;
    if (tube_.counts.along > most) return sections;
    for (std::uint32_t i = 0; i < tube_.counts.along; ++i)
      sections.push_back(placer.section(path.at_length(path.length() * i / tube_.counts.along), 0));
    sections.push_back(placer.section(path.end(), 0));
    return sections;
  }

  // The product of segments and sections is what the mesh costs.
  void choose_segments(const SplinePath& path, double sharpest) {
    const double outer =
        path.integral([&](double k) { return std::sqrt(k * (1 + k * tube_.radius)); });
    const double inner =
        path.integral([&](double k) { return std::sqrt(k * std::max(0.0, 1 - k * tube_.radius)); });
    const double relative = allowed_ / tube_.radius;
    const bool on_shape = exact_ || sharpest * tube_.radius > 0.9;
    const std::uint32_t fewest = segments_within(relative, Sector{}, on_shape);
    double best = 0;
    std::uint32_t chosen = 0;
    // three times the fewest leave eight ninths of the error to the sections
    const std::uint64_t most = 3 * std::uint64_t{fewest} + 3;
    const std::uint64_t stride = std::max<std::uint64_t>(1, (most - fewest) / 512);
    for (std::uint64_t n = fewest; n <= most && n < 1u << 31; n += stride) {
      set_segments(static_cast<std::uint32_t>(n), on_shape);
      if (sharpest * tube_.radius * plan_.factor > kClear && !on_shape) continue;
      const Allowance allowance = allowance_of(tube_.radius);
      if (!(allowance.low < 0 && allowance.high > 0)) continue;
      const double shift = shift_allowed();
      const double bands = std::max(outer / std::sqrt(8 * (shift - allowance.low)),
                                    inner / std::sqrt(8 * (shift + allowance.high)));
      const double cost = static_cast<double>(n) * (bands + 0.5);
      if (chosen != 0 && cost >= best) continue;
      best = cost;
      chosen = static_cast<std::uint32_t>(n);
    }
    set_segments(chosen != 0 ? chosen : fewest, on_shape);
  }

  Allowance allowance_of(double radius) const {
    const double high = allowed_ - outside() * radius;
    const double low = (allowed_ - inside() * radius) / det::cos(half());
    return {plan_.factor * radius, -low, high};
  }
  // where the segments use more than there is, sections get a quarter of the whole
  std::vector<Allowance> allowances() const {
    std::vector<Allowance> result{allowance_of(tube_.radius)};
    if (surfaces_ == 2) result.push_back(allowance_of(tube_.inner_radius));
    const double least = 0.25 * std::max(allowed_, 1e-9 * tube_.radius);
    for (Allowance& a : result) {
      a.low = std::min(a.low, -least);
      a.high = std::max(a.high, least);
    }
    return result;
  }
  double shift_allowed() const {
    if (tube_.counts.around != 0 || tube_.counts.along != 0) return 0;
    const Allowance allowance = allowance_of(tube_.radius);
    return kShiftShare * std::max(0.0, std::min(allowance.high, -allowance.low));
  }

  void add_sections(const SplinePath& path, const SectionPlacer& placer,
                    const std::vector<Section>& sections) {
    const std::size_t count = sections.size();
    plan_.rings.reserve(count);
    plan_.rows.reserve(count);
    plan_.bands.reserve(count);
    double outside_most = 0, inside_most = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Section& here = sections[i];
      const double v = i + 1 == count ? 1 : path.length_to(here.t) / path.length();
      const bool closing = tube_.closed && i + 1 == count;
      if (!closing) add_ring(here.frame, Vec3(0));
      add_row(closing ? 0 : static_cast<std::uint32_t>(i), closing ? shift_ : 0, here.frame, v);
      if (i == 0) continue;
      measure(placer, sections[i - 1], here, outside_most, inside_most);
      const auto row = static_cast<std::uint32_t>(i);
      // the last row is the first one, unless textures tell them apart
      if (closing && !options_.texcoords)
        plan_.bands.push_back({row - 1, 0, shift_});
      else
        plan_.bands.push_back({row - 1, row, 0});
    }
    if (tube_.closed && !options_.texcoords) plan_.rows.pop_back();
    plan_.error = std::max(outside_most, inside_most);
  }

  void measure(const SectionPlacer& placer, const Section& a, const Section& b,
               double& outside_most, double& inside_most) const {
    for (const double exact : {tube_.radius, tube_.inner_radius}) {
      if (exact == 0) continue;
      const double radius = plan_.factor * exact;
      Range range = placer.measure(a, b, radius);
      if (range.folded) {
        // explicit counts that are too few: no point is further from the path than the chord is
        // long
        const double chord = glm::length(b.frame.centre - a.frame.centre) + 2 * exact;
        range.low = -chord;
        range.high = chord;
      }
      outside_most = std::max(outside_most, radius + range.high - exact);
      inside_most = std::max(inside_most, exact - (radius + range.low) * det::cos(half()));
    }
  }

  const Tube& tube_;
  const TessellationOptions& options_;
  int surfaces_;
  double allowed_ = 0;  // metres
  bool exact_ = false;  // vertices stand on the shape
  double sharpness_ = 1;
  double clear_radius_ = 1e300;
  std::uint32_t shift_ = 0;
  std::vector<Vec3> begin_lean_, end_lean_;
  TubePlan plan_;
};

}  // namespace

Vec3 lean_of(const Vec3& tangent, const Vec3& other) {
  const Vec3 across = glm::normalize(tangent + other);
  const double cosine = glm::dot(tangent, across);
  return (across - cosine * tangent) / cosine;
}

Straights straights_of(const Tube& tube) {
  const std::vector<Vec3>& path = tube.path;
  const std::size_t count = path.size();
  const auto direction = [&](std::size_t i) {
    return glm::normalize(path[(i + 1) % count] - path[i]);
  };
  Straights result;
  const std::size_t segments = tube.closed ? count : count - 1;
  // a closed path begins at a corner
  std::size_t first = 0;
  const auto bends = [&](std::size_t i) {
    return angle_between(direction(i > 0 ? i - 1 : count - 1), direction(i)) > kStraight;
  };
  while (tube.closed && first + 1 < count && !bends(first)) ++first;
  for (std::size_t k = 0; k < segments; ++k) {
    const std::size_t i = (first + k) % count;
    const Vec3 tangent = direction(i);
    if (k > 0 && angle_between(tangent, result.frame.back().tangent) <= kStraight) continue;
    Frame frame{path[i], tangent, {}};
    frame.right = k == 0
                      ? first_right(tangent)
                      : carried({path[i], result.frame.back().tangent, result.frame.back().right},
                                path[i], tangent);
    result.corner.push_back(i);
    result.frame.push_back(frame);
  }
  for (std::size_t i = 0; i < result.frame.size(); ++i) {
    const bool last = i + 1 == result.frame.size();
    const Vec3& end = !last         ? result.frame[i + 1].centre
                      : tube.closed ? result.frame[0].centre
                                    : path.back();
    result.length.push_back(glm::length(end - result.frame[i].centre));
  }
  return result;
}

std::vector<Frame> end_frames(const Tube& tube) {
  if (tube.closed) return {};
  if (tube.spline) {
    const SplinePath path(tube.path, false);
    return {path.frame_at(0), path.frame_at(path.end())};
  }
  const Straights straights = straights_of(tube);
  Frame end = straights.frame.back();
  end.centre = tube.path.back();
  return {straights.frame.front(), end};
}

TubePlan plan_of(const Tube& tube, const TessellationOptions& options) {
  return Planner(tube, options).run();
}

}  // namespace panwright::geometry::internal
