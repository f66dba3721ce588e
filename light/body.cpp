#include "light/body.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace panwright::light {

BodyMap::BodyMap(MapPixels pixels, Scale scale) {
  if (scale == Scale::mean_one) {
    const Vec3 mean = mean_of(pixels);
    for (std::size_t i = 0; i < pixels.rgb.size(); ++i) {
      const double of = mean[static_cast<int>(i % 3)];
      pixels.rgb[i] = of > 0 ? static_cast<float>(pixels.rgb[i] / of) : 1.0f;
    }
  }
  levels_.push_back(std::move(pixels));
  add_levels();
}

void BodyMap::add_levels() {
  while (levels_.back().width > 1 && levels_.back().height > 1) {
    const MapPixels& fine = levels_.back();
    MapPixels coarse;
    coarse.width = fine.width / 2;
    coarse.height = std::max(1u, fine.height / 2);
    coarse.rgb.resize(std::size_t{3} * coarse.width * coarse.height);
    for (std::uint32_t row = 0; row < coarse.height; ++row)
      for (std::uint32_t column = 0; column < coarse.width; ++column)
        for (std::size_t k = 0; k < 3; ++k) {
          const auto of = [&](std::uint32_t y, std::uint32_t x) {
            return fine.rgb[3 * (std::size_t{std::min(2 * row + y, fine.height - 1)} * fine.width +
                                 2 * column + x) +
                            k];
          };
          coarse.rgb[3 * (std::size_t{row} * coarse.width + column) + k] =
              0.25f * (of(0, 0) + of(0, 1) + of(1, 0) + of(1, 1));
        }
    levels_.push_back(std::move(coarse));
  }
}

Vec3 BodyMap::bilinear(const MapPixels& level, double u, double v) const {
  const double x = u * level.width - 0.5, y = v * level.height - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const auto wrapped = [&](double column) {
    const double width = level.width;
    return static_cast<std::size_t>(column < 0 ? column + width
                                               : (column >= width ? column - width : column));
  };
  const auto held = [&](double row) {
    return static_cast<std::size_t>(std::clamp(row, 0.0, level.height - 1.0));
  };
  const std::size_t columns[2] = {wrapped(left), wrapped(left + 1)};
  const std::size_t rows[2] = {held(top), held(top + 1)};
  const double ax = x - left, ay = y - top;
  Vec3 result(0);
  for (std::size_t j = 0; j < 2; ++j)
    for (std::size_t i = 0; i < 2; ++i) {
      const double weight = (i == 1 ? ax : 1 - ax) * (j == 1 ? ay : 1 - ay);
      const float* rgb = &level.rgb[3 * (rows[j] * level.width + columns[i])];
      result += weight * Vec3(rgb[0], rgb[1], rgb[2]);
    }
  return result;
}

Vec3 BodyMap::at(const Vec3& direction, double footprint) const {
  const double length = std::sqrt(glm::dot(direction, direction));
  const double u = std::clamp(0.5 + det::atan2(direction.y, direction.x) / (2 * kPi), 0.0, 1.0);
  const double v = det::acos(std::clamp(direction.z / length, -1.0, 1.0)) / kPi;
  const double texels = footprint * levels_[0].width / (2 * kPi);
  if (!(texels > 1)) return bilinear(levels_[0], u, v);
  const double level =
      std::min(det::log(texels) / std::numbers::ln2, static_cast<double>(levels_.size() - 1));
  const auto fine = static_cast<std::size_t>(level);
  const Vec3 value = bilinear(levels_[fine], u, v);
  if (fine + 1 >= levels_.size()) return value;
  return glm::mix(value, bilinear(levels_[fine + 1], u, v), level - static_cast<double>(fine));
}

std::optional<Body> body_preset(std::string_view name) {
  Body body;
  body.name = name;
  if (name == "earth") {
    body.radii = Vec3(6378137, 6378137, 6356752.314245);  // WGS 84
    // geometric albedos of the whole disc in R, V and B relative to V: A. Mallama et al.,
    // "Comprehensive wide-band magnitudes and albedos for the planets", 2017
    body.albedo = 0.3 / 0.434 * Vec3(0.392, 0.434, 0.512);
    body.air = true;
    return body;
  }
  if (name == "moon") {
    body.radii = Vec3(1737400);  // IAU 2015
    body.photometry.law = Law::lunar_lambert;
    body.photometry.rolo = true;
    body.albedo = Vec3(1);
    return body;
  }
  return std::nullopt;
}

bool is_sound(const Body& body) {
  constexpr double kFlattest = 100;
  const Vec3& r = body.radii;
  const double least = std::min({r.x, r.y, r.z}), most = max_component(r);
  const Photometry& law = body.photometry;
  const Vec3& albedo = body.albedo;
  return is_finite(body.centre) && is_finite(r) && least > 0 && most <= kFlattest * least &&
         std::fabs(glm::dot(body.world_from_body, body.world_from_body) - 1) < 1e-6 &&
         is_finite(albedo) && albedo.x >= 0 && albedo.y >= 0 && albedo.z >= 0 &&
         law.single_scattering >= 0 && law.single_scattering <= 1 && law.asymmetry > -1 &&
         law.asymmetry < 1 && law.surge >= 0 && std::isfinite(law.surge) && law.surge_width > 0 &&
         std::isfinite(law.surge_width) && (body.air || !body.sunset) &&
         (!body.air || (law.law == Law::lambert && !law.rolo && least >= Air::kLeastRadius));
}

Vec3 reflected(const Body& body, const Vec3& place, double footprint, const Vec3& normal,
               const Vec3& to_sun, const Vec3& to_viewer, const Vec3& irradiance) {
  const double mu0 = glm::dot(normal, to_sun), mu = glm::dot(normal, to_viewer);
  if (!(mu0 > 0 && mu > 0)) return Vec3(0);
  const Photometry& law = body.photometry;
  const bool phased = law.rolo || law.law == Law::lunar_lambert || law.law == Law::hapke;
  const double phase = phased ? angle_between(to_sun, to_viewer) : 0;
  Vec3 result = body.albedo * irradiance * (radiance_factor(law, mu0, mu, phase) / kPi);
  if (law.rolo) result *= phase_factor(law, phase);
  if (body.map) result *= body.map->at(place, footprint);
  return result;
}

Vec3 night_light(const Body& body, const Vec3& place, double footprint, double mu_sun) {
  constexpr double kDusk = 0.1;  // sine of six degrees
  if (!body.night || !(mu_sun < 0)) return Vec3(0);
  return std::min(-mu_sun / kDusk, 1.0) * kNightRadiance * body.night->at(place, footprint);
}

std::shared_ptr<const Air> air_of(const Body& body) {
  const Vec3& r = body.radii;
  return body.air ? earth_air(det::pow(r.x * r.y * r.z, 1.0 / 3)) : nullptr;
}

Vec3 ground_albedo(const Body& body, const Air& air) {
  return glm::max((body.albedo - air.albedo()) / air.ground_factor(), Vec3(0));
}

Vec3 reflected_through(const Body& body, const Air& air, const Vec3& place, double footprint,
                       double mu_sun, double mu, const AirLight& between, const Vec3& irradiance) {
  const Vec3 whole = air.transmittance(1, mu);
  // of light that the air scatters upwards, the share below the viewer
  const Vec3 below = (Vec3(1) - between.through) / glm::max(Vec3(1) - whole, Vec3(1e-9));
  const Vec3 up = between.through + (air.upward(mu) - whole) * glm::min(below, Vec3(1));
  Vec3 ground = ground_albedo(body, air) * air.ground(mu_sun) * up / kPi;
  if (body.map) ground *= body.map->at(place, footprint);
  return irradiance * (between.light + ground);
}

}  // namespace panwright::light
