#include "server/encode.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "server/replies.h"

namespace panwright::server {

namespace {

constexpr std::size_t kBlock = std::size_t{1} << 17;  // values
constexpr std::size_t kRows = 16;

std::string header_of(const char* magic, const image::Image& image, const char* last) {
  return fmt::format("{}\n{} {}\n{}\n", magic, image.width, image.height, last);
}

// Begins an image reply of this size and returns its bytes after the header.
std::span<std::uint8_t> begin_image(WireWriter& out, const std::string& header, std::size_t bytes) {
  out.word(reply::kImage).word(static_cast<std::uint32_t>(header.size() + bytes));
  const std::span<std::uint8_t> room = out.room(header.size() + bytes);
  std::copy(header.begin(), header.end(), room.begin());
  return room.subspan(header.size());
}

std::uint8_t code_of(float value) {
  return static_cast<std::uint8_t>(std::min(std::max(value, 0.0f), 1.0f) * 255.0f + 0.5f);
}

// In groups of a constant size, which compilers make vectors of.
void write_codes(const float* from, float scale, std::span<std::uint8_t> to) {
  constexpr std::size_t kGroup = 32;
  std::size_t at = 0;
  for (; at + kGroup <= to.size(); at += kGroup) {
    std::array<std::uint8_t, kGroup> codes;  // apart: bytes may be those of the floats
    for (std::size_t i = 0; i < kGroup; ++i) codes[i] = code_of(from[at + i] * scale);
    std::memcpy(&to[at], codes.data(), kGroup);
  }
  for (; at < to.size(); ++at) to[at] = code_of(from[at] * scale);
}

void append_numbers(const image::Image& image, bool header, WireWriter& out) {
  const unsigned most = (1u << image.dn_bits) - 1;
  const bool wide = most > 255;
  const auto bytes =
      begin_image(out, header ? header_of("P5", image, fmt::format("{}", most).c_str()) : "",
                  image.pixels() * (wide ? 2 : 1));
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const std::uint16_t number = image.dn[i];
    if (wide) bytes[2 * i] = static_cast<std::uint8_t>(number >> 8);
    bytes[wide ? 2 * i + 1 : i] = static_cast<std::uint8_t>(number);
  }
}

// Calls body(begin, end) for blocks of [0, count).
template <class Body>
void in_blocks(std::size_t count, std::size_t block, const Job& job, const Body& body) {
  parallel_for((count + block - 1) / block,
               [&](std::size_t k) { body(k * block, std::min(count, (k + 1) * block)); }, job);
}

float mean_of(const float* bands) { return (bands[0] + bands[1] + bands[2]) / 3; }

void append_floats(const image::Image& image, bool grey, WireWriter& out) {
  const std::size_t channels = grey ? 1 : 3;
  const std::size_t row = channels * image.width;
  const auto bytes =
      begin_image(out, header_of(grey ? "Pf" : "PF", image, "-1.0"), 4 * row * image.height);
  std::vector<float> line(row);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const float* from =
        image.radiance.data() + std::size_t{3} * image.width * (image.height - 1 - y);
    for (std::size_t i = 0; i < row; ++i) line[i] = grey ? mean_of(from + 3 * i) : from[i];
    std::memcpy(bytes.data() + 4 * row * y, line.data(), 4 * row);
  }
}

}  // namespace

void add_sky_and_fog(const State& state, double white, image::Image& image, const Job& job) {
  const Vec3 sky = state.sky.color() * (white / kPi);
  const bool fog = state.fog.mode != FogMode::none && !image.range.empty();
  if (!fog && sky == Vec3(0)) return;
  in_blocks(image.height, kRows, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * image.width; i < end * image.width; ++i) {
      float* const radiance = &image.radiance[3 * i];
      const double coverage = image.coverage[i];
      double through = 1;
      if (fog) {
        double range = image.range[i];
        // the centre of a pixel on an edge may see past the target
        if (!std::isfinite(range) && coverage > 0)
          for (const std::ptrdiff_t step :
               {std::ptrdiff_t{-1}, std::ptrdiff_t{1}, -static_cast<std::ptrdiff_t>(image.width),
                static_cast<std::ptrdiff_t>(image.width)}) {
            const std::ptrdiff_t near = static_cast<std::ptrdiff_t>(i) + step;
            if (near >= 0 && near < static_cast<std::ptrdiff_t>(image.pixels()))
              range = std::min<double>(range, image.range[static_cast<std::size_t>(near)]);
          }
        through = state.fog.transmission(range);
      }
      // background and air have the sky's light; a covered pixel as much of it as is not let
      // through
      const double added = (1 - coverage) + coverage * (1 - through);
      for (int k = 0; k < 3; ++k)
        radiance[k] = static_cast<float>(radiance[k] * through + sky[k] * added);
    }
  });
}

void append_image(const Drawing& drawing, const WireImages& images, WireWriter& out,
                  const Job& job) {
  const image::Image& image = drawing.image;
  if (!image.dn.empty() && images.format != WireFormat::floats)
    return append_numbers(image, images.format == WireFormat::ppm, out);
  if (images.format == WireFormat::floats) return append_floats(image, images.grey, out);
  const std::size_t values = image.pixels() * (images.grey ? 1 : 3);
  const auto bytes = begin_image(
      out,
      images.format == WireFormat::raw ? "" : header_of(images.grey ? "P5" : "P6", image, "255"),
      values);
  const auto scale = static_cast<float>(kPi / drawing.white);
  const float* const from = image.radiance.data();
  in_blocks(values, kBlock, job, [&](std::size_t begin, std::size_t end) {
    if (images.grey)
      for (std::size_t i = begin; i < end; ++i) bytes[i] = code_of(mean_of(from + 3 * i) * scale);
    else
      write_codes(from + begin, scale, bytes.subspan(begin, end - begin));
  });
}

void append_greys(std::span<const std::uint8_t> greys, std::uint32_t width, std::uint32_t height,
                  const WireImages& images, WireWriter& out) {
  image::Image size;
  size.width = width;
  size.height = height;
  const bool header = images.format != WireFormat::raw;
  const std::size_t channels = images.grey ? 1 : 3;
  const auto bytes =
      begin_image(out, header ? header_of(images.grey ? "P5" : "P6", size, "255") : "",
                  greys.size() * channels);
  for (std::size_t i = 0; i < greys.size(); ++i)
    for (std::size_t k = 0; k < channels; ++k) bytes[channels * i + k] = greys[i];
}

}  // namespace panwright::server
