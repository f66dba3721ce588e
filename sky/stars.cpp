#include "sky/stars.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "light/light.h"
#include "sky/internal/pixel_shares.h"
#include "sky/internal/solid_angles.h"

namespace panwright::sky {
namespace {

constexpr double kLightSpeed = 299792458;  // m/s
constexpr double kSunColour = 0.65;        // B − V

// The smallest cosine of the angle between the boresight and what may fall on the image, by the
// rays of its border; -2: anything may.
double cone_of(const world::Camera& camera, double margin) {
  constexpr int kPoints = 32;  // along a side
  double smallest = 1;
  const double width = camera.width + 2 * margin;
  const double height = camera.height + 2 * margin;
  for (int i = 0; i <= kPoints; ++i) {
    const double x = width * i / kPoints - margin;
    const double y = height * i / kPoints - margin;
    for (const Vec2& pixel :
         {Vec2(x, -margin), Vec2(x, height - margin), Vec2(-margin, y), Vec2(width - margin, y)}) {
      const auto ray = world::distorted_ray(camera, pixel);
      if (!ray) return -2;  // the lens ends inside the image
      smallest = std::min(smallest, ray->direction.z);
    }
  }
  // note: directions lean less than between neighbouring rays of the border, hence the slack
  return smallest > 0 ? smallest - 0.01 * (1.001 - smallest) : -2;
}

// What draws points of light: buffers for a line of pixels, and what they have in common.
class PointDrawer {
 public:
  PointDrawer(const world::Camera& camera, double psf_sigma, std::size_t points,
              image::Image& image)
      : image_(image), psf_sigma_(psf_sigma), shares_(psf_sigma, 2 * points), angles_(camera) {}

  // Says which point add() comes to after the next one. Meanwhile its pixels are loaded, a row with
  // each row that is drawn: most of the time went into waiting for them.
  void load_next(const Vec2& pixel) {
    const double reach = kReach * psf_sigma_;
    const auto at = [](double place, std::uint32_t side) {
      return static_cast<std::int64_t>(std::clamp(place, 0.0, static_cast<double>(side) - 1));
    };
    next_ = {at(pixel.x - reach, image_.width), at(pixel.x + reach, image_.width),
             at(pixel.y - reach, image_.height), at(pixel.y + reach, image_.height)};
    const std::int64_t middle = at(pixel.y, image_.height) * std::int64_t{image_.width};
    __builtin_prefetch(image_.coverage.data() + middle + at(pixel.x, image_.width));
  }

  void add(const Vec2& pixel, const Vec3& irradiance) {
    constexpr float kMost = 1e30f;  // of radiance: floats stay finite
    const auto width = static_cast<std::int64_t>(image_.width);
    const auto height = static_cast<std::int64_t>(image_.height);
    shares_.find(pixel.x, across_);
    shares_.find(pixel.y, down_);
    const auto end_of = [](const Shares& shares) {
      return shares.first + static_cast<std::int64_t>(shares.of.size()) - 1;
    };
    const std::int64_t first[] = {std::max<std::int64_t>(across_.first, 0),
                                  std::max<std::int64_t>(down_.first, 0)};
    const std::int64_t last[] = {std::min(end_of(across_), width - 1),
                                 std::min(end_of(down_), height - 1)};
    if (first[0] > last[0] || first[1] > last[1]) return;
    angles_.begin(first, last);
    const double reach = kReach * psf_sigma_;
    for (std::int64_t y = first[1]; y <= last[1]; ++y) {
      load_row();
      // what lies within the reach of the row
      const double off = std::max(std::fabs(static_cast<double>(y) + 0.5 - pixel.y) - 0.5, 0.0);
      const double half = std::sqrt(std::max(reach * reach - off * off, 0.0));
      const auto from = std::max(static_cast<std::int64_t>(std::floor(pixel.x - half)), first[0]);
      const auto to = std::min(static_cast<std::int64_t>(std::floor(pixel.x + half)), last[0]);
      if (from > to) continue;
      const double* shares = &across_.of[static_cast<std::size_t>(from - across_.first)];
      const Vec3 along = irradiance * down_.of[static_cast<std::size_t>(y - down_.first)];
      const float bands[] = {static_cast<float>(along.x), static_cast<float>(along.y),
                             static_cast<float>(along.z)};
      float* radiance = &image_.radiance[3 * static_cast<std::size_t>(y * width + from)];
      angles_.for_row(
          from, y, static_cast<std::size_t>(to - from + 1), [&](std::size_t x, auto inverse) {
            const float share = static_cast<float>(shares[x]) * static_cast<float>(inverse);
            for (const float band : bands) *radiance++ += std::min(band * share, kMost);
          });
    }
  }

 private:
  void load_row() {
    constexpr std::int64_t kLine = 16;  // floats of a cache's line
    if (next_.y > next_.end) return;
    const float* row =
        image_.radiance.data() + 3 * next_.y++ * static_cast<std::int64_t>(image_.width);
    for (std::int64_t x = 3 * next_.from; x < 3 * (next_.to + 1) + kLine; x += kLine)
      __builtin_prefetch(row + std::min(x, 3 * next_.to + 2), 1);
  }

  image::Image& image_;
  double psf_sigma_;
  // Columns and rows to be loaded.
  struct {
    std::int64_t from = 0, to = -1, y = 0, end = -1;
  } next_;
  PixelShares shares_;
  InverseAngles angles_;
  Shares across_, down_;
};

}  // namespace

Vec3 apparent_direction(const Star& star, double years, const Vec3& velocity) {
  const Vec3 u = glm::normalize(star.direction + years * star.motion);
  const Vec3 b = velocity / kLightSpeed;
  const double square = glm::dot(b, b);
  assert(square < 1);
  if (square == 0) return u;
  const double g = 1 / std::sqrt(1 - square);
  const double along = glm::dot(b, u);
  return glm::normalize((u / g + b + (g / (g + 1) * along) * b) / (1 + along));
}

Vec3 star_irradiance(double v, double b_v) {
  constexpr double kSunV = -26.76;  // Willmer 2018
  const double colour = std::isnan(b_v) ? kSunColour : b_v;
  const auto power = [](double fainter) { return det::exp(-0.4 * std::numbers::ln10 * fainter); };
  const double redder = colour - kSunColour;
  return light::kSolarIrradiance *
         Vec3(power(v - kSunV - 0.55 * redder), power(v - kSunV), power(v - kSunV + redder));
}

std::vector<StarInView> stars_in_view(const light::Stars& stars, const world::Camera& camera,
                                      double margin) {
  std::vector<StarInView> found;
  if (!stars.catalogue || camera.projection != world::Projection::perspective) return found;
  const StarCatalogue& catalogue = *stars.catalogue;
  world::Camera still = camera;  // its axes are those of the world, and stars are far
  still.position = Vec3(0);
  still.world_from_camera = Quat(1, 0, 0, 0);
  const double cone = cone_of(still, margin);
  const Mat3 camera_from_icrs =
      glm::mat3_cast(glm::conjugate(camera.world_from_camera) * stars.world_from_icrs);
  const Vec3 boresight(camera_from_icrs[0].z, camera_from_icrs[1].z, camera_from_icrs[2].z);
  const double years = stars.year - catalogue.epoch;
  // aberration turns by less, so most stars are told by where they are without it
  const double least = cone - 2 * glm::length(stars.velocity) / kLightSpeed - 1e-9;
  for (std::size_t i = 0; i < catalogue.stars.size(); ++i) {
    const Star& star = catalogue.stars[i];
    if (star.v > stars.faintest) break;
    const Vec3 moved = star.direction + years * star.motion;
    const double along = glm::dot(boresight, moved);
    if (least > 0 && (along < 0 || along * along < least * least * glm::dot(moved, moved)))
      continue;
    const Vec3 direction = apparent_direction(star, years, stars.velocity);
    if (glm::dot(boresight, direction) < cone) continue;
    const auto pixel = world::project(still, camera_from_icrs * direction);
    if (!pixel || !(pixel->x >= -margin && pixel->x < camera.width + margin &&
                    pixel->y >= -margin && pixel->y < camera.height + margin))
      continue;
    found.push_back(
        {i, stars.world_from_icrs * direction, *pixel, star_irradiance(star.v, star.b_v)});
  }
  return found;
}

void remove_hidden(const Sky& sky, const Vec3& camera, std::vector<StarInView>& stars) {
  for (std::size_t i = 0; i < sky.size(); ++i) {
    const Ellipsoid& shape = sky.shape(i);
    const Vec3 to_centre = -shape.from(camera);
    if (glm::dot(to_centre, to_centre) < 1 - 1e-9) continue;  // a body that the camera is in
    std::erase_if(stars, [&](const StarInView& star) {
      const Vec3 along = shape.unit_from_world * star.direction;
      const Vec3 across = glm::cross(to_centre, along);
      return glm::dot(to_centre, along) > 0 && glm::dot(across, across) < glm::dot(along, along);
    });
    if (sky.air(i) == nullptr) continue;
    for (StarInView& star : stars)
      star.irradiance *= sky.air_light(i, -to_centre, star.direction).through;
  }
}

void add_point(const Vec2& pixel, const Vec3& irradiance, const world::Camera& camera,
               double psf_sigma, image::Image& image) {
  PointDrawer(camera, psf_sigma, 1, image).add(pixel, irradiance);
}

void add_stars(std::span<const StarInView> stars, const world::Camera& camera, double psf_sigma,
               const Vec3& unit, image::Image& image) {
  assert(image.width == camera.width && image.height == camera.height);
  const auto width = static_cast<std::int64_t>(image.width);
  const auto height = static_cast<std::int64_t>(image.height);
  // from the top of the image to its bottom, by bands that caches hold
  constexpr std::int64_t kBand = 16;
  const auto row_of = [&](const StarInView& star) {
    return std::clamp(static_cast<std::int64_t>(std::floor(star.pixel.y)), std::int64_t{0},
                      height - 1);
  };
  std::vector<std::size_t> next(static_cast<std::size_t>(height / kBand + 2), 0);
  for (const StarInView& star : stars) ++next[static_cast<std::size_t>(row_of(star) / kBand) + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<const StarInView*> order(stars.size());
  for (const StarInView& star : stars)
    order[next[static_cast<std::size_t>(row_of(star) / kBand)]++] = &star;
  PointDrawer drawer(camera, psf_sigma, stars.size(), image);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const StarInView* star = order[i];
    if (i + 1 < order.size()) drawer.load_next(order[i + 1]->pixel);
    // where the centre is outside, the nearest pixel says what is in front of it
    const auto column = std::clamp(static_cast<std::int64_t>(std::floor(star->pixel.x)),
                                   std::int64_t{0}, width - 1);
    const auto at = static_cast<std::size_t>(row_of(*star) * width + column);
    const double open = 1 - static_cast<double>(image.coverage[at]);
    if (open > 0) drawer.add(star->pixel, open * star->irradiance / unit);
  }
}

void add_stars(const Sky& sky, const light::Stars& stars, const world::Camera& camera,
               double psf_sigma, image::Image& image) {
  std::vector<StarInView> seen = stars_in_view(stars, camera, kReach * psf_sigma);
  remove_hidden(sky, camera.position, seen);
  add_stars(seen, camera, psf_sigma, image.unit == "1/sr" ? light::kSolarIrradiance : Vec3(1),
            image);
}

}  // namespace panwright::sky
