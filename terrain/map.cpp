#include "terrain/map.h"

#include <cmath>

namespace panwright::terrain {

namespace {

double wrapped(double longitude, int domain) {
  const double low = domain == 360 ? 0 : -180;
  double out = longitude - 360 * std::floor((longitude - low) / 360);
  if (out >= low + 360) out -= 360;
  return out;
}

// Snyder's t of a planetographic latitude on an ellipsoid, radians.
double snyder_t(double latitude, double e) {
  const double s = e * det::sin(latitude);
  return det::tan(kPi / 4 - latitude / 2) / det::pow((1 - s) / (1 + s), e / 2);
}

// Polar stereographic projection with the pole at +90 degrees.
struct Polar {
  double ratio;  // of the axes, squared
  double e;
  double scale;  // metres of t = 1

  explicit Polar(const Map& map) {
    const double flat = map.polar_radius > 0 ? map.polar_radius / map.radius : 1;
    ratio = flat * flat;
    e = std::sqrt(std::max(0.0, 1 - ratio));
    const double standard = std::fabs(map.standard_latitude) * kDegree;
    if (kPi / 2 - standard < 1e-9) {
      scale = 2 * map.radius / std::sqrt(det::pow(1 + e, 1 + e) * det::pow(1 - e, 1 - e));
      return;
    }
    const double geographic = det::atan(det::tan(standard) / ratio);
    const double s = e * det::sin(geographic);
    scale = map.radius * det::cos(geographic) / std::sqrt(1 - s * s) / snyder_t(geographic, e);
  }

  double rho(double latitude) const {
    if (kPi / 2 - latitude < 1e-12) return 0;
    return scale * snyder_t(det::atan(det::tan(latitude) / ratio), e);
  }
  double latitude(double rho) const {
    const double t = rho / scale;
    double geographic = kPi / 2 - 2 * det::atan(t);
    for (int k = 0; k < 12 && e > 0; ++k) {
      const double s = e * det::sin(geographic);
      geographic = kPi / 2 - 2 * det::atan(t * det::pow((1 - s) / (1 + s), e / 2));
    }
    return kPi / 2 - geographic < 1e-12 ? kPi / 2 : det::atan(det::tan(geographic) * ratio);
  }
};

}  // namespace

bool Map::is_whole_turn(double width) const {
  if (kind != Kind::cylindrical) return false;
  const double turn = 2 * kPi * radius * det::cos(standard_latitude * kDegree);
  return std::fabs(width * dx / turn - 1) < 1e-6;
}

LatLon Map::at(double column, double row) const {
  const Vec2 p = point(column, row);
  if (kind == Kind::cylindrical) {
    const double along = radius * det::cos(standard_latitude * kDegree);
    return {p.y / radius / kDegree, wrapped(center_longitude + p.x / along / kDegree, domain)};
  }
  const double rho = std::sqrt(p.x * p.x + p.y * p.y);
  const double latitude = Polar(*this).latitude(rho) / kDegree;
  const double turn = rho == 0 ? 0 : det::atan2(p.x, north ? -p.y : p.y) / kDegree;
  return {north ? latitude : -latitude, wrapped(center_longitude + turn, domain)};
}

Vec2 Map::pixel(const LatLon& place, double width) const {
  Vec2 p;
  if (kind == Kind::cylindrical) {
    const double along = radius * det::cos(standard_latitude * kDegree) * kDegree;
    const double middle = (left + width * dx / 2) / along;
    double turn = place.longitude - center_longitude;
    turn -= 360 * std::round((turn - middle) / 360);
    p = {along * turn, radius * place.latitude * kDegree};
  } else {
    const double rho = Polar(*this).rho((north ? place.latitude : -place.latitude) * kDegree);
    const auto [s, c] = det::sincos((place.longitude - center_longitude) * kDegree);
    p = {rho * s, north ? -rho * c : rho * c};
  }
  return {(p.x - left) / dx, (top - p.y) / dy};
}

Vec2 Map::spacing(double column, double row) const {
  if (kind == Kind::none) return {dx, dy};
  const Vec2 p = point(column, row);
  if (kind == Kind::cylindrical) {
    const double latitude = std::clamp(p.y / radius, -kPi / 2, kPi / 2);
    return {dx * std::fabs(det::cos(latitude)) / det::cos(standard_latitude * kDegree), dy};
  }
  // scale (1 + sin standard)/(1 + sin latitude), where tan²(45° − latitude/2) = (rho/2Rf)²
  const double f = (1 + det::sin(std::fabs(standard_latitude) * kDegree)) / 2;
  const double reach = 2 * radius * f;
  const double k = f * (1 + (p.x * p.x + p.y * p.y) / (reach * reach));
  return {dx / k, dy / k};
}

}  // namespace panwright::terrain
