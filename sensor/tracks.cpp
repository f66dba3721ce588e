#include "sensor/internal/tracks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"
#include "sensor/draws.h"
#include "sensor/internal/stages.h"

namespace panwright::sensor {

namespace {

// One track: from a place, in pixels, along a vector; charge in proportion to the length in a
// pixel.
void deposit(Vec2 at, const Vec2& way, double electrons, std::uint32_t width, std::uint32_t height,
             std::vector<Deposit>& out) {
  std::int64_t x = static_cast<std::int64_t>(std::floor(at.x));
  std::int64_t y = static_cast<std::int64_t>(std::floor(at.y));
  double done = 0;  // share of the way
  while (done < 1 && x >= 0 && y >= 0 && x < width && y < height) {
    const auto leaves = [&](double from, double length, std::int64_t cell) {
      if (length == 0) return 2.0;
      const double edge = static_cast<double>(length > 0 ? cell + 1 : cell);
      return (edge - from) / length;
    };
    const double next_x = leaves(at.x, way.x, x), next_y = leaves(at.y, way.y, y);
    const double next = std::clamp(std::min(next_x, next_y), done, 1.0);
    if (next > done)
      out.push_back({static_cast<std::uint32_t>(y * width + x), (next - done) * electrons});
    done = next;
    if (next_x <= next_y)
      x += way.x > 0 ? 1 : -1;
    else
      y += way.y > 0 ? 1 : -1;
  }
}

}  // namespace

std::vector<Deposit> cosmic_deposits(const Detector& detector, std::uint32_t width,
                                     std::uint32_t height, std::uint64_t seed,
                                     std::uint32_t frame) {
  const double area = 1e-8 * detector.pixel_um.x * detector.pixel_um.y * width * height;  // cm²
  const double mean = detector.cosmic_per_cm2_s * area * detector.exposure_s;
  const Stream stream{key_of(seed), frame, static_cast<std::uint32_t>(StreamStage::cosmic)};
  double count = 0;
  draw_poisson({&mean, 1}, ~0u, stream, {&count, 1});
  std::vector<Deposit> out;
  for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(count); ++k) {
    const auto word = philox({0, k, frame, stream.stage}, stream.seed);
    const Vec2 at(in_unit(word[0]) * width, in_unit(word[1]) * height);
    // a flux through a surface: the square of the cosine to its normal is uniform
    const double square = in_unit(word[2]);
    const double lateral = detector.depth_um * std::sqrt(1 / square - 1);
    const det::SinCos turn = det::sincos(2 * kPi * in_unit(word[3]));
    const double electrons = kElectronsPerMicrometre * detector.depth_um / std::sqrt(square);
    deposit(at, lateral * Vec2(turn.cos, turn.sin) / detector.pixel_um, electrons, width, height,
            out);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Deposit& a, const Deposit& b) { return a.pixel < b.pixel; });
  return out;
}

}  // namespace panwright::sensor
