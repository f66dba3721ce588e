#include "geometry/internal/weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "geometry/internal/deduplicate.h"

namespace panwright::geometry {

namespace {

using Key = std::array<std::uint64_t, 3>;

Key key_of(const Vec3& p) {
  // note: adding zero turns −0 into 0
  return {std::bit_cast<std::uint64_t>(p.x + 0.0), std::bit_cast<std::uint64_t>(p.y + 0.0),
          std::bit_cast<std::uint64_t>(p.z + 0.0)};
}

std::uint64_t mixed(const Key& key) {
  std::uint64_t h = kHashSeed;
  for (const std::uint64_t part : key) h = hash_step(h, part);
  return hash_end(h);
}

// of the largest coordinate: less is nothing beside its rounding, and makes cells without number
constexpr double kLeastTolerance = 1e-17;

double largest_coordinate(std::span<const Vec3> positions) {
  double largest = 0;
  for (const Vec3& p : positions)
    largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  return largest;
}

// Points that stayed, by the cell of a grid they lie in.
class Representatives {
 public:
  Representatives(std::span<const Vec3> positions, double tolerance)
      : positions_(positions), tolerance_(tolerance), cell_(4 * tolerance) {
    heads_.assign(std::bit_ceil(std::max<std::size_t>(16, positions.size() * 2)), kEmpty);
    next_.assign(positions.size(), kEmpty);
  }

  // The first that lies within the tolerance, or kEmpty. Cells are four tolerances wide, so that
  // what is near lies in the eight cells about the nearest corner of the grid.
  std::uint32_t near(const Vec3& p) const {
    std::uint32_t best = kEmpty;
    const Vec3 corner = glm::floor(p / cell_ + 0.5);
    for (int i = 0; i < 8; ++i) {
      const Vec3 cell = corner - Vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1);
      for (std::uint32_t r = heads_[slot(cell)]; r != kEmpty; r = next_[r]) {
        const Vec3 off = positions_[r] - p;
        if (glm::dot(off, off) <= tolerance_ * tolerance_) best = std::min(best, r);
      }
    }
    return best;
  }

  void add(std::uint32_t i) {
    std::uint32_t& head = heads_[slot(glm::floor(positions_[i] / cell_))];
    next_[i] = head;
    head = i;
  }

  static constexpr std::uint32_t kEmpty = 0xffffffffu;

 private:
  std::size_t slot(const Vec3& cell) const { return mixed(key_of(cell)) & (heads_.size() - 1); }

  std::span<const Vec3> positions_;
  double tolerance_;
  double cell_;
  std::vector<std::uint32_t> heads_;
  std::vector<std::uint32_t> next_;
};

// of positions: comparing all costs less than setting up a table
constexpr std::size_t kFew = 16;

std::vector<std::uint32_t> welded_by_comparing(std::span<const Vec3> positions) {
  std::array<Key, kFew> keys;
  std::vector<std::uint32_t> first(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    keys[i] = key_of(positions[i]);
    first[i] = 0;
    while (keys[first[i]] != keys[i]) ++first[i];
  }
  return first;
}

}  // namespace

std::vector<std::uint32_t> welded_by_sorting(std::span<const Vec3> positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Key ka = key_of(positions[a]);
    const Key kb = key_of(positions[b]);
    return ka != kb ? ka < kb : a < b;
  });
  std::vector<std::uint32_t> first(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key_of(positions[order[i]]) == key_of(positions[order[i - 1]]);
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

std::vector<std::uint32_t> welded(std::span<const Vec3> positions) {
  if (positions.size() <= kFew) return welded_by_comparing(positions);
  auto first = deduplicate(
      positions.size(), [&](std::uint32_t i) { return mixed(key_of(positions[i])); },
      [&](std::uint32_t a, std::uint32_t b) {
        return key_of(positions[a]) == key_of(positions[b]);
      });
  if (!first) return welded_by_sorting(positions);
  return std::move(*first);
}

std::vector<std::uint32_t> welded_within(std::span<const Vec3> positions, double tolerance) {
  std::vector<std::uint32_t> first = welded(positions);
  if (!(tolerance > kLeastTolerance * largest_coordinate(positions))) return first;
  Representatives representatives(positions, tolerance);
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    if (first[i] != i) {
      first[i] = first[first[i]];
      continue;
    }
    const std::uint32_t near = representatives.near(positions[i]);
    if (near == Representatives::kEmpty)
      representatives.add(i);
    else
      first[i] = near;
  }
  return first;
}

}  // namespace panwright::geometry
