#include "preview/frame/imposters.h"

#include <algorithm>
#include <optional>

namespace panwright::preview {
namespace {

// The golden angle of a lattice: its slope, and with it those along diagonals, are the numbers that
// fractions approximate worst.
const double kTurn = std::atan((std::sqrt(5.0) - 1) / 2);

// Where the centre lies among texels.
constexpr Vec2 kCentre(0.31, 0.13);

// Largest side of a target that has an imposter whatever its pixels' error is, pixels.
constexpr double kSmall = 100;
// What larger ones of few instances have of texels a pixel, where no photocentre is asked for.
constexpr double kSmoothRate = 2;
constexpr std::size_t kFewItems = 16;
// So many times the texels that they start with, those of more instances end with (measured).
constexpr std::uint32_t kMoreTexels = 7;
// So many times the texels of a disc's side are along the side of the box about a round target; a
// little more, so that few are drawn twice.
constexpr double kBoxOfDisc = 2;
// Targets share an imposter unless one is so many times as large as the other.
constexpr double kMuchLarger = 8;
// What a disc's boundary leaves of its area, relative, times the radius in texels to 3/2
// (reference: point lattices; measured by tests/preview/texel_areas_test.cpp).
constexpr double kDiscError = 0.29;
// The fewest along a side where there are many.
constexpr std::uint32_t kFewest = 32;

// Where a box falls on the image plane; nothing where it reaches behind the camera.
bool add_box(const world::Camera& camera, const PlacedBox& box, PlaneRect& rect) {
  const double c = std::cos(kTurn);
  const double s = std::sin(kTurn);
  for (const Vec3& corner : corners(box.low, box.high)) {
    Vec3 p(box.camera_from_mesh * Vec4(corner, 1));
    if (camera.projection == world::Projection::perspective) {
      if (!(p.z > 0)) return false;
      p /= p.z;
    }
    rect.add(Vec2(c * p.x + s * p.y, c * p.y - s * p.x));
  }
  return true;
}

std::uint32_t texels_of(double extent, const RenderOptions& options, double rate, bool tried) {
  return std::max(texels_for(flux_error_asked(options, tried)),
                  static_cast<std::uint32_t>(std::ceil(rate * extent)));
}

double tried_rate(const RenderOptions& options, std::size_t items) {
  return options.psf_sigma > 0 || items > kFewItems ? kImposterRate : kSmoothRate;
}

double pixels_of(const world::Camera& camera) { return std::max(camera.focal.x, camera.focal.y); }

}  // namespace

std::uint32_t texels_for(double flux_error) {
  const double texels = 2 * kBoxOfDisc * std::pow(kDiscError / flux_error, 2.0 / 3.0);
  return static_cast<std::uint32_t>(std::ceil(std::clamp(texels, 64.0, 16384.0)));
}

double flux_error_asked(const RenderOptions& options, bool tried) {
  return tried && !options.flux_error_of_large ? std::max(options.flux_error, options.pixel_error)
                                               : options.flux_error;
}

void place_imposter(const world::Camera& camera, Imposter& imposter) {
  const double c = std::cos(kTurn);
  const double s = std::sin(kTurn);
  const double focal = imposter.texels / imposter.rect.longest();
  const Vec2 centre = 0.5 * (imposter.rect.low + imposter.rect.high);
  // Even numbers of texels, one to spare on each side: the centre stands at one place among texels
  // whatever the numbers are; not on a corner, about which round targets would count fourfold.
  const Vec2 half = glm::ceil(0.5 * focal * (imposter.rect.high - imposter.rect.low) - 1e-6) + 1.0;
  world::Camera& own = imposter.camera;
  own = camera;
  own.width = static_cast<std::uint32_t>(2 * half.x);
  own.height = static_cast<std::uint32_t>(2 * half.y);
  own.focal = Vec2(focal);
  own.principal = half + kCentre - focal * centre;
  own.world_from_camera =
      camera.world_from_camera * Quat(std::cos(kTurn / 2), 0, 0, std::sin(kTurn / 2));
  imposter.plane = {centre - (half + kCentre) / focal, centre + (half - kCentre) / focal};
  const Vec2 corner = imposter.plane.low;
  imposter.origin = camera.focal * Vec2(c * corner.x - s * corner.y, s * corner.x + c * corner.y) +
                    camera.principal;
  imposter.along = camera.focal * Vec2(c, s) / focal;
  imposter.down = camera.focal * Vec2(-s, c) / focal;
}

// Merges imposters that overlap. Expects: sorted by the left sides of their rectangles.
bool ImposterFinder::merge_some(double pixels) {
  bool any = false;
  for (std::size_t i = 0; i < imposters_.size(); ++i) {
    Imposter& one = imposters_[i];
    for (std::size_t k = i + 1; k < imposters_.size() && one.extent > 0; ++k) {
      Imposter& other = imposters_[k];
      if (other.extent == 0) continue;  // merged into another one
      if (other.rect.low.x >= one.rect.high.x) break;
      if (!overlap(one.rect, other.rect) ||
          std::max(one.extent, other.extent) > kMuchLarger * std::min(one.extent, other.extent))
        continue;
      const double rate = std::max(one.rate(), other.rate());
      one.rect.add(other.rect);
      one.extent = pixels * one.rect.longest();
      one.texels = static_cast<std::uint32_t>(std::ceil(rate * one.extent));
      one.targets.insert(one.targets.end(), other.targets.begin(), other.targets.end());
      other.extent = 0;
      any = true;
    }
  }
  std::erase_if(imposters_, [](const Imposter& one) { return one.extent == 0; });
  return any;
}

// Expects: imposters_ and others_ are complete.
void ImposterFinder::add_tried() {
  const std::size_t settled = imposters_.size();
  for (Imposter& one : too_large_) {
    const auto overlaps = [&](const PlaneRect& rect) { return overlap(rect, one.rect); };
    // it is one of the others itself
    if (std::count_if(others_.begin(), others_.end(), overlaps) > 1 ||
        std::any_of(imposters_.begin(), imposters_.begin() + static_cast<std::ptrdiff_t>(settled),
                    [&](const Imposter& other) { return overlaps(other.rect); }))
      continue;
    one.tried = true;
    imposters_.push_back(std::move(one));
  }
}

std::span<Imposter> ImposterFinder::find(const world::Camera& camera, const VisibleSet& visible,
                                         const RenderOptions& options, std::uint32_t most_side) {
  imposters_.clear();
  others_.clear();
  too_large_.clear();
  if (options.imposters == Imposters::off) return {};
  const double pixels = pixels_of(camera);
  const double limit = (most_side - 4) / kImposterRate;
  const double largest = options.imposters == Imposters::always
                             ? limit
                             : std::min(limit, options.imposter_pixels.value_or(kSmall));
  for (std::uint32_t v = 0; v < visible.targets.size(); ++v) {
    Imposter one;
    bool before = true;
    for (const PlacedBox& box : visible.targets[v].boxes)
      before = before && add_box(camera, box, one.rect);
    one.extent = before ? pixels * one.rect.longest() : INFINITY;
    if (!before) one.rect = {Vec2(-INFINITY), Vec2(INFINITY)};
    one.targets.push_back(v);
    if (!(one.extent > 0 && one.extent <= largest)) {
      others_.push_back(one.rect);
      if (!(one.extent > 0 && one.extent <= limit)) continue;
      one.least_rate = tried_rate(options, visible.targets[v].items.size());
      one.texels = texels_of(one.extent, options, one.least_rate, true);
      too_large_.push_back(one);
      continue;
    }
    one.texels = texels_of(one.extent, options, one.least_rate, false);
    imposters_.push_back(std::move(one));
  }
  do
    std::sort(imposters_.begin(), imposters_.end(), [](const Imposter& a, const Imposter& b) {
      return a.rect.low.x != b.rect.low.x ? a.rect.low.x < b.rect.low.x : a.targets < b.targets;
    });
  while (merge_some(pixels));
  // a row of small ones may be long
  std::erase_if(imposters_, [&](const Imposter& one) {
    if (one.extent <= limit) return false;
    others_.push_back(one.rect);
    return true;
  });
  // for their pixels alone samples cost less; a PSF asks for photocentres
  const bool tries = options.flux_error_of_large || options.psf_sigma > 0;
  if (options.imposters == Imposters::automatic && !options.imposter_pixels && tries) add_tried();
  std::sort(imposters_.begin(), imposters_.end(), [](const Imposter& a, const Imposter& b) {
    return a.extent != b.extent ? a.extent > b.extent : a.targets < b.targets;
  });
  double all = 0;
  for (Imposter& one : imposters_) {
    std::sort(one.targets.begin(), one.targets.end());
    one.texels = std::min(one.texels, most_side - 4);
    all += static_cast<double>(one.texels) * one.texels;
  }
  const double share = std::sqrt(std::min(1.0, kMostTexels / std::max(all, 1.0)));
  for (Imposter& one : imposters_) {
    const double least = std::max<double>(kFewest, one.least_rate * one.extent);
    one.texels = static_cast<std::uint32_t>(
        std::ceil(std::max(share * one.texels, std::min<double>(least, one.texels))));
    std::size_t items = 0;
    for (const std::uint32_t v : one.targets) items += visible.targets[v].items.size();
    one.shadow_texels = items > kFewItems ? kMoreTexels * one.texels : 0;
    one.alone =
        one.tried || std::none_of(others_.begin(), others_.end(),
                                  [&](const PlaneRect& rect) { return overlap(rect, one.rect); });
  }
  return imposters_;
}

}  // namespace panwright::preview
