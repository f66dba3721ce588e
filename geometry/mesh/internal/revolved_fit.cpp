#include "geometry/mesh/internal/revolved_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/symmetric.h"

namespace panwright::geometry {
namespace {

constexpr double kMostOff = FitLimits{}.off;
constexpr double kLeastCosine = 0.85;  // of a facet's normal with the surface's at its corners
constexpr double kLeastTurn = 40 * kDegree;
constexpr double kSameDirection = 1e-5;  // radians between normals that count as one
constexpr int kMostSteps = 30;
constexpr std::size_t kUnknowns = 7;

std::vector<std::uint32_t> vertices_of(const Faces& faces, const FaceGroup& group) {
  std::vector<std::uint32_t> out;
  for (const std::uint32_t t : group)
    out.insert(out.end(), faces.triangles[t].begin(), faces.triangles[t].end());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::pair<Vec3, Vec3> across(const Vec3& axis) {
  int least = 0;
  for (int k = 1; k < 3; ++k)
    if (std::fabs(axis[k]) < std::fabs(axis[least])) least = k;
  Vec3 unit(0);
  unit[least] = 1;
  const Vec3 x = glm::normalize(unit - axis[least] * axis);
  return {x, glm::cross(axis, x)};
}

// Centre and radius of the circle that passes best through points, by the linear equations of Kåsa.
std::optional<Vec3> kasa(std::span<const Vec2> points) {
  Vec2 middle(0);
  for (const Vec2& p : points) middle += p / static_cast<double>(points.size());
  double size = 0;
  for (const Vec2& p : points) size = std::max(size, glm::length(p - middle));
  if (!(size > 0)) return std::nullopt;
  Mat3 m(0);
  Vec3 b(0);
  for (const Vec2& p : points) {
    const Vec2 q = (p - middle) / size;
    const Vec3 row(2 * q.x, 2 * q.y, 1);
    m += glm::outerProduct(row, row);
    b += glm::dot(q, q) * row;
  }
  const auto c = solved(m, b);
  if (!c) return std::nullopt;
  const double square = c->z + c->x * c->x + c->y * c->y;
  if (!(square > 0)) return std::nullopt;
  return Vec3(middle + size * Vec2(*c), size * std::sqrt(square));
}

// Height along the axis, distance from it, and the direction away from it.
struct RevolvedPlace {
  double t = 0, rho = 0;
  Vec3 q{0}, u{0};
};
RevolvedPlace place_of(const RevolvedFit& fit, const Vec3& p) {
  RevolvedPlace out;
  const Vec3 d = p - fit.origin;
  out.t = glm::dot(d, fit.axis);
  out.q = d - out.t * fit.axis;
  out.rho = glm::length(out.q);
  if (out.rho > 0) out.u = out.q / out.rho;
  return out;
}

// ---- first guesses

std::optional<RevolvedFit> first_cone(const Faces& faces, const FaceGroup& group) {
  Vec3 mean(0), b(0), middle(0);
  double area = 0;
  Mat3 planes(0), spread(0);
  for (const std::uint32_t t : group) {
    const Vec3 n = faces.normals[t], p = faces.points[faces.triangles[t][0]];
    mean += faces.areas[t] * n;
    middle += faces.areas[t] * p;
    area += faces.areas[t];
    planes += faces.areas[t] * glm::outerProduct(n, n);
    b += faces.areas[t] * glm::dot(n, p) * n;
  }
  const auto apex = solved(planes, b);
  if (!apex) return std::nullopt;
  mean /= area, middle /= area;
  for (const std::uint32_t t : group)
    spread += faces.areas[t] * glm::outerProduct(faces.normals[t] - mean, faces.normals[t] - mean);
  RevolvedFit fit;
  fit.kind = RevolvedKind::cone;
  fit.axis = eigenvectors(spread)[0];
  fit.origin = *apex + glm::dot(middle - *apex, fit.axis) * fit.axis;
  double rho = 0, t = 0;
  for (const std::uint32_t v : vertices_of(faces, group)) {
    const double along = glm::dot(faces.points[v] - *apex, fit.axis);
    rho += glm::length(faces.points[v] - *apex - along * fit.axis);
    t += along;
  }
  if (t == 0) return std::nullopt;
  fit.slope = rho / t;
  fit.radius = fit.slope * glm::dot(middle - *apex, fit.axis);
  return fit;
}

// The line that the normals' lines come nearest to: a·(p × n) + m·n = 0 for each, m = o × a.
std::optional<RevolvedFit> first_torus(const Faces& faces, const FaceGroup& group) {
  Mat3 mm(0), ma(0), aa(0);  // ma: rows of m, columns of a
  for (const std::uint32_t t : group) {
    Vec3 p(0);
    for (const std::uint32_t v : faces.triangles[t]) p += faces.points[v] / 3.0;
    const Vec3 n = faces.normals[t], moment = glm::cross(p, n);
    mm += faces.areas[t] * glm::outerProduct(n, n);
    ma += faces.areas[t] * glm::outerProduct(n, moment);
    aa += faces.areas[t] * glm::outerProduct(moment, moment);
  }
  Mat3 best;  // m that goes with each unit a
  for (int k = 0; k < 3; ++k) {
    const auto column = solved(mm, -ma[k]);
    if (!column) return std::nullopt;
    best[k] = *column;
  }
  Mat3 rest = aa + glm::transpose(ma) * best;
  rest = 0.5 * (rest + glm::transpose(rest));
  RevolvedFit fit;
  fit.kind = RevolvedKind::torus;
  fit.axis = eigenvectors(rest)[0];
  fit.origin = glm::cross(fit.axis, best * fit.axis);
  std::vector<Vec2> profile;
  for (const std::uint32_t v : vertices_of(faces, group)) {
    const RevolvedPlace place = place_of(fit, faces.points[v]);
    profile.emplace_back(place.rho, place.t);
  }
  const auto circle = kasa(profile);
  if (!circle || !(circle->x > 0)) return std::nullopt;
  fit.radius = circle->x;
  fit.origin += circle->y * fit.axis;
  fit.tube = circle->z;
  return fit;
}

// ---- least squares

using Row = std::array<double, kUnknowns>;

// The distance of a vertex and its derivatives by: origin along x and y, tilt towards x and y,
// radius, then slope, or tube and origin along the axis. Returns the number of unknowns.
std::size_t linearised(const RevolvedFit& fit, const Vec3& x, const Vec3& y, const Vec3& p,
                       double& off, Row& row) {
  const RevolvedPlace at = place_of(fit, p);
  const double ux = glm::dot(at.u, x), uy = glm::dot(at.u, y);
  const double qx = glm::dot(at.q, x), qy = glm::dot(at.q, y);
  if (fit.kind == RevolvedKind::torus) {
    const double wide = at.rho - fit.radius, far = std::sqrt(wide * wide + at.t * at.t);
    const double w = far > 0 ? wide / far : 0, v = far > 0 ? at.t / far : 0;
    off = far - fit.tube;
    row = {-w * ux, -w * uy, -w * at.t * ux + v * qx, -w * at.t * uy + v * qy, -w, -1, -v};
    return 7;
  }
  const double k = fit.slope;
  off = at.rho - fit.radius - k * at.t;
  row = {-ux, -uy, -at.t * ux - k * qx, -at.t * uy - k * qy, -1, -at.t, 0};
  return fit.kind == RevolvedKind::cone ? 6 : 5;
}

// Solves the normal equations in place by Cholesky's factors; false where they are singular.
bool solve(std::array<Row, kUnknowns>& m, Row& b, std::size_t count) {
  Row scale{};
  for (std::size_t i = 0; i < count; ++i) scale[i] = m[i][i];
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = m[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= m[i][k] * m[j][k];
      if (i == j) {
        if (!(sum > 1e-13 * scale[i])) return false;
        m[i][i] = std::sqrt(sum);
      } else {
        m[i][j] = sum / m[j][j];
      }
    }
    for (std::size_t k = 0; k < i; ++k) b[i] -= m[i][k] * b[k];
    b[i] /= m[i][i];
  }
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t k = i + 1; k < count; ++k) b[i] -= m[k][i] * b[k];
    b[i] /= m[i][i];
  }
  return true;
}

bool refine(RevolvedFit& fit, const Faces& faces, const std::vector<std::uint32_t>& vertices) {
  for (int step = 0; step < kMostSteps; ++step) {
    const auto [x, y] = across(fit.axis);
    std::array<Row, kUnknowns> m{};
    Row b{};
    std::size_t count = 0;
    for (const std::uint32_t v : vertices) {
      double off = 0;
      Row row{};
      count = linearised(fit, x, y, faces.points[v], off, row);
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j <= i; ++j) m[i][j] += row[i] * row[j];
        b[i] -= row[i] * off;
      }
    }
    if (vertices.size() < count || !solve(m, b, count)) return false;
    fit.origin += b[0] * x + b[1] * y;
    fit.axis = glm::normalize(fit.axis + b[2] * x + b[3] * y);
    fit.radius += b[4];
    if (fit.kind == RevolvedKind::cone) fit.slope += b[5];
    if (fit.kind == RevolvedKind::torus) {
      fit.tube += b[5];
      fit.origin += b[6] * fit.axis;
    }
    double largest = 0;
    for (std::size_t i = 0; i < count; ++i) largest = std::max(largest, std::fabs(b[i]));
    if (!(largest < 1e6)) return false;
    if (largest < 1e-14) break;
  }
  return fit.radius > 0 && (fit.kind != RevolvedKind::torus || fit.tube > 0);
}

// ---- whether it is one

// Radians that normals span about the axis; 0 with too few directions.
double turn_of(const RevolvedFit& fit, const Faces& faces, const FaceGroup& group,
               std::size_t least) {
  const auto [x, y] = across(fit.axis);
  std::vector<double> angles;
  for (const std::uint32_t t : group) {
    const double u = glm::dot(faces.normals[t], x), v = glm::dot(faces.normals[t], y);
    if (u * u + v * v > 1e-6) angles.push_back(det::atan2(v, u));
  }
  std::sort(angles.begin(), angles.end());
  if (angles.empty()) return 0;
  double widest = angles.front() + 2 * kPi - angles.back();
  std::size_t directions = widest > kSameDirection ? 1 : 0;
  for (std::size_t i = 1; i < angles.size(); ++i) {
    widest = std::max(widest, angles[i] - angles[i - 1]);
    if (angles[i] - angles[i - 1] > kSameDirection) ++directions;
  }
  return directions < least ? 0 : 2 * kPi - widest;
}

bool holds(RevolvedFit& fit, const Faces& faces, const FaceGroup& group,
           const std::vector<std::uint32_t>& vertices, const FitLimits& limits) {
  fit.low = HUGE_VAL, fit.high = -HUGE_VAL, fit.widest = 0;
  double squares = 0;
  for (const std::uint32_t v : vertices) {
    const RevolvedPlace at = place_of(fit, faces.points[v]);
    fit.low = std::min(fit.low, at.t);
    fit.high = std::max(fit.high, at.t);
    fit.widest = std::max(fit.widest, at.rho);
  }
  if (fit.kind != RevolvedKind::cone) fit.widest = fit.radius;
  const double scale = fit.kind == RevolvedKind::torus ? fit.tube : fit.widest;
  for (const std::uint32_t v : vertices) {
    const double off = fit.off(faces.points[v]);
    if (!(std::fabs(off) <= limits.off * scale)) return false;
    squares += off * off;
  }
  fit.residual = std::sqrt(squares / static_cast<double>(vertices.size()));
  int side = 0;
  for (const std::uint32_t t : group)
    for (const std::uint32_t v : faces.triangles[t]) {
      const double cosine = glm::dot(fit.normal(faces.points[v]), faces.normals[t]);
      if (cosine == 0) continue;  // at an apex
      if (side == 0) side = cosine > 0 ? 1 : -1;
      if (!(side * cosine >= kLeastCosine)) return false;
    }
  fit.turn = turn_of(fit, faces, group, limits.directions);
  fit.area = area_of(faces, group);
  return fit.turn >= kLeastTurn;
}

}  // namespace

double RevolvedFit::off(const Vec3& p) const {
  const RevolvedPlace at = place_of(*this, p);
  if (kind == RevolvedKind::torus)
    return std::sqrt((at.rho - radius) * (at.rho - radius) + at.t * at.t) - tube;
  return (at.rho - radius - slope * at.t) / std::sqrt(1 + slope * slope);
}

Vec3 RevolvedFit::normal(const Vec3& p) const {
  const RevolvedPlace at = place_of(*this, p);
  // note: what is near an apex has no direction that rounding did not give
  if (!(at.rho > 1e-6 * widest)) return Vec3(0);
  Vec3 out = at.u - slope * axis;
  if (kind == RevolvedKind::torus) out = (at.rho - radius) * at.u + at.t * axis;
  const double length = glm::length(out);
  return length > 0 ? out / length : Vec3(0);
}

Vec3 axis_across(const Faces& faces, const FaceGroup& group) {
  Mat3 spread(0);
  for (const std::uint32_t t : group)
    spread += faces.areas[t] * glm::outerProduct(faces.normals[t], faces.normals[t]);
  return eigenvectors(spread)[0];
}

std::optional<RevolvedFit> cylinder_about(const Vec3& axis, const Faces& faces,
                                          const FaceGroup& group) {
  RevolvedFit fit;
  fit.axis = axis;
  const auto [x, y] = across(axis);
  const std::vector<std::uint32_t> vertices = vertices_of(faces, group);
  std::vector<Vec2> points;
  double along = 0;
  for (const std::uint32_t v : vertices) {
    const Vec3& p = faces.points[v];
    points.emplace_back(glm::dot(p, x), glm::dot(p, y));
    along += glm::dot(p, axis) / static_cast<double>(vertices.size());
  }
  const auto circle = kasa(points);
  if (!circle) return std::nullopt;
  fit.origin = circle->x * x + circle->y * y + along * axis;
  fit.radius = fit.widest = circle->z;
  return fit;
}

std::optional<RevolvedFit> fitted(RevolvedKind kind, const Faces& faces, const FaceGroup& group,
                                  const FitLimits& limits) {
  auto fit = kind == RevolvedKind::cylinder
                 ? cylinder_about(axis_across(faces, group), faces, group)
             : kind == RevolvedKind::cone ? first_cone(faces, group)
                                          : first_torus(faces, group);
  const std::vector<std::uint32_t> vertices = vertices_of(faces, group);
  if (!fit || !refine(*fit, faces, vertices) || !holds(*fit, faces, group, vertices, limits))
    return std::nullopt;
  return fit;
}

bool is_sphere(const Faces& faces, const FaceGroup& group) {
  // |p|² = 2 c·p + (r² − |c|²), about the mean
  const std::vector<std::uint32_t> vertices = vertices_of(faces, group);
  Vec3 mean(0), b(0);
  double squares = 0;
  const auto count = static_cast<double>(vertices.size());
  for (const std::uint32_t v : vertices) mean += faces.points[v] / count;
  Mat3 m(0);
  for (const std::uint32_t v : vertices) {
    const Vec3 d = faces.points[v] - mean;
    m += glm::outerProduct(d, d);
    squares += glm::dot(d, d) / count;
    b += 0.5 * glm::dot(d, d) * d;
  }
  const auto centre = solved(m, b);
  if (!centre) return false;
  const double radius = std::sqrt(squares + glm::dot(*centre, *centre));
  return std::ranges::all_of(vertices, [&](std::uint32_t v) {
    return std::fabs(glm::length(faces.points[v] - mean - *centre) - radius) <= kMostOff * radius;
  });
}

std::optional<RevolvedFit> circle_through(const Faces& faces, std::span<const std::uint32_t> loop) {
  Vec3 mean(0);
  const auto count = static_cast<double>(loop.size());
  for (const std::uint32_t v : loop) mean += faces.points[v] / count;
  Mat3 spread(0);
  for (const std::uint32_t v : loop)
    spread += glm::outerProduct(faces.points[v] - mean, faces.points[v] - mean);
  RevolvedFit fit;
  fit.kind = RevolvedKind::circle;
  fit.axis = eigenvectors(spread)[0];
  const auto [x, y] = across(fit.axis);
  std::vector<Vec2> points;
  for (const std::uint32_t v : loop)
    points.emplace_back(glm::dot(faces.points[v] - mean, x), glm::dot(faces.points[v] - mean, y));
  const auto circle = kasa(points);
  if (!circle) return std::nullopt;
  fit.origin = mean + circle->x * x + circle->y * y;
  fit.radius = fit.widest = circle->z;
  double squares = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const RevolvedPlace at = place_of(fit, faces.points[loop[i]]);
    const double off = std::sqrt((at.rho - fit.radius) * (at.rho - fit.radius) + at.t * at.t);
    if (!(off <= kMostOff * fit.radius)) return std::nullopt;
    squares += off * off;
    // a step of more than 50 degrees is a side of something else
    const double step = glm::length(points[(i + 1) % points.size()] - points[i]);
    if (step > 0.85 * fit.radius) return std::nullopt;
  }
  fit.residual = std::sqrt(squares / count);
  fit.area = kPi * fit.radius * fit.radius;
  return fit;
}

}  // namespace panwright::geometry
