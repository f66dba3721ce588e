#include "labels/internal/pixels.h"

#include <algorithm>

namespace panwright::labels {

PixelMask pixels_of(const Mask& mask) {
  std::uint32_t left = mask.width, top = mask.height, right = 0, bottom = 0;
  PixelMask out;
  for (std::uint32_t j = 0; j < mask.height; ++j)
    for (std::uint32_t i = 0; i < mask.width; ++i) {
      if (mask.coverage[std::size_t{j} * mask.width + i] < kMoreThanHalf) continue;
      ++out.count;
      left = std::min(left, i), right = std::max(right, i + 1);
      top = std::min(top, j), bottom = std::max(bottom, j + 1);
    }
  if (out.empty()) return out;
  out.left = mask.left + left;
  out.top = mask.top + top;
  out.width = right - left;
  out.height = bottom - top;
  out.set.reserve(std::size_t{out.width} * out.height);
  for (std::uint32_t j = top; j < bottom; ++j)
    for (std::uint32_t i = left; i < right; ++i)
      out.set.push_back(mask.coverage[std::size_t{j} * mask.width + i] >= kMoreThanHalf);
  return out;
}

std::vector<std::uint32_t> rle_counts(const PixelMask& mask, std::uint32_t width,
                                      std::uint32_t height) {
  std::vector<std::uint32_t> counts;
  std::uint64_t begin = 0;  // of the run, in columns from the left
  bool value = false;
  const auto change = [&](std::uint64_t at) {
    counts.push_back(static_cast<std::uint32_t>(at - begin));
    begin = at;
    value = !value;
  };
  for (std::uint32_t i = 0; i < mask.width; ++i) {
    const std::uint64_t column = std::uint64_t{mask.left + i} * height + mask.top;
    // columns of full height join
    if (value && mask.height < height)
      change(column - mask.top - (height - mask.top - mask.height));
    for (std::uint32_t j = 0; j < mask.height; ++j)
      if ((mask.set[std::size_t{j} * mask.width + i] != 0) != value) change(column + j);
  }
  if (value && begin < std::uint64_t{mask.left + mask.width - 1} * height + mask.top + mask.height)
    change(std::uint64_t{mask.left + mask.width - 1} * height + mask.top + mask.height);
  const std::uint64_t end = std::uint64_t{width} * height;
  if (begin < end || counts.empty()) counts.push_back(static_cast<std::uint32_t>(end - begin));
  return counts;
}

std::string rle_text(const std::vector<std::uint32_t>& counts) {
  std::string out;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    std::int64_t value = counts[k];
    if (k > 2) value -= counts[k - 2];
    for (bool more = true; more;) {
      std::int64_t group = value & 0x1f;
      value >>= 5;
      more = (group & 0x10) != 0 ? value != -1 : value != 0;
      if (more) group |= 0x20;
      out += static_cast<char>(group + 48);
    }
  }
  return out;
}

std::vector<std::uint8_t> mask_image(const PixelMask& mask, std::uint32_t width,
                                     std::uint32_t height) {
  std::vector<std::uint8_t> out(std::size_t{width} * height);
  for (std::uint32_t j = 0; j < mask.height; ++j)
    for (std::uint32_t i = 0; i < mask.width; ++i)
      if (mask.set[std::size_t{j} * mask.width + i] != 0)
        out[(std::size_t{mask.top} + j) * width + mask.left + i] = 255;
  return out;
}

}  // namespace panwright::labels
