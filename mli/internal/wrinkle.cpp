#include <cmath>

#include "base/math.h"
#include "mli/internal/grid.h"

namespace panwright::mli {
namespace {

constexpr std::size_t kWaves = 24;
constexpr double kSpread = 0.2;  // of wave numbers, to either side
constexpr std::size_t kLanes = 8;

struct Wave {
  double kx, ky, phase;  // radians per metre; radians
};

// The half angle Θ over which wave vectors have rms components along and across as `ratio` to 1:
// mean(cos²) : mean(sin²) = 1 + s : 1 - s with s = sin(2Θ)/(2Θ).
double half_angle(double ratio) {
  const double wanted = (ratio * ratio - 1) / (ratio * ratio + 1);
  double low = 0, high = kPi / 2;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (det::sin(2 * middle) > wanted * 2 * middle ? low : high) = middle;
  }
  return (low + high) / 2;
}

std::array<Wave, kWaves> waves_of(const Wrinkle& wrinkle, const Grid& grid) {
  std::array<Wave, kWaves> waves;
  const double half = half_angle(wrinkle.anisotropy);
  for (std::size_t n = 0; n < kWaves; ++n) {
    const auto words = grid.words(static_cast<std::uint32_t>(n), 0);
    const double turn = 2 * (static_cast<double>(n) + in_unit(words[0])) / kWaves - 1;
    const auto direction = det::sincos(wrinkle.direction + half * turn);
    const double k = 2 * kPi / wrinkle.wavelength * (1 + kSpread * (2 * in_unit(words[1]) - 1));
    waves[n] = {k * direction.cos, k * direction.sin, 2 * kPi * in_unit(words[2])};
  }
  return waves;
}

// Adds one wave along a row to the real and imaginary parts of a sum. columns: a multiple of kLanes
void add_wave(const Wave& wave, double cell, double y, std::size_t columns, double* re,
              double* im) {
  const auto step = det::sincos(wave.kx * cell);
  const auto far = det::sincos(wave.kx * cell * kLanes);
  const auto start = det::sincos(wave.phase + wave.ky * y);
  double c[kLanes], s[kLanes];
  c[0] = start.cos;
  s[0] = start.sin;
  for (std::size_t p = 1; p < kLanes; ++p) {
    c[p] = c[p - 1] * step.cos - s[p - 1] * step.sin;
    s[p] = c[p - 1] * step.sin + s[p - 1] * step.cos;
  }
  for (std::size_t i = 0; i < columns; i += kLanes)
    for (std::size_t p = 0; p < kLanes; ++p) {
      re[i + p] += c[p];
      im[i + p] += s[p];
      const double next = c[p] * far.cos - s[p] * far.sin;
      s[p] = c[p] * far.sin + s[p] * far.cos;
      c[p] = next;
    }
}

}  // namespace

void apply(const Wrinkle& wrinkle, const Grid& grid, const Job& job) {
  const std::array<Wave, kWaves> waves = waves_of(wrinkle, grid);
  const double scale = wrinkle.amplitude * std::sqrt(1.5 / kWaves);
  const std::size_t padded = (grid.columns + kLanes - 1) / kLanes * kLanes;
  for_bands(grid, job, [&](std::size_t first, std::size_t end) {
    std::vector<double> re(padded), im(padded);
    for (std::size_t j = first; j < end; ++j) {
      std::fill(re.begin(), re.end(), 0.0);
      std::fill(im.begin(), im.end(), 0.0);
      for (const Wave& wave : waves)
        add_wave(wave, grid.cell, static_cast<double>(j) * grid.cell, padded, re.data(), im.data());
      double* h = grid.row(j);
      for (std::size_t i = 0; i < grid.columns; ++i) {
        const double size = std::sqrt(re[i] * re[i] + im[i] * im[i]);
        h[i] += scale * size * (1 - 2 / kPi * det::atan2(std::fabs(im[i]), re[i]));
      }
    }
  });
}

}  // namespace panwright::mli
