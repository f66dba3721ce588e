#include "bench/relief.h"

#include <cmath>
#include <cstdint>

namespace panwright::bench {

namespace {

double hashed(std::int64_t x, std::int64_t y, std::uint32_t octave) {
  std::uint64_t z = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ull ^
                    static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4full ^ octave;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return double((z ^ (z >> 31)) >> 11) / 9007199254740992.0 - 0.5;
}

}  // namespace

double rough(double x, double y, double longest, double shortest) {
  double sum = 0, size = longest;
  for (std::uint32_t octave = 0; size >= shortest; ++octave, size /= 2) {
    const double u = x / size, v = y / size;
    const double i = std::floor(u), j = std::floor(v);
    const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
    const double a = smooth(u - i), b = smooth(v - j);
    const auto p = [&](int k, int l) {
      return hashed(std::int64_t(i) + k, std::int64_t(j) + l, octave);
    };
    const double top = p(0, 0) + a * (p(1, 0) - p(0, 0)),
                 bottom = p(0, 1) + a * (p(1, 1) - p(0, 1));
    sum += std::pow(size, 0.8) * (top + b * (bottom - top));
  }
  return sum;
}

}  // namespace panwright::bench
