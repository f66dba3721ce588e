#include "preview/frame/lens_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace panwright::preview {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Steps of the grid of rays over an area, along a side.
constexpr int kSteps = 32;
// What the outline of an area bends between rays of the grid, in parts of its field.
constexpr double kBend = 0.005;
// Texels around a view.
constexpr double kViewBorder = 2;
// Views that draw so many times the texels they need are divided, down to parts of that many
// pixels a side or of few texels.
constexpr double kMuchWaste = 2.2;
constexpr std::uint32_t kSmallPart = 192;
constexpr double kManyTexels = 1 << 19;
constexpr std::uint32_t kLeastPart = 8;
// Texels of a view are at most this much finer than for a magnification of 1: where a fisheye
// spreads the direction behind it over a circle, it magnifies without limit.
constexpr double kMostMagnification = 16;
// Points along an edge of the faces of a box, and what its image bends between them.
constexpr int kFacePoints = 9;
constexpr double kAreaSlack = 0.02;

const double kGoldenTurn = std::atan((std::sqrt(5.0) - 1) / 2);

std::optional<Vec3> ray_at(const world::Camera& lens, const Vec2& pixel) {
  const Vec2 place = (pixel - lens.principal) / lens.focal;
  if (lens.distortion == nullptr) return glm::normalize(Vec3(place, 1));
  const auto ray = lens.distortion->ray(place);
  if (!ray) return std::nullopt;
  return ray->direction;
}

// Directions of an area: at the points of a grid, and at the ends of the domain between two of
// them; with the steps to places a little right of each and below.
struct Rays {
  struct Point {
    Vec3 direction{0};
    Vec3 right{0}, below{0};  // directions; 0: unknown
  };
  std::vector<Point> points;
  Vec3 middle{0};
  double step = 0;   // of right and below, pixels
  double share = 0;  // of the grid's points that have a ray
};

Vec3 end_of_domain(const world::Camera& lens, Vec2 inside, Vec2 outside, Vec3 direction) {
  for (int k = 0; k < 20; ++k) {
    const Vec2 middle = 0.5 * (inside + outside);
    if (const auto ray = ray_at(lens, middle)) {
      direction = *ray;
      inside = middle;
    } else {
      outside = middle;
    }
  }
  return direction;
}

Rays rays_of(const world::Camera& lens, const AxisRectangle& area) {
  Rays rays;
  const Vec2 extent = area.high - area.low;
  rays.step = std::min(0.25, 0.25 * std::max(extent.x, extent.y) / kSteps);
  const auto place = [&](int x, int y) {
    return area.low + extent * Vec2(x, y) / static_cast<double>(kSteps);
  };
  constexpr int kSide = kSteps + 1;
  std::vector<std::optional<Vec3>> grid(kSide * kSide);
  int found = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      auto& at = grid[static_cast<std::size_t>(y * kSide + x)];
      at = ray_at(lens, place(x, y));
      if (!at) continue;
      ++found;
      rays.middle += *at;
      const auto right = ray_at(lens, place(x, y) + Vec2(rays.step, 0));
      const auto below = ray_at(lens, place(x, y) + Vec2(0, rays.step));
      rays.points.push_back({*at, right.value_or(Vec3(0)), below.value_or(Vec3(0))});
    }
  rays.share = static_cast<double>(found) / (kSide * kSide);
  if (found > 0 && found < kSide * kSide)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const auto& at = grid[static_cast<std::size_t>(y * kSide + x)];
        if (!at) continue;
        for (const auto& [dx, dy] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const int i = x + dx, j = y + dy;
          if (i < 0 || j < 0 || i >= kSide || j >= kSide) continue;
          if (grid[static_cast<std::size_t>(j * kSide + i)]) continue;
          rays.points.push_back(
              {end_of_domain(lens, place(x, y), place(i, j), *at), Vec3(0), Vec3(0)});
        }
      }
  return rays;
}

// Axes of a view in those of the lens: z in the middle of the rays, x along the rows there.
Mat3 axes_of(const Rays& rays, LensTurn turn) {
  if (turn == LensTurn::none) return Mat3(1);
  const Vec3 z = glm::normalize(rays.middle);
  Vec3 along(0);
  double nearest = -2;
  for (const Rays::Point& each : rays.points) {
    if (each.right == Vec3(0) || !(glm::dot(each.direction, z) > nearest)) continue;
    nearest = glm::dot(each.direction, z);
    along = each.right - each.direction;
  }
  along -= glm::dot(along, z) * z;
  if (!(glm::length(along) > 0)) along = std::fabs(z.x) < 0.7 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 y = glm::normalize(glm::cross(z, along));
  const Vec3 x = glm::cross(y, z);
  if (turn == LensTurn::centred) return {x, y, z};
  const double c = std::cos(kGoldenTurn), s = std::sin(kGoldenTurn);
  return {c * x + s * y, c * y - s * x, z};
}

// Pixels of the longest displacement that a step of tangents can make: 1 over the shorter axis of
// the ellipse that a circle of pixels has in tangents.
double magnification(const Vec2& at, const Vec2& right, const Vec2& below, double step) {
  const Vec2 a = (right - at) / step, b = (below - at) / step;
  const double squares = glm::dot(a, a) + glm::dot(b, b);
  const double area = a.x * b.y - a.y * b.x;
  const double rest = std::sqrt(std::max(0.0, squares * squares - 4 * area * area));
  // the smaller singular value, without a difference
  const double shorter = std::fabs(area) * std::sqrt(2 / (squares + rest));
  return shorter > 0 ? 1 / shorter : 0;
}

}  // namespace

std::optional<LensView> lens_view(const world::Camera& lens, const AxisRectangle& area, double rate,
                                  LensTurn turn, NoView& why) {
  const Rays rays = rays_of(lens, area);
  why = NoView::none;
  if (rays.points.empty()) return std::nullopt;
  why = NoView::wide;
  if (!(glm::length(rays.middle) > 0)) return std::nullopt;
  LensView view;
  view.lens_from_view = axes_of(rays, turn);
  const Mat3 view_from_lens = glm::transpose(view.lens_from_view);
  const double least = 1 / std::sqrt(1 + kWidestTangent * kWidestTangent);
  const auto tangents = [&](const Vec3& direction) {
    const Vec3 at = view_from_lens * direction;
    return Vec2(at) / at.z;
  };
  AxisRectangle field;
  double largest = 0;
  for (const Rays::Point& each : rays.points) {
    if (!((view_from_lens * each.direction).z > least)) return std::nullopt;
    const Vec2 at = tangents(each.direction);
    field.add(at);
    if (each.right != Vec3(0) && each.below != Vec3(0))
      largest = std::max(largest,
                         magnification(at, tangents(each.right), tangents(each.below), rays.step));
  }
  const double plain = std::max(lens.focal.x, lens.focal.y);
  const double focal = rate * (largest > 0 ? std::min(largest, kMostMagnification * plain) : plain);
  field.widen(kBend * field.longest() + kViewBorder / focal);
  world::Camera& camera = view.camera;
  camera = lens;
  camera.distortion = nullptr;
  camera.focal = Vec2(focal);
  // corners of pixels of an undistorted part fall on corners of texels
  const Vec2 phase = turn == LensTurn::none ? glm::fract(rate * lens.principal) : Vec2(0);
  camera.principal = glm::ceil(-focal * field.low - phase) + phase;
  const Vec2 size = glm::ceil(focal * field.high + camera.principal);
  if (!(size.x * size.y < 1e15)) return std::nullopt;
  camera.width = static_cast<std::uint32_t>(std::clamp(size.x, 1.0, 1e9));
  camera.height = static_cast<std::uint32_t>(std::clamp(size.y, 1.0, 1e9));
  camera.world_from_camera =
      turn == LensTurn::none
          ? lens.world_from_camera
          : glm::normalize(lens.world_from_camera * glm::quat_cast(view.lens_from_view));
  view.pixels = rays.share * (area.high.x - area.low.x) * (area.high.y - area.low.y);
  view.waste = size.x * size.y / std::max(rate * rate * view.pixels, 1.0);
  return view;
}

bool divide(const world::Camera& lens, const Tile& part, double rate, double most_texels,
            std::vector<LensPart>& parts) {
  const Vec2 low(part.x, part.y);
  const AxisRectangle area{low, low + Vec2(part.width, part.height)};
  const std::uint32_t longer = std::max(part.width, part.height);
  for (const LensTurn turn : {LensTurn::none, LensTurn::centred}) {
    NoView why = NoView::none;
    auto view = lens_view(lens, area, rate, turn, why);
    if (!view && why == NoView::none) return true;
    if (!view) continue;
    const double texels = static_cast<double>(view->camera.width) * view->camera.height;
    if (!(texels <= most_texels && std::max(view->camera.width, view->camera.height) <= 16384))
      continue;
    if (view->waste > kMuchWaste &&
        (longer >= 2 * kSmallPart || (texels > kManyTexels && longer >= 2 * kLeastPart)))
      continue;
    parts.push_back({part, *std::move(view)});
    return true;
  }
  if (longer < 2 * kLeastPart) return false;
  Tile first = part, second = part;
  if (part.width >= part.height) {
    first.width = part.width / 2;
    second.x += first.width;
    second.width -= first.width;
  } else {
    first.height = part.height / 2;
    second.y += first.height;
    second.height -= first.height;
  }
  return divide(lens, first, rate, most_texels, parts) &&
         divide(lens, second, rate, most_texels, parts);
}

AxisRectangle lens_area(const world::Camera& lens, const world::Pose& pose, const AxisBox& box) {
  const AxisRectangle everywhere{Vec2(-kInfinity), Vec2(kInfinity)};
  const Quat camera_from_world = glm::conjugate(lens.world_from_camera);
  const Vec3 offset = camera_from_world * (pose.translation - lens.position);
  const Mat3 turn = glm::mat3_cast(camera_from_world * pose.rotation);
  const Vec3 eye = glm::transpose(turn) * -offset;
  if (glm::all(glm::lessThanEqual(box.low, eye)) && glm::all(glm::lessThanEqual(eye, box.high)))
    return everywhere;
  AxisRectangle area;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < kFacePoints; ++i)
        for (int j = 0; j < kFacePoints; ++j) {
          Vec3 at;
          at[axis] = side ? box.high[axis] : box.low[axis];
          const int u = (axis + 1) % 3, v = (axis + 2) % 3;
          const auto between = [&](int k, int step) {
            return box.low[k] + (box.high[k] - box.low[k]) * step / (kFacePoints - 1.0);
          };
          at[u] = between(u, i);
          at[v] = between(v, j);
          const auto place = lens.distortion->place(turn * at + offset);
          if (!place) return everywhere;
          area.add(lens.focal * *place + lens.principal);
        }
  area.widen(kAreaSlack * area.longest());
  return area;
}

Tile touched_pixels(const world::Camera& lens, const AxisRectangle& area) {
  const Vec2 size(lens.width, lens.height);
  const Vec2 low = glm::clamp(glm::floor(area.low), Vec2(0), size);
  const Vec2 high = glm::clamp(glm::ceil(area.high), Vec2(0), size);
  if (!(high.x > low.x && high.y > low.y)) return {};
  return {static_cast<std::uint32_t>(low.x), static_cast<std::uint32_t>(low.y),
          static_cast<std::uint32_t>(high.x - low.x), static_cast<std::uint32_t>(high.y - low.y)};
}

}  // namespace panwright::preview
