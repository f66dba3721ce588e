#include "geometry/mesh/distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "geometry/internal/triangle.h"
#include "geometry/mesh/internal/surface_search.h"

namespace panwright::geometry {
namespace {

constexpr double kUlps = 32 * std::numeric_limits<double>::epsilon();
constexpr std::size_t kDistanceBlock = 4096;  // triangles
constexpr std::size_t kWave = 16;             // blocks that start from one bound
constexpr double kSearches = 1024;            // of a block, and more for each triangle
constexpr double kWorthCutting = 0.25;        // of an edge
constexpr int kHalvings = 36;                 // of an edge, to find a change on it
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct CornerPoint {
  Vec3 at{0};
  double distance = 0;
  std::uint32_t nearest = 0;  // triangle of the other mesh
};

struct Piece {
  std::array<CornerPoint, 3> corners;
  double most = 0;          // no point of it is further off
  std::uint32_t order = 0;  // in which pieces were made
  std::uint32_t depth = 0;
};

// A heap has the one with the largest bound on top; of equals the first.
bool is_below(const Piece& a, const Piece& b) {
  return a.most != b.most ? a.most < b.most : a.order > b.order;
}

// Of a circle around a triangle.
double radius_of(const Piece& piece) {
  std::array<double, 3> sides;
  for (std::size_t k = 0; k < 3; ++k)
    sides[k] = glm::length(piece.corners[(k + 1) % 3].at - piece.corners[k].at);
  const double longest = std::max({sides[0], sides[1], sides[2]});
  const double squares =
      sides[0] * sides[0] + sides[1] * sides[1] + sides[2] * sides[2] - longest * longest;
  return squares <= longest * longest ? longest / 2 : longest / std::sqrt(3.0);
}

class OneSide {
 public:
  OneSide(const SurfaceSearch& from, const SurfaceSearch& to, const DistanceOptions& options,
          const Job& job)
      : from_(from.mesh()), to_(to), options_(options), job_(job) {
    rounding_ = kUlps * std::max(from.largest_coordinate(), to.largest_coordinate());
    searches_ = options.searches * (1 + static_cast<double>(to.mesh().triangles.size()) /
                                            static_cast<double>(from.mesh().triangles.size()));
  }

  // A bound from below, for both sides to start with.
  double look_at_vertices() {
    vertices_ = to_.nearest_of_vertices(from_, job_);
    double low = 0;
    for (SurfaceSearch::Nearest& vertex : vertices_) {
      vertex.squared = std::sqrt(vertex.squared);
      if (vertex.squared < kInfinity) low = std::max(low, vertex.squared);
    }
    return low;
  }

  // Expects: look_at_vertices() before.
  DistanceInterval run(double low) {
    DistanceInterval all{low, 0};
    if (low > options_.give_up) return {low, kInfinity};
    const std::size_t blocks = (from_.triangles.size() + kDistanceBlock - 1) / kDistanceBlock;
    for (std::size_t begin = 0; begin < blocks; begin += kWave) {
      const std::size_t count = std::min(kWave, blocks - begin);
      std::array<DistanceInterval, kWave> found;
      parallel_for(
          count, [&](std::size_t i) { found[i] = run_block(begin + i, all.low); }, job_);
      for (std::size_t i = 0; i < count; ++i) {
        all.low = std::max(all.low, found[i].low);
        all.high = std::max(all.high, found[i].high);
      }
      if (all.low > options_.give_up) return {all.low, kInfinity};
    }
    return all;
  }

  double rounding() const { return rounding_; }

 private:
  double enough(double low) const {
    return std::max(low * (1 + options_.relative), low + options_.absolute) + rounding_;
  }

  double distance(const CornerPoint& corner, std::uint32_t triangle) const {
    if (corner.nearest == triangle) return corner.distance;
    return std::sqrt(to_.triangles()[triangle].squared_distance(corner.at));
  }

  double farthest(const Piece& piece, std::uint32_t triangle) const {
    return std::max({distance(piece.corners[0], triangle), distance(piece.corners[1], triangle),
                     distance(piece.corners[2], triangle)});
  }

  void bound(Piece& piece) const {
    const std::array<CornerPoint, 3>& c = piece.corners;
    piece.most = std::max({c[0].distance, c[1].distance, c[2].distance}) + radius_of(piece);
    for (std::size_t k = 0; k < 3; ++k)
      if (k == 0 || c[k].nearest != c[k - 1].nearest)
        piece.most = std::min(piece.most, farthest(piece, c[k].nearest));
  }

  CornerPoint corner_at(const Vec3& at, std::uint32_t hint) const {
    const SurfaceSearch::Nearest found = to_.nearest(at, hint);
    return {at, std::sqrt(found.squared), found.triangle};
  }

  Piece piece_of(const Triangle& t) const {
    Piece piece;
    for (std::size_t k = 0; k < 3; ++k)
      piece.corners[k] = {from_.positions[t[k]], vertices_[t[k]].squared, vertices_[t[k]].triangle};
    return piece;
  }

  // How far the triangle next to an edge's first end reaches along it, as a share: its distance
  // grows towards the other end, for it is convex. 1: to the end.
  double reach(const CornerPoint& a, const CornerPoint& b, double enough) const {
    if (distance(b, a.nearest) <= enough) return 1;
    const FramedTriangle& triangle = to_.triangles()[a.nearest];
    double from = 0, to = 1;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (from + to);
      if (triangle.squared_distance(a.at + middle * (b.at - a.at)) <= enough * enough)
        from = middle;
      else
        to = middle;
    }
    return from;
  }

  // The edge to cut and the point: of edges that no triangle next to an end is near to as a whole
  // the longest, as far as one of them is; where there is none or that is not far, and each
  // fourth time, which alone makes pieces small, the middle of the longest.
  std::pair<std::size_t, Vec3> cut(const Piece& piece, double enough) const {
    const std::array<CornerPoint, 3>& c = piece.corners;
    std::array<double, 3> length;
    for (std::size_t k = 0; k < 3; ++k) length[k] = glm::length(c[(k + 1) % 3].at - c[k].at);
    std::size_t best = 3;
    for (std::size_t k = 0; k < 3 && piece.depth % 4 != 3; ++k) {
      const CornerPoint& next = c[(k + 1) % 3];
      if (c[k].nearest == next.nearest || (best < 3 && length[k] <= length[best]) ||
          distance(next, c[k].nearest) <= enough || distance(c[k], next.nearest) <= enough)
        continue;
      best = k;
    }
    if (best < 3) {
      const CornerPoint& a = c[best];
      const CornerPoint& b = c[(best + 1) % 3];
      for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &a)}) {
        const double share = reach(*from, *to, enough);
        if (share >= kWorthCutting) return {best, from->at + share * (to->at - from->at)};
      }
    }
    const auto longest =
        static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
    return {longest, 0.5 * (c[longest].at + c[(longest + 1) % 3].at)};
  }

  DistanceInterval run_block(std::size_t block, double low) const {
    DistanceInterval out{low, 0};
    std::vector<Piece> waiting;
    std::uint32_t made = 0;
    const auto add = [&](Piece& piece) {
      piece.order = made++;
      if (piece.most <= enough(out.low)) {
        out.high = std::max(out.high, piece.most);
        return;
      }
      waiting.push_back(piece);
      std::push_heap(waiting.begin(), waiting.end(), is_below);
    };
    const std::size_t begin = block * kDistanceBlock;
    const std::size_t end = std::min(from_.triangles.size(), begin + kDistanceBlock);
    double left = kSearches + searches_ * static_cast<double>(end - begin);
    for (std::size_t i = begin; i < end; ++i) {
      Piece piece = piece_of(from_.triangles[i]);
      bound(piece);
      add(piece);
    }
    while (!waiting.empty() && left >= 1 && out.low <= options_.give_up &&
           waiting.front().most > enough(out.low)) {
      std::pop_heap(waiting.begin(), waiting.end(), is_below);
      const Piece piece = waiting.back();
      waiting.pop_back();
      // the triangle that the middle is nearest to is the likeliest to be near all of it: corners
      // may be as near to neighbours
      if (piece.depth % 2 == 0) {
        const std::array<CornerPoint, 3>& c = piece.corners;
        const CornerPoint centre = corner_at((c[0].at + c[1].at + c[2].at) / 3.0, c[0].nearest);
        --left;
        out.low = std::max(out.low, centre.distance);
        const double most = farthest(piece, centre.nearest);
        if (most <= enough(out.low)) {
          out.high = std::max(out.high, most);
          continue;
        }
      }
      const auto [edge, at] = cut(piece, enough(out.low));
      const std::size_t next = (edge + 1) % 3;
      const CornerPoint corner = corner_at(at, piece.corners[edge].nearest);
      --left;
      out.low = std::max(out.low, corner.distance);
      for (const std::size_t gone : {edge, next}) {
        Piece half = piece;
        half.corners[gone] = corner;
        ++half.depth;
        bound(half);
        half.most = std::min(half.most, piece.most);
        add(half);
      }
    }
    if (!waiting.empty()) out.high = std::max(out.high, waiting.front().most);
    return out;
  }

  const Mesh& from_;
  const SurfaceSearch& to_;
  const DistanceOptions& options_;
  const Job& job_;
  double rounding_ = 0;
  double searches_ = 0;                           // for each triangle
  std::vector<SurfaceSearch::Nearest> vertices_;  // distances, not their squares
};

DistanceInterval without_triangles(const Mesh& a, const Mesh& b) {
  if (a.triangles.empty() && b.triangles.empty()) return {0, 0};
  return {kInfinity, kInfinity};
}

DistanceInterval finished(DistanceInterval found, double rounding) {
  found.high = std::max(found.high, found.low) + rounding;
  return found;
}

Vec3 facet_normal(const Mesh& mesh, const Triangle& t) {
  const TriangleMeasure m =
      measure(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
  return m.double_area > 0 ? m.cross / m.double_area : Vec3(0);
}

// Shares of the corners in the point of a triangle that is nearest to another one.
Vec3 shares(const Mesh& mesh, const Triangle& t, const Vec3& point) {
  const Vec3 a = mesh.positions[t[0]] - point;
  const Vec3 b = mesh.positions[t[1]] - point;
  const Vec3 c = mesh.positions[t[2]] - point;
  const Vec3 p = nearest_to_origin(a, b, c);
  const Vec3 n = glm::cross(b - a, c - a);
  const Vec3 share =
      glm::max(Vec3(glm::dot(glm::cross(b - p, c - p), n), glm::dot(glm::cross(c - p, a - p), n),
                    glm::dot(glm::cross(a - p, b - p), n)),
               Vec3(0));
  const double sum = share.x + share.y + share.z;
  return sum > 0 ? share / sum : Vec3(1.0 / 3);
}

Vec3 shading_normal(const Mesh& mesh, const Triangle& t, const Vec3& share) {
  if (mesh.normals.empty()) return facet_normal(mesh, t);
  const Vec3 n =
      share.x * mesh.normals[t[0]] + share.y * mesh.normals[t[1]] + share.z * mesh.normals[t[2]];
  const double length = glm::length(n);
  return length > 1e-9 ? n / length : facet_normal(mesh, t);
}

double angle_between(const Vec3& a, const Vec3& b) {
  return det::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

constexpr std::size_t kDirections = 64;

std::array<Vec3, kDirections> directions() {
  std::array<Vec3, kDirections> out;
  constexpr double kGolden = 2.399963229728653;  // radians: the golden angle
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double z = (static_cast<double>(i) + 0.5) / kDirections;
    const double r = std::sqrt(1 - z * z);
    const auto turn = det::sincos(kGolden * static_cast<double>(i));
    out[i] = {r * turn.cos, r * turn.sin, z};
  }
  return out;
}

std::array<double, kDirections> projected_areas(const Mesh& mesh, const Job& job) {
  const std::array<Vec3, kDirections> all = directions();
  const std::size_t chunks = (mesh.triangles.size() + kDistanceBlock - 1) / kDistanceBlock;
  std::vector<std::array<double, kDirections>> sums(chunks);
  parallel_for(
      chunks,
      [&](std::size_t chunk) {
        sums[chunk].fill(0);
        const std::size_t end = std::min(mesh.triangles.size(), (chunk + 1) * kDistanceBlock);
        for (std::size_t i = chunk * kDistanceBlock; i < end; ++i) {
          const Triangle& t = mesh.triangles[i];
          const Vec3 cross = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                        mesh.positions[t[2]] - mesh.positions[t[0]]);
          for (std::size_t k = 0; k < kDirections; ++k)
            sums[chunk][k] += 0.25 * std::fabs(glm::dot(cross, all[k]));
        }
      },
      job);
  std::array<double, kDirections> out{};
  for (const auto& sum : sums)
    for (std::size_t k = 0; k < kDirections; ++k) out[k] += sum[k];
  return out;
}

}  // namespace

MeasuredMesh::MeasuredMesh(const Mesh& mesh) : search_(std::make_unique<SurfaceSearch>(mesh)) {}
MeasuredMesh::~MeasuredMesh() = default;
MeasuredMesh::MeasuredMesh(MeasuredMesh&&) noexcept = default;
MeasuredMesh& MeasuredMesh::operator=(MeasuredMesh&&) noexcept = default;
const Mesh& MeasuredMesh::mesh() const { return search_->mesh(); }

DistanceInterval distance_from(const MeasuredMesh& from, const MeasuredMesh& to,
                               const DistanceOptions& options, const Job& job) {
  if (from.mesh().triangles.empty()) return {0, 0};
  if (to.mesh().triangles.empty()) return {kInfinity, kInfinity};
  OneSide side(from.search(), to.search(), options, job);
  return finished(side.run(side.look_at_vertices()), side.rounding());
}

DistanceInterval hausdorff_distance(const MeasuredMesh& a, const MeasuredMesh& b,
                                    const DistanceOptions& options, const Job& job) {
  if (a.mesh().triangles.empty() || b.mesh().triangles.empty())
    return without_triangles(a.mesh(), b.mesh());
  OneSide first(a.search(), b.search(), options, job);
  OneSide second(b.search(), a.search(), options, job);
  const double low = std::max(first.look_at_vertices(), second.look_at_vertices());
  const DistanceInterval one = first.run(low);
  const DistanceInterval other = second.run(one.low);
  return finished({other.low, std::max(one.high, other.high)}, first.rounding());
}

NormalError normal_error(const MeasuredMesh& mesh, const MeasuredMesh& other, double reach,
                         const Job& job) {
  constexpr std::size_t kMost = 32768;
  constexpr std::size_t kChunk = 256;
  const Mesh& full = mesh.mesh();
  if (full.triangles.empty() || other.mesh().triangles.empty()) return {};
  const std::size_t count = std::min(kMost, full.triangles.size());
  struct Sums {
    double area = 0, squares = 0, largest = 0;
  };
  std::vector<Sums> sums((count + kChunk - 1) / kChunk);
  parallel_for(
      sums.size(),
      [&](std::size_t chunk) {
        std::uint32_t hint = 0;
        for (std::size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
          const Triangle& t = full.triangles[i * full.triangles.size() / count];
          const Vec3 &a = full.positions[t[0]], &b = full.positions[t[1]];
          const Vec3& c = full.positions[t[2]];
          const double area = glm::length(glm::cross(b - a, c - a)) / 2;
          const Vec3 middle = (a + b + c) / 3.0;
          const Vec3 n = shading_normal(full, t, Vec3(1.0 / 3));
          const auto found = other.search().nearest_facing(middle, n, reach, hint);
          hint = found.triangle;
          const Triangle& u = other.mesh().triangles[found.triangle];
          const Vec3 m = shading_normal(other.mesh(), u, shares(other.mesh(), u, middle));
          if (!(area > 0) || n == Vec3(0) || m == Vec3(0)) continue;
          const double angle = angle_between(n, m);
          sums[chunk].area += area;
          sums[chunk].squares += area * angle * angle;
          sums[chunk].largest = std::max(sums[chunk].largest, angle);
        }
      },
      job);
  Sums all;
  for (const Sums& sum : sums)
    all = {all.area + sum.area, all.squares + sum.squares, std::max(all.largest, sum.largest)};
  return {all.area > 0 ? std::sqrt(all.squares / all.area) : 0, all.largest};
}

double projected_area_error(const Mesh& mesh, const Mesh& other, const Job& job) {
  const auto first = projected_areas(mesh, job);
  const auto second = projected_areas(other, job);
  double largest = 0, difference = 0;
  for (std::size_t k = 0; k < kDirections; ++k) {
    largest = std::max(largest, first[k]);
    difference = std::max(difference, std::fabs(second[k] - first[k]));
  }
  return largest > 0 ? difference / largest : 0;
}

}  // namespace panwright::geometry
