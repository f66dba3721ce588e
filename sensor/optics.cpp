#include "sensor/optics.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace panwright::sensor {

namespace {

constexpr double kPlanck = 6.62607015e-34;   // J s
constexpr double kLightSpeed = 299792458.0;  // m/s

double interpolated(const std::vector<std::pair<double, double>>& table, double at) {
  if (table.empty()) return 1;
  if (at <= table.front().first) return table.front().second;
  for (std::size_t i = 1; i < table.size(); ++i) {
    const auto& [x0, y0] = table[i - 1];
    const auto& [x1, y1] = table[i];
    if (at <= x1) return y0 + (y1 - y0) * (at - x0) / (x1 - x0);
  }
  return table.back().second;
}

// Directions of corners of pixels; a length of 0 where there is none.
Vec3 direction_at(const PixelGrid& grid, const Vec2& pixel) {
  const Vec2 place = (pixel - grid.principal) / grid.focal;
  if (grid.distortion == nullptr) return glm::normalize(Vec3(place, 1));
  const auto ray = grid.distortion->ray(place);
  return ray ? ray->direction : Vec3(0);
}

}  // namespace

double Optics::gaussian_px() const {
  return std::sqrt(psf_px * psf_px + jitter_px * jitter_px + diffusion_px * diffusion_px);
}

double airy_px(const Optics& optics, const PixelGrid& grid, const Vec2& pixel_um, double nm) {
  const double focal_mm = grid.focal.x * pixel_um.x * 1e-3;
  return nm * 1e-3 * focal_mm / optics.aperture_mm / pixel_um.x;
}

std::array<double, kBands> electrons_of_irradiance(const Optics& optics) {
  const double radius = 0.5e-3 * optics.aperture_mm;
  std::array<double, kBands> out{};
  for (std::size_t k = 0; k < kBands; ++k)
    out[k] = kPi * radius * radius * optics.transmission[k] * optics.qe[k] * kBandNm[k] * 1e-9 /
             (kPlanck * kLightSpeed);
  return out;
}

Sensitivity::Sensitivity(const Optics& optics, const PixelGrid& grid)
    : projected_(std::size_t{grid.width} * grid.height),
      of_bands_(electrons_of_irradiance(optics)) {
  const bool plain = grid.distortion == nullptr;
  parallel_for(grid.height, [&](std::size_t y) {
    float* out = projected_.data() + y * grid.width;
    std::vector<Vec3> above, below;
    for (std::size_t x = 0; !plain && x <= grid.width; ++x) {
      above.push_back(direction_at(grid, Vec2(x, y)));
      below.push_back(direction_at(grid, Vec2(x, y + 1)));
    }
    for (std::size_t x = 0; x < grid.width; ++x) {
      double cosine = 0, angle = 0;
      if (plain) {
        const Vec2 place = (Vec2(x + 0.5, y + 0.5) - grid.principal) / grid.focal;
        cosine = 1 / std::sqrt(1 + glm::dot(place, place));
        angle = cosine * cosine * cosine / (grid.focal.x * grid.focal.y);
      } else {
        const Vec3 &a = above[x], &b = above[x + 1], &c = below[x + 1], &d = below[x];
        const Vec3 middle = a + b + c + d;
        if (a == Vec3(0) || b == Vec3(0) || c == Vec3(0) || d == Vec3(0)) continue;
        const Vec3 direction = glm::normalize(middle);
        cosine = std::max(direction.z, 0.0);
        // a small quadrilateral on the unit sphere
        angle = 0.5 * std::fabs(glm::dot(glm::cross(c - a, d - b), direction));
      }
      const double degrees =
          optics.vignetting.empty() ? 0 : det::acos(std::min(cosine, 1.0)) / kDegree;
      out[x] = static_cast<float>(cosine * angle * interpolated(optics.vignetting, degrees));
    }
  });
}

void add_glare(const Optics& optics, const PixelGrid& grid, std::span<float> radiance) {
  const std::size_t width = grid.width, height = grid.height;
  if (!optics.ghosts.empty()) {
    const std::vector<float> from(radiance.begin(), radiance.end());
    for (const Ghost& ghost : optics.ghosts)
      parallel_for(height, [&](std::size_t y) {
        for (std::size_t x = 0; x < width; ++x) {
          const Vec2 centre(x + 0.5, y + 0.5);
          // radiance of the source, times the change of area
          const Vec2 at = (centre - grid.principal) / ghost.scale + grid.principal - 0.5;
          const Vec2 low = glm::floor(at);
          const Vec2 part = at - low;
          for (int corner = 0; corner < 4; ++corner) {
            const double i = low.x + (corner & 1), j = low.y + (corner >> 1);
            if (!(i >= 0 && j >= 0 && i < static_cast<double>(width) &&
                  j < static_cast<double>(height)))
              continue;
            const double weight = ((corner & 1) != 0 ? part.x : 1 - part.x) *
                                  ((corner >> 1) != 0 ? part.y : 1 - part.y) * ghost.share /
                                  (ghost.scale * ghost.scale);
            const std::size_t source =
                static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i);
            for (std::size_t k = 0; k < kBands; ++k)
              radiance[3 * (y * width + x) + k] +=
                  static_cast<float>(weight * from[3 * source + k]);
          }
        }
      });
  }
  if (!(optics.veiling_glare > 0)) return;
  std::array<double, kBands> sum{};
  for (std::size_t i = 0; i < radiance.size(); ++i)
    if (std::isfinite(radiance[i])) sum[i % kBands] += radiance[i];
  const double g = optics.veiling_glare, pixels = static_cast<double>(width * height);
  for (std::size_t i = 0; i < radiance.size(); ++i)
    radiance[i] = static_cast<float>((1 - g) * radiance[i] + g * sum[i % kBands] / pixels);
}

std::vector<float> mean_electrons(std::span<const float> radiance, const Sensitivity& sensitivity,
                                  double exposure_s) {
  std::vector<float> out(radiance.size());
  const std::vector<float>& projected = sensitivity.projected();
  constexpr std::size_t kPart = 1 << 14;
  parallel_for((projected.size() + kPart - 1) / kPart, [&](std::size_t part) {
    const std::size_t end = std::min(projected.size(), (part + 1) * kPart);
    for (std::size_t i = part * kPart; i < end; ++i)
      for (std::size_t k = 0; k < kBands; ++k)
        out[3 * i + k] = static_cast<float>(exposure_s * sensitivity.of_bands()[k] * projected[i] *
                                            radiance[3 * i + k]);
  });
  return out;
}

}  // namespace panwright::sensor
