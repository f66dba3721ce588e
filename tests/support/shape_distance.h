// Distances to exact shapes by means that geometry/ does not use: closed forms, root searches and
// dense polylines. For tests and benches.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/tessellate/shape.h"

namespace panwright::oracles {

// from a point to a surface, ≥ 0
using Distance = std::function<double(const Vec3&)>;

template <class Vec>
double to_segment(const Vec& p, const Vec& a, const Vec& b) {
  const Vec d = b - a;
  const double share = std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0);
  return glm::length(p - a - share * d);
}

// to a polyline; a long one in runs with their circles
template <class Vec>
class PolylineOf {
 public:
  explicit PolylineOf(std::vector<Vec> points)
      : run_(std::max(32.0, std::sqrt(static_cast<double>(points.size())))),
        points_(std::move(points)) {
    for (std::size_t i = 0; i + 1 < points_.size(); i += run_) {
      const std::size_t last = std::min(i + run_, points_.size() - 1);
      double reach = 0;
      for (std::size_t k = i; k <= last; ++k)
        reach = std::max(reach, glm::length(points_[k] - points_[i]));
      reach_.push_back(reach);
    }
  }
  double distance(const Vec& p) const {
    // no further than the nearest start of a run
    double best = HUGE_VAL;
    for (std::size_t run = 0; run < reach_.size(); ++run)
      best = std::min(best, glm::length(p - points_[run * run_]));
    for (std::size_t run = 0; run < reach_.size(); ++run) {
      const std::size_t i = run * run_;
      if (glm::length(p - points_[i]) - reach_[run] > best) continue;
      for (std::size_t k = i; k < std::min(i + run_, points_.size() - 1); ++k)
        best = std::min(best, to_segment(p, points_[k], points_[k + 1]));
    }
    return best;
  }

 private:
  std::size_t run_;
  std::vector<Vec> points_;
  std::vector<double> reach_;
};
using Polyline = PolylineOf<Vec2>;  // in the half-plane (r, z), or of a loop

inline Vec2 meridian(const Vec3& p) { return {std::hypot(p.x, p.y), p.z}; }

inline Distance to_revolved(std::vector<Vec2> profile) {
  return
      [line = Polyline(std::move(profile))](const Vec3& p) { return line.distance(meridian(p)); };
}

// the nearest point of a smooth curve by samples and a golden-section search about the best
template <class Point>
double to_curve(const Vec2& p, double begin, double end, int samples, const Point& point) {
  const auto at = [&](double t) { return glm::length(p - point(t)); };
  int best = 0;
  double nearest = HUGE_VAL;
  for (int i = 0; i <= samples; ++i) {
    const double d = at(begin + (end - begin) * i / samples);
    if (d < nearest) {
      nearest = d;
      best = i;
    }
  }
  double low = begin + (end - begin) * std::max(0, best - 1) / samples;
  double high = begin + (end - begin) * std::min(samples, best + 1) / samples;
  for (int i = 0; i < 60; ++i) {
    const double a = low + 0.381966011250105 * (high - low);
    const double b = high - 0.381966011250105 * (high - low);
    if (at(a) < at(b))
      high = b;
    else
      low = a;
  }
  return std::min(nearest, at(0.5 * (low + high)));
}

// to an ellipse's quadrant x, y ≥ 0 by bisection of the one root. Eberly, "Distance from a Point to
// an Ellipse, an Ellipsoid, or a Hyperellipsoid", 2013.
inline double to_ellipsoid(const Vec3& radii, const Vec3& point) {
  const double unit = std::min({radii.x, radii.y, radii.z});
  const Vec3 e = radii / unit;
  const Vec3 above = e * e - Vec3(1);
  // note: so that a point in a plane of symmetry has a foot on one side
  const Vec3 y = glm::max(glm::abs(point) / unit, Vec3(1e-30));
  // the foot is x_i = e_i² y_i/(w + e_i² − 1) with Σ(x_i/e_i)² = 1, w > 0
  const auto miss = [&](double w) {
    double sum = -1;
    for (int i = 0; i < 3; ++i) {
      const double q = e[i] * y[i] / (w + above[i]);
      sum += q * q;
    }
    return sum;
  };
  double low = 0, high = 1 + glm::length(e * y);
  for (int i = 0; i < 300 && low < high; ++i) {
    const double w = 0.5 * (low + high);
    (miss(w) > 0 ? low : high) = w;
  }
  const double w = 0.5 * (low + high);
  Vec3 d;
  for (int i = 0; i < 3; ++i) d[i] = (w - 1) * y[i] / (w + above[i]);
  return unit * glm::length(d);
}

// Distance to the whole surface of a shape; sectors: for points within their angles.
inline Distance distance_to(const geometry::Ellipsoid& s) {
  return [s](const Vec3& p) { return to_ellipsoid(s.radii, p); };
}
inline Distance distance_to(const geometry::Torus& s) {
  return [s](const Vec3& p) {
    const Vec2 m = meridian(p);
    return std::fabs(std::hypot(m.x - s.radius, m.y) - s.tube_radius);
  };
}
inline Distance distance_to(const geometry::Cone& s) {
  using geometry::Caps;
  std::vector<Vec2> line;
  if (s.caps == Caps::both || s.caps == Caps::bottom) line.push_back({0, -s.height / 2});
  line.push_back({s.bottom_radius, -s.height / 2});
  line.push_back({s.top_radius, s.height / 2});
  if (s.caps == Caps::both || s.caps == Caps::top) line.push_back({0, s.height / 2});
  line.erase(std::unique(line.begin(), line.end()), line.end());
  return to_revolved(line);
}
inline Distance distance_to(const geometry::Cylinder& s) {
  return distance_to(geometry::Cone{s.radius, s.radius, s.height, s.caps, s.sector, s.counts});
}
inline Distance distance_to(const geometry::Disc& s) {
  return to_revolved({{s.radius, 0}, {s.inner_radius, 0}});
}
inline Distance distance_to(const geometry::Sphere& s) {
  return [s](const Vec3& p) {
    const Vec2 m = meridian(p);
    const double latitude = std::clamp(std::atan2(m.y, m.x), s.latitude_min, s.latitude_max);
    return glm::length(m - s.radius * Vec2(std::cos(latitude), std::sin(latitude)));
  };
}
inline Distance distance_to(const geometry::Dish& s) {
  return [s](const Vec3& p) {
    const Vec2 m = meridian(p);
    const double radius = s.diameter / 2;
    const auto at = [&](double t) { return Vec2(t, t * t / (4 * s.focal_length)); };
    // the nearest point: the only root of a cubic for r ≥ 0 outside; a search finds it inside too
    const auto nearest = [&](const Vec2& q) { return to_curve(q, 0, radius, 64, at); };
    double best = nearest(m);
    if (s.thickness > 0) {
      const double rim = at(radius).y;
      best = std::min({best, nearest({m.x, m.y + s.thickness}),
                       to_segment(m, {radius, rim - s.thickness}, {radius, rim})});
    }
    return best;
  };
}

// A centripetal Catmull-Rom point by repeated interpolation. Barry, Goldman, 1988.
template <class Vec>
Vec catmull_rom(const Vec& a, const Vec& b, const Vec& c, const Vec& d, double share) {
  const double t0 = 0, t1 = t0 + std::sqrt(glm::length(b - a));
  const double t2 = t1 + std::sqrt(glm::length(c - b)), t3 = t2 + std::sqrt(glm::length(d - c));
  const double t = t1 + share * (t2 - t1);
  const auto mix = [t](const Vec& p, const Vec& q, double tp, double tq) {
    return ((tq - t) * p + (t - tp) * q) / (tq - tp);
  };
  const Vec p1 = mix(a, b, t0, t1), p2 = mix(b, c, t1, t2), p3 = mix(c, d, t2, t3);
  return mix(mix(p1, p2, t0, t2), mix(p2, p3, t1, t3), t1, t2);
}

// The profile of a lathe; splines as `steps` chords for each pair of points. Points on the axis lie
// at the ends only.
inline std::vector<Vec2> profile_of(const geometry::Lathe& s, int steps) {
  if (!s.spline) return s.profile;
  const auto& points = s.profile;
  const std::size_t last = points.size() - 1;
  const bool loop = points.front() == points.back();
  const auto beyond = [](const Vec2& end, const Vec2& inner) {
    return end.x == 0 ? Vec2(-inner.x, inner.y) : 2.0 * end - inner;
  };
  std::vector<Vec2> line;
  for (std::size_t i = 0; i < last; ++i) {
    const Vec2 before = i > 0  ? points[i - 1]
                        : loop ? points[last - 1]
                               : beyond(points[0], points[1]);
    const Vec2 after = i + 1 < last ? points[i + 2]
                       : loop       ? points[1]
                                    : beyond(points[last], points[last - 1]);
    for (int k = 0; k < steps; ++k)
      line.push_back(catmull_rom(before, points[i], points[i + 1], after, double(k) / steps));
  }
  line.push_back(points.back());
  return line;
}
inline Distance distance_to(const geometry::Lathe& s) { return to_revolved(profile_of(s, 1000)); }

// The outside of an open pipe with caps: along a spline as `steps` chords for each pair of points;
// along a polyline by its pieces, each up to the planes of its mitres and `slack` beyond.
inline Distance distance_to_spline_tube(const geometry::Tube& s, int steps) {
  const auto& points = s.path;
  const std::size_t last = points.size() - 1;
  std::vector<Vec3> line;
  for (std::size_t i = 0; i < last; ++i) {
    const Vec3 before = i > 0 ? points[i - 1] : 2.0 * points[0] - points[1];
    const Vec3 after = i + 1 < last ? points[i + 2] : 2.0 * points[last] - points[last - 1];
    for (int k = 0; k < steps; ++k)
      line.push_back(catmull_rom(before, points[i], points[i + 1], after, double(k) / steps));
  }
  line.push_back(points.back());
  const Vec3 ends[2] = {points[0], points[last]};
  const Vec3 out[2] = {glm::normalize(line[0] - line[1]),
                       glm::normalize(line.back() - line[line.size() - 2])};
  return [s, ends = std::vector(ends, ends + 2), out = std::vector(out, out + 2),
          axis = PolylineOf<Vec3>(std::move(line))](const Vec3& p) {
    double best = std::fabs(axis.distance(p) - s.radius);
    for (int k = 0; k < 2; ++k) {
      const double height = glm::dot(p - ends[k], out[k]);
      const double beside = glm::length(p - ends[k] - height * out[k]) - s.radius;
      best = std::min(best, std::hypot(height, std::max(0.0, beside)));
    }
    return best;
  };
}
inline Distance distance_to_mitred_tube(const geometry::Tube& s, double slack) {
  return [s, slack](const Vec3& p) {
    const std::size_t last = s.path.size() - 1;
    const auto along = [&](std::size_t i) { return glm::normalize(s.path[i + 1] - s.path[i]); };
    double best = HUGE_VAL;
    for (std::size_t i = 0; i < last; ++i) {
      const Vec3 d = along(i);
      const Vec3 begin = i > 0 ? glm::normalize(along(i - 1) + d) : d;
      const Vec3 end = i + 1 < last ? glm::normalize(d + along(i + 1)) : d;
      const double from = glm::dot(p - s.path[i], begin);
      const double to = glm::dot(p - s.path[i + 1], end);
      if (from < -slack || to > slack) continue;
      const auto radius = [&](const Vec3& q) {
        return glm::length(q - s.path[i] - glm::dot(q - s.path[i], d) * d);
      };
      best = std::min(best, std::fabs(radius(p) - s.radius));
      const double beside = std::max(0.0, radius(p) - s.radius);
      if (i == 0) best = std::min(best, std::hypot(from, beside));
      if (i + 1 == last) best = std::min(best, std::hypot(to, beside));
    }
    return best;
  };
}

inline Distance distance_to(const geometry::Plane& s) {
  return [s](const Vec3& p) {
    const double x = std::max(0.0, std::fabs(p.x) - s.width / 2);
    const double y = std::max(0.0, std::fabs(p.y) - s.height / 2);
    return glm::length(Vec3(x, y, p.z));
  };
}

// One with both caps, by the crossings of a ray with its loops.
inline Distance distance_to(const geometry::Extrude& s) {
  std::vector<std::vector<Vec2>> loops = s.holes;
  loops.push_back(s.outline);
  std::vector<Polyline> lines;
  for (auto& loop : loops) {
    loop.push_back(loop.front());
    lines.emplace_back(loop);
  }
  return [height = s.height, loops, lines](const Vec3& p) {
    double wall = HUGE_VAL;
    bool inside = false;
    for (std::size_t i = 0; i < loops.size(); ++i) {
      wall = std::min(wall, lines[i].distance({p.x, p.y}));
      for (std::size_t k = 0; k + 1 < loops[i].size(); ++k) {
        const Vec2 &a = loops[i][k], &b = loops[i][k + 1];
        if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x))
          inside = !inside;
      }
    }
    const double beyond = std::max({0.0, -p.z, p.z - height});
    if (!inside) return std::hypot(wall, beyond);
    return beyond > 0 ? beyond : std::min({wall, p.z, height - p.z});
  };
}

struct Sampled {
  double worst = 0;
  double rms = 0;
};

// Distances over a dense sampling of every triangle, for vertices as float32 stores them about the
// centre of their bounds.
inline Sampled sampled_distance(const geometry::Mesh& mesh, const Distance& distance, int steps) {
  Vec3 low = mesh.positions[0], high = low;
  for (const Vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const Vec3 centre = 0.5 * low + 0.5 * high;
  Sampled result;
  double sum = 0;
  std::size_t count = 0;
  for (const geometry::Triangle& t : mesh.triangles) {
    Vec3 corner[3];
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) {
        const volatile float stored = static_cast<float>(mesh.positions[t[k]][axis] - centre[axis]);
        corner[k][axis] = static_cast<double>(stored) + centre[axis];
      }
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const double u = static_cast<double>(i) / steps;
        const double v = static_cast<double>(j) / steps;
        const double d = distance((1 - u - v) * corner[0] + u * corner[1] + v * corner[2]);
        result.worst = std::max(result.worst, d);
        sum += d * d;
        ++count;
      }
    }
  }
  result.rms = std::sqrt(sum / static_cast<double>(count));
  return result;
}

}  // namespace panwright::oracles
