// The last sunlight behind a planet, through the ring of its air.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sky/sky.h"

namespace panwright::sky {
namespace {

// A place outside the air and the Sun's disc there, in the space where the body is the unit sphere.
// Radiance is the same along bent rays, so the apparent sky is summed: a ray of lowest height z is
// seen at the angle a from the body's centre, sin a = (1 + z)/distance, and comes from the angle
// a − bending; below 0 from the other side.
struct Ring {
  const light::Air* air = nullptr;
  double distance = 0;  // from the centre, above air->top()
  double radius = 0;    // of the Sun's disc, radians
  double limb = 0;      // darkening

  // Integral around the body of the disc's brightness at an angle from its centre; the Sun is at
  // the angle `sun`, its middle's brightness is 1.
  double across(double angle, double sun) const {
    constexpr int kPlaces = 8;
    const det::SinCos here = det::sincos(angle), there = det::sincos(sun);
    const double product = here.sin * there.sin;
    // (1 − cos) of what is left of the disc's radius
    const double left = det::cos(angle - sun) - det::cos(radius);
    if (!(left > 0)) return 0;
    const double half = product > 0.5 * left ? det::acos(1 - left / product) : kPi;
    double sum = 0;
    for (int k = 0; k < kPlaces; ++k) {
      // dense at the ends, where the brightness is a root
      const det::SinCos turn = det::sincos(0.5 * kPi * (k + 0.5) / kPlaces);
      const double sine = det::sin(0.5 * half * turn.sin);
      const double above = std::max(0.0, left - 2 * product * sine * sine);
      const double mu = std::sqrt(2 * above) / radius;
      sum += turn.cos * (1 - limb + limb * std::min(mu, 1.0));
    }
    return sum * kPi * half / kPlaces;
  }

  // Angle from the body's centre, below 0 beyond it, from which a ray of lowest place r comes.
  double source(double r) const { return det::asin(r / distance) - air->bending(r); }
  // The lowest place of rays from there, at the ground or above.
  double lowest(double from) const {
    if (from <= source(1)) return 1;
    if (from >= source(air->top())) return distance * det::sin(std::min(from, 0.5 * kPi));
    double low = 1, high = air->top();
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (source(middle) < from ? low : high) = middle;
    }
    return low;
  }

  // Share of the Sun's light at its angle from the body's centre.
  Vec3 share(double sun) const {
    constexpr int kPlaces = 40;
    // where rings begin and cease to meet the disc, and where they lie within it
    const double far = sun + radius, near = std::fabs(sun - radius);
    std::array<double, 6> ends = {lowest(-far), lowest(-near), lowest(0),
                                  lowest(near), lowest(far),   air->top()};
    std::ranges::sort(ends);
    Vec3 sum(0);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const double middle = 0.5 * (ends[i] + ends[i + 1]), half = 0.5 * (ends[i + 1] - ends[i]);
      if (!(half > 0) || !(across(std::fabs(source(middle)), sun) > 0)) continue;
      for (int k = 0; k < kPlaces; ++k) {
        // dense at both ends, where light begins as a root
        const det::SinCos turn = det::sincos(kPi * ((k + 0.5) / kPlaces - 0.5));
        const double r = middle + half * turn.sin;
        const double light = across(std::fabs(source(r)), sun);
        // of the apparent sky a ring has the sine of its angle, r/distance
        const double wide = half * turn.cos / std::sqrt((distance - r) * (distance + r));
        sum += air->grazing(r) * (light * r / distance * wide * kPi / kPlaces);
      }
    }
    const double whole = kPi * radius * radius * (1 - limb / 3);
    return glm::clamp(sum / whole, Vec3(0), Vec3(1));
  }

  // What arrives of the light of a point that stands at an angle from the body's centre, on both
  // sides of it: air dims it, and spreads it as the seen angle changes with its own.
  Vec3 through(double straight) const {
    constexpr double kStep = 1e-7;  // of the body's radius
    if (straight >= source(air->top())) return Vec3(1);
    Vec3 sum(0);
    for (const double from : {straight, -straight}) {
      if (from < source(1)) continue;
      const double r = lowest(from);
      const double seen = kStep / std::sqrt((distance - r) * (distance + r));
      const double change = source(r + kStep) - source(r);
      sum += air->grazing(r) * (seen / change * r / distance / std::max(det::sin(straight), 1e-9));
    }
    return sum;
  }

  // The Sun's angle from the body's centre where it stands t radii of its disc beyond the limb, as
  // radii_beyond() measures these.
  double sun_at(double t) const {
    const double slope = t * radius;
    return det::asin(std::min(1.0, 1 / (distance * std::sqrt(1 + slope * slope)))) +
           det::atan(slope);
  }
};

// How far the Sun stands beyond the limb at its angle from the body's centre, in radii of its disc.
double radii_beyond(const Ring& ring, double sun) {
  const det::SinCos at = det::sincos(sun);
  return (at.sin - 1 / ring.distance) / (std::max(at.cos, 1e-9) * ring.radius);
}

struct Placed {
  Ring ring;
  double sun = 0;  // its angle from the body's centre
};

// The ring of a body about the Sun at a point; none: the body has no sunset, is behind, or the
// point is in its air.
std::optional<Placed> placed(const Sky& sky, std::size_t index, const Vec3& point) {
  const light::Air* air = sky.air(index);
  if (air == nullptr || !sky.body(index).sunset) return std::nullopt;
  const Ellipsoid& shape = sky.shape(index);
  const Vec3 from = shape.from(point);
  const double distance = std::sqrt(glm::dot(from, from));
  const Vec3 sun = shape.unit_from_world * sky.to_sun();
  if (!(distance > air->top()) || glm::dot(from, sun) >= 0) return std::nullopt;
  const Vec3 toward = shape.centre - point;
  const Vec3 beside = toward - sky.to_sun() * glm::dot(toward, sky.to_sun());
  const double off = std::sqrt(glm::dot(beside, beside));
  const Vec3 aside = off > 0 ? beside / off : Vec3(0);
  const Vec3 edge = shape.unit_from_world * (sky.to_sun() + sky.sun_sine() * aside);
  const double radius = off > 0 ? angle_between(glm::normalize(sun), glm::normalize(edge))
                                : det::asin(sky.sun_sine());
  return Placed{{air, distance, radius, sky.limb_darkening()},
                angle_between(-from / distance, glm::normalize(sun))};
}

// The deepest sunset near a point, its shares yet to be found, and its ring.
std::optional<std::pair<Sunset, Ring>> deepest(const Sky& sky, const Vec3& point, double radius) {
  std::optional<std::pair<Sunset, Ring>> found;
  for (std::size_t i = 0; i < sky.size(); ++i) {
    const auto here = placed(sky, i, point);
    if (!here) continue;
    const Ring& ring = here->ring;
    Sunset sunset;
    sunset.body = i;
    sunset.edge.value = radii_beyond(ring, here->sun);
    double change = 0;
    for (int k = 0; k < 3; ++k) {
      Vec3 step(0);
      step[k] = radius;
      const auto more = placed(sky, i, point + step), less = placed(sky, i, point - step);
      if (!more || !less) continue;
      const double half =
          0.5 * (radii_beyond(more->ring, more->sun) - radii_beyond(less->ring, less->sun));
      sunset.edge.gradient[k] = half / radius;
      change += std::fabs(half);
    }
    const double lowest = det::asin(1 / ring.distance) - ring.air->bending(1) - ring.radius;
    const double highest = det::asin(ring.air->top() / ring.distance) + ring.radius;
    sunset.first = radii_beyond(ring, std::max(lowest, 0.0));
    sunset.step = (radii_beyond(ring, highest) - sunset.first) / (Sunset::kNodes - 1);
    if (sunset.edge.value - 2 * change > sunset.last()) continue;
    if (!found || sunset.edge.value < found->first.edge.value) found.emplace(sunset, ring);
  }
  return found;
}

}  // namespace

Vec3 Sunset::at(double t) const {
  const double x = (t - first) / step;
  if (!(x > 0)) return shares.front();
  const auto i = static_cast<std::size_t>(x);
  if (i + 1 >= shares.size()) return shares.back();
  return glm::mix(shares[i], shares[i + 1], x - static_cast<double>(i));
}

bool Sky::sunset_near(const Vec3& point, double radius) const {
  return deepest(*this, point, radius).has_value();
}

std::optional<Sunset> Sky::sunset(const Vec3& point, double radius) const {
  auto found = deepest(*this, point, radius);
  if (!found) return std::nullopt;
  auto& [sunset, ring] = *found;
  for (std::size_t k = 0; k + 1 < Sunset::kNodes; ++k)
    sunset.shares[k] = ring.share(ring.sun_at(sunset.first + static_cast<double>(k) * sunset.step));
  sunset.shares[Sunset::kNodes - 1] = Vec3(1);
  for (std::size_t k = 0; k < Sunset::kNodes; ++k)
    sunset.through[k] =
        ring.through(std::fabs(ring.sun_at(sunset.first + static_cast<double>(k) * sunset.step)));
  return sunset;
}

Vec3 Sky::sunlight(const Vec3& point) const {
  std::optional<std::size_t> lowest;
  std::optional<Placed> its;
  for (std::size_t i = 0; i < size(); ++i) {
    const auto here = placed(*this, i, point);
    if (!here ||
        here->sun > det::asin(here->ring.air->top() / here->ring.distance) + here->ring.radius)
      continue;
    if (its && radii_beyond(its->ring, its->sun) <= radii_beyond(here->ring, here->sun)) continue;
    lowest = i;
    its = here;
  }
  const double share = sun_share(point, lowest);
  if (!its) return Vec3(share);
  if (share == 0 || share == 1) return share * its->ring.share(its->sun);
  const Ellipsoid& shape = shapes_[*lowest];
  const Vec3 from = shape.from(point), aside = beside_sun(shape.centre - point);
  const Vec3 along = glm::cross(to_sun_, aside), down = -glm::normalize(from);
  const Vec3 through = mean_beside(
      point, *lowest, along,
      [&, middle = shape.unit_from_world * to_sun_,
       right = shape.unit_from_world * (sun_sine_ * along),
       up = shape.unit_from_world * (-sun_sine_ * aside)](double x, double y) {
        return its->ring.through(angle_between(down, glm::normalize(middle + x * right + y * up)));
      });
  return glm::clamp(through, Vec3(0), Vec3(1));
}

}  // namespace panwright::sky
