// Textures of a model at a point, read from the bytes of the pan.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/math.h"

namespace panwright::trace {

// Texture at full resolution, decoded in double on access and bilinear between texel centres. (0,
// 0) is the lower left corner. It repeats, except for clamped(), whose edge continues.
class Texture {
 public:
  // rgba: 4*H*W codes, row 0 at the top; it outlives the texture. linear: RGB is not sRGB encoded.
  Texture(std::span<const std::uint8_t> rgba, std::uint32_t width, std::uint32_t height,
          bool linear);

  Vec3 color(const Vec2& at) const;
  // Returns RGB times A before the interpolation, and A: transparent texels contribute no colour.
  Vec4 premultiplied(const Vec2& at) const;
  Vec4 clamped_premultiplied(const Vec2& at) const;
  // Returns a normal map's RGB: the mean of unit normals, never inwards; shorter than 1 if
  // neighbours differ.
  Vec3 normal(const Vec2& at) const;
  double red(const Vec2& at) const;  // code / 255, whatever the encoding
  // Returns A. Each texel is rounded to float, as a pan's threshold is: an alpha equal to the
  // threshold reaches it.
  double alpha(const Vec2& at) const;

 private:
  // Four texels around a place, and the share of the right and of the upper ones.
  struct Corners {
    std::array<const std::uint8_t*, 4> texel;  // lower left, lower right, upper left, upper right
    double right;
    double up;
  };
  Corners repeated(const Vec2& at) const;
  Corners clamped(const Vec2& at) const;
  Corners corners(std::size_t left, std::size_t right, std::size_t low, std::size_t high,
                  const Vec2& share) const;
  Vec4 decoded_premultiplied(const std::uint8_t* texel) const;

  std::span<const std::uint8_t> rgba_;
  std::size_t width_;
  std::size_t height_;
  const std::array<double, 256>* decoded_;  // of the codes of RGB
};

}  // namespace panwright::trace
