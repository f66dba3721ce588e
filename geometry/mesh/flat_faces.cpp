#include "geometry/mesh/flat_faces.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/axis_box.h"
#include "geometry/internal/triangle.h"
#include "geometry/internal/weld.h"

namespace panwright::geometry {

namespace {

// triangles of an edge that are compared with each other
constexpr std::size_t kMostAtEdge = 8;
// sides of a rectangle that differ by less count as equal
constexpr double kEqualSides = 1e-3;
// a border may not stray by more of the shorter side, however coarse the mesh
constexpr double kMostBorder = 0.05;
// texture coordinates that single precision still places within a cell
constexpr double kMostCoordinate = 1e6;

struct HalfEdge {
  std::uint32_t low, high;  // unique positions
  std::uint32_t triangle;
  std::uint32_t forward;  // 1: from low to high
};

struct BorderEdge {
  std::uint32_t from, to;  // unique positions
  std::uint32_t next;      // index of the edge that goes on, or kNoFace
};

// A vector's sign that does not depend on how it was found: its first large part is positive.
Vec3 canonical(const Vec3& a) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(a[i]) > 1e-6) return a[i] < 0 ? -a : a;
  return a;
}

// Whether a lies nearer to x than b, then to y, then to z.
bool nearer_to_axes(const Vec3& a, const Vec3& b) {
  for (int i = 0; i < 3; ++i) {
    const double difference = std::abs(a[i]) - std::abs(b[i]);
    if (std::abs(difference) > 1e-6) return difference > 0;
  }
  return false;
}

class Finder {
 public:
  Finder(std::span<const Vec3> positions, std::span<const Vec2> texcoords,
         std::span<const Triangle> triangles, const FlatFaceLimits& limits)
      : positions_(positions), texcoords_(texcoords), triangles_(triangles), limits_(limits) {}

  FlatFaces run() {
    measure_all();
    connect();
    std::vector<std::uint32_t> order;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      if (areas_[t] > 0) order.push_back(t);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return areas_[a] != areas_[b] ? areas_[a] > areas_[b] : a < b;
    });
    out_.face_of.assign(triangles_.size(), kNoFace);
    for (const std::uint32_t seed : order)
      if (out_.face_of[seed] == kNoFace) {
        gather(seed);
        lay_out();
      }
    return std::move(out_);
  }

 private:
  void measure_all() {
    unique_ = welded(positions_);
    AxisBox box;
    normals_.resize(triangles_.size());
    areas_.resize(triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const auto [a, b, c] = triangles_[t];
      for (const std::uint32_t v : triangles_[t]) box.add(positions_[v]);
      const TriangleMeasure m = measure(positions_[a], positions_[b], positions_[c]);
      if (m.degenerate() || !std::isfinite(m.double_area)) continue;
      areas_[t] = m.double_area / 2;
      normals_[t] = m.cross / m.double_area;
    }
    flat_ = triangles_.empty() ? 0 : limits_.flat * box.diagonal();
  }

  // Half-edges by edge, and where the edge of each triangle's side begins among them.
  void connect() {
    edges_.reserve(3 * triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (!(areas_[t] > 0)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = unique_[triangles_[t][k]];
        const std::uint32_t b = unique_[triangles_[t][(k + 1) % 3]];
        edges_.push_back({std::min(a, b), std::max(a, b), t, a < b ? 1u : 0u});
      }
    }
    std::sort(edges_.begin(), edges_.end(), [](const HalfEdge& a, const HalfEdge& b) {
      return std::array{a.low, a.high, a.triangle} < std::array{b.low, b.high, b.triangle};
    });
    sides_.assign(3 * triangles_.size(), 0);
    std::vector<std::uint8_t> used(triangles_.size());
    starts_.push_back(0);
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (i > 0 && (edges_[i].low != edges_[i - 1].low || edges_[i].high != edges_[i - 1].high))
        starts_.push_back(static_cast<std::uint32_t>(i));
      const std::uint32_t t = edges_[i].triangle;
      sides_[3 * std::size_t{t} + used[t]++] = static_cast<std::uint32_t>(starts_.size() - 1);
    }
    starts_.push_back(static_cast<std::uint32_t>(edges_.size()));
  }

  std::span<const HalfEdge> at_edge(std::uint32_t edge) const {
    return std::span(edges_).subspan(starts_[edge], starts_[edge + 1] - starts_[edge]);
  }

  bool in_plane(std::uint32_t triangle) const {
    if (!(glm::dot(normals_[triangle], normal_) >= limits_.cos_flat)) return false;
    for (const std::uint32_t v : triangles_[triangle])
      if (!(std::abs(glm::dot(positions_[v] - base_, normal_)) <= flat_)) return false;
    return true;
  }

  // The triangles of a new face, into members_.
  void gather(std::uint32_t seed) {
    const auto face = static_cast<std::uint32_t>(out_.faces.size());
    normal_ = normals_[seed];
    base_ = positions_[triangles_[seed][0]];
    members_.assign(1, seed);
    out_.face_of[seed] = face;
    for (std::size_t i = 0; i < members_.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto around = at_edge(sides_[3 * std::size_t{members_[i]} + k]);
        if (around.size() > kMostAtEdge) continue;
        for (const HalfEdge& other : around) {
          if (out_.face_of[other.triangle] != kNoFace || !in_plane(other.triangle)) continue;
          out_.face_of[other.triangle] = face;
          members_.push_back(other.triangle);
        }
      }
    std::sort(members_.begin(), members_.end());
    out_.faces.emplace_back();
  }

  // The border of the face, into border_, in the order of its edges' first points. False: some
  // edge has two triangles of the face on one side.
  bool find_border() {
    border_.clear();
    bool simple = true;
    const auto face = static_cast<std::uint32_t>(out_.faces.size() - 1);
    for (const std::uint32_t t : members_)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto around = at_edge(sides_[3 * std::size_t{t} + k]);
        std::size_t along = 0, against = 0;
        std::uint32_t forward = 0;
        if (around.size() > kMostAtEdge) {
          simple = false;
          continue;
        }
        for (const HalfEdge& e : around)
          if (e.triangle == t) forward = e.forward;
        for (const HalfEdge& e : around)
          if (out_.face_of[e.triangle] == face) ++(e.forward == forward ? along : against);
        simple = simple && along == 1 && against <= 1;
        const HalfEdge& e = around.front();
        if (against == 0)
          border_.push_back({forward ? e.low : e.high, forward ? e.high : e.low, kNoFace});
      }
    std::sort(border_.begin(), border_.end(), [](const BorderEdge& a, const BorderEdge& b) {
      return std::array{a.from, a.to} < std::array{b.from, b.to};
    });
    for (BorderEdge& e : border_) {
      const auto first = std::lower_bound(
          border_.begin(), border_.end(), e.to,
          [](const BorderEdge& edge, std::uint32_t from) { return edge.from < from; });
      const bool ends = first == border_.end() || first->from != e.to;
      const bool branches = !ends && first + 1 != border_.end() && (first + 1)->from == e.to;
      if (ends || branches)
        simple = false;
      else
        e.next = static_cast<std::uint32_t>(first - border_.begin());
    }
    return simple;
  }

  Vec3 along(const BorderEdge& e) const { return positions_[e.to] - positions_[e.from]; }

  // sine² of the bend is compared, and the edges must run the same way
  bool straight(const Vec3& a, const Vec3& b) const {
    const Vec3 cross = glm::cross(a, b);
    return glm::dot(a, b) > 0 && glm::dot(cross, cross) <= limits_.sin_flat * limits_.sin_flat *
                                                               glm::dot(a, a) * glm::dot(b, b);
  }

  // Takes the line of a side for the longest if it is; the lines of sides as long are compared by
  // their directions.
  void consider(const Vec3& side) {
    const double length = glm::length(side);
    if (!(length > 0)) return;
    const Vec3 line = canonical(side / length);
    const bool longer = length > longest_ * (1 + kEqualSides);
    const bool as_long = !longer && length >= longest_ * (1 - kEqualSides);
    if (longer || (as_long && nearer_to_axes(line, line_))) line_ = line;
    longest_ = std::max(longest_, length);
  }

  // The longest border edge after merging those in one line; returns the number of loops.
  std::size_t find_longest() {
    longest_ = 0;
    line_ = Vec3(0);
    std::vector<char> done(border_.size());
    std::size_t loops = 0;
    // chains that do not close begin where nothing leads to
    std::vector<char> led_to(border_.size());
    for (const BorderEdge& e : border_)
      if (e.next != kNoFace) led_to[e.next] = 1;
    std::vector<std::uint32_t> chain;
    for (const bool open : {true, false})
      for (std::uint32_t first = 0; first < border_.size(); ++first) {
        if (done[first] || (open && led_to[first])) continue;
        ++loops;
        chain.clear();
        for (std::uint32_t e = first; e != kNoFace && !done[e]; e = border_[e].next) {
          done[e] = 1;
          chain.push_back(e);
        }
        if (!open) to_sharpest(chain);
        sides_of(chain);
      }
    return loops;
  }

  // Turns a loop so that it begins behind its sharpest bend.
  void to_sharpest(std::vector<std::uint32_t>& loop) const {
    std::size_t sharpest = 0;
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3 before = along(border_[loop[(i + loop.size() - 1) % loop.size()]]);
      const Vec3 behind = along(border_[loop[i]]);
      const double cosine = glm::dot(before, behind) / (glm::length(before) * glm::length(behind));
      if (cosine < least) {
        least = cosine;
        sharpest = i;
      }
    }
    std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(sharpest), loop.end());
  }

  void sides_of(const std::vector<std::uint32_t>& chain) {
    Vec3 direction(0), side(0);
    for (const std::uint32_t index : chain) {
      const Vec3 step = along(border_[index]);
      if (side == Vec3(0) || !straight(direction, step)) {
        consider(side);
        direction = step;
        side = Vec3(0);
      }
      side += step;
    }
    consider(side);
  }

  void lay_out() {
    FlatFace& face = out_.faces.back();
    for (const std::uint32_t t : members_) face.area += areas_[t];
    const bool simple = find_border();
    const std::size_t loops = find_longest();
    if (longest_ == 0) return;
    // in the face's plane exactly
    line_ -= normal_ * glm::dot(line_, normal_);
    line_ /= glm::length(line_);
    if (follow_file(face)) return;
    if (simple && loops == 1) fit_rectangle(face);
  }

  // The affine map of the face's texture coordinates, where it is close to a similarity along the
  // longest edge; then exactly that.
  bool follow_file(FlatFace& face) const {
    if (texcoords_.empty()) return false;
    const Vec3 across = glm::cross(normal_, line_);
    // slopes of both coordinates along the line and across, means over the area
    Vec2 slope_u(0), slope_v(0), mean(0);
    Vec3 middle(0);
    for (const std::uint32_t t : members_) {
      const auto [a, b, c] = triangles_[t];
      const Vec3 ab = positions_[b] - positions_[a], ac = positions_[c] - positions_[a];
      const Vec2 p(glm::dot(ab, line_), glm::dot(ab, across));
      const Vec2 q(glm::dot(ac, line_), glm::dot(ac, across));
      const Vec2 along_p = texcoords_[b] - texcoords_[a], along_q = texcoords_[c] - texcoords_[a];
      // area · the triangle's slope
      slope_u += Vec2(along_p.x * q.y - along_q.x * p.y, along_q.x * p.x - along_p.x * q.x) * 0.5;
      slope_v += Vec2(along_p.y * q.y - along_q.y * p.y, along_q.y * p.x - along_p.y * q.x) * 0.5;
      mean += areas_[t] / 3 * (texcoords_[a] + texcoords_[b] + texcoords_[c]);
      middle += areas_[t] / 3 *
                ((positions_[a] - base_) + (positions_[b] - base_) + (positions_[c] - base_));
    }
    slope_u /= face.area;
    slope_v /= face.area;
    mean /= face.area;
    middle = base_ + middle / face.area;
    // σ₁² + σ₂² and σ₁σ₂ of the map
    const double squares = glm::dot(slope_u, slope_u) + glm::dot(slope_v, slope_v);
    const double product = std::abs(slope_u.x * slope_v.y - slope_u.y * slope_v.x);
    const double sum = std::sqrt(squares + 2 * product);
    const double difference = std::sqrt(std::max(0.0, squares - 2 * product));
    if (!(product > 0) || !std::isfinite(squares)) return false;
    if (!(sum + difference <= limits_.stretch * (sum - difference))) return false;
    const double scale = std::sqrt(product);  // texture coordinates per metre
    const double sine = std::min(std::abs(slope_u.x), std::abs(slope_u.y)) / glm::length(slope_u);
    if (!(sine <= limits_.sin_flat)) return false;
    const double most = limits_.residual * std::sqrt(face.area);
    for (const std::uint32_t t : members_)
      for (const std::uint32_t i : triangles_[t]) {
        const Vec2 p(glm::dot(positions_[i] - middle, line_),
                     glm::dot(positions_[i] - middle, across));
        const Vec2 off = texcoords_[i] - mean - Vec2(glm::dot(slope_u, p), glm::dot(slope_v, p));
        if (!(glm::length(off) <= most * scale)) return false;
      }
    const bool turned = std::abs(slope_u.y) > std::abs(slope_u.x);
    const Vec3 u = turned ? across : line_, v = turned ? line_ : across;
    const double along_u = turned ? slope_u.y : slope_u.x;
    const double along_v = turned ? slope_v.x : slope_v.y;
    const Vec2 at = mean / scale;
    if (!(std::abs(at.x) <= kMostCoordinate && std::abs(at.y) <= kMostCoordinate)) return false;
    face.u = along_u < 0 ? -u : u;
    face.v = along_v < 0 ? -v : v;
    face.origin = at - Vec2(glm::dot(face.u, middle), glm::dot(face.v, middle));
    face.layout = FaceLayout::file;
    return true;
  }

  // A border all of which lies at that of its bounds, around as much area, is a rectangle.
  void fit_rectangle(FlatFace& face) const {
    const Vec3 across = glm::cross(normal_, line_);
    const auto at = [&](std::uint32_t i) {
      return Vec2(glm::dot(positions_[i] - base_, line_), glm::dot(positions_[i] - base_, across));
    };
    AxisRectangle bounds;
    for (const BorderEdge& e : border_) bounds.add(at(e.from));
    const auto& [low, high] = bounds;
    const Vec2 size = bounds.extent();
    const double shorter = std::min(size.x, size.y);
    const double most = std::min(std::max(limits_.border * shorter, flat_), kMostBorder * shorter);
    if (!(shorter > 0)) return;
    for (const BorderEdge& e : border_) {
      const Vec2 p = at(e.from), q = at(e.to);
      // both ends at the same side: no edge cuts a corner
      const bool fits = std::max(p.x - low.x, q.x - low.x) <= most ||
                        std::max(high.x - p.x, high.x - q.x) <= most ||
                        std::max(p.y - low.y, q.y - low.y) <= most ||
                        std::max(high.y - p.y, high.y - q.y) <= most;
      if (!fits) return;
    }
    // what such a border may leave out
    if (!(face.area >= size.x * size.y - 2 * most * (size.x + size.y))) return;
    face.u = line_;
    face.v = across;
    face.origin = Vec2(-glm::dot(base_, face.u), -glm::dot(base_, face.v)) - low;
    face.layout = FaceLayout::rectangle;
  }

  std::span<const Vec3> positions_;
  std::span<const Vec2> texcoords_;
  std::span<const Triangle> triangles_;
  const FlatFaceLimits& limits_;
  double flat_ = 0;                    // metres from a face's plane
  std::vector<std::uint32_t> unique_;  // V
  std::vector<Vec3> normals_;          // T
  std::vector<double> areas_;          // T; 0: degenerate
  std::vector<HalfEdge> edges_;
  std::vector<std::uint32_t> starts_;  // of each edge among half-edges
  std::vector<std::uint32_t> sides_;   // 3·T edges
  // of the face at work
  Vec3 normal_{0};
  Vec3 base_{0};
  std::vector<std::uint32_t> members_;
  std::vector<BorderEdge> border_;
  double longest_ = 0;
  Vec3 line_{0};
  FlatFaces out_;
};

}  // namespace

FlatFaces flat_faces(std::span<const Vec3> positions, std::span<const Vec2> texcoords,
                     std::span<const Triangle> triangles, const FlatFaceLimits& limits) {
  assert(texcoords.empty() || texcoords.size() == positions.size());
  return Finder(positions, texcoords, triangles, limits).run();
}

}  // namespace panwright::geometry
