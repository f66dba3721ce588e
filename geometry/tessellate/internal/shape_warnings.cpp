// Shape warnings: degenerate triangles, inside-out surfaces, self-intersections.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "geometry/internal/triangle.h"
#include "geometry/internal/weld.h"
#include "geometry/tessellate/internal/predicates.h"
#include "geometry/tessellate/internal/tessellators.h"
#include "geometry/tessellate/shape.h"

namespace panwright::geometry {

namespace {

using internal::orientation;

// A band this narrow beside its radius has degenerate triangles up to 600 segments about the axis,
// as many as an error of 1e-5 of the radius takes.
constexpr double kNarrowBand = 1e-9;
// A point or pipe this narrow beside its length has them with any number of segments.
constexpr double kNeedle = 1e-8;
// radians: of a sector or a range of latitudes, the same
constexpr double kNarrowAngle = 1e-8;
// chords that approximate each piece of a spline
constexpr int kChords = 16;
// pairs of a profile's edges that are compared; more of them are let pass
constexpr std::uint64_t kMostPairs = 20'000'000;

using ShapeWarnings = std::vector<ShapeProblem>;

struct Length {
  std::string_view name;  // with its article
  double metres;
};

void thin(const Length& small, const Length& large, double ratio, std::string_view part,
          ShapeWarnings& out) {
  if (!(small.metres > 0 && small.metres < ratio * large.metres)) return;
  out.push_back({Code("W2006"),
                 fmt::format("{} of {:.4g} m with {} of {:.4g} m makes triangles without area",
                             small.name, small.metres, large.name, large.metres),
                 part});
}

void narrow_sector(const Sector& sector, ShapeWarnings& out) {
  if (sector.end - sector.begin < kNarrowAngle)
    out.push_back({Code("W2006"),
                   fmt::format("a sector of {:.4g} deg makes triangles without area",
                               (sector.end - sector.begin) / kDegree),
                   "sector"});
}

// A wall between two radii.
void thin_wall(double bottom, double top, double height, const Sector& sector, ShapeWarnings& out) {
  const double slant = std::hypot(height, bottom - top);
  thin({"a height", slant}, {"a radius", std::max(bottom, top)}, kNarrowBand, "height", out);
  const bool bottom_is_less = bottom > 0 && (bottom <= top || top == 0);
  thin({"a radius", bottom_is_less ? bottom : top}, {"a height", slant}, kNeedle,
       bottom_is_less ? "bottom_radius" : "top_radius", out);
  narrow_sector(sector, out);
}

// ---- lathes

struct Profile {
  std::vector<Vec2> points;
  bool loop = false;
};

// What the turned profile encloses, in m³: positive with the outside on its right.
double turned_volume(const Profile& profile) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < profile.points.size(); ++i) {
    const Vec2& a = profile.points[i];
    const Vec2& b = profile.points[i + 1];
    sum += (b.y - a.y) * (a.x * a.x + a.x * b.x + b.x * b.x);
  }
  return sum * kPi / 3;
}

bool in_box(const Vec2& p, const Vec2& a, const Vec2& b) {
  return p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) && p.y >= std::min(a.y, b.y) &&
         p.y <= std::max(a.y, b.y);
}

// Whether two edges have a point in common.
bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const int ca = orientation(a, b, c), da = orientation(a, b, d);
  const int ac = orientation(c, d, a), bc = orientation(c, d, b);
  if (ca * da < 0 && ac * bc < 0) return true;
  return (ca == 0 && in_box(c, a, b)) || (da == 0 && in_box(d, a, b)) ||
         (ac == 0 && in_box(a, c, d)) || (bc == 0 && in_box(b, c, d));
}

// The edges of a profile that run through or along each other, by their first points: those of
// lowest z first. Runs may meet on the axis.
std::optional<std::pair<std::size_t, std::size_t>> crossing(const Profile& profile) {
  const std::vector<Vec2>& p = profile.points;
  const std::size_t edges = p.size() - 1;
  const auto low = [&](std::size_t i) { return std::min(p[i].y, p[i + 1].y); };
  const auto high = [&](std::size_t i) { return std::max(p[i].y, p[i + 1].y); };
  std::vector<std::size_t> order(edges);
  for (std::size_t i = 0; i < edges; ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return low(a) != low(b) ? low(a) < low(b) : a < b;
  });
  const auto clash = [&](std::size_t a, std::size_t b) {
    if (std::max(p[a].x, p[a + 1].x) < std::min(p[b].x, p[b + 1].x) ||
        std::max(p[b].x, p[b + 1].x) < std::min(p[a].x, p[a + 1].x))
      return false;
    const auto [first, second] = std::minmax(a, b);
    const bool wraps = profile.loop && first == 0 && second + 1 == edges;
    if (second == first + 1 || wraps) {
      // neighbours: only one that turns back on itself
      const Vec2& from = wraps ? p[second] : p[first];
      const Vec2& at = wraps ? p[0] : p[second];
      const Vec2& to = wraps ? p[1] : p[second + 1];
      return orientation(from, at, to) == 0 && glm::dot(at - from, to - at) < 0;
    }
    // what lies on the axis makes no surface, and runs may meet there
    const auto on_axis = [&](std::size_t edge) { return p[edge].x == 0 && p[edge + 1].x == 0; };
    if (on_axis(a) || on_axis(b)) return false;
    for (const std::size_t i : {a, a + 1})
      for (const std::size_t k : {b, b + 1})
        if (p[i].x == 0 && p[i] == p[k]) {
          const Vec2& one = p[i == a ? a + 1 : a];
          return orientation(p[i], one, p[k == b ? b + 1 : b]) == 0;
        }
    return meet(p[a], p[a + 1], p[b], p[b + 1]);
  };
  std::vector<std::size_t> open;
  std::uint64_t pairs = 0;
  for (const std::size_t edge : order) {
    std::erase_if(open, [&](std::size_t other) { return high(other) < low(edge); });
    if ((pairs += open.size()) > kMostPairs) return std::nullopt;
    for (const std::size_t other : open)
      if (clash(edge, other)) return std::minmax(edge, other);
    open.push_back(edge);
  }
  return std::nullopt;
}

// The first point that is nearly on the axis.
void needle_in(const std::vector<Vec2>& profile, ShapeWarnings& out) {
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const double length = glm::length(profile[i + 1] - profile[i]);
    for (const std::size_t end : {i, i + 1}) {
      if (!(profile[end].x > 0 && profile[end].x < kNeedle * length)) continue;
      thin({"a radius", profile[end].x}, {"a stretch", length}, kNeedle, "profile", out);
      out.back().item = end;
      return;
    }
  }
}

void look_at(const Lathe& s, ShapeWarnings& out) {
  Profile profile{internal::sampled_profile(s, kChords),
                  s.profile.size() > 2 && s.profile.front() == s.profile.back()};
  const std::size_t step = s.spline ? kChords : 1;
  needle_in(s.profile, out);
  narrow_sector(s.sector, out);
  if (const auto edges = crossing(profile)) {
    const std::size_t a = edges->first / step, b = edges->second / step;
    out.push_back(
        {Code("W2019"),
         a == b
             ? fmt::format("the profile crosses itself after point {}", a + 1)
             : fmt::format("the profile after point {} crosses or touches its part after point {}",
                           b + 1, a + 1),
         "profile", b});
    return;
  }
  if (!is_closed(s)) return;
  if (const double volume = turned_volume(profile); volume < 0)
    out.push_back({Code("W2009"),
                   fmt::format("the lathe is closed and inside out: it encloses {:.4g} m³; the "
                               "outside must be on the right of the profile",
                               volume),
                   "profile"});
}

// ---- polygons

// The sides of faces as polygons share them.
struct Sides {
  std::uint64_t misoriented = 0;
  bool closed = true;
};

class PolygonsReader {
 public:
  explicit PolygonsReader(const Polygons& shape)
      : shape_(shape), position_(welded(shape.positions)) {}

  void look(ShapeWarnings& out) {
    origin_ = shape_.positions[shape_.faces[0].outline[0]];
    for (std::size_t i = 0; i < shape_.faces.size(); ++i) read(i);
    if (thin_ > 0)
      out.push_back({Code("W2006"),
                     fmt::format("face {}{} too thin to have an area", thin_face_ + 1,
                                 thin_ > 1 ? fmt::format(" and {} more are", thin_ - 1) : " is"),
                     "faces", thin_face_});
    const Sides sides = count();
    if (sides.misoriented > 0)
      out.push_back({Code("W2007"),
                     fmt::format("at {} neighbouring faces have opposite winding, expected "
                                 "outlines counter-clockwise from outside",
                                 counted(sides.misoriented, "edge")),
                     "polygons"});
    // sheets of two faces enclose nothing, but for rounding
    if (sides.closed && volume_ < -1e-12 * extent_)
      out.push_back(
          {Code("W2009"),
           fmt::format("the polygons are closed and inside out: they enclose {:.4g} m³", volume_),
           "polygons"});
  }

 private:
  struct Side {
    std::uint32_t low, high;
    bool forward;
  };

  Vec3 area(const std::vector<std::uint32_t>& loop) const {
    Vec3 sum(0);
    const Vec3& first = shape_.positions[loop[0]];
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
      sum += glm::cross(shape_.positions[loop[i]] - first, shape_.positions[loop[i + 1]] - first);
    return 0.5 * sum;
  }

  void read(std::size_t index) {
    const Polygons::Face& face = shape_.faces[index];
    Vec3 whole = area(face.outline);
    double longest = 0;
    add(face.outline, false);
    for (const auto& hole : face.holes) {
      const Vec3 inner = area(hole);
      const bool same_way = glm::dot(inner, whole) > 0;
      whole += same_way ? -inner : inner;
      add(hole, same_way);
    }
    Vec3 low = shape_.positions[face.outline[0]], high = low;
    for (const std::uint32_t v : face.outline) {
      low = glm::min(low, shape_.positions[v]);
      high = glm::max(high, shape_.positions[v]);
    }
    longest = glm::length(high - low);
    // note: an outline is no longer than its diagonal, so that no triangle of it has more
    if (2 * glm::length(whole) < kDegenerateRatio * longest * longest / 3 && thin_++ == 0)
      thin_face_ = index;
    const Vec3 to_face = shape_.positions[face.outline[0]] - origin_;
    volume_ += glm::dot(whole, to_face) / 3;
    extent_ += glm::length(whole) * (glm::length(to_face) + longest);
  }

  void add(const std::vector<std::uint32_t>& loop, bool backwards) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::uint32_t a = position_[loop[i]],
                          b = position_[loop[i + 1 == loop.size() ? 0 : i + 1]];
      sides_.push_back({std::min(a, b), std::max(a, b), (a < b) != backwards});
    }
  }

  // By their lower positions, then by their upper ones.
  Sides count() {
    std::vector<std::uint32_t> start(shape_.positions.size() + 1, 0);
    for (const Side& side : sides_) ++start[side.low + 1];
    for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
    std::vector<std::uint64_t> upper(sides_.size());  // position · 2 + forward
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    for (const Side& side : sides_)
      upper[next[side.low]++] = 2 * std::uint64_t{side.high} + (side.forward ? 1 : 0);
    Sides sides;
    for (std::size_t v = 0; v + 1 < start.size(); ++v) {
      const auto end = upper.begin() + start[v + 1];
      std::sort(upper.begin() + start[v], end);
      for (auto side = upper.begin() + start[v]; side != end;) {
        const auto first = side;
        std::uint64_t forward = 0;
        for (; side != end && *side / 2 == *first / 2; ++side) forward += *side & 1;
        sides.misoriented += side - first == 2 && forward != 1;
        sides.closed &= side - first == 2 && forward == 1;
      }
    }
    return sides;
  }

  const Polygons& shape_;
  std::vector<std::uint32_t> position_;  // V
  std::vector<Side> sides_;
  Vec3 origin_{0};
  double volume_ = 0;
  double extent_ = 0;  // of the terms of the volume
  std::uint64_t thin_ = 0;
  std::size_t thin_face_ = 0;
};

// ---- the others

void look_at(const Sphere& s, ShapeWarnings& out) {
  if (s.latitude_max - s.latitude_min < kNarrowAngle)
    out.push_back({Code("W2006"),
                   fmt::format("latitudes over {:.4g} deg make triangles without area",
                               (s.latitude_max - s.latitude_min) / kDegree),
                   "latitude_min"});
  narrow_sector(s.sector, out);
}

void look_at(const Ellipsoid& s, ShapeWarnings& out) {
  double r[] = {s.radii.x, s.radii.y, s.radii.z};
  std::sort(r, r + 3);
  thin({"a radius", r[1]}, {"one", r[2]}, kNeedle, "radii", out);
}

void look_at(const Box& s, ShapeWarnings& out) {
  const double least = std::min({s.size.x, s.size.y, s.size.z});
  const double most = std::max({s.size.x, s.size.y, s.size.z});
  thin({"a side", least}, {"one", most}, kDegenerateRatio, "size", out);
  // the strip of a bevel is wider than the bevel by √2
  thin({"a bevel", s.bevel}, {"a side", most}, kDegenerateRatio * std::sqrt(0.5), "bevel", out);
  thin({"a flat side", least - 2 * s.bevel}, {"a side", most}, s.bevel > 0 ? kDegenerateRatio : 0,
       "bevel", out);
}

void look_at(const Cylinder& s, ShapeWarnings& out) {
  thin_wall(s.radius, s.radius, s.height, s.sector, out);
}
void look_at(const Cone& s, ShapeWarnings& out) {
  thin_wall(s.bottom_radius, s.top_radius, s.height, s.sector, out);
}

void look_at(const Disc& s, ShapeWarnings& out) {
  thin({"a ring", s.radius - s.inner_radius}, {"a radius", s.radius}, kNarrowBand, "inner_radius",
       out);
  thin({"an inner radius", s.inner_radius}, {"a radius", s.radius}, kNeedle, "inner_radius", out);
  narrow_sector(s.sector, out);
}

void look_at(const Torus& s, ShapeWarnings& out) {
  thin({"a tube radius", s.tube_radius}, {"a radius", s.radius}, kNarrowBand, "tube_radius", out);
  narrow_sector(s.sector, out);
}

void look_at(const Dish& s, ShapeWarnings& out) {
  thin({"a thickness", s.thickness}, {"a diameter", s.diameter}, kNarrowBand, "thickness", out);
}

void look_at(const Plane& s, ShapeWarnings& out) {
  thin({"a side", std::min(s.width, s.height)}, {"one", std::max(s.width, s.height)},
       kDegenerateRatio, "width", out);
}

void look_at(const Tube& s, ShapeWarnings& out) {
  double longest = 0;
  for (std::size_t i = 0; i + 1 < s.path.size() && !s.spline; ++i)
    longest = std::max(longest, glm::length(s.path[i + 1] - s.path[i]));
  thin({"a radius", s.radius}, {"a stretch", longest}, kNeedle, "radius", out);
  if (s.inner_radius > 0)
    thin({"a wall", s.radius - s.inner_radius}, {"a radius", s.radius}, kNarrowBand, "inner_radius",
         out);
}

void look_at(const Extrude& s, ShapeWarnings& out) {
  double least = s.height, most = 0;
  const auto look_at_loop = [&](const std::vector<Vec2>& loop) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const double edge = glm::length(loop[(i + 1) % loop.size()] - loop[i]);
      least = std::min(least, edge);
      most = std::max(most, edge);
    }
  };
  look_at_loop(s.outline);
  for (const auto& hole : s.holes) look_at_loop(hole);
  thin({"a height", s.height}, {"an edge", most}, kDegenerateRatio, "height", out);
  if (least < s.height)
    thin({"an edge", least}, {"a height", s.height}, kDegenerateRatio, "height", out);
}

void look_at(const Polygons& s, ShapeWarnings& out) { PolygonsReader(s).look(out); }
void look_at(const Subdiv& s, ShapeWarnings& out) { out = internal::warnings(s); }
void look_at(const MeshShape&, ShapeWarnings&) {}

}  // namespace

std::vector<ShapeProblem> shape_warnings_of(const Shape& shape) {
  ShapeWarnings out;
  std::visit([&](const auto& s) { look_at(s, out); }, shape);
  return out;
}

}  // namespace panwright::geometry
