#include "preview/frame/thin_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/parallel.h"

namespace panwright::preview {
namespace {

// Bands wider than this meet a centre or a corner of pixels wherever they lie: sqrt(1/2).
constexpr double kWidest = 0.70710678118654752;
// Vertices and triangles of one task.
constexpr std::size_t kAtOnce = 1u << 14;

// A triangle cut by up to four lines.
struct CutTriangle {
  std::array<Vec2, 8> corners;
  std::size_t count = 0;

  // Keeps what lies above a coordinate along an axis, or below it.
  void cut(int axis, double at, bool above) {
    std::array<Vec2, 8> kept;
    std::size_t number = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec2& p = corners[i];
      const Vec2& q = corners[(i + 1) % count];
      const double a = above ? p[axis] - at : at - p[axis];
      const double b = above ? q[axis] - at : at - q[axis];
      if (a >= 0) kept[number++] = p;
      if ((a > 0 && b < 0) || (a < 0 && b > 0)) kept[number++] = p + a / (a - b) * (q - p);
    }
    corners = kept;
    count = number;
  }

  double area() const {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < count; ++i) {
      const Vec2 a = corners[i] - corners[0];
      const Vec2 b = corners[i + 1] - corners[0];
      twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * std::fabs(twice);
  }
};

}  // namespace

void find_empty(const image::Image& image, const image::Image* corners, const Tile& part,
                std::vector<std::uint8_t>& empty) {
  empty.assign(std::size_t{part.width} * part.height, 0);
  const auto row = [&](std::size_t line) {
    const auto y = static_cast<std::uint32_t>(part.y + line);
    const std::uint32_t bottom = std::min(y + 1, part.y + part.height - 1);
    for (std::uint32_t x = part.x; x < part.x + part.width; ++x) {
      const std::uint32_t right = std::min(x + 1, part.x + part.width - 1);
      const auto shown = [&](const image::Image& in, std::uint32_t left, std::uint32_t top) {
        for (std::uint32_t v = top; v <= bottom; ++v)
          for (std::uint32_t u = left; u <= right; ++u)
            if (in.coverage[std::size_t{v} * in.width + u] > 0) return true;
        return false;
      };
      const bool any =
          corners ? image.coverage[std::size_t{y} * image.width + x] > 0 || shown(*corners, x, y)
                  : shown(image, std::max(x, part.x + 1) - 1, std::max(y, part.y + 1) - 1);
      empty[line * part.width + (x - part.x)] = any ? 0 : 1;
    }
  };
  parallel_for(part.height, std::ref(row));
}

void ThinParts::begin(const Tile& part, std::span<const std::uint8_t> empty) {
  part_ = part;
  areas_.assign(empty.size(), 0.0f);
  empty_.assign(empty.begin(), empty.end());
  empty_pixels_.clear();
  for (std::uint32_t y = 0; y < part.height; ++y)
    for (std::uint32_t x = 0; x < part.width; ++x)
      if (empty[std::size_t{y} * part.width + x] != 0) empty_pixels_.push_back({x, y});
  set_.assign({0, 0, part.width, part.height}, empty_pixels_);
}

// Whether a triangle is thin, and its box holds an empty pixel.
bool ThinParts::may_count(const Triangle& triangle) const {
  const auto& [a, b, c] = triangle.corners;
  const Vec2 low = glm::max(glm::floor(glm::min(a, glm::min(b, c))), Vec2(0));
  const Vec2 high = glm::min(glm::max(a, glm::max(b, c)), Vec2(part_.width, part_.height));
  if (!(low.x < high.x && low.y < high.y)) return false;
  const Tile box{static_cast<std::uint32_t>(low.x), static_cast<std::uint32_t>(low.y),
                 static_cast<std::uint32_t>(std::ceil(high.x) - low.x),
                 static_cast<std::uint32_t>(std::ceil(high.y) - low.y)};
  if (!set_.any(box)) return false;
  const double longest =
      std::sqrt(std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)}));
  const double twice = std::fabs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  return twice > 0 && twice < kWidest * longest;
}

void ThinParts::lay(const Triangle& triangle, double weight) {
  const auto& [a, b, c] = triangle.corners;
  const auto first = [](double low) { return std::max(std::floor(low), 0.0); };
  const double bottom = std::min(std::max({a.y, b.y, c.y}), static_cast<double>(part_.height));
  for (double y = first(std::min({a.y, b.y, c.y})); y < bottom; ++y) {
    CutTriangle row{{a, b, c}, 3};
    row.cut(1, y, true);
    row.cut(1, y + 1, false);
    if (row.count < 3) continue;
    double left = HUGE_VAL;
    double right = -HUGE_VAL;
    for (std::size_t i = 0; i < row.count; ++i) {
      left = std::min(left, row.corners[i].x);
      right = std::max(right, row.corners[i].x);
    }
    right = std::min(right, static_cast<double>(part_.width));
    for (double x = first(left); x < right; ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y) * part_.width + static_cast<std::size_t>(x);
      if (empty_[at] == 0) continue;
      CutTriangle square = row;
      square.cut(0, x, true);
      square.cut(0, x + 1, false);
      areas_[at] = std::min(1.0f, areas_[at] + static_cast<float>(weight * square.area()));
    }
  }
}

void ThinParts::add(const world::Camera& camera, const ThinMesh& mesh) {
  const bool perspective = camera.projection == world::Projection::perspective;
  const Vec2 corner = camera.principal - Vec2(part_.x, part_.y);
  places_.resize(mesh.mesh.positions.size());
  const auto tasks = [](std::size_t count) { return (count + kAtOnce - 1) / kAtOnce; };
  parallel_for(tasks(places_.size()), [&](std::size_t task) {
    const std::size_t end = std::min(places_.size(), (task + 1) * kAtOnce);
    for (std::size_t i = task * kAtOnce; i < end; ++i) {
      const pan::layout::Float3& p = mesh.mesh.positions[i];
      const Vec3 q(mesh.camera_from_mesh * Vec4(p.x, p.y, p.z, 1));
      const Vec2 plane = perspective ? Vec2(q) / q.z : Vec2(q);
      places_[i] = Vec3(camera.focal * plane + corner, !perspective || q.z > 0 ? 1 : 0);
    }
  });
  const pan::Indices& indices = mesh.mesh.indices;
  const std::size_t triangles = indices.size() / 3;
  thin_.resize(std::max(thin_.size(), tasks(triangles)));
  parallel_for(tasks(triangles), [&](std::size_t task) {
    thin_[task].clear();
    const std::size_t end = std::min(triangles, (task + 1) * kAtOnce);
    for (std::size_t i = task * kAtOnce; i < end; ++i) {
      const Vec3* of[3];
      for (std::size_t k = 0; k < 3; ++k) of[k] = &places_[indices[3 * i + k]];
      if (of[0]->z + of[1]->z + of[2]->z < 3) continue;
      const Triangle triangle{{Vec2(*of[0]), Vec2(*of[1]), Vec2(*of[2])}};
      if (may_count(triangle)) thin_[task].push_back(triangle);
    }
  });
  // one after the other: sums do not depend on the number of threads
  for (std::size_t task = 0; task < tasks(triangles); ++task)
    for (const Triangle& triangle : thin_[task]) lay(triangle, mesh.closed ? 0.5 : 1);
}

}  // namespace panwright::preview
