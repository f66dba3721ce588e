#include "sky/backdrop.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "sky/internal/blur.h"
#include "sky/internal/layer.h"

namespace panwright::sky {
namespace {

// Below this radius, pixels, a disc is the sum of its parts.
constexpr double kSmallDisc = 2;
// Parts of a pixel, along a side, are so small that a disc's radius has as many.
constexpr double kDiscSteps = 48;
constexpr int kMostSteps = 24;

// Rays about the centre of a pixel, world axes; linear in the offset from it, pixels.
struct PixelRays {
  Vec3 origin, origin_x{0}, origin_y{0};
  Vec3 ray, ray_x, ray_y;
};

// Of a camera's pixels, as world::distorted_ray().
class Rays {
 public:
  explicit Rays(const world::Camera& camera)
      : camera_(camera), axes_(glm::mat3_cast(camera.world_from_camera)) {}

  std::optional<PixelRays> at(double x, double y) const {
    PixelRays rays;
    rays.origin = camera_.position;
    const Vec2 plane = (Vec2(x, y) - camera_.principal) / camera_.focal;
    if (camera_.projection == world::Projection::orthographic) {
      rays.origin += axes_ * Vec3(plane, 0);
      rays.origin_x = axes_[0] / camera_.focal.x;
      rays.origin_y = axes_[1] / camera_.focal.y;
      rays.ray = axes_[2];
      return rays;
    }
    if (camera_.distortion == nullptr) {
      rays.ray = axes_ * Vec3(plane, 1);
      rays.ray_x = axes_[0] / camera_.focal.x;
      rays.ray_y = axes_[1] / camera_.focal.y;
      return rays;
    }
    const auto here = camera_.distortion->ray(plane);
    if (!here) return std::nullopt;
    rays.origin += axes_ * here->origin;
    rays.ray = axes_ * here->direction;
    rays.ray_x = slope(plane, {0.5 / camera_.focal.x, 0}, rays.ray);
    rays.ray_y = slope(plane, {0, 0.5 / camera_.focal.y}, rays.ray);
    return rays;
  }

 private:
  // over one pixel; one-sided at the end of the lens's domain
  Vec3 slope(const Vec2& plane, const Vec2& step, const Vec3& middle) const {
    const auto before = camera_.distortion->ray(plane - step);
    const auto after = camera_.distortion->ray(plane + step);
    if (before && after) return axes_ * (after->direction - before->direction);
    if (after) return 2.0 * (axes_ * after->direction - middle);
    return before ? 2.0 * (middle - axes_ * before->direction) : Vec3(0);
  }
  const world::Camera& camera_;
  Mat3 axes_;
};

// Area of the unit square about the origin where gradient·p + value > 0; gradient: unit.
double covered(double value, const Vec2& gradient) {
  const double a = std::max(std::fabs(gradient.x), std::fabs(gradient.y));
  const double b = std::min(std::fabs(gradient.x), std::fabs(gradient.y));
  if (b < 1e-6) return std::clamp(value / a + 0.5, 0.0, 1.0);
  const auto half_square = [](double t) { return t > 0 ? 0.5 * t * t : 0.0; };
  const double sum = 0.5 * (a + b), difference = 0.5 * (a - b);
  const double area = half_square(value + sum) - half_square(value + difference) -
                      half_square(value - difference) + half_square(value - sum);
  return std::clamp(area / (a * b), 0.0, 1.0);
}

// Colour of a part of a pixel, times the share that is covered.
struct Shade {
  Vec3 light{0};
  Vec3 cover{0};  // per band, since air dims
  void add(const Shade& other, const Vec3& weight) {
    light += weight * other.light;
    cover += weight * other.cover;
  }
};

bool is_open(const Vec3& cover) { return cover.x < 1 || cover.y < 1 || cover.z < 1; }

// A body, or the Sun as a unit sphere so far away that it is a disc of its size.
class Disc {
 public:
  Disc(const Sky& sky, std::optional<std::size_t> index, const Vec3& viewer)
      : sky_(&sky), index_(index) {
    if (index) {
      const Ellipsoid& shape = sky.shape(*index);
      unit_from_world_ = shape.unit_from_world;
      air_ = sky.air(*index);
      from_ = shape.from(viewer);
    } else {
      from_ = -sky.to_sun() / sky.sun_sine();
    }
    viewer_ = viewer;
  }

  double distance() const {
    const double units = std::sqrt(glm::dot(from_, from_));
    return index_ ? (units - 1) * sky_->shape(*index_).radius : HUGE_VAL;
  }
  // on the surface too, whatever was rounded
  bool outside() const { return glm::dot(from_, from_) >= 1 - 1e-9; }
  const light::Air* air() const { return air_; }
  const Vec3& from() const { return from_; }
  std::optional<std::size_t> index() const { return index_; }
  // towards the centre, world axes
  Vec3 toward() const { return index_ ? sky_->shape(*index_).centre - viewer_ : sky_->to_sun(); }

  // Of the square of side `size` pixels about an offset from a pixel's centre.
  Shade shade(const PixelRays& rays, const Vec2& offset, double size) const {
    Local at(*this, rays, offset);
    const bool in_air = air_ && glm::dot(at.from, at.from) < air_->top() * air_->top();
    if (!(at.ahead > 0)) return in_air ? air_shade(at) : Shade{};
    Vec2 gradient = -size * at.gradient();
    const double slope = std::sqrt(glm::dot(gradient, gradient));
    // distance to the limb in sides of the square, > 0 within
    const double inside = slope > 0 ? (1 - at.impact) / slope : (at.impact < 1 ? 1e9 : -1e9);
    if (inside > (air_ ? kHazy : 0.75)) return {radiance(at, size), Vec3(1)};
    if (slope > 0) gradient /= slope;
    Shade air;
    if (air_) {
      air = beside_limb(at.impact, inside, slope, gradient, rays, offset, size);
      add_hazy_ground(inside, gradient, rays, offset, size, air);
      return air;
    }
    if (inside < -0.75) return air;
    const double cover = covered(inside, gradient);
    if (!(cover > 0)) return air;
    // where a root of the distance to the limb has its mean
    const double place = 4.0 / 9 * cover;
    if (inside < 0.5 + place) {
      const Vec2 moved = offset + gradient * ((place - inside) * size);
      at = Local(*this, rays, moved);
    }
    air.add({radiance(at, size), Vec3(1)}, Vec3(cover));
    return air;
  }

  // Of a direction of the ellipsoid's space that misses the ground.
  Shade air_shade_of(const Vec3& from, const Vec3& ray) const {
    const light::AirLight light = sky_->air_light(*index_, from, ray);
    return {light.light, Vec3(1) - light.through};
  }

  // Depth along a boresight of the nearest place that a ray meets, or passes.
  double depth(const PixelRays& rays, const Vec3& boresight) const {
    if (!index_) return HUGE_VAL;
    const Local at(*this, rays, Vec2(0));
    const double square = glm::dot(at.ray, at.ray);
    const double impact = std::min(at.impact, 1.0);
    const double half = std::sqrt((1 - impact) * (1 + impact) * square);
    const double distance = std::sqrt(glm::dot(at.from, at.from));
    const double way =
        at.impact < 1 ? (distance - 1) * (distance + 1) / (at.ahead + half) : at.ahead / square;
    return glm::dot(rays.origin - viewer_ + way * at.world_ray, boresight);
  }

  // Radius in pixels, about.
  double pixel_radius(const PixelRays& rays) const {
    const Local at(*this, rays, Vec2(0));
    const Vec3 across = glm::cross(from_at(rays, Vec2(0)), unit(rays.ray_x));
    const Vec3 other = glm::cross(unit(rays.origin_x), unit(rays.ray));
    const double step =
        std::sqrt(glm::dot(across + other, across + other) / glm::dot(at.ray, at.ray));
    return step > 0 ? 1 / step : HUGE_VAL;
  }

  // Radiance of a place of the ellipsoid's space along a ray of the world.
  Vec3 radiance_at(const Vec3& place, const Vec3& ray, double footprint) const {
    const bool in_air = air_ && glm::dot(from_, from_) < air_->top() * air_->top();
    return sky_->radiance(*index_, place, -glm::normalize(ray), footprint,
                          in_air ? &from_ : nullptr);
  }

 private:
  // Half of the width of a unit square along a unit vector.
  static double reach_of(const Vec2& gradient) {
    return 0.5 * (std::fabs(gradient.x) + std::fabs(gradient.y));
  }
  static constexpr double kHazy = 4;  // pixels within the limb

  struct Local;
  Shade air_shade(const Local& at) const { return air_shade_of(at.from, at.world_ray); }

  // Ground below much air, which changes within a pixel: strips along the limb, as below.
  void add_hazy_ground(double inside, const Vec2& gradient, const PixelRays& rays,
                       const Vec2& offset, double size, Shade& sum) const {
    constexpr int kStrips = 6;
    const double reach = reach_of(gradient), low = std::max(-inside, -reach), range = reach - low;
    if (!(range > 0)) return;
    double before = covered(-low, gradient);
    for (int i = 0; i < kStrips; ++i) {
      // close to each other at the limb
      const auto place = [&](double t) { return low + range * t * t; };
      const double after = covered(-place((i + 1.0) / kStrips), gradient);
      const Vec2 moved = offset + gradient * (place((i + 0.5) / kStrips) * size);
      if (before > after)
        sum.add({radiance(Local(*this, rays, moved), size), Vec3(1)}, Vec3(before - after));
      before = after;
    }
  }

  // Air in the part of a square that lies beyond the limb: strips along it, by their areas. Names
  // are those of shade().
  Shade beside_limb(double impact, double inside, double slope, const Vec2& gradient,
                    const PixelRays& rays, const Vec2& offset, double size) const {
    if (!(slope > 0)) return impact < air_->top() ? air_shade(Local(*this, rays, offset)) : Shade{};
    const double reach = reach_of(gradient);
    const double low = std::max((impact - air_->top()) / slope, -reach);
    const double high = std::min(-inside, reach);
    Shade sum;
    if (!(high > low)) return sum;
    constexpr double kStrip = 0.02;  // of the air's height: a quarter of its scale
    const int strips = static_cast<int>(
        std::clamp(std::ceil((high - low) * slope / (kStrip * (air_->top() - 1))), 1.0, 96.0));
    double before = covered(-low, gradient);
    for (int i = 0; i < strips; ++i) {
      const double width = (high - low) / strips, middle = low + (i + 0.5) * width;
      const double after = covered(-(low + (i + 1) * width), gradient);
      if (before > after)
        sum.add(air_shade(Local(*this, rays, offset + gradient * (middle * size))),
                Vec3(before - after));
      before = after;
    }
    return sum;
  }

  Vec3 unit(const Vec3& v) const { return index_ ? unit_from_world_ * v : v; }
  Vec3 from_at(const PixelRays& rays, const Vec2& offset) const {
    // the Sun is as far from everywhere
    if (!index_) return from_;
    return from_ + unit_from_world_ * (rays.origin - viewer_ + offset.x * rays.origin_x +
                                       offset.y * rays.origin_y);
  }

  // A ray near the limb: how far it passes from the centre, in radii.
  struct Local {
    Vec3 from, ray, moment;
    Vec3 moment_x, moment_y, ray_x, ray_y;
    Vec3 world_ray;
    double impact, ahead;

    Local(const Disc& disc, const PixelRays& rays, const Vec2& offset)
        : from(disc.from_at(rays, offset)),
          ray_x(disc.unit(rays.ray_x)),
          ray_y(disc.unit(rays.ray_y)),
          world_ray(rays.ray + offset.x * rays.ray_x + offset.y * rays.ray_y) {
      ray = disc.unit(world_ray);
      moment = glm::cross(from, ray);
      moment_x = glm::cross(from, ray_x);
      moment_y = glm::cross(from, ray_y);
      if (disc.index_) {
        moment_x += glm::cross(disc.unit_from_world_ * rays.origin_x, ray);
        moment_y += glm::cross(disc.unit_from_world_ * rays.origin_y, ray);
      }
      impact = std::sqrt(glm::dot(moment, moment) / glm::dot(ray, ray));
      ahead = -glm::dot(from, ray);
    }
    // of the impact, per pixel
    Vec2 gradient() const {
      const double square = glm::dot(ray, ray);
      const double scale = 1 / std::max(impact * square, 1e-300);
      return Vec2(glm::dot(moment, moment_x) - impact * impact * glm::dot(ray, ray_x),
                  glm::dot(moment, moment_y) - impact * impact * glm::dot(ray, ray_y)) *
             scale;
    }
  };

  Vec3 radiance(const Local& at, double size) const {
    const double square = std::min(at.impact * at.impact, 1.0);
    if (!index_) return sky_->sun_radiance(square);
    // the nearest of both points of the ray
    const double length = std::sqrt(glm::dot(at.ray, at.ray));
    const double rise = std::sqrt((1 - square) > 0 ? 1 - square : 0);
    const Vec3 direction = at.ray / length;
    // the foot of the centre on the ray, without its large part along the ray
    const Vec3 foot = glm::cross(direction, glm::cross(at.from, direction));
    const Vec3 place = glm::normalize(foot - rise * direction);
    const double pixel = std::sqrt(glm::dot(at.moment_x, at.moment_x)) / length;
    const double footprint = size * pixel / std::max(rise, 0.1);
    return radiance_at(place, at.world_ray, footprint);
  }

  const Sky* sky_;
  std::optional<std::size_t> index_;  // none: the Sun
  const light::Air* air_ = nullptr;   // null: none
  Mat3 unit_from_world_{1};
  Vec3 from_, viewer_;
};

// A disc of less than some pixels: sums of its parts in these.
struct SmallDisc {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
  std::vector<Shade> shades;
  const Shade* at(std::uint32_t column, std::uint32_t row) const {
    if (column < x || row < y || column >= x + width || row >= y + height) return nullptr;
    return &shades[std::size_t{row - y} * width + column - x];
  }
};

class Painter {
 public:
  Painter(const Sky& sky, const world::Camera& camera) : sky_(sky), camera_(camera), rays_(camera) {
    for (std::size_t i = 0; i < sky.size(); ++i) discs_.emplace_back(sky, i, camera.position);
    if (sky.sun_visible()) discs_.emplace_back(sky, std::nullopt, camera.position);
    std::erase_if(discs_, [](const Disc& disc) { return !disc.outside(); });
    std::ranges::stable_sort(
        discs_, [](const Disc& a, const Disc& b) { return a.distance() < b.distance(); });
    for (const Disc& disc : discs_) prepare(disc);
  }

  bool empty() const { return discs_.empty(); }

  // What stands before a depth, or behind it.
  struct Part {
    bool before = false;
    double depth = -HUGE_VAL;
  };

  Shade pixel(std::uint32_t column, std::uint32_t row, const Part& part) const {
    const Vec3 boresight = glm::mat3_cast(camera_.world_from_camera)[2];
    Shade sum;
    std::optional<PixelRays> rays;
    for (std::size_t i = 0; i < discs_.size() && is_open(sum.cover); ++i) {
      Shade shade;
      const Shade* small = small_[i] ? small_[i]->at(column, row) : nullptr;
      if (small_[i] && small == nullptr) continue;
      const bool sided = part.before || part.depth > -HUGE_VAL;
      if (!rays && (sided || !small)) rays = rays_.at(column + 0.5, row + 0.5);
      if (!rays && !small) return {};
      if (sided && rays && (discs_[i].depth(*rays, boresight) < part.depth) != part.before)
        continue;
      shade = small ? *small : shade_of(i, *rays);
      sum.add(shade, Vec3(1) - sum.cover);
    }
    return sum;
  }

 private:
  void prepare(const Disc& disc) {
    std::optional<SmallDisc> small;
    int steps = 1;
    double radius = HUGE_VAL;
    std::optional<Vec2> middle;
    if (camera_.projection == world::Projection::orthographic) {
      if (const auto rays = rays_.at(camera_.principal.x, camera_.principal.y))
        radius = disc.pixel_radius(*rays);
    } else {
      // at a distance that is safe in double, along the direction
      middle = world::project(camera_, camera_.position + glm::normalize(disc.toward()));
      if (middle)
        if (const auto rays = rays_.at(middle->x, middle->y)) radius = disc.pixel_radius(*rays);
    }
    steps = static_cast<int>(std::clamp(std::ceil(kDiscSteps / radius), 1.0, double(kMostSteps)));
    if (middle && radius < kSmallDisc) small = splat(disc, *middle, radius);
    small_.push_back(std::move(small));
    steps_.push_back(steps);
  }

  Shade shade_of(std::size_t i, const PixelRays& rays) const {
    const int steps = steps_[i];
    if (steps == 1) return discs_[i].shade(rays, Vec2(0), 1);
    Shade sum;
    const double size = 1.0 / steps;
    for (int y = 0; y < steps; ++y)
      for (int x = 0; x < steps; ++x)
        sum.add(discs_[i].shade(rays, Vec2(x + 0.5, y + 0.5) * size - 0.5, size),
                Vec3(size * size));
    return sum;
  }

  // Adds the parts of a disc to their pixels: flux by flux, so that none is lost.
  SmallDisc splat(const Disc& disc, const Vec2& middle, double radius) const;
  void splat_air(const Disc& disc, SmallDisc& result) const;
  // A part of a disc, by its direction and solid angle.
  void splat_part(const Vec3& toward, double solid, const Shade& part, SmallDisc& result) const;

  const Sky& sky_;
  const world::Camera& camera_;
  Rays rays_;
  std::vector<Disc> discs_;
  std::vector<std::optional<SmallDisc>> small_;
  std::vector<int> steps_;
};

SmallDisc Painter::splat(const Disc& disc, const Vec2& middle, double radius) const {
  SmallDisc result;
  const Vec2 size(camera_.width, camera_.height);
  const Vec2 low = glm::clamp(glm::floor(middle - radius - 2.0), Vec2(0), size);
  const Vec2 high = glm::clamp(glm::ceil(middle + radius + 2.0), Vec2(0), size);
  result.x = static_cast<std::uint32_t>(low.x);
  result.y = static_cast<std::uint32_t>(low.y);
  result.width = static_cast<std::uint32_t>(high.x - low.x);
  result.height = static_cast<std::uint32_t>(high.y - low.y);
  result.shades.resize(std::size_t{result.width} * result.height);
  if (result.shades.empty()) return result;
  constexpr int kRings = 64, kSectors = 64;
  const Vec3 from = disc.from();
  const double distance = std::sqrt(glm::dot(from, from));
  if (!(distance > 1)) return result;
  const Vec3 axis = -from / distance;
  const Vec3 x =
      glm::normalize(glm::cross(axis, std::fabs(axis.z) < 0.6 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
  const Vec3 y = glm::cross(axis, x);
  const double cosine = std::sqrt((distance - 1) * (distance + 1)) / distance;
  const double height = 1 / (distance * distance) / (1 + cosine);
  for (int ring = 0; ring < kRings; ++ring) {
    const double h = height * (ring + 0.5) / kRings;
    const double across = std::sqrt(h * (2 - h)), along = 1 - h;
    const double square = std::min(1.0, distance * across * distance * across);
    for (int sector = 0; sector < kSectors; ++sector) {
      const det::SinCos turn = det::sincos(2 * kPi * (sector + 0.5) / kSectors);
      const Vec3 ray = along * axis + across * (turn.cos * x + turn.sin * y);
      Vec3 toward = ray;
      double solid = 2 * kPi * height / (kRings * kSectors);
      Vec3 light;
      if (disc.index()) {
        const Ellipsoid& shape = sky_.shape(*disc.index());
        toward = shape.world_from_unit * ray;
        const double stretch = std::sqrt(glm::dot(toward, toward));
        solid *= shape.volume / (stretch * stretch * stretch);
        const Vec3 foot = glm::cross(ray, glm::cross(from, ray));
        light = disc.radiance_at(glm::normalize(foot - std::sqrt(1 - square) * ray), toward, 0.05);
      } else {
        light = sky_.sun_radiance(square);
      }
      splat_part(toward, solid, {light, Vec3(1)}, result);
    }
  }
  if (disc.air()) splat_air(disc, result);
  for (Shade& shade : result.shades) shade.cover = glm::min(shade.cover, Vec3(1));
  return result;
}

void Painter::splat_part(const Vec3& toward, double solid, const Shade& part,
                         SmallDisc& result) const {
  const auto place = world::project(camera_, camera_.position + glm::normalize(toward));
  if (!place) return;
  const Vec2 pixel = glm::floor(*place) - Vec2(result.x, result.y);
  if (!(pixel.x >= 0 && pixel.y >= 0 && pixel.x < result.width && pixel.y < result.height)) return;
  const auto column = static_cast<std::uint32_t>(pixel.x);
  const auto row = static_cast<std::uint32_t>(pixel.y);
  const double all = world::pixel_solid_angle(camera_, result.x + column, result.y + row);
  if (!(all > 0)) return;
  result.shades[std::size_t{row} * result.width + column].add(part, Vec3(solid / all));
}

// The ring of air about a small disc.
void Painter::splat_air(const Disc& disc, SmallDisc& result) const {
  constexpr int kRings = 32, kSectors = 64;
  const Vec3 from = disc.from();
  const double distance = std::sqrt(glm::dot(from, from)), top = disc.air()->top();
  const Vec3 axis = -from / distance;
  const Vec3 x =
      glm::normalize(glm::cross(axis, std::fabs(axis.z) < 0.6 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
  const Vec3 y = glm::cross(axis, x);
  const Ellipsoid& shape = sky_.shape(*disc.index());
  for (int ring = 0; ring < kRings; ++ring) {
    const double t = (ring + 0.5) / kRings, beside = 1 + (top - 1) * t * t;
    const double across = beside / distance;
    const double along = std::sqrt((1 - across) * (1 + across));
    // 2·pi·sin·d(sin)/cos
    const double annulus =
        2 * kPi * across / along * ((top - 1) * 2 * t / kRings) / distance / kSectors;
    for (int sector = 0; sector < kSectors; ++sector) {
      const det::SinCos turn = det::sincos(2 * kPi * (sector + 0.5) / kSectors);
      const Vec3 toward =
          shape.world_from_unit * (along * axis + across * (turn.cos * x + turn.sin * y));
      const double stretch = std::sqrt(glm::dot(toward, toward));
      splat_part(toward, annulus * shape.volume / (stretch * stretch * stretch),
                 disc.air_shade_of(from, toward), result);
    }
  }
}

}  // namespace

Layer layer(const Sky& sky, const world::Camera& camera, double psf_sigma,
            const std::vector<float>* depths, bool before, const Job& job,
            const std::vector<float>* coverage) {
  const auto margin = psf_sigma > 0 ? static_cast<std::uint32_t>(std::ceil(5 * psf_sigma)) + 1 : 0u;
  world::Camera wide = camera;
  wide.width += 2 * margin;
  wide.height += 2 * margin;
  wide.principal += static_cast<double>(margin);
  const Painter painter(sky, wide);
  Layer result;
  result.light.resize(std::size_t{3} * wide.width * wide.height);
  if (depths) result.cover.resize(result.light.size());
  const auto part_of = [&](std::uint32_t column, std::uint32_t row) {
    if (!depths) return Painter::Part{};
    const std::uint32_t x = column - margin, y = row - margin;
    // beyond the image there are no targets
    const bool within = x < camera.width && y < camera.height;
    return Painter::Part{before, within ? (*depths)[std::size_t{y} * camera.width + x] : 0};
  };
  const auto paint = [&](std::size_t row) {
    for (std::uint32_t column = 0; column < wide.width; ++column) {
      const auto line = static_cast<std::uint32_t>(row);
      if (margin == 0 && coverage && !((*coverage)[row * wide.width + column] < 1)) continue;
      const Shade shade = painter.pixel(column, line, part_of(column, line));
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t at = 3 * (row * wide.width + column) + k;
        result.light[at] = static_cast<float>(shade.light[static_cast<int>(k)]);
        if (depths) result.cover[at] = static_cast<float>(shade.cover[static_cast<int>(k)]);
      }
    }
  };
  if (!painter.empty()) parallel_for(wide.height, paint, job);
  if (margin == 0) return result;
  const std::vector<double> kernel = kernel_of_psf(psf_sigma, margin);
  const std::size_t width = wide.width, height = wide.height;
  std::vector<float> rows(3 * std::size_t{camera.width} * height);
  for (std::vector<float>* pixels : {&result.light, &result.cover}) {
    if (pixels->empty()) continue;
    convolve(*pixels, height, width, 3, 3 * width, kernel, rows, 3, std::size_t{3} * camera.width);
    pixels->assign(3 * std::size_t{camera.width} * camera.height, 0);
    convolve(rows, camera.width, height, std::size_t{3} * camera.width, 3, kernel, *pixels,
             std::size_t{3} * camera.width, 3);
  }
  return result;
}

std::vector<float> backdrop(const Sky& sky, const world::Camera& camera, double psf_sigma,
                            const Job& job, const std::vector<float>* coverage) {
  return layer(sky, camera, psf_sigma, nullptr, false, job, coverage).light;
}

}  // namespace panwright::sky
