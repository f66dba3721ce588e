#include "mli/internal/drape.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <queue>

#include "base/parallel.h"
#include "mli/internal/form.h"
#include "mli/internal/grid.h"

namespace panwright::mli {

using geometry::Triangle;

namespace {

// metres per metre: how steeply foil rises from where a part holds it down, and from an inner edge
constexpr double kRise = 0.5, kCornerRise = 0.8;
// of the stand-off: what is nearer to a face stands on it
constexpr double kOnFace = 1e-3;
// of the stand-off: chords that are no deeper are rounded
constexpr double kRound = 0.05;
// of the root of a group's area: the widest tape
constexpr double kWidestTapeShare = 0.125;

double twice_area(const Piece& piece, const Triangle& t) {
  return glm::length(
      glm::cross(piece.points[t[1]] - piece.points[t[0]], piece.points[t[2]] - piece.points[t[0]]));
}

// Lets bounds of heights grow from those that there are by no more than `rise` along the faces, as
// foil does that is held down: where they end at once, it would stand in teeth.
void spread(const Piece& piece, const std::vector<double>& heights, double rise,
            std::vector<double>& bounds) {
  std::vector<std::uint32_t> begin(piece.points.size() + 1, 0);
  for (const Triangle& t : piece.triangles)
    for (const std::uint32_t v : t) begin[v + 1] += 2;
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> near(begin.back()), at(begin.begin(), begin.end() - 1);
  for (const Triangle& t : piece.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      near[at[t[k]]++] = t[(k + 1) % 3];
      near[at[t[k]]++] = t[(k + 2) % 3];
    }
  using Step = std::pair<double, std::uint32_t>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> next;
  for (std::uint32_t v = 0; v < bounds.size(); ++v)
    if (bounds[v] < HUGE_VAL) next.emplace(bounds[v], v);
  while (!next.empty()) {
    const auto [bound, v] = next.top();
    next.pop();
    if (bound > bounds[v]) continue;
    for (std::uint32_t i = begin[v]; i < begin[v + 1]; ++i) {
      const std::uint32_t to = near[i];
      const double there = bound + rise * glm::length(piece.points[to] - piece.points[v]);
      if (there >= bounds[to] || there >= heights[to]) continue;
      bounds[to] = there;
      next.emplace(there, to);
    }
  }
}

}  // namespace

// Appends triangles with vertices of their own.
class Draper::Appender {
 public:
  Appender(const Surface& surface, Cloth& cloth) : surface_(surface), cloth_(cloth) {}

  // normal: of a level
  std::uint32_t vertex(const Vec3& position, const Vec3& root,
                       const std::optional<Vec3>& normal = {}, double turns = 0) {
    const auto index = static_cast<std::uint32_t>(cloth_.mesh.positions.size());
    cloth_.mesh.positions.push_back(position);
    cloth_.mesh.texcoords.push_back(surface_.flat(root, turns) - surface_.low);
    cloth_.roots.push_back(root);
    cloth_.below.push_back(surface_.normal(root));
    if (normal) cloth_.mesh.normals.push_back(*normal);
    return index;
  }
  void triangle(const Triangle& corners, Cover cover) {
    cloth_.mesh.triangles.push_back(corners);
    cloth_.covers.push_back(cover);
  }

 private:
  const Surface& surface_;
  Cloth& cloth_;
};

struct Draper::Draped {
  const Surface& surface;
  Sampler sampler;
  double cell;   // of the sheet
  double reach;  // metres from the border over which heights fade out
  double mixed;  // metres over which both ends of a closed sheet are one
  double longest = 0;
  double tape = 0;
  Piece piece = {};
  Edges border = {};
  std::optional<BorderDistance> to_border = {};
  std::vector<double> distances = {};
  std::vector<char> taped = {};
  std::vector<double> heights = {};  // above the mean
};

bool Draper::cut(Draped& draped, const Group& members, double longest, double left) const {
  draped.longest = longest;
  draped.piece = piece_of(faces_, members);
  if (!refine(draped.piece, longest, left, job_)) return false;
  draped.border = border_of(draped.piece);
  draped.to_border.emplace(draped.piece, draped.border,
                           std::max(draped.reach + draped.cell, 2 * draped.tape), longest);
  for (const Vec3& p : draped.piece.points) {
    if (draped.distances.size() % 4096 == 0) job_.poll();
    draped.distances.push_back(draped.to_border->at(p));
  }
  if (draped.tape > 0)
    draped.taped = cut_at(draped.piece, draped.distances, draped.tape);
  else
    draped.taped.assign(draped.piece.triangles.size(), 0);
  return static_cast<double>(draped.piece.triangles.size() + 2 * draped.border.size()) <= left;
}

// The sheet over the unrolled surface. Where that closes, sheet before its begin and after its end
// are mixed, so that they meet; with weights that keep the variance.
double Draper::height_at(const Draped& draped, const Vec3& p) const {
  const Surface& surface = draped.surface;
  const Vec2 place = surface.flat(p) - surface.low;
  const double height = draped.sampler.at(place.x, place.y);
  if (!surface.around) return height;
  const double t = surface.angle(p) * surface.across(p) / draped.mixed;
  if (t >= 1) return height;
  const Vec2 after = surface.flat(p, 1) - surface.low;
  return det::sin(kPi / 2 * t) * height +
         det::cos(kPi / 2 * t) * draped.sampler.at(after.x, after.y);
}

// Of the finest blanket, by central differences over its cells. inwards: metres, see append().
Vec3 Draper::normal_at(const Draped& draped, std::size_t v, const WrapGroup& group,
                       double inwards) const {
  const Vec3& p = draped.piece.points[v];
  const Vec3 up = draped.surface.normal(p);
  const Vec3 across =
      glm::normalize(glm::cross(up, std::fabs(up.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
  const bool faded = draped.distances[v] < draped.reach + draped.cell;
  const auto height = [&](const Vec3& place) {
    const double above = height_at(draped, place) - group.mean;
    if (!faded) return above;
    const double inside = (draped.to_border->at(place) + inwards) / draped.reach;
    return smooth_step(std::min(inside, 1.0)) * above;
  };
  Vec3 normal = up;
  for (const Vec3& along : {across, glm::cross(up, across)})
    normal -= group.scale * (height(p + draped.cell * along) - height(p - draped.cell * along)) /
              (2 * draped.cell) * along;
  return glm::normalize(normal);
}

void Draper::set_heights(Draped& draped, WrapGroup& group, bool level) const {
  const Piece& piece = draped.piece;
  std::vector<double>& heights = draped.heights;
  std::vector<double> fade(piece.points.size());
  for (std::size_t v = 0; v < fade.size(); ++v) {
    fade[v] = smooth_step(std::min(draped.distances[v] / draped.reach, 1.0));
    heights.push_back(height_at(draped, piece.points[v]));
  }
  if (!level) {
    double sum = 0, weight = 0;
    for (const Triangle& t : piece.triangles) {
      const double area = twice_area(piece, t);
      for (const std::uint32_t v : t) {
        sum += area * fade[v] * heights[v];
        weight += area * fade[v];
      }
    }
    group.mean = weight > 0 ? sum / weight : 0;
  }
  double lowest = 0;
  for (std::size_t v = 0; v < heights.size(); ++v) {
    heights[v] = fade[v] * (heights[v] - group.mean);
    lowest = std::min(lowest, heights[v]);
  }
  const double below = options_.margin > 0 ? options_.margin : 0.1 * options_.stand_off;
  if (!level && options_.stand_off + lowest < below)
    group.scale = (options_.stand_off - below) / -lowest;
}

// Lowers what other parts are nearer than. Returns the area of the triangles that it changes.
double Draper::hold(const Draped& draped, std::vector<double>& heights) const {
  if (!options_.room) return 0;
  const Piece& piece = draped.piece;
  std::vector<double> most(heights.size());
  constexpr std::size_t kBlock = 1024;
  parallel_for((heights.size() + kBlock - 1) / kBlock,
               [&](std::size_t block) {
                 for (std::size_t v = block * kBlock;
                      v < std::min(heights.size(), (block + 1) * kBlock); ++v) {
                   const Vec3& p = piece.points[v];
                   const double far = heights[v] / kWrapReach;
                   const double free = options_.room(p, draped.surface.normal(p), far);
                   most[v] = free < far ? kWrapReach * free : HUGE_VAL;
                 }
               },
               job_);
  // an edge from below a part to its outside would cut its border
  std::vector<double> least = most;
  double area = 0;
  for (const Triangle& t : piece.triangles) {
    const double low = std::min({most[t[0]], most[t[1]], most[t[2]]});
    if (low == HUGE_VAL) continue;
    for (const std::uint32_t v : t) least[v] = std::min(least[v], low);
    area += twice_area(piece, t) / 2;
  }
  if (area > 0) spread(piece, heights, kRise, least);
  for (std::size_t v = 0; v < heights.size(); ++v) heights[v] = std::min(heights[v], least[v]);
  return area;
}

// Leaves to other blankets what is nearer to their faces. Returns the area of the triangles that it
// changes.
double Draper::share(const Draped& draped, std::vector<double>& heights) const {
  const Piece& piece = draped.piece;
  const OtherCorners& others = options_.corners;
  std::vector<double> most(heights.size(), HUGE_VAL);
  constexpr std::size_t kBlock = 1024;
  const auto all = [&](std::size_t count, const auto& work) {
    parallel_for((count + kBlock - 1) / kBlock,
                 [&](std::size_t block) {
                   const std::size_t end = std::min(count, (block + 1) * kBlock);
                   for (std::size_t i = block * kBlock; i < end; ++i) work(i);
                 },
                 job_);
  };
  all(heights.size(), [&](std::size_t v) {
    const Vec3& p = piece.points[v];
    const Vec3 up = draped.surface.normal(p);
    const double far = heights[v] / kCornerReach;
    if (!(far > 0)) return;
    double free = corners_.room(owner_, p, up, far);
    if (others.room) free = others.room(p, up, free);
    if (free < far) most[v] = kCornerReach * free;
  });
  // where a face stands on this one, triangles below its border lie flat
  std::vector<char> crossed(piece.triangles.size(), 0);
  const double tolerance = kOnFace * options_.stand_off;
  all(crossed.size(), [&](std::size_t i) {
    const Triangle& t = piece.triangles[i];
    if (std::min({most[t[0]], most[t[1]], most[t[2]]}) == HUGE_VAL) return;
    for (std::size_t k = 0; k < 3 && crossed[i] == 0; ++k) {
      const Vec3 &a = piece.points[t[k]], &b = piece.points[t[(k + 1) % 3]];
      if (corners_.crossed(owner_, a, b, tolerance) ||
          (others.crossed && others.crossed(a, b, tolerance)))
        crossed[i] = 1;
    }
  });
  double area = 0;
  std::vector<double> least = most;
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    const Triangle& t = piece.triangles[i];
    if (std::min({most[t[0]], most[t[1]], most[t[2]]}) == HUGE_VAL) continue;
    area += twice_area(piece, t) / 2;
    // note: a triangle that ends at an inner edge of its own lies on one side of it
    const bool ends = most[t[0]] == 0 || most[t[1]] == 0 || most[t[2]] == 0;
    if (crossed[i] != 0 && !ends)
      for (const std::uint32_t v : t) least[v] = 0;
  }
  // note: what is nearer to faces that are no half-planes is not convex, triangles are
  if (area > 0) spread(piece, heights, kCornerRise, least);
  for (std::size_t v = 0; v < heights.size(); ++v) heights[v] = std::min(heights[v], least[v]);
  return area;
}

// Straight down from the border; as wide as a tape, they are part of it. base: of the blanket's
// vertices, whose positions are `tops`. A level's have normals, and vertices of their own. There
// are none on inner edges, where the blanket comes down to the faces.
void Draper::add_seams(const Draped& draped, std::uint32_t base, const std::vector<Vec3>& tops,
                       bool level, Appender& out) const {
  const std::vector<Vec3>& points = draped.piece.points;
  const Cover cover = options_.edge ? Cover::edge : draped.tape > 0 ? Cover::tape : Cover::foil;
  const auto down = [&](std::uint32_t v) { return tops[v] == points[v]; };
  std::map<std::uint32_t, std::uint32_t> foot;
  const auto foot_of = [&](std::uint32_t v) {
    const auto [at, fresh] = foot.try_emplace(v, 0);
    if (fresh) at->second = out.vertex(points[v], points[v]);
    return at->second;
  };
  for (const auto& [a, b] : draped.border) {
    const bool a_down = down(a), b_down = down(b);
    if (a_down && b_down) continue;
    if (level) {
      const Vec3 side = a_down ? glm::cross(points[a] - tops[b], points[b] - tops[b])
                               : glm::cross(tops[a] - tops[b], points[a] - tops[b]);
      const double length = glm::length(side);
      const Vec3 normal = length > 0 ? side / length : draped.surface.normal(points[a]);
      const std::uint32_t first = out.vertex(tops[b], points[b], normal);
      out.vertex(tops[a], points[a], normal);
      out.vertex(points[a], points[a], normal);
      out.vertex(points[b], points[b], normal);
      if (!a_down) out.triangle({first, first + 1, first + 2}, cover);
      if (!b_down) out.triangle({first, first + 2, first + 3}, cover);
    } else {
      const std::uint32_t c = a_down ? base + a : foot_of(a), d = b_down ? base + b : foot_of(b);
      if (!a_down) out.triangle({base + b, base + a, c}, cover);
      if (!b_down) out.triangle({base + b, c, d}, cover);
    }
  }
}

void Draper::append(const Draped& draped, WrapGroup& group, Cloth& cloth, bool level) const {
  // note: lambdas of clang 14 take no structured bindings
  const Surface& surface = draped.surface;
  const Piece& piece = draped.piece;
  // where facets are fine the blanket is as round as what they stand for
  double chord = 0;
  for (const Vec3& p : piece.points) chord = std::max(chord, std::fabs(surface.above(p)));
  const double round = chord <= kRound * options_.stand_off ? 1 : 0;
  std::vector<double> heights(piece.points.size());
  for (std::size_t v = 0; v < heights.size(); ++v)
    heights[v] = options_.stand_off + group.scale * draped.heights[v] +
                 round * surface.above(piece.points[v]);
  const double held = hold(draped, heights), cornered = share(draped, heights);
  if (!level) group.held = held, group.cornered = cornered;
  Appender out(surface, cloth);
  const auto base = static_cast<std::uint32_t>(cloth.mesh.positions.size());
  // where borders are all there is, vertices stand for what lies half an edge within
  const double deepest = *std::ranges::max_element(draped.distances);
  const double inwards = deepest < draped.reach / 2 ? draped.longest / 2 : 0;
  std::vector<Vec3> tops;
  std::vector<std::optional<Vec3>> normals(heights.size());
  for (std::size_t v = 0; v < heights.size(); ++v) {
    const Vec3& p = piece.points[v];
    tops.push_back(p + heights[v] * surface.normal(p));
    if (level) normals[v] = normal_at(draped, v, group, inwards);
    out.vertex(tops[v], p, normals[v]);
  }
  // a vertex again: where the unrolled surface closes its places are those behind the end
  std::map<std::uint32_t, std::uint32_t> behind;
  const auto behind_end = [&](std::uint32_t v) {
    const auto [at, fresh] = behind.try_emplace(v, 0);
    if (fresh) at->second = out.vertex(tops[v], piece.points[v], normals[v], 1);
    return at->second;
  };
  for (std::size_t i = 0; i < piece.triangles.size(); ++i) {
    const Triangle& t = piece.triangles[i];
    Triangle corners{base + t[0], base + t[1], base + t[2]};
    if (surface.around) {
      double angles[3];
      for (std::size_t k = 0; k < 3; ++k) angles[k] = surface.angle(piece.points[t[k]]);
      const double most = std::max({angles[0], angles[1], angles[2]});
      for (std::size_t k = 0; k < 3; ++k)
        if (angles[k] < most - kPi) corners[k] = behind_end(t[k]);
    }
    out.triangle(corners, draped.taped[i] != 0 ? Cover::tape : Cover::foil);
  }
  add_seams(draped, base, tops, level, out);
}

namespace {

Vec2 fades(const WrapOptions& options, double area) {
  const double root = std::sqrt(area);
  return {options.border > 0 ? options.border : std::min(3 * options.stand_off, root / 4),
          std::min(options.tape, kWidestTapeShare * root)};
}

}  // namespace

bool Draper::add(const Group& members, const Surface& surface, const Sheet& sheet, double left,
                 WrapGroup& group, Cloth& cloth) const {
  const Vec2 widths = fades(options_, group.area);
  const double longest = 1.5 * sheet.spacing.x;
  Draped draped{surface, Sampler{sheet}, sheet.spacing.x, widths.x, std::max(widths.x, 8 * longest),
                longest, widths.y};
  if (!cut(draped, members, longest, left)) return false;
  set_heights(draped, group, false);
  group.first = cloth.mesh.triangles.size();
  append(draped, group, cloth, false);
  group.count = cloth.mesh.triangles.size() - group.first;
  return true;
}

bool Draper::add_level(const Group& members, const Surface& surface, const Sheet& sheet,
                       double left, const WrapGroup& group, Cloth& level) const {
  const Vec2 widths = fades(options_, group.area);
  Draped draped{surface,
                Sampler{sheet},
                sheet.spacing.x,
                widths.x,
                std::max(widths.x, 12 * sheet.spacing.x),
                level.longest,
                widths.y};
  if (!cut(draped, members, level.longest, left)) return false;
  WrapGroup same = group;
  set_heights(draped, same, true);
  append(draped, same, level, true);
  return true;
}

}  // namespace panwright::mli
