#include "labels/internal/ground_bits.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace panwright::labels {

namespace {

constexpr std::uint64_t kWhole = ~std::uint64_t{0};
constexpr int kBlock = 8;  // squares

// Tangents of the planes through an axis that touch a sphere; none: it is not before the camera.
std::optional<std::pair<double, double>> tangents(double across, double ahead, double radius) {
  const double distance = std::sqrt(across * across + ahead * ahead);
  if (!(distance > radius)) return std::nullopt;
  const double middle = det::atan2(across, ahead), half = det::asin(radius / distance);
  constexpr double kMost = 89.9 * kDegree;
  if (!(middle - half > -kMost && middle + half < kMost)) return std::nullopt;
  const auto tangent = [](double angle) { return det::sin(angle) / det::cos(angle); };
  return std::pair(tangent(middle - half), tangent(middle + half));
}

// Whether the terrain is at the corners of squares, each found once.
class Corners {
 public:
  Corners(const Shown& shown, std::uint32_t target, const Region& region, const SampleBits& bits)
      : shown_(shown),
        target_(target),
        region_(region),
        bits_(bits),
        known_(static_cast<std::size_t>(bits.width + 1) * static_cast<std::size_t>(bits.height + 1),
               kUnknown) {}

  bool meets(const Vec2& place) const {
    const auto ray = shown_.plane.view_ray(place);
    return ray && shown_.scene.meets_ground(target_, *ray);
  }

  bool at(int x, int y) {
    char& known =
        known_[static_cast<std::size_t>(y - bits_.top) * static_cast<std::size_t>(bits_.width + 1) +
               static_cast<std::size_t>(x - bits_.left)];
    if (known == kUnknown)
      known = meets(Vec2(region_.left, region_.top) + Vec2(x, y) / region_.scale) ? 1 : 0;
    return known != 0;
  }

  // Of the corners of a rectangle; nothing: they differ.
  std::optional<bool> of(int left, int top, int right, int bottom) {
    const bool first = at(left, top);
    if (at(right, top) != first || at(left, bottom) != first || at(right, bottom) != first)
      return std::nullopt;
    return first;
  }

 private:
  static constexpr char kUnknown = 2;
  const Shown& shown_;
  std::uint32_t target_;
  const Region& region_;
  const SampleBits& bits_;
  std::vector<char> known_;
};

// True: the pixel and all around it show the target in the image.
bool is_inside(const Shown& shown, std::uint32_t target, const Region& region, int x, int y) {
  const image::Image* layers = shown.layers;
  if (layers == nullptr || region.scale != 1) return false;
  const int column = static_cast<int>(region.left) + x, row = static_cast<int>(region.top) + y;
  const int width = static_cast<int>(layers->width), height = static_cast<int>(layers->height);
  if (column < 1 || row < 1 || column >= width - 1 || row >= height - 1) return false;
  for (int j = row - 1; j <= row + 1; ++j)
    for (int i = column - 1; i <= column + 1; ++i)
      if (layers->target_id[static_cast<std::size_t>(j) * layers->width +
                            static_cast<std::size_t>(i)] != target + 1)
        return false;
  return true;
}

}  // namespace

std::optional<AxisRectangle> ground_rectangle(const trace::Scene& scene, std::uint32_t target,
                                              const ImagePlane& plane) {
  if (plane.distorted()) return std::nullopt;
  const trace::Affine camera_from_model = scene.observer_from(target);
  const trace::Target& traced = *scene.targets()[target].target;
  double radius = 0;
  for (const terrain::ChartRecord& chart : traced.ground()->tiles().charts())
    if (chart.radius > 0)
      radius =
          std::max(radius, std::max(chart.radius, chart.polar_radius) + std::max(chart.high, 0.0));
  AxisRectangle out;
  if (radius > 0 && !plane.orthographic()) {
    const Vec3 centre = camera_from_model.offset;
    const auto x = tangents(centre.x, centre.z, radius), y = tangents(centre.y, centre.z, radius);
    if (!x || !y) return std::nullopt;
    out.add(*plane.place(Vec3(x->first, y->first, 1)));
    out.add(*plane.place(Vec3(x->second, y->second, 1)));
    return out;
  }
  const AxisBox& box = traced.bounds();
  for (int corner = 0; corner < 8; ++corner) {
    const auto at = plane.place(camera_from_model(Vec3(corner & 1 ? box.high.x : box.low.x,
                                                       corner & 2 ? box.high.y : box.low.y,
                                                       corner & 4 ? box.high.z : box.low.z)));
    if (!at) return std::nullopt;
    out.add(*at);
  }
  return out;
}

void draw_ground(const Shown& shown, std::uint32_t target, const Region& region, SampleBits& bits) {
  Corners corners(shown, target, region, bits);
  const int right = bits.left + bits.width, bottom = bits.top + bits.height;
  const Vec2 low = region.local(Vec2(0)),
             high = region.local(Vec2(shown.plane.camera().width, shown.plane.camera().height));
  const auto square = [&](int x, int y) {
    std::uint64_t& word = bits.words[bits.index(x, y)];
    if (is_inside(shown, target, region, x, y)) {
      word = kWhole;
      return;
    }
    if (const auto all = corners.of(x, y, x + 1, y + 1)) {
      if (*all) word = kWhole;
      return;
    }
    for (unsigned bit = 0; bit < 64; ++bit)
      if (corners.meets(region.place(x, y, bit))) word |= std::uint64_t{1} << bit;
  };
  for (int y = bits.top; y < bottom; y += kBlock)
    for (int x = bits.left; x < right; x += kBlock) {
      const int x1 = std::min(x + kBlock, right), y1 = std::min(y + kBlock, bottom);
      const bool outside = x1 <= low.x || x >= high.x || y1 <= low.y || y >= high.y;
      const auto all = outside ? corners.of(x, y, x1, y1) : std::nullopt;
      for (int j = y; j < y1; ++j)
        for (int i = x; i < x1; ++i) {
          if (!all)
            square(i, j);
          else if (*all)
            bits.words[bits.index(i, j)] = kWhole;
        }
    }
}

}  // namespace panwright::labels
