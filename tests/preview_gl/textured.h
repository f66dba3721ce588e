// Models with textures, viewed from straight above.
#pragma once

#include <functional>
#include <list>

#include "materials/brdf.h"
#include "models.h"

namespace panwright::preview::testing_support {

using Texel = std::array<std::uint8_t, 4>;

// Contents that own their textures.
struct Textured : pan::Contents {
  explicit Textured(const pan::Contents& contents) : pan::Contents(contents) {}

  // texel(x, y): y from the bottom row, as texture coordinates count.
  std::int32_t add(std::uint32_t width, std::uint32_t height, bool linear,
                   const std::function<Texel(std::uint32_t, std::uint32_t)>& texel) {
    std::vector<std::uint8_t>& rgba = pixels.emplace_back();
    for (std::uint32_t row = 0; row < height; ++row)
      for (std::uint32_t x = 0; x < width; ++x) {
        const Texel value = texel(x, height - 1 - row);
        rgba.insert(rgba.end(), value.begin(), value.end());
      }
    pan::TextureContent texture;
    texture.name = "picture";
    texture.width = width;
    texture.height = height;
    texture.linear = linear;
    texture.rgba = rgba;
    textures.push_back(texture);
    return static_cast<std::int32_t>(textures.size() - 1);
  }

  std::list<std::vector<std::uint8_t>> pixels;
};

inline Texel grey(int code, int alpha = 255) {
  const auto c = static_cast<std::uint8_t>(code);
  return {c, c, c, static_cast<std::uint8_t>(alpha)};
}

// Orthographic, size pixels over `width` metres, from +z with +y up; `side` −1: from −z.
inline View above(std::uint32_t size, double width, const Vec3& to_sun = Vec3(0, 0, 1),
                  double side = 1) {
  DiagnosticLog log;
  View view;
  set_orthographic(view.camera, size, size, width);
  view.camera.position = {0, 0, 10 * side};
  view.camera.world_from_camera =
      *world::looking_at(view.camera.position, Vec3(0), Vec3(0, 1, 0), log);
  view.to_sun = to_sun;
  return view;
}

// The direction to the Sun; where the horizon of a normal cuts its disc, with the mean cosine of
// the disc's part above it.
inline Vec3 to_mean_sun(const Vec3& to_sun, const Vec3& normal) {
  const double radius = std::sqrt(8 * materials::kSunAlpha2);
  const double cosine = glm::dot(normal, to_sun);
  const double t = cosine / radius;
  if (std::fabs(t) >= 1) return to_sun;
  const double mean =
      t / 2 + ((2 + t * t) * std::sqrt(1 - t * t) + 3 * t * std::asin(t)) / (3 * kPi);
  return to_sun + normal * (radius * mean - cosine);
}

struct Sums {
  Vec3 radiance{0};  // of all pixels
  double coverage = 0;
};

inline Sums sums(const image::Image& image) {
  Sums result;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      result.radiance[static_cast<int>(k)] += image.radiance[3 * i + k];
    result.coverage += image.coverage[i];
  }
  return result;
}

inline Vec3 radiance_at(const image::Image& image, std::size_t x, std::size_t y) {
  const float* p = &image.radiance[3 * (y * image.width + x)];
  return Vec3(p[0], p[1], p[2]);
}

}  // namespace panwright::preview::testing_support
