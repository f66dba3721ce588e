#include "sky/stars.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "light/light.h"

namespace panwright::sky {
namespace {

constexpr double kLightSpeed = 299792458;  // m/s
constexpr double kReach = 6;               // sigmas of a Gaussian: 2e-9 lie beyond
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

// Integrals of a Gaussian about a centre over pixels from `first` on.
struct Shares {
  std::int64_t first = 0;
  std::vector<double> of;
};

Shares shares_of(double centre, double sigma) {
  Shares out;
  if (sigma == 0) return {static_cast<std::int64_t>(std::floor(centre)), {1}};
  out.first = static_cast<std::int64_t>(std::floor(centre - kReach * sigma));
  const auto last = static_cast<std::int64_t>(std::floor(centre + kReach * sigma));
  const double scale = 1 / (sigma * std::sqrt(2.0));
  double before = std::erf((static_cast<double>(out.first) - centre) * scale);
  for (std::int64_t pixel = out.first; pixel <= last; ++pixel) {
    const double after = std::erf((static_cast<double>(pixel + 1) - centre) * scale);
    out.of.push_back(0.5 * (after - before));
    before = after;
  }
  return out;
}

// Solid angles of the pixels of a rectangle in an image. A tenth pixel decides whether a surface of
// second order through nine of them has them; if not, each is computed.
class SolidAngles {
 public:
  // Pixels from `first` to `last`, these included.
  SolidAngles(const world::Camera& camera, const std::int64_t (&first)[2],
              const std::int64_t (&last)[2])
      : camera_(camera), first_(first[0]) {
    constexpr std::int64_t kFew = 6;  // on a side: not worth it
    if (last[0] - first[0] < kFew || last[1] - first[1] < kFew) return;
    for (int k = 0; k < 2; ++k) {
      node_[k][0] = first[k];
      node_[k][1] = (first[k] + last[k]) / 2;
      node_[k][2] = last[k];
    }
    bool all = true;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) all = all && (value_[j][i] = exact(node_[0][i], node_[1][j])) > 0;
    constexpr double kSmooth = 1e-7;  // relative: about that of a float
    const std::int64_t x = first[0] + 1, y = first[1] + 1;
    const double between = exact(x, y);
    smooth_ = all && std::fabs(by_nodes(x, y) - between) <= kSmooth * between;
    if (!smooth_) return;
    for (std::int64_t column = first[0]; column <= last[0]; ++column) {
      const Vec3 across = weights(node_[0], static_cast<double>(column));
      for (int i = 0; i < 3; ++i) across_[i].push_back(across[i]);
    }
  }

  // Sets those of a row of the rectangle.
  void row(std::int64_t y, std::span<double> out) const {
    if (!smooth_) {
      for (std::size_t x = 0; x < out.size(); ++x)
        out[x] = exact(first_ + static_cast<std::int64_t>(x), y);
      return;
    }
    std::ranges::fill(out, 0.0);
    const Vec3 down = weights(node_[1], static_cast<double>(y));
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i)
        for (std::size_t x = 0; x < out.size(); ++x)
          out[x] += down[j] * across_[i][x] * value_[j][i];
  }

 private:
  double exact(std::int64_t x, std::int64_t y) const {
    return world::pixel_solid_angle(camera_, static_cast<std::uint32_t>(x),
                                    static_cast<std::uint32_t>(y));
  }

  double by_nodes(std::int64_t x, std::int64_t y) const {
    const Vec3 across = weights(node_[0], static_cast<double>(x));
    const Vec3 down = weights(node_[1], static_cast<double>(y));
    double sum = 0;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) sum += down[j] * across[i] * value_[j][i];
    return sum;
  }

  // Lagrange's polynomials of three nodes.
  static Vec3 weights(const std::int64_t (&node)[3], double at) {
    const auto a = static_cast<double>(node[0]), b = static_cast<double>(node[1]),
               c = static_cast<double>(node[2]);
    return {(at - b) * (at - c) / ((a - b) * (a - c)), (at - a) * (at - c) / ((b - a) * (b - c)),
            (at - a) * (at - b) / ((c - a) * (c - b))};
  }

  const world::Camera& camera_;
  std::int64_t first_ = 0;
  std::int64_t node_[2][3] = {};
  double value_[3][3] = {};
  bool smooth_ = false;
  std::vector<double> across_[3];  // weights of the columns
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
  const auto power = [](double fainter) { return det::pow(10, -0.4 * fainter); };
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
  for (std::size_t i = 0; i < catalogue.stars.size(); ++i) {
    const Star& star = catalogue.stars[i];
    if (star.v > stars.faintest) break;
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
  constexpr double kMost = 1e30;  // of radiance: floats stay finite
  const auto width = static_cast<std::int64_t>(image.width);
  const auto height = static_cast<std::int64_t>(image.height);
  const Shares across = shares_of(pixel.x, psf_sigma);
  const Shares down = shares_of(pixel.y, psf_sigma);
  const auto end_of = [](const Shares& shares) {
    return shares.first + static_cast<std::int64_t>(shares.of.size()) - 1;
  };
  const std::int64_t first[] = {std::max<std::int64_t>(across.first, 0),
                                std::max<std::int64_t>(down.first, 0)};
  const std::int64_t last[] = {std::min(end_of(across), width - 1),
                               std::min(end_of(down), height - 1)};
  if (first[0] > last[0] || first[1] > last[1]) return;
  const SolidAngles angles(camera, first, last);
  std::vector<double> row(static_cast<std::size_t>(last[0] - first[0] + 1));
  for (std::int64_t y = first[1]; y <= last[1]; ++y) {
    angles.row(y, row);
    const Vec3 along = irradiance * down.of[static_cast<std::size_t>(y - down.first)];
    const double* shares = &across.of[static_cast<std::size_t>(first[0] - across.first)];
    float* radiance = &image.radiance[3 * static_cast<std::size_t>(y * width + first[0])];
    for (std::size_t x = 0; x < row.size(); ++x, radiance += 3) {
      if (!(row[x] > 0)) continue;
      for (int band = 0; band < 3; ++band)
        radiance[band] += static_cast<float>(std::min(along[band] * shares[x] / row[x], kMost));
    }
  }
}

void add_stars(std::span<const StarInView> stars, const world::Camera& camera, double psf_sigma,
               const Vec3& unit, image::Image& image) {
  assert(image.width == camera.width && image.height == camera.height);
  const auto width = static_cast<std::int64_t>(image.width);
  const auto height = static_cast<std::int64_t>(image.height);
  for (const StarInView& star : stars) {
    // where the centre is outside, the nearest pixel says what is in front of it
    const auto column =
        std::clamp(static_cast<std::int64_t>(std::floor(star.pixel.x)), std::int64_t{0}, width - 1);
    const auto row = std::clamp(static_cast<std::int64_t>(std::floor(star.pixel.y)),
                                std::int64_t{0}, height - 1);
    const double open =
        1 - static_cast<double>(image.coverage[static_cast<std::size_t>(row * width + column)]);
    if (!(open > 0)) continue;
    add_point(star.pixel, open * star.irradiance / unit, camera, psf_sigma, image);
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
