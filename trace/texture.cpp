#include "trace/texture.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace panwright::trace {
namespace {

// IEC 61966-2-1, 5.2.
double srgb_to_linear(double encoded) {
  if (encoded <= 0.04045) return encoded / 12.92;
  return det::pow((encoded + 0.055) / 1.055, 2.4);
}

const std::array<double, 256>& decoding(bool linear) {
  static const std::array<std::array<double, 256>, 2> tables = [] {
    std::array<std::array<double, 256>, 2> all;
    for (std::size_t code = 0; code < 256; ++code) {
      const double share = static_cast<double>(code) / 255;
      all[0][code] = srgb_to_linear(share);
      all[1][code] = share;
    }
    return all;
  }();
  return tables[linear];
}

// note: equal ends give themselves, whatever the share
template <class T>
T between(const T& a, const T& b, double share) {
  return a + share * (b - a);
}

template <class Corners, class Decode>
auto interpolated(const Corners& at, const Decode& decode) {
  return between(between(decode(at.texel[0]), decode(at.texel[1]), at.right),
                 between(decode(at.texel[2]), decode(at.texel[3]), at.right), at.up);
}

Vec3 unit_normal(const std::uint8_t* texel) {
  Vec3 n = Vec3(texel[0], texel[1], texel[2]) * (2.0 / 255) - 1.0;
  n.z = std::max(n.z, 0.0);
  const double length = glm::length(n);
  return length > 0 ? n / length : Vec3(0, 0, 1);
}

}  // namespace

Texture::Texture(std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height,
                 bool linear)
    : rgba_(rgba), width_(width), height_(height), decoded_(&decoding(linear)) {
  assert(width > 0 && height > 0 && rgba.size() == 4 * width_ * height_);
}

Texture::Corners Texture::corners(std::size_t left, std::size_t right, std::size_t low,
                                  std::size_t high, const Vec2& share) const {
  // v grows upwards, rows downwards
  const std::uint8_t* lower = rgba_.data() + 4 * width_ * (height_ - 1 - low);
  const std::uint8_t* upper = rgba_.data() + 4 * width_ * (height_ - 1 - high);
  return {
      {lower + 4 * left, lower + 4 * right, upper + 4 * left, upper + 4 * right}, share.x, share.y};
}

Texture::Corners Texture::repeated(const Vec2& at) const {
  std::array<std::size_t, 2> first, second;
  Vec2 share;
  const std::array<std::size_t, 2> size{width_, height_};
  for (int axis = 0; axis < 2; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const auto count = static_cast<double>(size[i]);
    const double place = at[axis] * count - 0.5;
    const double below = std::floor(place);
    share[axis] = place - below;
    // exact, also for places that are too far out to have a fraction
    double texel = std::fmod(below, count);
    if (texel < 0) texel += count;
    // no number: the first one
    if (!(texel >= 0 && texel < count)) texel = share[axis] = 0;
    first[i] = static_cast<std::size_t>(texel);
    second[i] = first[i] + 1 == size[i] ? 0 : first[i] + 1;
  }
  return corners(first[0], second[0], first[1], second[1], share);
}

Texture::Corners Texture::clamped(const Vec2& at) const {
  std::array<std::size_t, 2> first, second;
  Vec2 share;
  const std::array<std::size_t, 2> size{width_, height_};
  for (int axis = 0; axis < 2; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const auto last = static_cast<double>(size[i] - 1);
    const double place = std::clamp(at[axis] * static_cast<double>(size[i]) - 0.5, 0.0, last);
    first[i] = static_cast<std::size_t>(place);
    second[i] = std::min(first[i] + 1, size[i] - 1);
    share[axis] = place - static_cast<double>(first[i]);
  }
  return corners(first[0], second[0], first[1], second[1], share);
}

Vec4 Texture::decoded_premultiplied(const std::uint8_t* texel) const {
  const double a = texel[3] / 255.0;
  return Vec4((*decoded_)[texel[0]] * a, (*decoded_)[texel[1]] * a, (*decoded_)[texel[2]] * a, a);
}

Vec3 Texture::color(const Vec2& at) const {
  return interpolated(repeated(at), [&](const std::uint8_t* texel) {
    return Vec3((*decoded_)[texel[0]], (*decoded_)[texel[1]], (*decoded_)[texel[2]]);
  });
}

Vec4 Texture::premultiplied(const Vec2& at) const {
  return interpolated(repeated(at),
                      [&](const std::uint8_t* texel) { return decoded_premultiplied(texel); });
}

Vec4 Texture::clamped_premultiplied(const Vec2& at) const {
  return interpolated(clamped(at),
                      [&](const std::uint8_t* texel) { return decoded_premultiplied(texel); });
}

Vec3 Texture::normal(const Vec2& at) const { return interpolated(repeated(at), unit_normal); }

double Texture::red(const Vec2& at) const {
  return interpolated(repeated(at), [](const std::uint8_t* texel) { return texel[0] / 255.0; });
}

double Texture::alpha(const Vec2& at) const {
  return interpolated(repeated(at), [](const std::uint8_t* texel) {
    return static_cast<double>(static_cast<float>(texel[3] / 255.0));
  });
}

}  // namespace panwright::trace
