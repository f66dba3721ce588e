#include "preview/model/texture_charts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace panwright::preview {
namespace {

constexpr double kTexelsAcross = 8;     // of a mip level, across a chart
constexpr double kLeftOut = 0.02;       // of the area
constexpr double kWholeTexture = 0.98;  // of its sides

// Vertices of the same texture coordinates are one: flat facets that lie side by side in the
// texture are one chart, though they share no vertices.
std::vector<std::uint32_t> first_alike(const pan::MeshView& mesh) {
  const auto& at = mesh.texcoords;
  std::vector<std::uint32_t> order(at.size()), first(at.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(at[a].x, at[a].y, a) < std::tie(at[b].x, at[b].y, b);
  });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool alike =
        k > 0 && at[order[k]].x == at[order[k - 1]].x && at[order[k]].y == at[order[k - 1]].y;
    first[order[k]] = alike ? first[order[k - 1]] : order[k];
  }
  return first;
}

struct Chart {
  Vec2 low{HUGE_VAL}, high{-HUGE_VAL};
  double texels = 0;  // twice its area
  double area = 0;    // of the surface, twice
};

double chart_level(const Chart& chart, const Vec2& repeat, const Vec2& sides) {
  const Vec2 size = (chart.high - chart.low) * repeat;
  const Vec2 across = size * sides;
  const double longer = std::max(across.x, across.y);
  if (!(longer > 0)) return HUGE_VAL;  // one place of the texture, as of a palette
  if (std::min(size.x, size.y) >= kWholeTexture) return HUGE_VAL;
  const double width =
      std::min(std::min(across.x, across.y), 0.5 * chart.texels / glm::length(across));
  return width > kTexelsAcross ? std::log2(width / kTexelsAcross) : 0;
}

}  // namespace

double largest_level(const pan::MeshView& mesh, const Vec2& repeat, const Vec2& sides) {
  if (mesh.texcoords.empty()) return HUGE_VAL;
  const std::vector<std::uint32_t> first = first_alike(mesh);
  std::vector<std::uint32_t> parent = first;
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    for (std::size_t k = 1; k < 3; ++k)
      parent[root(first[mesh.indices[i + k]])] = root(first[mesh.indices[i]]);
  std::vector<Chart> charts(mesh.texcoords.size());
  const auto place = [&](std::uint32_t v) {
    return Vec2(double{mesh.texcoords[v].x}, double{mesh.texcoords[v].y});
  };
  const auto position = [&](std::uint32_t v) {
    return Vec3(double{mesh.positions[v].x}, double{mesh.positions[v].y},
                double{mesh.positions[v].z});
  };
  const Vec2 texels = repeat * sides;
  double area = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const std::uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
    Chart& chart = charts[root(first[a])];
    for (const std::uint32_t v : {a, b, c}) {
      chart.low = glm::min(chart.low, place(v));
      chart.high = glm::max(chart.high, place(v));
    }
    const Vec2 u = (place(b) - place(a)) * texels, v = (place(c) - place(a)) * texels;
    chart.texels += std::fabs(u.x * v.y - u.y * v.x);
    const double twice =
        glm::length(glm::cross(position(b) - position(a), position(c) - position(a)));
    chart.area += twice;
    area += twice;
  }
  std::vector<std::pair<double, double>> levels;  // and areas
  for (const Chart& chart : charts)
    if (chart.area > 0) levels.emplace_back(chart_level(chart, repeat, sides), chart.area);
  std::sort(levels.begin(), levels.end());
  double below = 0;
  for (const auto& [level, part] : levels)
    if ((below += part) > kLeftOut * area) return level;
  return HUGE_VAL;
}

}  // namespace panwright::preview
