#include "mli/internal/piece.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "mli/internal/grid.h"

namespace panwright::mli {
namespace {

using geometry::Triangle;

// Lengths that differ by less are equal, so that moved faces are cut as they were: rounding does
// not say which of two equal sides is shorter.
constexpr double kEqualLengths = 1e-9;

std::uint64_t key(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

}  // namespace

Piece piece_of(const Faces& faces, const Group& group) {
  Piece piece;
  std::map<std::uint32_t, std::uint32_t> local;
  for (const std::uint32_t t : group) {
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = faces.triangles[t][k];
      const auto [at, fresh] =
          local.try_emplace(v, static_cast<std::uint32_t>(piece.points.size()));
      if (fresh) piece.points.push_back(faces.points[v]);
      corners[k] = at->second;
    }
    piece.triangles.push_back(corners);
  }
  return piece;
}

bool refine(Piece& piece, double longest, double limit, const Job& job) {
  for (bool again = true; again;) {
    again = false;
    job.poll();
    std::unordered_map<std::uint64_t, std::uint32_t> middles;
    std::vector<Triangle> next;
    for (const Triangle& t : piece.triangles) {
      std::uint32_t m[3];
      int cuts = 0, uncut = 0, cut = 0;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        m[k] = kNone;
        if (glm::length(piece.points[a] - piece.points[b]) > longest * (1 + kEqualLengths)) {
          const auto [at, fresh] =
              middles.try_emplace(key(a, b), static_cast<std::uint32_t>(piece.points.size()));
          if (fresh) piece.points.push_back(0.5 * (piece.points[a] + piece.points[b]));
          m[k] = at->second;
          ++cuts, cut = k;
        } else {
          uncut = k;
        }
      }
      again = again || cuts > 0;
      if (cuts == 0) {
        next.push_back(t);
      } else if (cuts == 1) {
        const std::uint32_t a = t[cut], b = t[(cut + 1) % 3], c = t[(cut + 2) % 3];
        next.push_back({a, m[cut], c});
        next.push_back({m[cut], b, c});
      } else if (cuts == 2) {
        const std::uint32_t a = t[uncut], b = t[(uncut + 1) % 3], c = t[(uncut + 2) % 3];
        const std::uint32_t p = m[(uncut + 1) % 3], q = m[(uncut + 2) % 3];
        next.push_back({p, c, q});
        const bool first = glm::length(piece.points[a] - piece.points[p]) <=
                           (1 + kEqualLengths) * glm::length(piece.points[b] - piece.points[q]);
        next.push_back(first ? Triangle{a, b, p} : Triangle{a, b, q});
        next.push_back(first ? Triangle{a, p, q} : Triangle{b, p, q});
      } else {
        next.push_back({t[0], m[0], m[2]});
        next.push_back({m[0], t[1], m[1]});
        next.push_back({m[2], m[1], t[2]});
        next.push_back({m[0], m[1], m[2]});
      }
      if (static_cast<double>(next.size()) > limit) return false;
    }
    piece.triangles = std::move(next);
  }
  return true;
}

Edges border_of(const Piece& piece) {
  std::unordered_map<std::uint64_t, int> uses;
  for (const Triangle& t : piece.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[key(t[k], t[(k + 1) % 3])];
  Edges out;
  for (const Triangle& t : piece.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (uses[key(t[k], t[(k + 1) % 3])] == 1) out.push_back({t[k], t[(k + 1) % 3]});
  return out;
}

BorderDistance::BorderDistance(const Piece& piece, const Edges& border, double reach,
                               double longest)
    : reach_(reach), size_(reach + longest) {
  for (const auto& [a, b] : border)
    cells_[cell(0.5 * (piece.points[a] + piece.points[b]))].push_back(
        {piece.points[a], piece.points[b]});
}

BorderDistance::Cell BorderDistance::cell(const Vec3& place) const {
  return {static_cast<std::int64_t>(std::floor(place.x / size_)),
          static_cast<std::int64_t>(std::floor(place.y / size_)),
          static_cast<std::int64_t>(std::floor(place.z / size_))};
}

double BorderDistance::at(const Vec3& place) const {
  double nearest = reach_;
  const Cell at = cell(place);
  for (int k = 0; k < 27; ++k) {
    const auto found = cells_.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
    if (found == cells_.end()) continue;
    for (const auto& [a, b] : found->second) {
      const Vec3 d = b - a;
      const double t = std::clamp(glm::dot(place - a, d) / glm::dot(d, d), 0.0, 1.0);
      nearest = std::min(nearest, glm::length(place - a - t * d));
    }
  }
  return nearest;
}

std::vector<char> cut_at(Piece& piece, std::vector<double>& distances, double width,
                         std::vector<Cut>* cuts) {
  constexpr double kNear = 0.15;  // of an edge: a cut nearer to its end goes through that
  const auto crosses = [&](std::uint32_t a, std::uint32_t b) {
    return (distances[a] - width) * (distances[b] - width) < 0;
  };
  std::vector<char> on(piece.points.size(), 0);
  for (const Triangle& t : piece.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (!crosses(a, b)) continue;
      const double part = (width - distances[a]) / (distances[b] - distances[a]);
      if (part < kNear) on[a] = 1;
      if (part > 1 - kNear) on[b] = 1;
    }
  for (std::size_t v = 0; v < on.size(); ++v)
    if (on[v]) distances[v] = width;
  std::unordered_map<std::uint64_t, std::uint32_t> known;
  const auto cut = [&](std::uint32_t a, std::uint32_t b) {
    const auto [at, fresh] =
        known.try_emplace(key(a, b), static_cast<std::uint32_t>(piece.points.size()));
    if (fresh) {
      // from the same end whichever triangle asks
      const std::uint32_t low = std::min(a, b), high = std::max(a, b);
      const double part = (width - distances[low]) / (distances[high] - distances[low]);
      piece.points.push_back(piece.points[low] + part * (piece.points[high] - piece.points[low]));
      distances.push_back(width);
      if (cuts != nullptr) cuts->push_back({low, high, part});
    }
    return at->second;
  };
  std::vector<Triangle> next;
  for (const Triangle& t : piece.triangles) {
    std::size_t count = 0, first = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (crosses(t[k], t[(k + 1) % 3])) ++count;
    if (count == 0) {
      next.push_back(t);
      continue;
    }
    // one edge: from its cut to the corner opposite; two: around the corner that both share
    while (count == 1 ? !crosses(t[first], t[(first + 1) % 3])
                      : crosses(t[(first + 1) % 3], t[(first + 2) % 3]))
      ++first;
    const std::uint32_t a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3];
    const std::uint32_t ab = cut(a, b);
    if (count == 1) {
      next.push_back({a, ab, c});
      next.push_back({ab, b, c});
    } else {
      const std::uint32_t ca = cut(c, a);
      next.push_back({a, ab, ca});
      next.push_back({ab, b, c});
      next.push_back({ab, c, ca});
    }
  }
  piece.triangles = std::move(next);
  std::vector<char> within;
  within.reserve(piece.triangles.size());
  for (const Triangle& t : piece.triangles)
    within.push_back(distances[t[0]] <= width && distances[t[1]] <= width &&
                     distances[t[2]] <= width &&
                     std::min({distances[t[0]], distances[t[1]], distances[t[2]]}) < width);
  return within;
}

}  // namespace panwright::mli
