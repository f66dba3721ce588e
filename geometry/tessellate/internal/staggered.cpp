#include "geometry/tessellate/internal/staggered.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace panwright::geometry::internal {

namespace {

// meridians of a quarter turn that are looked at where steps are uneven
constexpr int kMeridians = 4;
// fewest steps: about a pole, and in rings with texture coordinates as a share of the equator's
constexpr std::uint32_t kFewest = 5;
constexpr double kTextureShare = 0.7;
// of equilateral facets at the equator, the length of their sides
constexpr std::array kFirst{0.95, 1.03, 1.08};
// Counts fall where facets have become slimmer than the first, to make them as wide as the second:
// falling costs half a row, which matters less the more rows there are. From so many steps at the
// equator on; measured on spheres.
struct Fall {
  double steps, slim, wide;
};
constexpr std::array kFalls{Fall{0, 0.5, 0.8}, Fall{45, 0.6, 0.85}, Fall{80, 0.7, 0.9},
                            Fall{150, 0.75, 0.95}, Fall{350, 0.85, 1.0}};
// a strip with fewer steps is at least so much as high as one without
constexpr double kLeastHeight = 0.35;
// shorter sides where no plan was found, and how short they become
constexpr double kNarrow = 0.75, kNarrowest = 0.01;
// steps towards equal errors inside and outside
constexpr int kBalances = 40;

enum class Joint : std::uint8_t {
  staggered,  // the vertices of one ring half a step from those of the other
  any         // wherever they stand
};

class StaggeredPlanner {
 public:
  StaggeredPlanner(const Vec3& radii, const Steps& around, double error, bool texcoords)
      : radii_(radii), error_(error), texcoords_(texcoords) {
    set_out(error);
    const std::uint64_t count = around.even() ? 0 : kMeridians;
    for (std::uint64_t k = 0; k <= count; ++k) {
      const det::SinCos at = around.at(k, 4 * kMeridians);
      meridians_.push_back({around.stretch(k, 4 * kMeridians), at.cos * at.cos, at.sin * at.sin});
    }
    cosines_.resize(meridians_.size());
    equator_ = steps_of_side(0);
  }

  std::optional<Staggered> best(double most) {
    std::optional<Staggered> best;
    Fall fall = kFalls.front();
    for (const Fall& other : kFalls)
      if (equator_ >= other.steps) fall = other;
    for (const double side : kFirst)
      if (!consider(side, fall, most, best)) return std::nullopt;
    // note: where much longer steps stand beside short ones, strips may be too low for them
    for (double side = kNarrow * kFirst.front(); !best && side > kNarrowest; side *= kNarrow)
      if (!consider(side, fall, most, best)) return std::nullopt;
    if (!best || best->triangles > most) return std::nullopt;
    balance(*best);
    return best;
  }

 private:
  // Takes the plan for sides of that length at the equator if it is the best so far. False: there
  // are too many steps.
  bool consider(double side, const Fall& fall, double most, std::optional<Staggered>& best) {
    const double wanted = std::ceil(equator_ / side);
    if (!(wanted < 0x1p29)) return false;
    const auto steps = static_cast<std::uint32_t>(std::max(3.0, wanted));
    for (const bool across : {true, false}) {
      const double bound = best ? std::min(most, best->triangles) : most;
      std::optional<Staggered> plan = hemisphere(steps, across, fall, bound);
      if (plan && (!best || plan->triangles < best->triangles)) best = std::move(plan);
    }
    return true;
  }

  struct Meridian {
    double stretch;     // of a step against an even one
    double cos2, sin2;  // of its longitude
  };

  void set_out(double out) {
    out_ = out;
    const Vec3 large = radii_ + Vec3(out);
    inverse_ = Vec3(1) / (large * large);
    const Vec3 less = radii_ / large;
    less_ = less * less;
  }

  // the squares of a normal's parts across and along the axis, on the unit sphere, weighed
  static double weighed(const Meridian& m, const Vec3& weight, double across, double along) {
    return across * (m.cos2 * weight.x + m.sin2 * weight.y) + along * weight.z;
  }

  // half of the square of the radius about a facet, on the unit sphere
  double facet_share(const Meridian& m, const det::SinCos& latitude) const {
    const double across = latitude.cos * latitude.cos, along = latitude.sin * latitude.sin;
    return std::min(1.0, 2 * error_ * std::sqrt(weighed(m, inverse_, across, along)));
  }

  // The steps about the axis for sides of equilateral facets at a latitude.
  double steps_of_side(double latitude) const {
    const det::SinCos at = det::sincos(latitude);
    double most = 0;
    for (const Meridian& m : meridians_)
      most = std::max(most, m.stretch / std::sqrt(facet_share(m, at)));
    // the side is √3 of the radius about a facet
    return most * 2 * kPi * std::fabs(at.cos) / std::sqrt(6.0);
  }

  void set_steps(std::uint32_t steps) {
    for (std::size_t i = 0; i < meridians_.size(); ++i)
      cosines_[i] = det::sincos(std::min(0.5 * kPi, kPi / steps * meridians_[i].stretch)).cos;
  }

  // Of the plane through two points of a meridian, (radius, height), and the normal to that
  // meridian.
  double facet_depth(const Meridian& m, const Vec2& a, const Vec2& b) const {
    const Vec2 e = b - a;
    const double length2 = glm::dot(e, e);
    if (!(length2 > 0)) return std::numeric_limits<double>::infinity();
    const double distance = std::fabs(a.x * b.y - a.y * b.x) / std::sqrt(length2);
    const double across = e.y * e.y / length2, along = e.x * e.x / length2;
    return (std::sqrt(weighed(m, less_, across, along)) - distance) /
           std::sqrt(weighed(m, inverse_, across, along));
  }

  // of the facets between two parallels, after set_steps() of the wider steps
  double strip_depth(const det::SinCos& low, const det::SinCos& high, Joint joint) const {
    double deepest = -error_;
    for (std::size_t i = 0; i < meridians_.size(); ++i) {
      const Meridian& m = meridians_[i];
      const Vec2 a(cosines_[i] * low.cos, low.sin), b(cosines_[i] * high.cos, high.sin);
      deepest = std::max({deepest, facet_depth(m, a, {high.cos, high.sin}),
                          facet_depth(m, {low.cos, low.sin}, b)});
      // vertices one above the other: four of them lie in one plane
      if (joint == Joint::any) deepest = std::max(deepest, facet_depth(m, a, b));
    }
    return deepest;
  }

  // How high a strip of equal steps from a parallel may be, about.
  double guess(double latitude, std::uint32_t steps, Joint joint) const {
    const det::SinCos at = det::sincos(latitude);
    double least = kPi;
    for (const Meridian& m : meridians_) {
      const double radius = std::sqrt(2 * facet_share(m, at));
      const double side = 2 * kPi / steps * m.stretch * at.cos;
      const double height =
          joint == Joint::staggered
              ? radius + std::sqrt(std::max(0.0, radius * radius - 0.25 * side * side))
              : std::sqrt(std::max(0.0, 4 * radius * radius - side * side));
      least = std::min(least, std::max(height, 0.3 * radius));
    }
    return least;
  }

  // The largest x up to `room` for which deep(x), rising about there, is allowed; 0: none found.
  template <class Deep>
  double widest(double x, double room, const Deep& deep) {
    x = std::min(x, room);
    double low = 0, high = 0, at_low = 0, at_high = 0;
    for (int i = 0; i < 24 && (low == 0 || high == 0); ++i) {
      // the guess is near
      const double value = deep(x) - error_;
      if (value <= 0) {
        low = x;
        at_low = value;
        if (x == room) break;
        x = std::min(room, (i == 0 ? 1.04 : 1.15) * x);
      } else {
        high = x;
        at_high = value;
        x *= i == 0 ? 0.96 : 0.88;
      }
    }
    if (low == 0 || high == 0) return low;
    for (int i = 0; i < 4 && at_low < -1e-4 * error_; ++i) {
      const double middle = low + (high - low) * (at_low / (at_low - at_high));
      const double value = deep(middle) - error_;
      (value <= 0 ? low : high) = middle;
      (value <= 0 ? at_low : at_high) = value;
    }
    return low;
  }

  // the latitude of the next ring, or one beyond the pole where none is possible
  double next(double latitude, std::uint32_t steps, Joint joint) {
    set_steps(steps);
    const det::SinCos at = det::sincos(latitude);
    const double height =
        widest(guess(latitude, steps, joint), 0.5 * kPi - latitude,
               [&](double x) { return strip_depth(at, det::sincos(latitude + x), joint); });
    return height > 0 ? latitude + height : kPi;
  }

  // From the equator to the north pole; across: a strip lies across the equator, not a ring on it.
  std::optional<Staggered> hemisphere(std::uint32_t first, bool across, const Fall& fall,
                                      double most) {
    const std::uint32_t fewest = std::max(
        kFewest, texcoords_ ? static_cast<std::uint32_t>(std::ceil(kTextureShare * first)) : 0u);
    std::uint32_t steps = first;
    double latitude = 0;
    if (across) {
      set_steps(steps);
      latitude =
          widest(0.5 * guess(0, steps, Joint::staggered), 0.5 * kPi * (1 - 1e-9), [&](double x) {
            const det::SinCos at = det::sincos(x);
            return strip_depth({-at.sin, at.cos}, at, Joint::staggered);
          });
      if (latitude == 0) return std::nullopt;
    }
    std::vector<StaggeredRing> north{{det::sincos(latitude), steps, false}};
    double triangles = 0;
    for (;;) {
      set_steps(steps);
      const bool closes = strip_depth(north.back().latitude, {1, 0}, Joint::staggered) <= error_;
      if (closes) break;
      const double even = next(latitude, steps, Joint::staggered);
      if (!(even < 0.5 * kPi) || even - latitude < 1e-9) return std::nullopt;
      const auto [further, fewer] = fallen(latitude, even, steps, fewest, fall);
      latitude = further;
      steps = fewer;
      north.push_back({det::sincos(latitude), steps, false});
      // note: of both hemispheres
      triangles += 4.0 * steps;
      if (triangles > most) return std::nullopt;
    }
    return finished(north, across);
  }

  // The next ring, with fewer steps where they have become too short.
  std::pair<double, std::uint32_t> fallen(double latitude, double even, std::uint32_t steps,
                                          std::uint32_t fewest, const Fall& fall) {
    const double wanted = steps_of_side(even);
    if (steps <= fewest || wanted >= fall.slim * steps) return {even, steps};
    auto fewer = static_cast<std::uint32_t>(
        std::clamp(wanted / fall.wide, static_cast<double>(fewest), static_cast<double>(steps)));
    const det::SinCos at = det::sincos(latitude);
    const double least = latitude + kLeastHeight * (even - latitude);
    const det::SinCos above = det::sincos(least);
    for (; fewer < steps; fewer += 1 + fewer / 50) {
      set_steps(fewer);
      if (strip_depth(at, above, Joint::any) > error_) continue;
      const double further = next(latitude, fewer, Joint::any);
      if (further < 0.5 * kPi && further > least &&
          steps_of_side(further) <= 1.2 * fall.wide * fewer)
        return {further, fewer};
    }
    return {even, steps};
  }

  // both hemispheres, and what they cost
  Staggered finished(const std::vector<StaggeredRing>& north, bool across) const {
    Staggered plan;
    for (std::size_t i = north.size(); i-- > (across ? 0 : 1);) {
      StaggeredRing ring = north[i];
      ring.latitude.sin = -ring.latitude.sin;
      plan.rings.push_back(ring);
    }
    plan.rings.insert(plan.rings.end(), north.begin(), north.end());
    double before = 0;
    for (std::size_t i = 0; i < plan.rings.size(); ++i) {
      StaggeredRing& ring = plan.rings[i];
      ring.shifted = i > 0 && plan.rings[i - 1].steps == ring.steps && !plan.rings[i - 1].shifted;
      const double segments = ring.steps + (texcoords_ && ring.shifted ? 1.0 : 0.0);
      plan.triangles += before + segments;
      plan.vertices += segments + (texcoords_ ? 1 : 0);
      if (i == 0) plan.vertices += texcoords_ ? segments : 1;
      before = segments;
    }
    plan.triangles += before;
    plan.vertices += texcoords_ ? before : 1;
    return plan;
  }

  double depth_of(const std::vector<StaggeredRing>& rings) {
    set_steps(rings.front().steps);
    double deepest = strip_depth({-1, 0}, rings.front().latitude, Joint::staggered);
    for (std::size_t i = 1; i < rings.size(); ++i) {
      const bool same = rings[i - 1].steps == rings[i].steps;
      set_steps(std::min(rings[i - 1].steps, rings[i].steps));
      deepest = std::max(deepest, strip_depth(rings[i - 1].latitude, rings[i].latitude,
                                              same ? Joint::staggered : Joint::any));
    }
    return deepest;
  }

  // Vertices stand out by as much as facets lie inside.
  void balance(Staggered& plan) {
    for (int i = 0; i < kBalances; ++i) {
      plan.out = out_;
      plan.depth = depth_of(plan.rings);
      if (std::fabs(plan.depth - plan.out) <= 1e-3 * plan.out) break;
      set_out(0.5 * (plan.out + std::max(plan.depth, 0.0)));
    }
  }

  Vec3 radii_;
  double error_;
  bool texcoords_;
  double out_ = 0;
  Vec3 inverse_,
      less_;  // squares of the inverse of the vertices' radii, and of the shape's by them
  std::vector<Meridian> meridians_;
  std::vector<double> cosines_;  // of half a step, by meridian
  double equator_ = 0;           // steps of equilateral facets at the equator
};

}  // namespace

std::optional<Staggered> staggered(const Vec3& radii, const Steps& around, double error,
                                   bool texcoords, double most) {
  // beyond the shape's size an error allows no fewer triangles, and vertices should not stand so
  // far out
  const double largest = std::max({radii.x, radii.y, radii.z});
  return StaggeredPlanner(radii, around, std::min(error, largest), texcoords).best(most);
}

}  // namespace panwright::geometry::internal
