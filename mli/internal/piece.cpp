#include "mli/internal/piece.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "mli/internal/grid.h"

namespace panwright::mli {
namespace {

using geometry::Triangle;

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
        if (glm::length(piece.points[a] - piece.points[b]) > longest) {
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
                           glm::length(piece.points[b] - piece.points[q]);
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

std::vector<double> tapers(const Piece& piece, const Edges& border, double reach, double longest,
                           const Job& job) {
  const double size = reach + longest;
  using Cell = std::array<std::int64_t, 3>;
  std::map<Cell, std::vector<std::size_t>> cells;
  const auto cell = [&](const Vec3& p) {
    return Cell{static_cast<std::int64_t>(std::floor(p.x / size)),
                static_cast<std::int64_t>(std::floor(p.y / size)),
                static_cast<std::int64_t>(std::floor(p.z / size))};
  };
  const auto& points = piece.points;
  for (std::size_t e = 0; e < border.size(); ++e)
    cells[cell(0.5 * (points[border[e][0]] + points[border[e][1]]))].push_back(e);
  std::vector<double> out(points.size(), 1.0);
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (v % 4096 == 0) job.poll();
    double nearest = reach;
    const Cell at = cell(points[v]);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
      if (found == cells.end()) continue;
      for (const std::size_t e : found->second) {
        const Vec3 a = points[border[e][0]], d = points[border[e][1]] - a;
        const double t = std::clamp(glm::dot(points[v] - a, d) / glm::dot(d, d), 0.0, 1.0);
        nearest = std::min(nearest, glm::length(points[v] - a - t * d));
      }
    }
    out[v] = smooth_step(nearest / reach);
  }
  return out;
}

}  // namespace panwright::mli
