#include "mli/internal/surface.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/axis_box.h"
#include "geometry/symmetric.h"

namespace panwright::mli {
namespace {

using geometry::eigenvectors;
using geometry::solved;

// facets that a turn needs at least; fewer are a prism
constexpr double kMostStep = 2 * kPi / 8;
// of a facet's normal with the surface's: heights over facets are off by no more
constexpr double kLeastCosine = 0.95;

// Any two directions across an axis.
void complete(Surface& s, const Vec3& hint) {
  s.x = glm::normalize(hint - glm::dot(hint, s.z) * s.z);
  s.y = glm::cross(s.z, s.x);
}

std::vector<std::uint32_t> vertices_of(const Faces& faces, const Group& group) {
  std::vector<std::uint32_t> out;
  for (const std::uint32_t t : group)
    out.insert(out.end(), faces.triangles[t].begin(), faces.triangles[t].end());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// The convex hull, counter-clockwise: Andrew's monotone chain.
std::vector<Vec2> hull_of(std::vector<Vec2> points) {
  std::ranges::sort(
      points, [](const Vec2& a, const Vec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<Vec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const Vec2& p : points) {
      while (hull.size() >= first + 2) {
        const Vec2 u = hull.back() - hull[hull.size() - 2], v = p - hull.back();
        if (u.x * v.y - u.y * v.x > 0) break;
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::ranges::reverse(points);
  }
  return hull;
}

// The direction of the long side of the smallest rectangle about the points; of equal ones the
// nearest to x, then the one at y > 0.
Vec2 along_rectangle(const std::vector<Vec2>& points) {
  constexpr double kEqual = 1e-6;
  const std::vector<Vec2> hull = hull_of(points);
  Vec2 best(1, 0);
  double least = HUGE_VAL;
  // note: sides of fine round outlines are sampled, the cost is their product with the hull
  const std::size_t step = hull.size() / 1024 + 1;
  for (std::size_t k = 0; k < hull.size(); k += step) {
    const Vec2 side = hull[(k + 1) % hull.size()] - hull[k];
    if (!(glm::length(side) > 0)) continue;
    const Vec2 u = glm::normalize(side), v(-u.y, u.x);
    AxisRectangle bounds;
    for (const Vec2& p : hull) bounds.add(Vec2(glm::dot(p, u), glm::dot(p, v)));
    const Vec2 size = bounds.extent();
    const double area = size.x * size.y;
    if (area > least * (1 + kEqual)) continue;
    const bool smaller = area < least * (1 - kEqual);
    if (smaller) least = area, best = Vec2(-2, 0);
    for (const Vec2& d : {u, v, -u, -v}) {
      const bool on_u = std::fabs(glm::dot(d, u)) > 0.5;
      const double along = on_u ? size.x : size.y, across = on_u ? size.y : size.x;
      if (along < across * (1 - kEqual)) continue;
      if (d.x > best.x + kEqual || (d.x > best.x - kEqual && d.y > best.y + kEqual)) best = d;
    }
  }
  return best.x < -1.5 ? Vec2(1, 0) : best;
}

std::optional<Surface> plane_through(const Faces& faces, const Group& group, double tolerance) {
  Vec3 normal(0), longest(0);
  for (const std::uint32_t t : group) normal += faces.areas[t] * faces.normals[t];
  if (!(glm::length(normal) > 0)) return std::nullopt;
  Surface s;
  s.z = glm::normalize(normal);
  s.origin = faces.points[faces.triangles[group[0]][0]];
  for (const std::uint32_t t : group)
    for (std::size_t k = 0; k < 3; ++k) {
      if (glm::dot(faces.normals[t], s.z) < 0.9) return std::nullopt;
      const Vec3 p = faces.points[faces.triangles[t][k]];
      if (std::fabs(glm::dot(p - s.origin, s.z)) > tolerance) return std::nullopt;
      const Vec3 edge = faces.points[faces.triangles[t][(k + 1) % 3]] - p;
      if (glm::length(edge) > glm::length(longest)) longest = edge;
    }
  complete(s, longest);
  std::vector<Vec2> points;
  for (const std::uint32_t v : vertices_of(faces, group)) points.push_back(s.flat(faces.points[v]));
  const Vec2 along = along_rectangle(points);
  complete(s, along.x * s.x + along.y * s.y);
  return s;
}

// Along the axis, away from where most of the vertices' heights are: so that turned input gives the
// turned surface, the sign follows the group's first facet.
Vec3 signed_axis(const Faces& faces, const Group& group, Vec3 axis) {
  const auto& t = faces.triangles[group[0]];
  for (int k = 0; k < 3; ++k) {
    const double along = glm::dot(faces.points[t[(k + 1) % 3]] - faces.points[t[k]], axis);
    const double length = glm::length(faces.points[t[(k + 1) % 3]] - faces.points[t[k]]);
    if (std::fabs(along) > 1e-3 * length) return along > 0 ? axis : -axis;
  }
  return axis;
}

std::optional<Surface> cylinder_through(const Faces& faces, const Group& group,
                                        const std::vector<std::uint32_t>& vertices) {
  Mat3 spread(0);
  for (const std::uint32_t t : group)
    spread += faces.areas[t] * glm::outerProduct(faces.normals[t], faces.normals[t]);
  Surface s;
  s.kind = Surface::Kind::cylinder;
  s.z = signed_axis(faces, group, eigenvectors(spread)[0]);
  const Vec3 first = faces.points[vertices[0]];
  complete(s, faces.normals[group[0]]);
  // |q|² = 2 c·q + r² − |c|², in a frame of the group's size
  Vec2 middle(0);
  for (const std::uint32_t v : vertices)
    middle += Vec2(glm::dot(faces.points[v] - first, s.x), glm::dot(faces.points[v] - first, s.y));
  middle /= static_cast<double>(vertices.size());
  double size = 0;
  const auto place = [&](std::uint32_t v) {
    const Vec3 d = faces.points[v] - first;
    return Vec2(glm::dot(d, s.x), glm::dot(d, s.y)) - middle;
  };
  for (const std::uint32_t v : vertices) size = std::max(size, glm::length(place(v)));
  if (!(size > 0)) return std::nullopt;
  Mat3 m(0);
  Vec3 b(0);
  for (const std::uint32_t v : vertices) {
    const Vec2 q = place(v) / size;
    const Vec3 row(2 * q.x, 2 * q.y, 1);
    m += glm::outerProduct(row, row);
    b += glm::dot(q, q) * row;
  }
  const auto c = solved(m, b);
  if (!c) return std::nullopt;
  const double square = c->z + c->x * c->x + c->y * c->y;
  if (!(square > 0)) return std::nullopt;
  s.radius = size * std::sqrt(square);
  const Vec2 centre = middle + size * Vec2(*c);
  s.origin = first + centre.x * s.x + centre.y * s.y;
  return s;
}

std::optional<Surface> cone_through(const Faces& faces, const Group& group,
                                    const std::vector<std::uint32_t>& vertices) {
  const Vec3 first = faces.points[vertices[0]];
  Vec3 mean(0);
  double area = 0;
  Mat3 planes(0);
  Vec3 b(0);
  for (const std::uint32_t t : group) {
    const Vec3 n = faces.normals[t];
    mean += faces.areas[t] * n;
    area += faces.areas[t];
    planes += faces.areas[t] * glm::outerProduct(n, n);
    b += faces.areas[t] * glm::dot(n, faces.points[faces.triangles[t][0]] - first) * n;
  }
  const auto apex = solved(planes, b);
  if (!apex) return std::nullopt;
  mean /= area;
  Mat3 spread(0);
  for (const std::uint32_t t : group)
    spread += faces.areas[t] * glm::outerProduct(faces.normals[t] - mean, faces.normals[t] - mean);
  Surface s;
  s.kind = Surface::Kind::cone;
  s.origin = first + *apex;
  s.z = eigenvectors(spread)[0];
  Vec3 middle(0);
  for (const std::uint32_t v : vertices) middle += faces.points[v] - s.origin;
  if (glm::dot(middle, s.z) < 0) s.z = -s.z;
  complete(s, faces.normals[group[0]]);
  double sine = 0, cosine = 0;
  for (const std::uint32_t v : vertices) {
    sine += s.across(faces.points[v]);
    cosine += glm::dot(faces.points[v] - s.origin, s.z);
  }
  const double both = std::hypot(sine, cosine);
  if (!(sine > 0 && cosine > 0)) return std::nullopt;
  s.sine = sine / both, s.cosine = cosine / both;
  return s;
}

// Where the faces lie around the axis.
bool open_up(Surface& s, const Faces& faces, const Group& group,
             const std::vector<std::uint32_t>& vertices) {
  std::vector<double> angles;
  s.begin = 0;
  for (const std::uint32_t v : vertices)
    if (s.across(faces.points[v]) > 0) angles.push_back(s.angle(faces.points[v]));
  std::sort(angles.begin(), angles.end());
  if (angles.empty()) return false;
  double widest = angles.front() + 2 * kPi - angles.back();
  s.begin = angles.front();
  for (std::size_t i = 1; i < angles.size(); ++i)
    // note: of equal gaps the first, whatever rounding says
    if (angles[i] - angles[i - 1] > widest * (1 + 1e-6)) {
      widest = angles[i] - angles[i - 1];
      s.begin = angles[i];
    }
  // a facet over the widest gap: the faces close
  const double gap_end = s.begin, gap_begin = gap_end - widest;
  for (const std::uint32_t t : group) {
    Vec3 middle(0);
    for (const std::uint32_t v : faces.triangles[t]) middle += faces.points[v] / 3.0;
    const double begin = s.begin;
    s.begin = 0;
    const double at = s.angle(middle);
    s.begin = begin;
    for (const double shifted : {at - 2 * kPi, at, at + 2 * kPi})
      if (shifted > gap_begin + 1e-3 * widest && shifted < gap_end - 1e-3 * widest) s.around = true;
  }
  return s.around ? widest <= kMostStep * (1 + 1e-9) : true;
}

bool holds(const Surface& s, const Faces& faces, const Group& group,
           const std::vector<std::uint32_t>& vertices, double tolerance) {
  for (const std::uint32_t v : vertices) {
    const Vec3 p = faces.points[v];
    const double off = s.kind == Surface::Kind::cylinder
                           ? s.across(p) - s.radius
                           : s.cosine * s.across(p) - s.sine * glm::dot(p - s.origin, s.z);
    if (!(std::fabs(off) <= tolerance)) return false;
  }
  for (const std::uint32_t t : group) {
    Vec3 middle(0);
    for (const std::uint32_t v : faces.triangles[t]) middle += faces.points[v] / 3.0;
    if (!(glm::dot(s.normal(middle), faces.normals[t]) > kLeastCosine)) return false;
  }
  return true;
}

void bound(Surface& s, const Faces& faces, const std::vector<std::uint32_t>& vertices) {
  s.low = Vec2(HUGE_VAL), s.high = Vec2(-HUGE_VAL);
  const auto take = [&](const Vec2& p) {
    s.low = glm::min(s.low, p);
    s.high = glm::max(s.high, p);
  };
  double widest = 0, nearest = HUGE_VAL, farthest = 0;
  for (const std::uint32_t v : vertices) {
    const Vec3 p = faces.points[v];
    take(s.flat(p));
    if (s.around) take(s.flat(p, 1));
    widest = std::max(widest, s.angle(p));
    nearest = std::min(nearest, glm::length(p - s.origin));
    farthest = std::max(farthest, glm::length(p - s.origin));
  }
  if (s.kind == Surface::Kind::plane) return;
  s.narrowest = HUGE_VAL;
  for (const std::uint32_t v : vertices)
    s.narrowest = std::min(s.narrowest, s.across(faces.points[v]));
  if (s.kind == Surface::Kind::cylinder) return;
  // arcs bulge beyond their ends
  const double turns = s.around ? 2 : widest / (2 * kPi);
  for (int k = 0; k <= 256; ++k)
    for (const double r : {nearest, farthest}) {
      const double a = s.outwards * turns * 2 * kPi * s.sine * k / 256;
      take(r * Vec2(det::cos(a), -det::sin(a)));
    }
}

}  // namespace

double Surface::angle(const Vec3& p) const {
  if (kind == Kind::plane) return 0;
  const double a = det::atan2(glm::dot(p - origin, y), glm::dot(p - origin, x)) - begin;
  const double around_once = a < 0 ? a + 2 * kPi : a;
  // vertices at the begin stand there, whatever rounding says
  return around_once < 2 * kPi - 1e-9 ? around_once : 0;
}

double Surface::across(const Vec3& p) const {
  if (kind == Kind::plane) return 0;
  const double u = glm::dot(p - origin, x), v = glm::dot(p - origin, y);
  return std::sqrt(u * u + v * v);
}

Vec2 Surface::flat(const Vec3& p, double turns) const {
  const Vec3 d = p - origin;
  if (kind == Kind::plane) return {glm::dot(d, x), glm::dot(d, y)};
  const double a = outwards * (angle(p) + turns * 2 * kPi);
  if (kind == Kind::cylinder) return {radius * a, glm::dot(d, z)};
  const double r = glm::length(d);
  // note: seen from outside, angles run clockwise about the apex
  return r * Vec2(det::cos(a * sine), -det::sin(a * sine));
}

double Surface::above(const Vec3& p) const {
  if (kind == Kind::plane) return 0;
  if (kind == Kind::cylinder) return outwards * (radius - across(p));
  return outwards * (glm::dot(p - origin, z) * sine - across(p) * cosine);
}

Vec3 Surface::normal(const Vec3& p) const {
  if (kind == Kind::plane) return z;
  const Vec3 d = p - origin;
  const double r = across(p);
  const Vec3 radial =
      r > 0 ? (glm::dot(d, x) * x + glm::dot(d, y) * y) / r : Vec3(0);  // note: the apex
  if (kind == Kind::cylinder) return outwards * radial;
  return outwards * (r > 0 ? cosine * radial - sine * z : -z);
}

std::optional<Surface> surface_through(const Faces& faces, const Group& group, double tolerance) {
  const std::vector<std::uint32_t> vertices = vertices_of(faces, group);
  if (auto plane = plane_through(faces, group, tolerance)) {
    bound(*plane, faces, vertices);
    return plane;
  }
  for (auto* const fit : {&cylinder_through, &cone_through}) {
    auto s = (*fit)(faces, group, vertices);
    if (!s) continue;
    double towards = 0;
    for (const std::uint32_t t : group)
      towards += faces.areas[t] *
                 glm::dot(faces.normals[t], s->normal(faces.points[faces.triangles[t][0]]));
    s->outwards = towards < 0 ? -1 : 1;
    if (!holds(*s, faces, group, vertices, tolerance) || !open_up(*s, faces, group, vertices))
      continue;
    bound(*s, faces, vertices);
    return s;
  }
  return std::nullopt;
}

}  // namespace panwright::mli
