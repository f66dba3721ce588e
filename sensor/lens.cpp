#include "sensor/lens.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "sensor/internal/dual.h"

namespace panwright::sensor {

namespace {

// Places farther out than any image: beyond them a ray is rounding.
constexpr double kFarPlace = 1e9;

// Steps of this share of a number, and smaller ones, are its rounding.
constexpr double kRoundings = 4e-16;

// Ends of searches for a fold: tangents of angles to the boresight.
constexpr double kNearest = 1e-3;
constexpr double kFarthest = 1e6;

// Value of an increasing function, and its slope; a slope <= 0 ends the domain.
struct Slope {
  double value;
  double slope;
};

Slope radial(const Brown& lens, double r) {
  const auto& k = lens.k;
  const double q = r * r;
  const double over = 1 + q * (k[0] + q * (k[1] + q * k[4]));
  const double over_slope = k[0] + q * (2 * k[1] + q * 3 * k[4]);
  const double under = 1 + q * (k[5] + q * (k[6] + q * k[7]));
  const double under_slope = k[5] + q * (2 * k[6] + q * 3 * k[7]);
  if (!(under > 0)) return {0, -1};
  return {r * over / under,
          (over * under + 2 * q * (over_slope * under - over * under_slope)) / (under * under)};
}

Slope radial(const Fisheye& lens, double theta) {
  const auto& k = lens.k;
  const double q = theta * theta;
  return {theta * (1 + q * (k[0] + q * (k[1] + q * (k[2] + q * k[3])))),
          1 + q * (3 * k[0] + q * (5 * k[1] + q * (7 * k[2] + q * 9 * k[3])))};
}

Slope radial(const RadialPowers& lens, double r) {
  const auto& k = lens.k;
  return {r * (1 + k[0] + r * (k[1] + r * (k[2] + r * (k[3] + r * k[4])))),
          1 + k[0] + r * (2 * k[1] + r * (3 * k[2] + r * (4 * k[3] + r * 5 * k[4])))};
}

Slope radial(const Cahvore& lens, double chi) {
  const auto& c = lens.r;
  const double q = chi * chi;
  return {chi * (1 + c[0] + q * (c[1] + q * c[2])), 1 + c[0] + q * (3 * c[1] + q * 5 * c[2])};
}

// Returns the largest t up to `far` before the first fold.
template <class Model>
double before_fold(const Model& model, double far) {
  const auto rises = [&](double t) { return radial(model, t).slope > 0; };
  if (!rises(0)) return 0;
  double good = 0;
  for (double bad = std::min(kNearest, far);; bad = std::min(bad * 1.003, far)) {
    if (!rises(bad)) {
      for (int step = 0; step < 100; ++step) {
        const double middle = (good + bad) / 2;
        (rises(middle) ? good : bad) = middle;
      }
      return good;
    }
    good = bad;
    if (bad >= far) return far;
  }
}

// Returns t in [0, limit] of a value up to that at the limit: Newton's steps within a bracket.
template <class Model>
double inverse(const Model& model, double limit, double value) {
  double low = 0, high = limit;
  double t = std::min(value, limit);
  for (int step = 0; step < 200; ++step) {
    const Slope at = radial(model, t);
    const double miss = at.value - value;
    (miss > 0 ? high : low) = t;
    double next = t - miss / at.slope;
    if (std::fabs(next - t) <= kRoundings * t) return t;
    if (!(next > low && next < high)) next = (low + high) / 2;
    t = next;
  }
  return t;
}

// Terms beside the radial ones.
bool bends(const Brown& lens) {
  const auto& k = lens.k;
  return k[2] != 0 || k[3] != 0 || k[8] != 0 || k[9] != 0 || k[10] != 0 || k[11] != 0;
}

template <class Number>
std::array<Number, 2> distorted(const Brown& lens, const Number& x, const Number& y) {
  const auto& k = lens.k;
  const Number xx = x * x, yy = y * y, xy = x * y;
  const Number q = xx + yy, qq = q * q, qqq = qq * q;
  const Number scale =
      (1.0 + k[0] * q + k[1] * qq + k[4] * qqq) / (1.0 + k[5] * q + k[6] * qq + k[7] * qqq);
  return {x * scale + 2 * k[2] * xy + k[3] * (q + 2.0 * xx) + k[8] * q + k[9] * qq,
          y * scale + k[2] * (q + 2.0 * yy) + 2 * k[3] * xy + k[10] * q + k[11] * qq};
}

struct Bent {
  Vec2 value;
  double determinant;
  Vec2 step;  // to value = target
};
Bent bent(const Brown& lens, const Vec2& at, const Vec2& target) {
  const auto [x, y] = distorted(lens, Dual{at.x, 1, 0}, Dual{at.y, 0, 1});
  const double determinant = x.dx * y.dy - x.dy * y.dx;
  const Vec2 miss = target - Vec2(x.value, y.value);
  return {{x.value, y.value},
          determinant,
          Vec2(y.dy * miss.x - x.dy * miss.y, x.dx * miss.y - y.dx * miss.x) / determinant};
}

// Rotation of a tilted sensor, and the projection back on its plane: OpenCV's matTilt.
Mat3 tilt_of(double x, double y) {
  const auto [sx, cx] = det::sincos(x);
  const auto [sy, cy] = det::sincos(y);
  const Mat3 about_x(1, 0, 0, 0, cx, -sx, 0, sx, cx);  // columns
  const Mat3 about_y(cy, 0, sy, 0, 1, 0, -sy, 0, cy);
  const Mat3 turn = about_y * about_x;
  const Mat3 back(turn[2][2], 0, 0, 0, turn[2][2], 0, -turn[2][0], -turn[2][1], 1);
  return back * turn;
}

std::optional<Vec2> through(const Mat3& matrix, const Vec2& at) {
  const Vec3 to = matrix * Vec3(at, 1);
  if (!(to.z > 0)) return std::nullopt;
  return Vec2(to) / to.z;
}

// Variable of CAHVORE's polynomial for an angle to the axis, and back.
double chi_of(double linearity, double theta) {
  if (std::fabs(linearity) < 1e-15) return theta;
  const double turned = linearity * theta;
  return (linearity < 0 ? det::sin(turned) : det::tan(turned)) / linearity;
}
double theta_of(double linearity, double chi) {
  if (std::fabs(linearity) < 1e-15) return chi;
  const double turned = linearity * chi;
  return (linearity < 0 ? det::asin(std::max(turned, -1.0)) : det::atan(turned)) / linearity;
}

// E's polynomial, and its slope.
Slope pupil(const Cahvore& lens, double theta) {
  const double q = theta * theta;
  return {lens.e[0] + q * (lens.e[1] + q * lens.e[2]), theta * (2 * lens.e[1] + q * 4 * lens.e[2])};
}

// The angle to the axis of the ray through a point: `along` and `across` it. Nothing: there is
// none.
std::optional<double> pupil_angle(const Cahvore& lens, double along, double across, double most) {
  double theta = det::atan2(across, along);
  if (lens.e == std::array<double, 3>{}) return theta;
  for (int step = 0; step < 50; ++step) {
    const auto [sine, cosine] = det::sincos(theta);
    const auto [e, slope] = pupil(lens, theta);
    const double under = along * cosine + across * sine - (1 - cosine) * e - (theta - sine) * slope;
    if (!(under > 0)) return std::nullopt;
    const double change = (along * sine - across * cosine - (theta - sine) * e) / under;
    theta -= change;
    if (!(theta >= -1e-9 && theta <= most + 1e-9)) return std::nullopt;
    if (std::fabs(change) <= 1e-15) break;
  }
  return std::max(theta, 0.0);
}

// Direction at an angle to an axis, on the side of `across`; the axis, if that is 0.
Vec3 turned(const Vec3& axis, const Vec3& across, double length, double theta) {
  if (length == 0) return axis;
  const auto [sine, cosine] = det::sincos(theta);
  return glm::normalize(cosine * axis + (sine / length) * across);
}

// ---- points of the camera's axes onto the image plane, and back

struct Domain {
  double limit;        // of the variable of the distortion
  double limit_image;  // its distorted value
  double angle;        // to the axis
  const Mat3& tilt;
  const Mat3& untilt;
};

std::optional<Vec2> onto(const Pinhole&, const Domain&, const Vec3& point) {
  if (!(point.z > 0)) return std::nullopt;
  return Vec2(point) / point.z;
}

std::optional<Vec2> onto(const Brown& lens, const Domain& domain, const Vec3& point) {
  if (!(point.z > 0)) return std::nullopt;
  const Vec2 at = Vec2(point) / point.z;
  if (!(glm::length(at) <= domain.limit)) return std::nullopt;
  if (bends(lens) && !(bent(lens, at, at).determinant > 0)) return std::nullopt;
  const auto [x, y] = distorted(lens, at.x, at.y);
  return through(domain.tilt, {x, y});
}

std::optional<Vec2> onto(const Fisheye& lens, const Domain& domain, const Vec3& point) {
  const double across = glm::length(Vec2(point));
  const double theta = det::atan2(across, point.z);
  if (!(theta <= domain.limit) || (across == 0 && !(point.z > 0))) return std::nullopt;
  if (across == 0) return Vec2(0);
  return Vec2(point) * (radial(lens, theta).value / across);
}

std::optional<Vec2> onto(const Division& lens, const Domain&, const Vec3& point) {
  const double square = point.z * point.z - 4 * lens.k * (point.x * point.x + point.y * point.y);
  if (!(square >= 0) || (!(point.z > 0) && !(lens.k < 0))) return std::nullopt;
  const double under = point.z + std::sqrt(square);
  if (!(under > 0)) return std::nullopt;
  return Vec2(point) * (2 / under);
}

std::optional<Vec2> onto(const RadialPowers& lens, const Domain& domain, const Vec3& point) {
  if (!(point.z > 0)) return std::nullopt;
  const Vec2 at = Vec2(point) / point.z;
  const double r = glm::length(at);
  if (!(r <= domain.limit)) return std::nullopt;
  return r == 0 ? at : at * (radial(lens, r).value / r);
}

std::optional<Vec2> onto(const Cahvore& lens, const Domain& domain, const Vec3& point) {
  const double along = glm::dot(point, lens.axis);
  const Vec3 across = point - along * lens.axis;
  const double length = glm::length(across);
  if (length == 0 && !(along > 0)) return std::nullopt;
  const auto theta = pupil_angle(lens, along, length, domain.angle);
  if (!theta || !(*theta <= domain.angle)) return std::nullopt;
  const double chi = chi_of(lens.linearity, *theta);
  const Vec3 seen =
      length == 0 ? lens.axis : lens.axis + across * (radial(lens, chi).value / length);
  return onto(Pinhole{}, domain, seen);
}

std::optional<LensRay> from(const Pinhole&, const Domain&, const Vec2& at) {
  return LensRay{.direction = glm::normalize(Vec3(at, 1))};
}

std::optional<LensRay> from(const Brown& lens, const Domain& domain, const Vec2& image) {
  const auto target = through(domain.untilt, image);
  if (!target) return std::nullopt;
  const double r = glm::length(*target);
  const bool other_terms = bends(lens);
  if (r > domain.limit_image && !other_terms) return std::nullopt;
  Vec2 at = *target;
  if (r > 0) at *= inverse(lens, domain.limit, std::min(r, domain.limit_image)) / r;
  double miss = 0;
  double last = std::numeric_limits<double>::infinity();  // of changes near the end
  for (int step = 0; other_terms && step < 40; ++step) {
    const Bent here = bent(lens, at, *target);
    miss = glm::length(*target - here.value);
    if (!(here.determinant > 0)) return std::nullopt;
    const double change = glm::length(here.step);
    at += here.step;
    if (const double now = glm::length(at); now > domain.limit) at *= domain.limit / now;
    if (change <= kRoundings * glm::length(at) || change >= last) break;
    last = change < 1e-12 ? change : last;
  }
  if (!(miss <= 1e-14 * (1 + r))) return std::nullopt;
  return LensRay{.direction = glm::normalize(Vec3(at, 1))};
}

std::optional<LensRay> from(const Fisheye& lens, const Domain& domain, const Vec2& at) {
  const double r = glm::length(at);
  if (!(r <= domain.limit_image)) return std::nullopt;
  const double theta = inverse(lens, domain.limit, r);
  return LensRay{.direction = turned({0, 0, 1}, Vec3(at, 0), r, theta)};
}

std::optional<LensRay> from(const Division& lens, const Domain&, const Vec2& at) {
  const double q = lens.k * glm::dot(at, at);
  if (!(q <= 1)) return std::nullopt;
  return LensRay{.direction = glm::normalize(Vec3(at, 1 + q))};
}

std::optional<LensRay> from(const RadialPowers& lens, const Domain& domain, const Vec2& at) {
  const double r = glm::length(at);
  if (!(r <= domain.limit_image)) return std::nullopt;
  const double scale = r == 0 ? 1 : inverse(lens, domain.limit, r) / r;
  return LensRay{.direction = glm::normalize(Vec3(at * scale, 1))};
}

std::optional<LensRay> from(const Cahvore& lens, const Domain& domain, const Vec2& at) {
  const Vec3 seen(at, 1);
  const double along = glm::dot(seen, lens.axis);
  if (!(along > 0)) return std::nullopt;
  const Vec3 across = seen - along * lens.axis;
  const double length = glm::length(across);
  const double image = length / along;
  if (!(image <= domain.limit_image)) return std::nullopt;
  const double theta = theta_of(lens.linearity, inverse(lens, domain.limit, image));
  LensRay ray{.direction = turned(lens.axis, across, length, theta)};
  if (theta > 0) ray.origin = (theta / det::sin(theta) - 1) * pupil(lens, theta).value * lens.axis;
  return ray;
}

}  // namespace

DistortionMap::DistortionMap(const Distortion& distortion) : distortion_(distortion) {
  if (const auto* brown = std::get_if<Brown>(&distortion)) {
    limit_ = before_fold(*brown, kFarthest);
    limit_image_ = radial(*brown, limit_).value;
    domain_ = det::atan(limit_);
    tilt_ = tilt_of(brown->k[12], brown->k[13]);
    untilt_ = glm::inverse(tilt_);
  } else if (const auto* fisheye = std::get_if<Fisheye>(&distortion)) {
    domain_ = limit_ = before_fold(*fisheye, kPi);
    limit_image_ = radial(*fisheye, limit_).value;
  } else if (const auto* powers = std::get_if<RadialPowers>(&distortion)) {
    limit_ = before_fold(*powers, kFarthest);
    limit_image_ = radial(*powers, limit_).value;
    domain_ = det::atan(limit_);
  } else if (const auto* cahvore = std::get_if<Cahvore>(&distortion)) {
    assert(cahvore->axis.z >= 0.49);
    const double linearity = cahvore->linearity;
    const double widest = linearity == 0 ? kPi : std::min(kPi, kPi / 2 / std::fabs(linearity));
    const double far = linearity > 0.5 ? kFarthest : chi_of(linearity, widest);
    limit_ = before_fold(*cahvore, far);
    limit_image_ = radial(*cahvore, limit_).value;
    domain_ = theta_of(linearity, limit_);
  } else if (const auto* division = std::get_if<Division>(&distortion)) {
    const double k = division->k;
    domain_ = k > 0 ? det::atan(0.5 / std::sqrt(k)) : k < 0 ? kPi : kPi / 2;
  } else {
    domain_ = kPi / 2;
  }
}

std::optional<Vec2> DistortionMap::place(const Vec3& point) const {
  const Domain domain{limit_, limit_image_, domain_, tilt_, untilt_};
  const auto at =
      std::visit([&](const auto& lens) { return onto(lens, domain, point); }, distortion_);
  if (!at || !(std::fabs(at->x) < kFarPlace && std::fabs(at->y) < kFarPlace)) return std::nullopt;
  return at;
}

std::optional<LensRay> DistortionMap::ray(const Vec2& place) const {
  if (!(std::fabs(place.x) < kFarPlace && std::fabs(place.y) < kFarPlace)) return std::nullopt;
  const Domain domain{limit_, limit_image_, domain_, tilt_, untilt_};
  return std::visit([&](const auto& lens) { return from(lens, domain, place); }, distortion_);
}

}  // namespace panwright::sensor
