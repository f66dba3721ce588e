#include "sensor/internal/fourier.h"

#include <algorithm>
#include <utility>

#include "base/math.h"

namespace panwright::sensor {

Fourier::Fourier(std::size_t side) : side_(side), order_(side) {
  // of each pass next to each other
  for (std::size_t half = 1; half < side; half *= 2)
    for (std::size_t k = 0; k < half; ++k) {
      const det::SinCos turn =
          det::sincos(-kPi * static_cast<double>(k) / static_cast<double>(half));
      roots_.push_back({turn.cos, turn.sin});
    }
  for (std::size_t i = 0; i < side; ++i) {
    std::size_t reversed = 0;
    for (std::size_t bit = 1, mirrored = side / 2; mirrored > 0; bit <<= 1, mirrored >>= 1)
      if ((i & bit) != 0) reversed |= mirrored;
    order_[i] = static_cast<std::uint32_t>(reversed);
  }
}

// Cooley and Tukey, radix 2.
void Fourier::line(Complex* values, bool back) const {
  for (std::size_t i = 0; i < side_; ++i)
    if (i < order_[i]) std::swap(values[i], values[order_[i]]);
  const double sign = back ? -1 : 1;
  for (std::size_t half = 1; half < side_; half *= 2) {
    const Complex* roots = roots_.data() + (half - 1);
    for (std::size_t begin = 0; begin < side_; begin += 2 * half)
      for (std::size_t k = 0; k < half; ++k) {
        const double re = roots[k][0], im = sign * roots[k][1];
        Complex &a = values[begin + k], &b = values[begin + half + k];
        const Complex turned{b[0] * re - b[1] * im, b[0] * im + b[1] * re};
        b = {a[0] - turned[0], a[1] - turned[1]};
        a = {a[0] + turned[0], a[1] + turned[1]};
      }
  }
}

void Fourier::run(std::span<Complex> plane, bool back) const {
  constexpr std::size_t kColumns = 8;  // taken together
  const auto is_empty = [](const Complex* row, std::size_t count) {
    return std::all_of(row, row + count, [](const Complex& z) { return z[0] == 0 && z[1] == 0; });
  };
  for (std::size_t y = 0; y < side_; ++y)
    if (Complex* row = plane.data() + y * side_; !is_empty(row, side_)) line(row, back);
  std::vector<Complex> columns(kColumns * side_);
  for (std::size_t x = 0; x < side_; x += kColumns) {
    const std::size_t count = std::min(kColumns, side_ - x);
    for (std::size_t y = 0; y < side_; ++y)
      for (std::size_t k = 0; k < count; ++k) columns[k * side_ + y] = plane[y * side_ + x + k];
    for (std::size_t k = 0; k < count; ++k) line(columns.data() + k * side_, back);
    for (std::size_t y = 0; y < side_; ++y)
      for (std::size_t k = 0; k < count; ++k) plane[y * side_ + x + k] = columns[k * side_ + y];
  }
  if (!back) return;
  const double factor = 1.0 / static_cast<double>(side_ * side_);
  for (Complex& z : plane) z = {z[0] * factor, z[1] * factor};
}

}  // namespace panwright::sensor
