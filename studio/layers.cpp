#include "studio/layers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math.h"
#include "base/parallel.h"

namespace panwright::studio {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr Rgb kBackground = {22, 22, 26};

// S. van der Walt and N. Smith, "viridis" (2015, public domain), at equal steps.
constexpr std::array<Rgb, 9> kViridis = {{{68, 1, 84},
                                          {71, 44, 122},
                                          {59, 81, 139},
                                          {44, 113, 142},
                                          {33, 144, 141},
                                          {39, 173, 129},
                                          {92, 200, 99},
                                          {170, 220, 50},
                                          {253, 231, 37}}};

Rgb mixed(const Rgb& a, const Rgb& b, double share) {
  Rgb out{};
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = static_cast<std::uint8_t>(std::lround(a[k] + share * (b[k] - a[k])));
  return out;
}

Rgb viridis(double share) {
  const double at = std::clamp(share, 0.0, 1.0) * (kViridis.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), kViridis.size() - 2);
  return mixed(kViridis[i], kViridis[i + 1], at - static_cast<double>(i));
}

// Colours of ids, distinct for neighbours: hues by the golden ratio, in three lightnesses.
Rgb id_color(std::uint32_t id) {
  if (id == 0) return kBackground;
  const double hue = std::fmod(id * 0.61803398874989485, 1.0) * 6;
  const double light = 0.55 + 0.2 * (id % 3);
  Rgb out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double far = std::fabs(std::remainder(hue - 2.0 * static_cast<double>(k), 6.0));
    out[k] = static_cast<std::uint8_t>(255 * light * (0.3 + 0.7 * std::clamp(2 - far, 0.0, 1.0)));
  }
  return out;
}

template <class Color>
std::vector<std::uint8_t> colored_pixels(const image::Image& image, const Color& color) {
  std::vector<std::uint8_t> out(4 * image.pixels());
  parallel_for(image.height, [&](std::size_t row) {
    for (std::size_t i = row * image.width; i < (row + 1) * image.width; ++i) {
      const Rgb rgb = color(i);
      std::copy(rgb.begin(), rgb.end(), &out[4 * i]);
      out[4 * i + 3] = 255;
    }
  });
  return out;
}

double channel_mean(const image::Image& image, std::size_t i) {
  return (static_cast<double>(image.radiance[3 * i]) +
          static_cast<double>(image.radiance[3 * i + 1]) +
          static_cast<double>(image.radiance[3 * i + 2])) /
         3;
}

Pixels false_color_pixels(const image::Image& image) {
  constexpr double kDecades = 4;
  Pixels out;
  for (std::size_t i = 0; i < image.pixels(); ++i)
    out.high = std::max(out.high, channel_mean(image, i));
  if (!(out.high > 0)) out.high = 1;
  out.low = out.high * std::pow(10, -kDecades);
  out.logarithmic = true;
  out.unit = "radiance";
  out.rgba = colored_pixels(image, [&](std::size_t i) {
    const double light = channel_mean(image, i);
    if (!(light > 0)) return kBackground;
    return viridis(1 + std::log10(light / out.high) / kDecades);
  });
  return out;
}

Pixels depth_pixels(const image::Image& image) {
  Pixels out;
  out.unit = "m";
  out.low = INFINITY;
  out.high = -INFINITY;
  for (std::size_t i = 0; i < image.pixels(); ++i)
    if (image.target_id[i] > 0) {
      out.low = std::min(out.low, static_cast<double>(image.depth[i]));
      out.high = std::max(out.high, static_cast<double>(image.depth[i]));
    }
  if (!(out.low <= out.high)) out.low = out.high = 0;
  const double span = std::max(out.high - out.low, 1e-30);
  // near is bright
  out.rgba = colored_pixels(image, [&](std::size_t i) {
    if (image.target_id[i] == 0) return kBackground;
    return viridis(1 - (static_cast<double>(image.depth[i]) - out.low) / span);
  });
  return out;
}

}  // namespace

void scale_color(double share, std::uint8_t* rgb) {
  const Rgb color = viridis(share);
  std::copy(color.begin(), color.end(), rgb);
}

Pixels layer_pixels(const image::Image& image, const std::string& layer) {
  if (layer == "false colours") return false_color_pixels(image);
  if (layer == "depth") return depth_pixels(image);
  Pixels out;
  if (layer == "normals")
    out.rgba = colored_pixels(image, [&](std::size_t i) {
      if (image.target_id[i] == 0) return kBackground;
      Rgb rgb{};
      for (std::size_t k = 0; k < 3; ++k)
        rgb[k] = static_cast<std::uint8_t>(std::lround(
            127.5 * (1 + std::clamp(static_cast<double>(image.normal[3 * i + k]), -1.0, 1.0))));
      return rgb;
    });
  else if (layer == "parts")
    // parts of different targets have different colours
    out.rgba = colored_pixels(image, [&](std::size_t i) {
      return id_color(image.target_id[i] == 0 ? 0
                                              : image.node_id[i] + 101 * (image.target_id[i] - 1));
    });
  else
    out.rgba = colored_pixels(image, [&](std::size_t i) {
      return id_color(
          image.target_id[i] == 0 ? 0 : image.material_id[i] + 101 * (image.target_id[i] - 1));
    });
  return out;
}

std::vector<std::uint8_t> dn_pixels(const image::Image& image) {
  const std::uint32_t most = (1u << image.dn_bits) - 1;
  return colored_pixels(image, [&](std::size_t i) {
    Rgb grey{};
    grey.fill(static_cast<std::uint8_t>((255u * image.dn[i] + most / 2) / most));
    return grey;
  });
}

void mark_pixels(std::uint32_t width, std::span<const std::uint8_t> marked,
                 std::vector<std::uint8_t>& rgba) {
  for (std::size_t i = 0; i < marked.size(); ++i) {
    const bool stripe = ((i % width + i / width) / 4) % 2 == 0;
    constexpr Rgb kMagenta = {204, 0, 153};
    if (marked[i] != 0 && stripe) std::copy(kMagenta.begin(), kMagenta.end(), &rgba[4 * i]);
  }
}

void mark_white(std::uint32_t width, std::vector<std::uint8_t>& rgba) {
  std::vector<std::uint8_t> white(rgba.size() / 4);
  for (std::size_t i = 0; i < white.size(); ++i)
    white[i] = std::max({rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]}) == 255;
  mark_pixels(width, white, rgba);
}

Comparison compared(const image::Image& image, const preview::ReferenceImage& reference) {
  Comparison out;
  double off = 0, all = 0, noise = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    double is = 0, should = 0;
    for (std::size_t i = k; i < image.radiance.size(); i += 3) {
      const auto a = static_cast<double>(image.radiance[i]);
      const auto b = static_cast<double>(reference.image.radiance[i]);
      is += a;
      should += b;
      off += (a - b) * (a - b);
      all += b * b;
      noise += static_cast<double>(reference.standard_error[i]) *
               static_cast<double>(reference.standard_error[i]);
    }
    if (!(should > 0)) continue;
    const double flux = is / should - 1;
    if (std::fabs(flux) < std::fabs(out.flux)) continue;
    out.flux = flux;
    out.flux_error =
        reference.flux[static_cast<int>(k)] > 0
            ? reference.flux_error[static_cast<int>(k)] / reference.flux[static_cast<int>(k)]
            : 0;
  }
  if (all > 0) {
    out.rmse = std::sqrt(off / all);
    out.noise = std::sqrt(noise / all);
    out.rms = std::sqrt(all / static_cast<double>(image.radiance.size()));
  }
  return out;
}

Pixels difference_pixels(const image::Image& image, const image::Image& reference, double rms,
                         double range) {
  constexpr Rgb kDarker = {0, 114, 178};
  constexpr Rgb kEqual = {240, 240, 240};
  constexpr Rgb kBrighter = {213, 94, 0};
  Pixels out;
  out.low = -100 * range;
  out.high = 100 * range;
  out.unit = "% of the RMS radiance";
  const double scale = 1 / std::max(rms * range, 1e-300);
  out.rgba = colored_pixels(image, [&](std::size_t i) {
    if (image.coverage[i] == 0 && reference.coverage[i] == 0) return kBackground;
    const double share =
        std::clamp(scale * (channel_mean(image, i) - channel_mean(reference, i)), -1.0, 1.0);
    return mixed(kEqual, share < 0 ? kDarker : kBrighter, std::fabs(share));
  });
  return out;
}

}  // namespace panwright::studio
