#include "preview/reference/internal/cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/axis_box.h"
#include "base/parallel.h"

namespace panwright::preview::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// pixels; instances of boxes up to this wide are measured by their vertices
constexpr double kSmall = 8;

// Where a set of points falls, widened by what rounding is worth. all: behind or beside the camera
// too, so that it may be anywhere.
class Projected {
 public:
  Projected(const world::Camera& camera, const trace::Affine& camera_from_mesh, double rounding)
      : camera_(camera), camera_from_mesh_(camera_from_mesh), rounding_(rounding) {}

  void add(const Vec3& p) {
    const Vec3 at = camera_from_mesh_(p);
    nearest_ = std::min(nearest_, at.z);
    if (camera_.projection == world::Projection::orthographic)
      area_.add(camera_.focal * Vec2(at) + camera_.principal);
    else if (at.z > 0)
      area_.add(camera_.focal * (Vec2(at) / at.z) + camera_.principal);
  }

  AxisRectangle area() const {
    const double focal = std::max(camera_.focal.x, camera_.focal.y);
    AxisRectangle result = area_;
    double slack = focal * rounding_;
    if (camera_.projection == world::Projection::perspective) {
      if (!(nearest_ > 2 * rounding_)) return {Vec2(-kInfinity), Vec2(kInfinity)};
      slack /= nearest_ - rounding_;
    }
    if (result.empty()) return result;
    const Vec2 far = glm::max(glm::abs(result.low), glm::abs(result.high));
    slack += 1e-5 * result.longest() + 1e-14 * std::max({far.x, far.y, focal});
    result.widen(slack);
    return result;
  }

 private:
  const world::Camera& camera_;
  const trace::Affine& camera_from_mesh_;
  double rounding_;
  double nearest_ = kInfinity;
  AxisRectangle area_;
};

std::array<Vec3, 8> corners_of(const trace::Model::Part& part) {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      corners[i][axis] = (i >> axis & 1 ? part.high : part.low)[axis];
  return corners;
}

// Whether all corners lie behind the camera or beyond one side of the image and a pixel more.
bool is_out_of_view(const world::Camera& camera, std::span<const Vec3> corners) {
  const bool perspective = camera.projection == world::Projection::perspective;
  bool behind = true, left = true, right = true, above = true, below = true;
  for (const Vec3& p : corners) {
    // in pixels times the depth, so that what is behind needs no division
    const double depth = perspective ? p.z : 1;
    const Vec2 at = camera.focal * Vec2(p) + camera.principal * depth;
    behind = behind && !(p.z > 0);
    left = left && at.x < -depth;
    right = right && at.x > (camera.width + 1.0) * depth;
    above = above && at.y < -depth;
    below = below && at.y > (camera.height + 1.0) * depth;
  }
  return behind || left || right || above || below;
}

bool pupil_moves(const world::Camera& camera) {
  const auto* cahvore = std::get_if<sensor::Cahvore>(&camera.distortion->distortion());
  return cahvore != nullptr && cahvore->e != decltype(cahvore->e){};
}

// The area of a sphere on an image with distortion: that of the rim of its cone. The rim's image
// surrounds that of what is inside it.
AxisRectangle distorted_area(const world::Camera& camera, const Vec3& centre, double radius) {
  constexpr int kRim = 64;
  // what chords of the rim cut off, and what its image bends beyond them: 0.12 % of a circle
  constexpr double kSlack = 0.02;
  const AxisRectangle everywhere{Vec2(-kInfinity), Vec2(kInfinity)};
  const double distance = glm::length(centre);
  const double sine = radius / distance;
  if (!(sine < 0.9) || pupil_moves(camera)) return everywhere;
  const Vec3 axis = centre / distance;
  const Vec3 beside =
      glm::normalize(glm::cross(axis, std::fabs(axis.x) < 0.7 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
  const Vec3 other = glm::cross(axis, beside);
  AxisRectangle area;
  for (int k = 0; k < kRim; ++k) {
    const auto [s, c] = det::sincos(2 * kPi * k / kRim);
    const auto place = camera.distortion->place(std::sqrt(1 - sine * sine) * axis +
                                                sine * (c * beside + s * other));
    if (!place) return everywhere;
    area.add(camera.focal * *place + camera.principal);
  }
  area.widen(kSlack * area.longest() + 1e-6);
  return area;
}

// The area of a box on an image with distortion: the outline of its image is that of some edges.
// Nothing: a point of them has no place.
std::optional<AxisRectangle> distorted_edges(const world::Camera& camera,
                                             const std::array<Vec3, 8>& corners) {
  constexpr int kSteps = 8;
  constexpr double kSlack = 0.02;  // what images of edges bend between points
  AxisRectangle area;
  for (std::size_t from = 0; from < 8; ++from)
    for (std::size_t axis = 1; axis < 8; axis *= 2) {
      if ((from & axis) != 0) continue;
      for (int k = 0; k <= kSteps; ++k) {
        const double t = double{1} / kSteps * k;
        const auto place =
            camera.distortion->place((1 - t) * corners[from] + t * corners[from + axis]);
        if (!place) return std::nullopt;
        area.add(camera.focal * *place + camera.principal);
      }
    }
  area.widen(kSlack * area.longest() + 1e-6);
  return area;
}

AxisRectangle area_of(const world::Camera& camera, const trace::Model::Part& part,
                      const trace::Affine& camera_from_mesh, const Vec3& target) {
  std::array<Vec3, 8> corners = corners_of(part);
  const Vec3 far =
      glm::max(glm::abs(camera_from_mesh.offset), glm::abs(camera.position) + glm::abs(target));
  // metres: some roundings of the largest numbers on the way
  const double rounding = 1e-15 * std::max({far.x, far.y, far.z});
  if (camera.distortion != nullptr) {
    Vec3 low(kInfinity), high(-kInfinity);
    for (Vec3& corner : corners) {
      corner = camera_from_mesh(corner);
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
    const Vec3 centre = (low + high) / 2.0;
    const double radius = glm::length(high - low) / 2 + rounding;
    // boxes around the eye, and such as rounding moves, by the sphere around them
    if (radius < 0.5 * glm::length(centre) && rounding < 1e-6 * radius && !pupil_moves(camera))
      if (const auto area = distorted_edges(camera, corners)) return *area;
    return distorted_area(camera, centre, radius);
  }
  Projected whole(camera, camera_from_mesh, rounding);
  for (Vec3& corner : corners) {
    whole.add(corner);
    corner = camera_from_mesh(corner);
  }
  if (is_out_of_view(camera, corners)) return {};
  const AxisRectangle area = whole.area();
  const Vec2 size = area.high - area.low;
  if (!(std::max(size.x, size.y) <= kSmall)) return area;
  Projected vertices(camera, camera_from_mesh, rounding);
  for (const pan::layout::Float3& p : part.mesh.positions) vertices.add(Vec3(p.x, p.y, p.z));
  return vertices.area();
}

// Pixels with the parts that areas cover.
class Grid {
 public:
  Grid(std::uint32_t width, std::uint32_t height, const AxisRectangle& bounds) {
    const auto pixel = [](double at, std::uint32_t size) {
      return static_cast<std::int64_t>(std::clamp(at, 0.0, static_cast<double>(size)));
    };
    left_ = pixel(std::floor(bounds.low.x), width);
    top_ = pixel(std::floor(bounds.low.y), height);
    columns_ = std::max<std::int64_t>(0, pixel(std::ceil(bounds.high.x), width) - left_);
    rows_ = std::max<std::int64_t>(0, pixel(std::ceil(bounds.high.y), height) - top_);
    parts_.resize(static_cast<std::size_t>(columns_ * rows_));
    inside_.resize(static_cast<std::size_t>((columns_ + 1) * (rows_ + 1)));
  }

  void add(const AxisRectangle& area) {
    const std::int64_t x0 = clamped(std::floor(area.low.x) - static_cast<double>(left_), columns_);
    const std::int64_t y0 = clamped(std::floor(area.low.y) - static_cast<double>(top_), rows_);
    const std::int64_t x1 = clamped(std::ceil(area.high.x) - static_cast<double>(left_), columns_);
    const std::int64_t y1 = clamped(std::ceil(area.high.y) - static_cast<double>(top_), rows_);
    if (x0 >= x1 || y0 >= y1) return;
    // pixels that are covered whole are counted by the corners of their rectangle
    const std::int64_t a0 = clamped(std::ceil(area.low.x) - static_cast<double>(left_), columns_);
    const std::int64_t b0 = clamped(std::ceil(area.low.y) - static_cast<double>(top_), rows_);
    const std::int64_t a1 = clamped(std::floor(area.high.x) - static_cast<double>(left_), columns_);
    const std::int64_t b1 = clamped(std::floor(area.high.y) - static_cast<double>(top_), rows_);
    const bool has_whole = a0 < a1 && b0 < b1;
    if (has_whole) {
      ++count(a0, b0);
      --count(a1, b0);
      --count(a0, b1);
      ++count(a1, b1);
    }
    for (std::int64_t y = y0; y < y1; ++y)
      for (std::int64_t x = x0; x < x1; ++x) {
        if (has_whole && y >= b0 && y < b1 && x >= a0 && x < a1) {
          x = a1 - 1;
          continue;
        }
        AxisRectangle& part = parts_[static_cast<std::size_t>(y * columns_ + x)];
        const Vec2 corner(static_cast<double>(left_ + x), static_cast<double>(top_ + y));
        part.add(glm::clamp(area.low - corner, Vec2(0), Vec2(1)));
        part.add(glm::clamp(area.high - corner, Vec2(0), Vec2(1)));
      }
  }

  std::vector<Cell> cells() const {
    std::vector<Cell> result;
    std::vector<std::int32_t> above(static_cast<std::size_t>(columns_) + 1);
    for (std::int64_t y = 0; y < rows_; ++y) {
      std::int32_t covered = 0;
      for (std::int64_t x = 0; x < columns_; ++x) {
        auto& column = above[static_cast<std::size_t>(x)];
        column += inside_[static_cast<std::size_t>(y * (columns_ + 1) + x)];
        covered += column;
        Cell cell;
        cell.column = static_cast<std::uint32_t>(left_ + x);
        cell.row = static_cast<std::uint32_t>(top_ + y);
        if (covered == 0) {
          const AxisRectangle& part = parts_[static_cast<std::size_t>(y * columns_ + x)];
          if (!(part.low.x < part.high.x && part.low.y < part.high.y)) continue;
          cell.low = part.low;
          cell.high = part.high;
        }
        result.push_back(cell);
      }
    }
    return result;
  }

 private:
  static std::int64_t clamped(double at, std::int64_t size) {
    return static_cast<std::int64_t>(std::clamp(at, 0.0, static_cast<double>(size)));
  }
  std::int32_t& count(std::int64_t x, std::int64_t y) {
    return inside_[static_cast<std::size_t>(y * (columns_ + 1) + x)];
  }

  std::int64_t left_ = 0, top_ = 0, columns_ = 0, rows_ = 0;
  std::vector<AxisRectangle> parts_;
  std::vector<std::int32_t> inside_;
};

}  // namespace

std::vector<Cell> cells_of(
    const trace::Scene& scene, const world::Camera& camera,
    const std::function<bool(std::uint32_t target, std::uint32_t part)>& wanted) {
  std::vector<AxisRectangle> areas;
  for (std::uint32_t t = 0; t < scene.targets().size(); ++t) {
    const trace::Scene::Placed& placed = scene.targets()[t];
    const trace::Affine camera_from_model = between(scene.observer(), placed.frame);
    const trace::Target& target = *placed.target;
    // terrain may be anywhere
    if (target.ground() != nullptr && !wanted) areas.push_back({Vec2(-kInfinity), Vec2(kInfinity)});
    const std::size_t first = areas.size();
    areas.resize(first + target.parts().size());
    parallel_for(target.parts().size(), [&](std::size_t i) {
      if (wanted && !wanted(t, target.parts()[i])) return;
      // the positions of the camera and of the model have cancelled before that of the part joins
      const trace::Affine camera_from_mesh =
          camera_from_model * target.placements()[i].model_from_mesh;
      areas[first + i] = area_of(camera, target.model().parts()[target.parts()[i]],
                                 camera_from_mesh, placed.frame.position);
    });
  }
  AxisRectangle bounds;
  for (const AxisRectangle& area : areas) {
    if (area.empty()) continue;
    bounds.add(area.low);
    bounds.add(area.high);
  }
  if (bounds.empty()) return {};
  Grid grid(camera.width, camera.height, bounds);
  for (const AxisRectangle& area : areas)
    if (!area.empty()) grid.add(area);
  return grid.cells();
}

}  // namespace panwright::preview::reference
