#include "workspace/convex_outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "base/axis_box.h"
#include "world/evaluation.h"

namespace panwright::workspace {

namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x * b.y - a.y * b.x; }

// Convex hull, by A. M. Andrew's monotone chain.
std::vector<Vec2> hull_of(std::vector<Vec2> points) {
  std::ranges::sort(
      points, [](const Vec2& a, const Vec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  std::vector<Vec2> out;
  for (int side = 0; side < 2; ++side) {
    const std::size_t base = out.size();
    for (const Vec2& p : points) {
      while (out.size() >= base + 2 && cross(out.back() - out[out.size() - 2], p - out.back()) <= 0)
        out.pop_back();
      out.push_back(p);
    }
    out.pop_back();
    std::ranges::reverse(points);
  }
  return out;
}

double area_of(const std::vector<Vec2>& polygon) {
  double area = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k)
    area += 0.5 * cross(polygon[k], polygon[(k + 1) % polygon.size()]);
  return std::fabs(area);
}

// Area of a convex polygon within an image.
double area_within(std::vector<Vec2> polygon, double width, double height) {
  const std::array<Vec3, 4> sides = {Vec3(1, 0, 0), Vec3(-1, 0, width), Vec3(0, 1, 0),
                                     Vec3(0, -1, height)};
  for (const Vec3& side : sides) {
    std::vector<Vec2> cut;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec2 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
      const double da = side.x * a.x + side.y * a.y + side.z;
      const double db = side.x * b.x + side.y * b.y + side.z;
      if (da >= 0) cut.push_back(a);
      if ((da < 0) != (db < 0)) cut.push_back(a + da / (da - db) * (b - a));
    }
    polygon = std::move(cut);
  }
  return area_of(polygon);
}

}  // namespace

std::vector<Vec3> extreme_points(const world::Instance& target) {
  constexpr std::size_t kDirections = 400;
  std::vector<Vec3> all;
  const world::EvaluatedInstance nodes = world::evaluated(target);
  const pan::Model& model = *target.model();
  std::vector<std::pair<double, Vec3>> far;
  std::vector<Vec3> along;
  for (std::size_t k = 0; k < kDirections; ++k) {  // a spiral over the sphere
    const auto step = static_cast<double>(k);
    const double z = 1 - (2 * step + 1) / kDirections;
    const auto [s, c] = det::sincos(step * kPi * (3 - std::sqrt(5.0)));
    along.push_back(Vec3(std::sqrt(1 - z * z) * Vec2(c, s), z));
    far.emplace_back(-HUGE_VAL, Vec3(0));
  }
  for (const pan::layout::Instance& placed : model.instances()) {
    if (!nodes.node_visible[placed.node]) continue;
    const auto& o = model.meshes()[placed.mesh].origin;
    const Mat4& matrix = nodes.model_from_nodes[placed.node];
    const std::span<const pan::layout::Float3> positions = model.mesh(placed.mesh).positions;
    // neighbours in a mesh are near each other: most have none that is the farthest
    constexpr std::size_t kTogether = 64;
    for (std::size_t first = 0; first < positions.size(); first += kTogether) {
      std::array<Vec3, kTogether> some;
      const std::size_t count = std::min(kTogether, positions.size() - first);
      AxisBox box;
      for (std::size_t i = 0; i < count; ++i) {
        const auto& p = positions[first + i];
        some[i] = Vec3(matrix * Vec4(o[0] + p.x, o[1] + p.y, o[2] + p.z, 1));
        box.add(some[i]);
      }
      const Vec3 centre = box.centre(), half = 0.5 * box.extent();
      const double slack = 1e-12 * (glm::length(centre) + glm::length(half));
      for (std::size_t k = 0; k < kDirections; ++k) {
        const Vec3& d = along[k];
        if (glm::dot(centre, d) + glm::dot(half, glm::abs(d)) + slack <= far[k].first) continue;
        for (std::size_t i = 0; i < count; ++i)
          if (const double way = glm::dot(some[i], d); way > far[k].first) far[k] = {way, some[i]};
      }
    }
  }
  for (const auto& [distance, at] : far)
    if (std::isfinite(distance) && std::ranges::find(all, at) == all.end()) all.push_back(at);
  return all;
}

HullArea hull_area(std::vector<Vec2> points, std::uint32_t width, std::uint32_t height) {
  if (points.size() < 3) return {};
  const std::vector<Vec2> hull = hull_of(std::move(points));
  return {area_of(hull), area_within(hull, width, height)};
}

}  // namespace panwright::workspace
