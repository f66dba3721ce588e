#include "scenario/dated_sky.h"

#include <cmath>

#include "ephemeris/analytic.h"
#include "ephemeris/kernels.h"
#include "scenario/kernels.h"

namespace panwright::scenario {

namespace {

constexpr double kMetresOfKm = 1000;
constexpr double kMetresOfAu = 149597870700.0;
constexpr double kYearSeconds = 365.25 * 86400;

// Speed of a position over seconds, by central differences.
template <class Position>
Vec3 slope(const Position& position, double et, double step) {
  return kMetresOfKm / (2 * step) * (position(et + step) - position(et - step));
}

Vec3 earth_velocity_at(double et) {
  // the Earth turns by 0.25° in the step: 3e-6 of its speed
  constexpr double kStep = 21600;
  return -slope(ephemeris::sun_from_earth, et, kStep);
}

Quat from_body(const ephemeris::Attitude& attitude) {
  return glm::normalize(glm::quat_cast(glm::transpose(attitude.from_j2000)));
}

// Attitude of the axes of RTN: columns in axes of J2000.
Quat rtn_axes(const OrbitState& state) {
  const Vec3 x = glm::normalize(state.position);
  const Vec3 z = glm::normalize(glm::cross(state.position, state.velocity));
  return glm::normalize(glm::quat_cast(Mat3(x, glm::cross(z, x), z)));
}

}  // namespace

double gravity_of(Centre centre) {
  return centre == Centre::earth ? kEarthGravity : 4.902800066e12;
}

double least_radius(Centre centre) { return centre == Centre::earth ? 6356752 : 1735000; }

std::optional<OrbitState> state_of(const OrbitElements& elements, double mu) {
  const double e = elements.eccentricity;
  const double parameter = elements.semi_major * (1 - e * e);
  const det::SinCos nu = det::sincos(elements.true_anomaly);
  const double share = 1 + e * nu.cos;
  if (!(e >= 0) || !(parameter > 0) || !(share > 0) || !std::isfinite(parameter))
    return std::nullopt;
  const det::SinCos node = det::sincos(elements.node), i = det::sincos(elements.inclination),
                    w = det::sincos(elements.periapsis);
  // towards the periapsis, and a quarter of a turn later
  const Vec3 p(node.cos * w.cos - node.sin * w.sin * i.cos,
               node.sin * w.cos + node.cos * w.sin * i.cos, w.sin * i.sin);
  const Vec3 q(-node.cos * w.sin - node.sin * w.cos * i.cos,
               -node.sin * w.sin + node.cos * w.cos * i.cos, w.cos * i.sin);
  const double speed = std::sqrt(mu / parameter);
  return OrbitState{parameter / share * (nu.cos * p + nu.sin * q),
                    speed * (-nu.sin * p + (e + nu.cos) * q)};
}

Vec3 earth_velocity(const Epoch& date) { return earth_velocity_at(et_of(date)); }

std::optional<DatedSky> dated_sky(const Orbit& orbit, const Epoch& date) {
  const double et = et_of(date);
  if (!(et > -200 * kYearSeconds && et < 50 * kYearSeconds)) return std::nullopt;
  const Vec3 moon = kMetresOfKm * ephemeris::moon_from_earth(et);
  Vec3 origin(0);  // from the Earth's centre, axes of J2000
  Vec3 velocity(0);
  if (orbit.about == Centre::moon) {
    constexpr double kMoonStep = 600;
    origin = moon;
    velocity = slope(ephemeris::moon_from_earth, et, kMoonStep);
  }
  DatedSky out;
  if (!orbit.at_centre) {
    const double since = orbit.epoch ? seconds_between(*orbit.epoch, date) : 0;
    const auto state =
        since == 0 ? orbit.start : two_body(orbit.start, gravity_of(orbit.about), since);
    if (!state) return std::nullopt;
    origin += state->position;
    velocity += state->velocity;
    if (orbit.axes == WorldAxes::rtn) out.world_from_icrf = glm::conjugate(rtn_axes(*state));
  }
  const auto place = [&](const Vec3& centre, const ephemeris::Attitude& attitude) {
    return DatedBody{out.world_from_icrf * (centre - origin),
                     glm::normalize(out.world_from_icrf * from_body(attitude))};
  };
  out.earth = place(Vec3(0), ephemeris::earth_attitude(et, utc_seconds(date)));
  out.moon = place(moon, ephemeris::moon_attitude(et));
  out.velocity = earth_velocity_at(et) + velocity;
  const Vec3 sun = kMetresOfKm * ephemeris::sun_from_earth(et) - origin;
  constexpr double kMetresOfLight = kMetresOfKm * ephemeris::kLightSpeed;
  out.sun_distance = glm::length(sun) / kMetresOfAu;
  out.sun_direction =
      out.world_from_icrf * glm::normalize(glm::normalize(sun) + out.velocity / kMetresOfLight);
  return out;
}

}  // namespace panwright::scenario
