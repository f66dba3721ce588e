// Bodies before and behind the targets of an image.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sky/backdrop.h"
#include "sky/internal/layer.h"

namespace panwright::sky {
namespace {

// Depths of targets; where there is none, the largest of the pixels around, else 0.
std::vector<float> depths_of(const image::Image& image) {
  std::vector<float> depths(image.pixels(), 0);
  const auto width = static_cast<std::int64_t>(image.width);
  const auto height = static_cast<std::int64_t>(image.height);
  for (std::int64_t y = 0; y < height; ++y)
    for (std::int64_t x = 0; x < width; ++x) {
      float& depth = depths[static_cast<std::size_t>(y * width + x)];
      const float own = image.depth[static_cast<std::size_t>(y * width + x)];
      if (std::isfinite(own)) {
        depth = own;
        continue;
      }
      for (std::int64_t j = std::max<std::int64_t>(y - 1, 0); j <= std::min(y + 1, height - 1); ++j)
        for (std::int64_t i = std::max<std::int64_t>(x - 1, 0); i <= std::min(x + 1, width - 1);
             ++i) {
          const float other = image.depth[static_cast<std::size_t>(j * width + i)];
          if (std::isfinite(other)) depth = std::max(depth, other);
        }
    }
  return depths;
}

void clear_truth(image::Image& image, std::size_t pixel) {
  image.depth[pixel] = image.range[pixel] = INFINITY;
  for (std::size_t k = 0; k < 3; ++k) image.normal[3 * pixel + k] = 0;
  image.target_id[pixel] = image.node_id[pixel] = image.material_id[pixel] = 0;
}

}  // namespace

bool may_hide(const Sky& sky, const Vec3& point, double distance) {
  for (std::size_t i = 0; i < sky.size(); ++i) {
    const Vec3 from = sky.shape(i).from(point);
    const double units = std::sqrt(glm::dot(from, from));
    const Vec3& radii = sky.body(i).radii;
    if (units >= 1 && (units - 1) * std::min({radii.x, radii.y, radii.z}) < distance) return true;
  }
  return false;
}

void add_around(const Sky& sky, const world::Camera& camera, double psf_sigma, image::Image& image,
                const Job& job) {
  const std::vector<float> depths = depths_of(image);
  const Layer before = layer(sky, camera, psf_sigma, &depths, true, job);
  add_behind(layer(sky, camera, psf_sigma, &depths, false, job).light, image);
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    float open = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float share = 1 - before.cover[3 * i + k];
      float& light = image.radiance[3 * i + k];
      light = light * share + before.light[3 * i + k];
      open += share / 3;
    }
    image.coverage[i] *= open;
    if (open < 0.5f && image.has_ground_truth()) clear_truth(image, i);
  }
}

void add_behind(const std::vector<float>& backdrop, image::Image& image) {
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const float open = 1 - image.coverage[i];
    if (!(open > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) image.radiance[3 * i + k] += open * backdrop[3 * i + k];
  }
}

}  // namespace panwright::sky
