#include "preview/reference/internal/texels.h"

#include <algorithm>
#include <cmath>

namespace panwright::preview::reference {
namespace {

// The two texels beside a place on one axis, and the share of the second.
struct Pair {
  std::size_t first;
  std::size_t second;
  double share;
};

Pair repeated(double at, std::uint32_t size) {
  // what is too far out for a fraction of a texel, or no number, takes the first
  const double place = (at - std::floor(at)) * size - 0.5;
  if (!(place >= -0.5 && place <= size)) return {0, 0, 0};
  const double below = std::floor(place);
  const auto texel = static_cast<std::int64_t>(below);
  const auto wrapped = [&](std::int64_t i) {
    return static_cast<std::size_t>((i + size) % static_cast<std::int64_t>(size));
  };
  return {wrapped(texel), wrapped(texel + 1), place - below};
}

Pair clamped(double at, std::uint32_t size) {
  const double last = size - 1.0;
  const double place = std::clamp(at * size - 0.5, 0.0, last);
  const double below = std::floor(place);
  const auto texel = static_cast<std::size_t>(below);
  return {texel, std::min<std::size_t>(texel + 1, size - 1), place - below};
}

Vec4 texel_at(const TextureLevel& picture, const Pair& x, const Pair& y) {
  const auto texel = [&](std::size_t column, std::size_t row) {
    const float* t = &picture.rgba[4 * (row * picture.width + column)];
    return Vec4(t[0], t[1], t[2], t[3]);
  };
  const auto row = [&](std::size_t j) {
    return texel(x.first, j) * (1 - x.share) + texel(x.second, j) * x.share;
  };
  return row(y.first) * (1 - y.share) + row(y.second) * y.share;
}

}  // namespace

Vec4 repeated_texel(const TextureLevel& picture, const Vec2& at) {
  return texel_at(picture, repeated(at.x, picture.width), repeated(at.y, picture.height));
}

Vec4 clamped_texel(const TextureLevel& picture, const Vec2& at) {
  return texel_at(picture, clamped(at.x, picture.width), clamped(at.y, picture.height));
}

}  // namespace panwright::preview::reference
