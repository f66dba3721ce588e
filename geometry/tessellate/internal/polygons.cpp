#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.h"
#include "geometry/internal/limits.h"
#include "geometry/internal/weld.h"
#include "geometry/tessellate/internal/flat.h"
#include "geometry/tessellate/internal/predicates.h"
#include "geometry/tessellate/internal/revolve.h"
#include "geometry/tessellate/internal/triangulate.h"

namespace panwright::geometry::internal {

namespace {

// corners may lie this far from a face's plane, relative to its size
constexpr double kFlatness = 1e-6;

using Face = Polygons::Face;

double corner_count(const Face& face) {
  double count = static_cast<double>(face.outline.size());
  for (const auto& hole : face.holes) count += static_cast<double>(hole.size());
  return count;
}

double face_triangles(const Face& face) {
  return corner_count(face) + 2 * static_cast<double>(face.holes.size()) - 2;
}

// The vector of an outline's area, relative to the square of its size.
Vec3 area_vector(const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& outline,
                 double size) {
  Vec3 sum(0);
  const Vec3& origin = positions[outline[0]];
  for (std::size_t i = 1; i + 1 < outline.size(); ++i)
    sum += glm::cross((positions[outline[i]] - origin) / size,
                      (positions[outline[i + 1]] - origin) / size);
  return 0.5 * sum;
}

double size_of(const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& outline) {
  Vec3 low = positions[outline[0]];
  Vec3 high = low;
  for (const std::uint32_t v : outline) {
    low = glm::min(low, positions[v]);
    high = glm::max(high, positions[v]);
  }
  return glm::length(high - low);
}

// A face in its plane, seen along the axis nearest to its normal: coordinates stay exact, and the
// outline runs counter-clockwise.
struct FlatFace {
  FlatFace(const std::vector<Vec3>& positions, const Face& face)
      : size(size_of(positions, face.outline)) {
    if (size == 0) return;
    const Vec3 area = area_vector(positions, face.outline, size);
    const double length = glm::length(area);
    // an outline as thin as this has no direction
    if (!(length > 1e-15)) return;
    normal = area / length;
    for (const int other : {1, 0})
      if (std::fabs(area[other]) > std::fabs(area[axis])) axis = other;
    away = area[axis] < 0;
  }
  bool has_area() const { return normal != Vec3(0); }
  Vec2 flat(const Vec3& p) const {
    const double x = p[(axis + 1) % 3];
    const double y = p[(axis + 2) % 3];
    return away ? Vec2(y, x) : Vec2(x, y);
  }

  double size;     // of the outline
  Vec3 normal{0};  // unit, zero: no area
  int axis = 2;
  bool away = false;
};

Region region_of_face(const std::vector<Vec3>& positions, const Face& face, const FlatFace& flat) {
  std::vector<Vec2> points;
  std::vector<std::uint32_t> loops{0};
  const auto add = [&](const std::vector<std::uint32_t>& loop) {
    for (const std::uint32_t v : loop) points.push_back(flat.flat(positions[v]));
    loops.push_back(static_cast<std::uint32_t>(points.size()));
  };
  add(face.outline);
  for (const auto& hole : face.holes) add(hole);
  return region_of(points, std::move(loops));
}

// Triangles and quads that turn left at each corner need no sweep. Not all sound ones: those that
// do not pass are examined closely.
bool is_simple(const std::vector<Vec3>& positions, const Face& face, const FlatFace& flat) {
  const std::size_t count = face.outline.size();
  if (count > 4 || !face.holes.empty()) return false;
  Vec2 p[4];
  for (std::size_t i = 0; i < count; ++i) p[i] = flat.flat(positions[face.outline[i]]);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2& next = p[(i + 1) % count];
    if (!(glm::length(next - p[i]) > 1e-8 * flat.size)) return false;
    if (orientation(p[i], next, p[(i + 2) % count]) <= 0) return false;
  }
  return true;
}

// The corner furthest from the plane through the outline, and how far it is.
std::pair<std::uint32_t, double> furthest_corner(const std::vector<Vec3>& positions,
                                                 const Face& face, const FlatFace& flat) {
  const Vec3& origin = positions[face.outline[0]];
  double low = 0, high = 0;
  std::uint32_t lowest = face.outline[0], highest = lowest;
  const auto look_at = [&](const std::vector<std::uint32_t>& loop) {
    for (const std::uint32_t v : loop) {
      const double height = glm::dot(positions[v] - origin, flat.normal);
      if (height < low) low = height, lowest = v;
      if (height > high) high = height, highest = v;
    }
  };
  look_at(face.outline);
  for (const auto& hole : face.holes) look_at(hole);
  return {-low > high ? lowest : highest, 0.5 * (high - low)};
}

ShapeProblem polygon_problem(Code code, std::size_t face, const std::string& what) {
  return {code, fmt::format("face {}: {}", face + 1, what), "faces", face};
}

Problem index_problem(const Polygons& shape, std::size_t index) {
  const Face& face = shape.faces[index];
  const auto loop_problem = [&](const std::vector<std::uint32_t>& loop) -> Problem {
    if (loop.size() < 3)
      return polygon_problem(Code("E2015"), index,
                             fmt::format("a loop of {} points, expected at least 3", loop.size()));
    for (const std::uint32_t v : loop)
      if (v >= shape.positions.size())
        return polygon_problem(
            Code("E2001"), index,
            fmt::format("vertex index {}, expected below {}", v, shape.positions.size()));
    return std::nullopt;
  };
  if (auto bad = loop_problem(face.outline)) return bad;
  for (const auto& hole : face.holes)
    if (auto bad = loop_problem(hole)) return bad;
  return std::nullopt;
}

Problem problem_of_face(const Polygons& shape, std::size_t index) {
  if (auto bad = index_problem(shape, index)) return bad;
  const Face& face = shape.faces[index];
  const FlatFace flat(shape.positions, face);
  if (!flat.has_area())
    return polygon_problem(Code("E2012"), index, "its outline encloses no area");
  const auto [vertex, distance] = furthest_corner(shape.positions, face, flat);
  if (distance > kFlatness * flat.size)
    return polygon_problem(
        Code("E2016"), index,
        fmt::format("vertex {} lies {} m from its plane, expected at most {} m", vertex,
                    format_double(distance), format_double(kFlatness * flat.size)));
  if (is_simple(shape.positions, face, flat)) return std::nullopt;
  Region region = region_of_face(shape.positions, face, flat);
  const auto fault = fault_of(region);
  if (!fault) return std::nullopt;
  return polygon_problem(code_of(*fault, region), index, sentence_of(*fault, region));
}

// Corners are numbered face by face, loop by loop. The corners at one position whose faces are
// smooth there share a vertex.
class PolygonBuilder {
 public:
  PolygonBuilder(const Polygons& shape, bool texcoords)
      : shape_(shape),
        texcoords_(texcoords),
        cos_smooth_(det::cos(std::min(shape.smooth + kAngleSlack, kPi))) {}

  // false: not what problem_of() lets pass
  bool build(Mesh& mesh) {
    position_ = welded(shape_.positions);
    flats_.reserve(shape_.faces.size());
    for (const Face& face : shape_.faces)
      if (!add_face(face)) return false;
    first_.push_back(static_cast<std::uint32_t>(corner_.size()));
    join_corners();
    sum_normals();
    add_vertices(mesh);
    for (Triangle& t : triangles_)
      for (std::uint32_t& corner : t) corner = vertex_[corner];
    mesh.triangles = std::move(triangles_);
    mesh.closed = closed_;
    return true;
  }

 private:
  struct Side {
    std::uint32_t low, high;        // unique positions
    std::uint32_t at_low, at_high;  // corners of the face
    std::uint32_t face;
    bool forward;  // runs from the lower position
  };

  bool add_face(const Face& face) {
    const auto first = static_cast<std::uint32_t>(corner_.size());
    const FlatFace flat(shape_.positions, face);
    if (!flat.has_area()) return false;
    first_.push_back(first);
    flats_.push_back(flat);
    corner_.insert(corner_.end(), face.outline.begin(), face.outline.end());
    const auto count = static_cast<std::uint32_t>(face.outline.size());
    if (is_simple(shape_.positions, face, flat)) {
      for (std::uint32_t i = 0; i < count; ++i) {
        next_.push_back(first + (i + 1) % count);
        prev_.push_back(first + (i + count - 1) % count);
      }
      add_simple(first, count);
      return true;
    }
    for (const auto& hole : face.holes) corner_.insert(corner_.end(), hole.begin(), hole.end());
    Region region = region_of_face(shape_.positions, face, flat);
    if (fault_of(region)) return false;
    for (std::uint32_t i = 0; i < region.size(); ++i) {
      next_.push_back(first + region.next[i]);
      prev_.push_back(first + region.prev[i]);
    }
    for (const Triangle& t : triangulated(region, scaled(first)))
      triangles_.push_back({first + t[0], first + t[1], first + t[2]});
    return true;
  }

  // A quad is cut along its shorter diagonal.
  void add_simple(std::uint32_t a, std::uint32_t count) {
    if (count == 3) {
      triangles_.push_back({a, a + 1, a + 2});
      return;
    }
    const double across = glm::length(position(a + 2) - position(a));
    const std::uint32_t b = glm::length(position(a + 3) - position(a + 1)) < across ? 1 : 0;
    triangles_.push_back({a + b, a + b + 1, a + b + 2});
    triangles_.push_back({a + b, a + b + 2, a + (b + 3) % 4});
  }

  const Vec3& position(std::uint32_t corner) const { return shape_.positions[corner_[corner]]; }

  // Corners from `first` on, about the first and by the largest coordinate, for no other reason
  // than range.
  std::vector<Vec3> scaled(std::uint32_t first) const {
    double largest = 0;
    std::vector<Vec3> result;
    result.reserve(corner_.size() - first);
    for (std::uint32_t i = first; i < corner_.size(); ++i) {
      const Vec3 d = position(i) - position(first);
      largest = std::max({largest, std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
      result.push_back(d);
    }
    for (Vec3& d : result) d /= largest;
    return result;
  }

  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  // Sides in the order of their lower position.
  std::vector<Side> sides() const {
    std::vector<std::uint32_t> start(shape_.positions.size() + 1, 0);
    const auto low = [&](std::uint32_t i) {
      return std::min(position_[corner_[i]], position_[corner_[next_[i]]]);
    };
    for (std::uint32_t i = 0; i < corner_.size(); ++i) ++start[low(i) + 1];
    for (std::size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
    std::vector<Side> result(corner_.size());
    for (std::uint32_t f = 0; f < flats_.size(); ++f) {
      for (std::uint32_t i = first_[f]; i < first_[f + 1]; ++i) {
        const std::uint32_t j = next_[i];
        const std::uint32_t a = position_[corner_[i]];
        const std::uint32_t b = position_[corner_[j]];
        result[start[low(i)]++] = a < b ? Side{a, b, i, j, f, true} : Side{b, a, j, i, f, false};
      }
    }
    return result;
  }

  void join_corners() {
    parent_.resize(corner_.size());
    std::iota(parent_.begin(), parent_.end(), 0u);
    std::vector<Side> all = sides();
    for (std::size_t i = 0; i < all.size();) {
      std::size_t end = i;
      while (end < all.size() && all[end].low == all[i].low) ++end;
      std::sort(all.begin() + static_cast<std::ptrdiff_t>(i),
                all.begin() + static_cast<std::ptrdiff_t>(end), [](const Side& a, const Side& b) {
                  return a.high != b.high ? a.high < b.high : a.at_low < b.at_low;
                });
      while (i < end) i = join_side(all, i);
    }
  }

  // All faces at one side between two positions; returns where the next begins.
  std::size_t join_side(const std::vector<Side>& all, std::size_t i) {
    std::size_t end = i;
    while (end < all.size() && all[end].low == all[i].low && all[end].high == all[i].high) ++end;
    // note: where more than two faces meet none goes on in another
    if (end - i != 2) {
      closed_ = false;
      return end;
    }
    const Side& a = all[i];
    const Side& b = all[i + 1];
    closed_ &= a.forward != b.forward;
    if (smooth(flats_[a.face].normal, flats_[b.face].normal)) {
      join(a.at_low, b.at_low);
      join(a.at_high, b.at_high);
    }
    return end;
  }

  bool smooth(const Vec3& a, const Vec3& b) const {
    const double cosine = glm::dot(a, b);
    if (cosine < cos_smooth_ - 1e-6) return false;
    return cosine > cos_smooth_ + 1e-6 || angle_between(a, b) <= shape_.smooth + kAngleSlack;
  }

  // Weighted by the angles of the corners.
  void sum_normals() {
    normals_.assign(corner_.size(), Vec3(0));
    std::vector<bool> shared(corner_.size(), false);
    for (std::uint32_t i = 0; i < corner_.size(); ++i)
      if (root(i) != i) shared[root(i)] = true;
    for (std::uint32_t f = 0; f < flats_.size(); ++f) {
      const Vec3& normal = flats_[f].normal;
      for (std::uint32_t i = first_[f]; i < first_[f + 1]; ++i) {
        if (!shared[root(i)]) {
          normals_[i] = normal;
          continue;
        }
        const Vec3 to_next = position(next_[i]) - position(i);
        const Vec3 to_prev = position(prev_[i]) - position(i);
        double angle = angle_between(to_next, to_prev);
        if (glm::dot(glm::cross(to_next, to_prev), normal) < 0) angle = 2 * kPi - angle;
        normals_[root(i)] += angle * normal;
      }
    }
  }

  void add_vertices(Mesh& mesh) {
    vertex_.assign(corner_.size(), kNone);
    for (std::uint32_t f = 0; f < flats_.size(); ++f) {
      for (std::uint32_t i = first_[f]; i < first_[f + 1]; ++i) {
        const std::uint32_t group = root(i);  // no corner of it comes before
        if (vertex_[group] != kNone && !texcoords_) {
          vertex_[i] = vertex_[group];
          continue;
        }
        vertex_[i] = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(position(i));
        const double length = glm::length(normals_[group]);
        mesh.normals.push_back(length > 1e-9 ? normals_[group] / length : flats_[f].normal);
      }
      if (texcoords_) add_texcoords(mesh, f);
    }
  }

  void add_texcoords(Mesh& mesh, std::uint32_t f) {
    const Upright axes = upright(flats_[f].normal);
    const auto flat = [&](std::uint32_t corner) {
      const Vec3 p = position(corner) - position(first_[f]);
      return Vec2(glm::dot(p, axes.right), glm::dot(p, axes.up));
    };
    Vec2 low(0), high(0);
    for (std::uint32_t i = 0; i < shape_.faces[f].outline.size(); ++i) {
      low = glm::min(low, flat(first_[f] + i));
      high = glm::max(high, flat(first_[f] + i));
    }
    for (std::uint32_t i = first_[f]; i < first_[f + 1]; ++i)
      mesh.texcoords.push_back((flat(i) - low) / (high - low));
  }

  const Polygons& shape_;
  bool texcoords_;
  double cos_smooth_;
  bool closed_ = true;                      // each side has two faces that run it oppositely
  std::vector<std::uint32_t> position_;     // V, see welded()
  std::vector<FlatFace> flats_;             // F
  std::vector<std::uint32_t> first_;        // F + 1, corner of each face
  std::vector<std::uint32_t> corner_;       // C, the position of each
  std::vector<std::uint32_t> next_, prev_;  // C, corners along their loop, the face on the left
  std::vector<Triangle> triangles_;         // of corners
  std::vector<std::uint32_t> parent_;       // C
  std::vector<Vec3> normals_;               // C, by the first corner of a group; not unit
  std::vector<std::uint32_t> vertex_;       // C
};

}  // namespace

Problem problem(const Polygons& shape) {
  if (auto bad = coordinate_problem(shape.positions, "positions")) return bad;
  if (!(shape.smooth >= 0 && shape.smooth <= 2 * kPi))
    return ShapeProblem{Code("E2011"),
                        fmt::format("a smoothing angle of {:.12g} deg, expected 0 to 360 deg",
                                    shape.smooth / kDegree),
                        "smooth"};
  if (shape.faces.empty())
    return ShapeProblem{Code("E2015"), "no faces, expected at least 1", "faces"};
  for (std::size_t i = 0; i < shape.faces.size(); ++i)
    if (auto bad = problem_of_face(shape, i)) return bad;
  return std::nullopt;
}

Result<Mesh> make(const Polygons& shape, const TessellationOptions& options, SourceSpan where,
                  DiagnosticLog& log) {
  double vertices = 0;
  for (const Face& face : shape.faces) vertices += corner_count(face);
  if (!within_counts(planned(shape, options), vertices, "a list of faces", options, where, log))
    return failed;
  Mesh mesh;
  if (!PolygonBuilder(shape, options.texcoords).build(mesh)) return failed;
  set_error(mesh, 0);
  return mesh;
}

double planned(const Polygons& shape, const TessellationOptions&) {
  double triangles = 0;
  for (const Face& face : shape.faces) triangles += face_triangles(face);
  return triangles;
}

}  // namespace panwright::geometry::internal
