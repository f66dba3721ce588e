#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.h"
#include "geometry/check.h"
#include "geometry/internal/flat.h"
#include "geometry/internal/revolve.h"
#include "geometry/internal/triangulate.h"
#include "geometry/internal/weld.h"

namespace panwright::geometry::internal {

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
// corners may lie this far from a face's plane, relative to its size
constexpr double kFlatness = 1e-6;
// radians: what rounding may do to an angle
constexpr double kAngleSlack = 1e-9;

using Face = Polygons::Face;

// The corners of a face, loop by loop.
std::vector<std::uint32_t> corners_of(const Face& face, std::vector<std::uint32_t>& loops) {
  std::vector<std::uint32_t> corners = face.outline;
  loops = {0, static_cast<std::uint32_t>(corners.size())};
  for (const auto& hole : face.holes) {
    corners.insert(corners.end(), hole.begin(), hole.end());
    loops.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  return corners;
}

double corner_count(const Face& face) {
  double count = static_cast<double>(face.outline.size());
  for (const auto& hole : face.holes) count += static_cast<double>(hole.size());
  return count;
}

double triangle_count(const Face& face) {
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

// A face in its plane, seen along the axis nearest to its normal: coordinates stay exact.
struct FlatFace {
  Vec3 normal{0};                      // unit, zero: no area
  std::vector<std::uint32_t> corners;  // C
  Region region;                       // C points
};

FlatFace flat_face(const std::vector<Vec3>& positions, const Face& face) {
  FlatFace flat;
  const double size = size_of(positions, face.outline);
  if (size == 0) return flat;
  const Vec3 area = area_vector(positions, face.outline, size);
  const double length = glm::length(area);
  // an outline as thin as this has no direction
  if (!(length > 1e-15)) return flat;
  flat.normal = area / length;
  std::vector<std::uint32_t> loops;
  flat.corners = corners_of(face, loops);
  int axis = 2;
  for (const int other : {1, 0})
    if (std::fabs(area[other]) > std::fabs(area[axis])) axis = other;
  const bool away = area[axis] < 0;
  std::vector<Vec2> points;
  points.reserve(flat.corners.size());
  for (const std::uint32_t v : flat.corners) {
    const double x = positions[v][(axis + 1) % 3];
    const double y = positions[v][(axis + 2) % 3];
    points.push_back(away ? Vec2(y, x) : Vec2(x, y));
  }
  flat.region = region_of(points, std::move(loops));
  return flat;
}

// The corner furthest from the plane through the outline, and how far it is.
std::pair<std::uint32_t, double> furthest_corner(const std::vector<Vec3>& positions,
                                                 const FlatFace& flat) {
  const Vec3& origin = positions[flat.corners[0]];
  double low = 0, high = 0;
  std::uint32_t lowest = flat.corners[0], highest = lowest;
  for (const std::uint32_t v : flat.corners) {
    const double height = glm::dot(positions[v] - origin, flat.normal);
    if (height < low) low = height, lowest = v;
    if (height > high) high = height, highest = v;
  }
  return {-low > high ? lowest : highest, 0.5 * (high - low)};
}

ShapeProblem face_problem(Code code, std::size_t face, const std::string& what) {
  return {code, fmt::format("face {}: {}", face + 1, what), "faces", face};
}

Problem index_problem(const Polygons& shape, std::size_t index) {
  const Face& face = shape.faces[index];
  const auto loop_problem = [&](const std::vector<std::uint32_t>& loop) -> Problem {
    if (loop.size() < 3)
      return face_problem(Code::E2015, index,
                          fmt::format("a loop of {} points; it needs at least 3", loop.size()));
    for (const std::uint32_t v : loop)
      if (v >= shape.positions.size())
        return face_problem(Code::E2001, index,
                            fmt::format("vertex {} of {}", v, shape.positions.size()));
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
  FlatFace flat = flat_face(shape.positions, face);
  if (flat.normal == Vec3(0))
    return face_problem(Code::E2012, index, "its outline encloses no area");
  const double size = size_of(shape.positions, face.outline);
  const auto [vertex, distance] = furthest_corner(shape.positions, flat);
  if (distance > kFlatness * size)
    return face_problem(Code::E2016, index,
                        fmt::format("vertex {} lies {} m from its plane; {} m is accepted", vertex,
                                    format_double(distance), format_double(kFlatness * size)));
  const auto fault = fault_of(flat.region);
  if (!fault) return std::nullopt;
  return face_problem(code_of(*fault, flat.region), index, sentence_of(*fault, flat.region));
}

// One vertex for the corners at a place whose faces are smooth there.
class PolygonBuilder {
 public:
  PolygonBuilder(const Polygons& shape, bool texcoords) : shape_(shape), texcoords_(texcoords) {}

  bool build(Mesh& mesh) {
    place_ = welded(shape_.positions);
    for (const Face& face : shape_.faces) {
      flats_.push_back(flat_face(shape_.positions, face));
      FlatFace& flat = flats_.back();
      if (flat.normal == Vec3(0) || fault_of(flat.region)) return false;
      first_.push_back(corner_total_);
      corner_total_ += static_cast<std::uint32_t>(flat.corners.size());
    }
    join_corners();
    sum_normals();
    fill(mesh);
    return true;
  }

 private:
  struct Side {
    std::uint32_t low, high;        // places
    std::uint32_t at_low, at_high;  // corners of the face
    std::uint32_t face;
  };

  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  void join_corners() {
    parent_.resize(corner_total_);
    std::iota(parent_.begin(), parent_.end(), 0u);
    std::vector<Side> sides;
    sides.reserve(corner_total_);
    for (std::uint32_t f = 0; f < flats_.size(); ++f) {
      const FlatFace& flat = flats_[f];
      for (std::uint32_t i = 0; i < flat.corners.size(); ++i) {
        const std::uint32_t j = flat.region.next[i];
        const std::uint32_t a = place_[flat.corners[i]];
        const std::uint32_t b = place_[flat.corners[j]];
        const std::uint32_t at_a = first_[f] + i;
        const std::uint32_t at_b = first_[f] + j;
        sides.push_back(a < b ? Side{a, b, at_a, at_b, f} : Side{b, a, at_b, at_a, f});
      }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      if (a.low != b.low) return a.low < b.low;
      return a.high != b.high ? a.high < b.high : a.at_low < b.at_low;
    });
    for (std::size_t i = 0; i < sides.size();) {
      std::size_t end = i;
      while (end < sides.size() && sides[end].low == sides[i].low &&
             sides[end].high == sides[i].high)
        ++end;
      // note: where more than two faces meet none goes on in another
      if (end - i == 2 && smooth(flats_[sides[i].face].normal, flats_[sides[i + 1].face].normal)) {
        join(sides[i].at_low, sides[i + 1].at_low);
        join(sides[i].at_high, sides[i + 1].at_high);
      }
      i = end;
    }
  }

  bool smooth(const Vec3& a, const Vec3& b) const {
    return angle_between(a, b) <= shape_.smooth + kAngleSlack;
  }

  // Weighted by the angles of the corners.
  void sum_normals() {
    normals_.assign(corner_total_, Vec3(0));
    for (std::uint32_t f = 0; f < flats_.size(); ++f) {
      const FlatFace& flat = flats_[f];
      for (std::uint32_t i = 0; i < flat.corners.size(); ++i) {
        const Vec3& p = position(flat, i);
        const Vec3 to_next = position(flat, flat.region.next[i]) - p;
        const Vec3 to_prev = position(flat, flat.region.prev[i]) - p;
        double angle = angle_between(to_next, to_prev);
        if (glm::dot(glm::cross(to_next, to_prev), flat.normal) < 0) angle = 2 * kPi - angle;
        normals_[root(first_[f] + i)] += angle * flat.normal;
      }
    }
  }
  const Vec3& position(const FlatFace& flat, std::uint32_t i) const {
    return shape_.positions[flat.corners[i]];
  }

  void fill(Mesh& mesh) {
    std::vector<std::uint32_t> vertex(corner_total_, kNone);  // by corner, first of its group
    std::vector<Vec3> space;
    std::vector<std::uint32_t> of_corner;
    for (std::uint32_t f = 0; f < flats_.size(); ++f) {
      const FlatFace& flat = flats_[f];
      space.clear();
      of_corner.clear();
      for (std::uint32_t i = 0; i < flat.corners.size(); ++i) {
        space.push_back(position(flat, i));
        const std::uint32_t group = root(first_[f] + i);
        std::uint32_t& known = vertex[group];
        if (known == kNone || texcoords_) {
          known = static_cast<std::uint32_t>(mesh.positions.size());
          mesh.positions.push_back(space.back());
          const double length = glm::length(normals_[group]);
          mesh.normals.push_back(length > 1e-9 ? normals_[group] / length : flat.normal);
        }
        of_corner.push_back(known);
      }
      if (texcoords_) add_texcoords(mesh, flat, space);
      for (const Triangle& t : triangulated(flat.region, scaled(space)))
        mesh.triangles.push_back({of_corner[t[0]], of_corner[t[1]], of_corner[t[2]]});
    }
  }

  // about the first corner and in the size of the region's points, for no other reason than range
  static std::vector<Vec3> scaled(const std::vector<Vec3>& space) {
    double largest = 0;
    std::vector<Vec3> result;
    result.reserve(space.size());
    for (const Vec3& p : space) {
      result.push_back(p - space[0]);
      const Vec3& d = result.back();
      largest = std::max({largest, std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
    }
    for (Vec3& d : result) d /= largest;
    return result;
  }

  void add_texcoords(Mesh& mesh, const FlatFace& flat, const std::vector<Vec3>& space) {
    const Upright axes = upright(flat.normal);
    std::vector<Vec2> uv;
    uv.reserve(space.size());
    for (const Vec3& p : space)
      uv.push_back({glm::dot(p - space[0], axes.right), glm::dot(p - space[0], axes.up)});
    Vec2 low = uv[0], high = uv[0];
    for (std::uint32_t i = 0; i < flat.region.loops[1]; ++i) {
      low = glm::min(low, uv[i]);
      high = glm::max(high, uv[i]);
    }
    for (const Vec2& p : uv) mesh.texcoords.push_back((p - low) / (high - low));
  }

  const Polygons& shape_;
  bool texcoords_;
  std::vector<std::uint32_t> place_;  // V, see welded()
  std::vector<FlatFace> flats_;
  std::vector<std::uint32_t> first_;  // corner of each face
  std::uint32_t corner_total_ = 0;
  std::vector<std::uint32_t> parent_;  // by corner
  std::vector<Vec3> normals_;          // by group, at its first corner; not unit
};

}  // namespace

Problem problem(const Polygons& shape) {
  if (auto bad = coordinate_problem(shape.positions, "positions")) return bad;
  if (!(shape.smooth >= 0 && shape.smooth <= 2 * kPi))
    return ShapeProblem{Code::E2011, "an angle of smoothing that is not between 0 and a whole turn",
                        "smooth"};
  if (shape.faces.empty())
    return ShapeProblem{Code::E2015, "no faces; at least 1 is needed", "faces"};
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
  set_closed(mesh);
  set_error(mesh, 0);
  return mesh;
}

double planned(const Polygons& shape, const TessellationOptions&) {
  double triangles = 0;
  for (const Face& face : shape.faces) triangles += triangle_count(face);
  return triangles;
}

}  // namespace panwright::geometry::internal
