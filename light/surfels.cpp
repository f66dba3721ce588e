#include "light/surfels.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <tuple>

#include "base/parallel.h"

namespace panwright::light {
namespace {

// The cosine between normals from which on all counts; at a right angle nothing does.
constexpr float kFacingScale = 1 / 0.7f;
// Squared distances along the normal count as often, so that a shelf does not light the next one.
constexpr float kAcross = 8;

// The direction along an axis that is nearest to a normal: 0 to 5.
template <class T>
std::uint32_t direction_of(const T& n) {
  const auto x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
  if (x >= y && x >= z) return n.x < 0 ? 1 : 0;
  if (y >= z) return n.y < 0 ? 3 : 2;
  return n.z < 0 ? 5 : 4;
}

Vec3 axis_of(std::uint32_t direction) {
  Vec3 axis(0);
  axis[static_cast<int>(direction / 2)] = direction % 2 == 0 ? 1 : -1;
  return axis;
}

std::uint32_t packed_normal(const Vec3& n) {
  const double sum = std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z);
  double x = n.x / sum, y = n.y / sum;
  if (n.z < 0) {
    const double folded = (1 - std::fabs(y)) * (x < 0 ? -1 : 1);
    y = (1 - std::fabs(x)) * (y < 0 ? -1 : 1);
    x = folded;
  }
  const auto code = [](double v) {
    return static_cast<std::uint32_t>(std::floor(std::clamp(127.5 + 127 * v, 0.0, 255.0)));
  };
  return code(x) | code(y) << 8;
}

glm::vec3 unpacked_normal(std::uint32_t word) {
  float x = (static_cast<float>(word & 255u) - 127) / 127.0f;
  float y = (static_cast<float>(word >> 8 & 255u) - 127) / 127.0f;
  const float z = 1 - std::fabs(x) - std::fabs(y);
  if (z < 0) {
    const float folded = (1 - std::fabs(y)) * (x < 0 ? -1.0f : 1.0f);
    y = (1 - std::fabs(x)) * (y < 0 ? -1.0f : 1.0f);
    x = folded;
  }
  const glm::vec3 n(x, y, z);
  return n / std::sqrt(glm::dot(n, n));
}

// The largest cosine between a normal and those that are nearest to a direction.
double largest_cosine(const Vec3& normal, std::uint32_t direction) {
  // the half-angle of a cube's face about its middle: atan(√2)
  constexpr double kCos = 0.57735026918962576, kSin = 0.81649658092772603;
  const double cosine = glm::dot(normal, axis_of(direction));
  if (cosine >= kCos) return 1;
  return cosine * kCos + std::sqrt(std::max(1 - cosine * cosine, 0.0)) * kSin;
}

std::uint64_t scattered(std::uint64_t key) {
  key *= 0x9E3779B97F4A7C15u;
  return key ^ key >> 32;
}

// Set of keys of cells, above 0.
class CellSet {
 public:
  // Returns whether it is new.
  bool add(std::uint64_t key) {
    if (2 * (count_ + 1) > slots_.size()) grow();
    std::uint64_t& slot = slots_[find(key)];
    if (slot == key) return false;
    slot = key;
    ++count_;
    return true;
  }
  bool has(std::uint64_t key) const { return !slots_.empty() && slots_[find(key)] == key; }
  bool empty() const { return count_ == 0; }

 private:
  std::size_t find(std::uint64_t key) const {
    std::size_t slot = scattered(key) & (slots_.size() - 1);
    while (slots_[slot] != 0 && slots_[slot] != key) slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }
  void grow() {
    std::vector<std::uint64_t> old(std::max<std::size_t>(2 * slots_.size(), 1024), 0);
    std::swap(old, slots_);
    for (const std::uint64_t key : old)
      if (key != 0) slots_[find(key)] = key;
  }
  std::vector<std::uint64_t> slots_;
  std::size_t count_ = 0;
};

struct Listed {
  std::uint64_t cell;  // z, y, x, direction
  float distance;      // from the middle of the cube
  std::uint32_t surfel;
};

// Whether a limit of a surfel leaves nothing of a cube.
//
//   middle  of the cube, from the surfel
bool is_beyond(const Surfel& surfel, const Vec3& middle, double side) {
  for (std::uint32_t k = 0; k < surfel.limit_count; ++k) {
    const Vec3 normal(surfel.limits[k]);
    const double half =
        0.5 * side * (std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z));
    if (glm::dot(normal, surfel.position + middle) + surfel.limits[k].w < -half) return true;
  }
  return false;
}

std::uint64_t cell_key(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t direction) {
  return (std::uint64_t{z} << 32 | std::uint64_t{y} << 16 | x) << 3 | direction;
}

// Cells of places and those beside them. A direction counts where normals that differ by some
// degrees, as smooth ones do from those of triangles, are nearest to it.
CellSet cells_of(std::span<const SurfacePlace> places, const SurfelGrid& grid) {
  constexpr double kLeast = 0.4;  // cosine; the nearest has 0.577 or more
  CellSet own, all;
  for (const SurfacePlace& place : places) {
    const Vec3 at = glm::floor((place.position - grid.origin) / grid.side);
    for (std::uint32_t d = 0; d < 6; ++d) {
      if (glm::dot(place.normal, axis_of(d)) < kLeast) continue;
      const auto cube = [&](int k, int step) {
        return static_cast<std::uint32_t>(std::clamp(at[k] + step, 0.0, 65535.0));
      };
      // + 1: no key is 0
      if (!own.add(cell_key(cube(0, 0), cube(1, 0), cube(2, 0), d) + 1)) continue;
      for (int i = 0; i < 27; ++i)
        all.add(cell_key(cube(0, i % 3 - 1), cube(1, i / 3 % 3 - 1), cube(2, i / 9 - 1), d) + 1);
    }
  }
  return all;
}

// Lists of all cubes that a surfel reaches.
void add_cells(const Surfel& surfel, std::uint32_t index, const SurfelGrid& grid,
               const CellSet& cells, std::vector<Listed>& to) {
  const double reach = surfel.radius;
  const Vec3 at = surfel.position - grid.origin;
  std::int64_t low[3], high[3];
  for (int k = 0; k < 3; ++k) {
    // along the normal it reaches less far
    const double n = surfel.normal[k];
    const double extent = reach * std::sqrt(std::max(1 - n * n * (kAcross / (1 + kAcross)), 0.0));
    low[k] = std::max<std::int64_t>(
        static_cast<std::int64_t>(std::floor((at[k] - extent) / grid.side)), 0);
    high[k] = std::min<std::int64_t>(
        static_cast<std::int64_t>(std::floor((at[k] + extent) / grid.side)), 65535);
  }
  for (std::int64_t z = low[2]; z <= high[2]; ++z)
    for (std::int64_t y = low[1]; y <= high[1]; ++y)
      for (std::int64_t x = low[0]; x <= high[0]; ++x) {
        const Vec3 corner = grid.side * Vec3(x, y, z);
        const Vec3 apart = at - glm::clamp(at, corner, corner + grid.side);
        // the plane of the surfel passes the cube at this distance at least
        const Vec3 middle = at - corner - 0.5 * grid.side;
        const double half =
            0.5 * grid.side *
            (std::fabs(surfel.normal.x) + std::fabs(surfel.normal.y) + std::fabs(surfel.normal.z));
        const double across = std::max(std::fabs(glm::dot(middle, surfel.normal)) - half, 0.0);
        const double least = glm::dot(apart, apart) + kAcross * across * across;
        if (least >= reach * reach || is_beyond(surfel, -middle, grid.side)) continue;
        for (std::uint32_t d = 0; d < 6; ++d) {
          if (largest_cosine(surfel.normal, d) <= 0) continue;
          const std::uint64_t key =
              cell_key(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                       static_cast<std::uint32_t>(z), d);
          if (!cells.empty() && !cells.has(key + 1)) continue;
          to.push_back({key, static_cast<float>(glm::dot(middle, middle)), index});
        }
      }
}

// Those of all surfels: by cell, and by distance within one.
std::vector<Listed> all_cells(std::span<const Surfel> surfels, const SurfelGrid& grid,
                              const CellSet& cells, const Job& job) {
  constexpr std::size_t kAtOnce = 256;
  constexpr std::uint64_t kRanges = 64;  // of hashed cells, sorted one by one
  const std::size_t chunks = (surfels.size() + kAtOnce - 1) / kAtOnce;
  std::vector<std::array<std::vector<Listed>, kRanges>> found(chunks);
  parallel_for(
      chunks,
      [&](std::size_t c) {
        std::vector<Listed> some;
        const std::size_t end = std::min(surfels.size(), (c + 1) * kAtOnce);
        for (std::size_t i = c * kAtOnce; i < end; ++i)
          add_cells(surfels[i], static_cast<std::uint32_t>(i), grid, cells, some);
        for (const Listed& one : some) found[c][scattered(one.cell) % kRanges].push_back(one);
      },
      job);
  std::vector<std::vector<Listed>> sorted(kRanges);
  parallel_for(
      kRanges,
      [&](std::size_t range) {
        for (const auto& chunk : found)
          sorted[range].insert(sorted[range].end(), chunk[range].begin(), chunk[range].end());
        std::ranges::sort(sorted[range], [](const Listed& a, const Listed& b) {
          return std::tie(a.cell, a.distance, a.surfel) < std::tie(b.cell, b.distance, b.surfel);
        });
      },
      job);
  std::vector<Listed> all;
  for (const std::vector<Listed>& range : sorted) all.insert(all.end(), range.begin(), range.end());
  return all;
}

void add_limits(const Surfel& surfel, std::size_t index, SurfelGrid& grid) {
  if (surfel.limit_count == 0) return;
  grid.limits.resize(std::max(grid.limits.size(), (index + 1) * Surfel::kMostLimits));
  for (std::uint32_t k = 0; k < surfel.limit_count; ++k) {
    const Vec3 normal(surfel.limits[k]);
    const glm::vec4 limit(glm::vec3(normal),
                          static_cast<float>(surfel.limits[k].w + glm::dot(normal, grid.origin)));
    grid.limits[index * Surfel::kMostLimits + k] = {limit.x, limit.y, limit.z, limit.w};
  }
}

// Whether a point, from the origin, is on the side of all limits.
bool is_within(const SurfelGrid& grid, std::size_t surfel, const glm::vec3& at) {
  const auto count = static_cast<std::uint32_t>(grid.surfels[surfel][3]) >> 16;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto& limit = grid.limits[surfel * Surfel::kMostLimits + k];
    if (limit[0] * at.x + limit[1] * at.y + limit[2] * at.z + limit[3] < 0) return false;
  }
  return true;
}

}  // namespace

float SurfelSides::packed() const {
  const auto code = [](float share) {
    return std::floor(std::clamp(255 * share, 0.0f, 255.0f) + 0.5f);
  };
  return code(low) + 256 * code(middle) + 65536 * code(high);
}

std::uint32_t SurfelGrid::slot_of(std::uint32_t xy, std::uint32_t zd) {
  std::uint32_t h = xy * 0x9E3779B1u ^ zd * 0x85EBCA77u;
  h = (h ^ h >> 15) * 0x2C1B3C6Du;
  return h ^ h >> 13;
}

SurfelGrid surfel_grid(std::span<const Surfel> surfels, double side,
                       std::span<const SurfacePlace> places, const Job& job) {
  assert(surfels.size() <= SurfelGrid::kMost);
  SurfelGrid grid;
  grid.stamp = next_stamp();
  AxisBox bounds;
  double widest = 0;
  for (const Surfel& surfel : surfels) {
    bounds.add(surfel.position);
    widest = std::max(widest, surfel.radius);
  }
  if (!bounds.empty()) grid.origin = bounds.low - widest;
  grid.side = std::max(side, bounds.empty() ? 1 : (bounds.longest() + 2 * widest) / 60000);
  const CellSet cells = cells_of(places, grid);
  for (std::uint32_t i = 0; i < surfels.size(); ++i) {
    const glm::vec3 at(surfels[i].position - grid.origin);
    const Surfel& surfel = surfels[i];
    grid.surfels.push_back(
        {at.x, at.y, at.z,
         static_cast<float>(packed_normal(surfel.normal) | surfel.limit_count << 16)});
    add_limits(surfel, i, grid);
  }
  const std::vector<Listed> listed = all_cells(surfels, grid, cells, job);
  std::vector<std::array<std::uint32_t, 4>> lists;
  for (std::size_t i = 0; i < listed.size();) {
    std::size_t end = i;
    while (end < listed.size() && listed[end].cell == listed[i].cell) ++end;
    const std::uint64_t cell = listed[i].cell >> 3;
    const auto first = static_cast<std::uint32_t>(grid.entries.size());
    const std::size_t kept = std::min<std::size_t>(end - i, SurfelGrid::kMostListed);
    std::uint32_t limited = 0;
    for (const bool with : {false, true})
      for (std::size_t k = i; k < i + kept; ++k) {
        if ((surfels[listed[k].surfel].limit_count > 0) != with) continue;
        grid.entries.push_back(static_cast<std::uint16_t>(listed[k].surfel));
        limited += with;
      }
    lists.push_back({static_cast<std::uint32_t>(cell & 0xffffffffu),
                     static_cast<std::uint32_t>(cell >> 32) |
                         static_cast<std::uint32_t>(listed[i].cell & 7) << 16,
                     first, static_cast<std::uint32_t>(kept) | limited << 16});
    i = end;
  }
  grid.cells.assign(std::bit_ceil(std::max<std::size_t>(3 * lists.size(), 1)), {});
  const auto mask = static_cast<std::uint32_t>(grid.cells.size() - 1);
  for (const auto& list : lists) {
    std::uint32_t slot = SurfelGrid::slot_of(list[0], list[1]) & mask;
    std::uint32_t probes = 1;
    for (; grid.cells[slot][3] != 0; slot = (slot + 1) & mask) ++probes;
    grid.cells[slot] = list;
    grid.longest_probe = std::max(grid.longest_probe, probes);
  }
  return grid;
}

Vec3 irradiance_at(const SurfelLight& light, const Vec3& point, const Vec3& normal) {
  if (!light.grid) return Vec3(0);
  const SurfelGrid& grid = *light.grid;
  const glm::vec3 at(point - grid.origin);
  const glm::vec3 n(normal);
  const glm::vec3 cell = glm::floor(at * static_cast<float>(1 / grid.side));
  if (!(cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < 65536 && cell.y < 65536 &&
        cell.z < 65536))
    return Vec3(0);
  const std::uint32_t xy = static_cast<std::uint32_t>(cell.x) | static_cast<std::uint32_t>(cell.y)
                                                                    << 16;
  const std::uint32_t zd = static_cast<std::uint32_t>(cell.z) | direction_of(n) << 16;
  const auto mask = static_cast<std::uint32_t>(grid.cells.size() - 1);
  std::uint32_t slot = SurfelGrid::slot_of(xy, zd) & mask;
  for (std::uint32_t k = 0; k < grid.longest_probe; ++k, slot = (slot + 1) & mask) {
    const auto& list = grid.cells[slot];
    if (list[3] == 0) break;
    if (list[0] != xy || list[1] != zd) continue;
    glm::vec3 sum(0);
    float weights = 0;
    for (std::uint32_t e = list[2]; e < list[2] + (list[3] & 0xffffu); ++e) {
      const auto& surfel = grid.surfels[grid.entries[e]];
      if (!is_within(grid, grid.entries[e], at)) continue;
      const glm::vec3 apart = glm::vec3(surfel[0], surfel[1], surfel[2]) - at;
      const auto& sent = light.irradiance[grid.entries[e]];
      const glm::vec3 its_normal = unpacked_normal(static_cast<std::uint32_t>(surfel[3]));
      const float across = glm::dot(apart, its_normal);
      const float left = std::max(
          1 - (glm::dot(apart, apart) + kAcross * across * across) * sent[3] * sent[3], 0.0f);
      const float facing = std::clamp(glm::dot(n, its_normal) * kFacingScale, 0.0f, 1.0f);
      const float weight = left * left * facing * facing;
      sum += weight * glm::vec3(sent[0], sent[1], sent[2]);
      weights += weight;
    }
    return weights > 0 ? Vec3(sum / weights) : Vec3(0);
  }
  return Vec3(0);
}

}  // namespace panwright::light
