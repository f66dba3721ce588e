#include "image/texture_bake.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/parallel.h"
#include "image/srgb.h"

namespace panwright::image {

namespace {

// What codes stand for, and the code nearest to a number.
class Coding {
 public:
  explicit Coding(bool srgb) {
    const auto value = [&](double code) {
      return srgb ? linear_from_srgb(code / 255) : code / 255;
    };
    for (std::size_t i = 0; i < 256; ++i) values_[i] = value(static_cast<double>(i));
    for (std::size_t i = 0; i < 255; ++i) edges_[i] = value(static_cast<double>(i) + 0.5);
    for (std::size_t i = 0; i < kBuckets; ++i) {
      const auto above =
          std::upper_bound(edges_.begin(), edges_.end(), static_cast<double>(i) / kBuckets);
      buckets_[i] = static_cast<std::uint8_t>(above - edges_.begin());
    }
  }
  double value(std::uint8_t code) const { return values_[code]; }
  // value: 0 to 1
  std::uint8_t code(double value) const {
    if (!(value < 1)) return 255;
    std::uint8_t code = buckets_[static_cast<std::size_t>(value * kBuckets)];
    while (code < 255 && edges_[code] <= value) ++code;
    return code;
  }

 private:
  static constexpr std::size_t kBuckets = 4096;  // of 0 to 1: few hold an edge, none holds two
  std::array<double, 256> values_{};
  std::array<double, 255> edges_{};               // half way between two codes
  std::array<std::uint8_t, kBuckets> buckets_{};  // the code where each begins
};

// The two texels of one axis beside the centre of another texture's texel, and the second's share.
struct Pair {
  std::size_t first = 0;
  std::size_t second = 0;
  double share = 0;
};

std::vector<Pair> pairs(std::uint32_t from, std::uint32_t to) {
  std::vector<Pair> all(to);
  for (std::uint32_t i = 0; i < to; ++i) {
    const double at = (i + 0.5) / to * from - 0.5;
    const double below = std::floor(at);
    const auto texel = static_cast<std::int64_t>(below);
    const auto wrapped = [&](std::int64_t k) {
      return static_cast<std::size_t>((k + from) % static_cast<std::int64_t>(from));
    };
    all[i] = {wrapped(texel), wrapped(texel + 1), at - below};
  }
  return all;
}

class Reader {
 public:
  Reader(const BakeSource& source, std::uint32_t width, std::uint32_t height, const Coding& colors,
         const Coding& numbers)
      : source_(source), colors_(source.srgb ? colors : numbers), numbers_(numbers) {
    if (source.rgba.empty()) return;
    columns_ = pairs(source.width, width);
    rows_ = pairs(source.height, height);
  }

  Vec4 at(std::size_t x, std::size_t y) const {
    if (source_.rgba.empty()) return Vec4(1);
    const auto row = [&](std::size_t j) {
      const Pair& p = columns_[x];
      if (p.share == 0) return texel(p.first, j);
      return texel(p.first, j) * (1 - p.share) + texel(p.second, j) * p.share;
    };
    const Pair& p = rows_[y];
    return p.share == 0 ? row(p.first) : row(p.first) * (1 - p.share) + row(p.second) * p.share;
  }

 private:
  Vec4 texel(std::size_t x, std::size_t y) const {
    const std::uint8_t* code = &source_.rgba[4 * (y * source_.width + x)];
    return {colors_.value(code[0]), colors_.value(code[1]), colors_.value(code[2]),
            numbers_.value(code[3])};
  }

  BakeSource source_;
  const Coding& colors_;
  const Coding& numbers_;
  std::vector<Pair> columns_;
  std::vector<Pair> rows_;
};

}  // namespace

std::uint32_t baked_width(std::span<const BakeSource> sources) {
  std::uint32_t side = 0;
  for (const BakeSource& source : sources) side = std::max(side, source.width);
  return side;
}

std::uint32_t baked_height(std::span<const BakeSource> sources) {
  std::uint32_t side = 0;
  for (const BakeSource& source : sources) side = std::max(side, source.height);
  return side;
}

Baked baked(std::span<const BakeSource> sources, std::span<const bool> srgb,
            const std::function<void(std::span<const Vec4>, std::span<Vec4>)>& texel,
            const Job& job) {
  const Coding colors(true), numbers(false);
  Baked out{baked_width(sources), baked_height(sources), {}};
  assert(out.width > 0 && out.height > 0);
  out.textures.resize(srgb.size());
  for (auto& texture : out.textures) texture.resize(std::size_t{4} * out.width * out.height);
  std::vector<Reader> readers;
  for (const BakeSource& source : sources)
    readers.emplace_back(source, out.width, out.height, colors, numbers);
  parallel_for(
      out.height,
      [&](std::size_t y) {
        std::vector<Vec4> from(sources.size()), before, to(srgb.size());
        for (std::size_t x = 0; x < out.width; ++x) {
          for (std::size_t i = 0; i < from.size(); ++i) from[i] = readers[i].at(x, y);
          const bool same = from == before;  // as in evenly coloured areas
          if (!same) {
            texel(from, to);
            before = from;
          }
          for (std::size_t i = 0; i < to.size(); ++i) {
            std::uint8_t* code = &out.textures[i][4 * (y * out.width + x)];
            if (same) {
              std::copy_n(code - 4, 4, code);
              continue;
            }
            const Vec4 value = glm::clamp(to[i], Vec4(0), Vec4(1));
            for (int k = 0; k < 4; ++k)
              code[k] = (srgb[i] && k < 3 ? colors : numbers).code(value[k]);
          }
        }
      },
      job);
  return out;
}

}  // namespace panwright::image
