#include "terrain/internal/samples.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace panwright::terrain {

namespace {

constexpr double kMostHeight = 1e30;
constexpr std::uint64_t kBandBytes = 4u << 20;  // of rows that are given at once

template <class T>
std::uint64_t bits_of(T value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof value);
  return bits;
}

template <class T>
T swapped(T value) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof value);
  std::reverse(bytes.begin(), bytes.end());
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

// F_floating: 16-bit words of which the first holds sign, exponent of excess 128, and the upper
// bits of a fraction of 0.5 to 1 without its first.
double vax_f(std::uint32_t stored, bool& reserved) {
  const std::uint32_t bits = stored << 16 | stored >> 16;
  const int exponent = static_cast<int>(bits >> 23 & 0xff);
  reserved = exponent == 0 && (bits >> 31) != 0;
  if (exponent == 0) return 0;
  const double fraction = 0.5 + static_cast<double>(bits & 0x7fffff) / 16777216.0;
  const double value = std::ldexp(fraction, exponent - 128);
  return bits >> 31 ? -value : value;
}

}  // namespace

std::string SampleType::words() const {
  const char* name = kind == Kind::unsigned_integer ? "unsigned integer"
                     : kind == Kind::signed_integer ? "integer"
                     : kind == Kind::real           ? "float"
                                                    : "VAX float";
  std::string out = fmt::format("{}-bit {}", 8 * bytes, name);
  if (bytes > 1 && kind != Kind::vax_real) out += big_endian ? ", big-endian" : ", little-endian";
  return out;
}

void VoidRules::add_isis(const SampleType& type) {
  using K = VoidKind;
  constexpr K kOrder[] = {K::null, K::low_representation, K::low_instrument, K::high_instrument,
                          K::high_representation};
  if (type.kind == SampleType::Kind::real) {
    const std::uint64_t base = type.bytes == 4 ? 0xff7ffffbull : 0xffeffffffffffffbull;
    for (unsigned k = 0; k < 5; ++k) patterns.emplace_back(base + k, kOrder[k]);
  } else if (type.kind == SampleType::Kind::signed_integer && type.bytes == 2) {
    for (unsigned k = 0; k < 5; ++k) patterns.emplace_back(0x8000u + k, kOrder[k]);
  } else if (type.kind == SampleType::Kind::unsigned_integer && type.bytes == 2) {
    patterns.insert(patterns.end(), {{0u, K::null},
                                     {1u, K::low_representation},
                                     {2u, K::low_instrument},
                                     {65534u, K::high_instrument},
                                     {65535u, K::high_representation}});
  } else if (type.kind == SampleType::Kind::unsigned_integer && type.bytes == 1) {
    patterns.insert(patterns.end(), {{0u, K::null}, {255u, K::high_representation}});
  }
}

Decoder::Decoder(SampleType type, const VoidRules& rules) : type_(type), rules_(rules) {
  // a label writes a float's value with fewer or more digits than it has
  for (auto& [value, kind] : rules_.values)
    if (type_.kind == SampleType::Kind::real && type_.bytes == 4)
      value = static_cast<double>(
          static_cast<float>(std::clamp(value, -double(std::numeric_limits<float>::max()),
                                        double(std::numeric_limits<float>::max()))));
}

VoidKind Decoder::kind_of(double value, std::uint64_t bits) const {
  for (const auto& [pattern, kind] : rules_.patterns)
    if (bits == pattern) return kind;
  if (!std::isfinite(value)) return VoidKind::not_finite;
  for (const auto& [constant, kind] : rules_.values)
    if (value == constant || (std::fabs(constant) > kMostHeight &&
                              std::fabs(value - constant) < 1e-5 * std::fabs(constant)))
      return kind;
  if (value < rules_.least || value > rules_.largest) return VoidKind::out_of_range;
  if (rules_.undeclared && std::fabs(value) > kMostHeight) return VoidKind::undeclared;
  return VoidKind::none;
}

template <class T>
void Decoder::run_as(const std::byte* from, std::size_t stride, std::span<double> to,
                     std::span<VoidKind> voids) const {
  const bool swap = type_.big_endian != (std::endian::native == std::endian::big);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool ruled = !rules_.patterns.empty() || !rules_.values.empty() ||
                     std::isfinite(rules_.least) || std::isfinite(rules_.largest) ||
                     std::is_floating_point_v<T>;
  for (std::size_t i = 0; i < to.size(); ++i, from += stride) {
    T stored;
    std::memcpy(&stored, from, sizeof stored);
    if (swap) stored = swapped(stored);
    const double value = static_cast<double>(stored);
    const VoidKind kind = ruled ? kind_of(value, bits_of(stored)) : VoidKind::none;
    voids[i] = kind;
    to[i] = kind == VoidKind::none ? value : kNone;
  }
}

void Decoder::run(const std::byte* from, std::size_t stride, std::span<double> to,
                  std::span<VoidKind> voids) const {
  using K = SampleType::Kind;
  if (type_.kind == K::vax_real) {
    for (std::size_t i = 0; i < to.size(); ++i, from += stride) {
      std::uint32_t stored = 0;
      std::memcpy(&stored, from, sizeof stored);
      bool reserved = false;
      to[i] = vax_f(stored, reserved);
      voids[i] = reserved ? VoidKind::not_finite : kind_of(to[i], stored);
      if (voids[i] != VoidKind::none) to[i] = std::numeric_limits<double>::quiet_NaN();
    }
    return;
  }
  const auto as = [&]<class T>(T) { run_as<T>(from, stride, to, voids); };
  if (type_.kind == K::real) return type_.bytes == 8 ? as(double{}) : as(float{});
  const bool is_signed = type_.kind == K::signed_integer;
  switch (type_.bytes) {
    case 1:
      return is_signed ? as(std::int8_t{}) : as(std::uint8_t{});
    case 2:
      return is_signed ? as(std::int16_t{}) : as(std::uint16_t{});
    case 4:
      return is_signed ? as(std::int32_t{}) : as(std::uint32_t{});
    default:
      return is_signed ? as(std::int64_t{}) : as(std::uint64_t{});
  }
}

void Decoder::judge(std::span<double> values, std::span<VoidKind> voids) const {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool single = type_.kind == SampleType::Kind::real && type_.bytes == 4;
    voids[i] =
        kind_of(values[i], single ? bits_of(static_cast<float>(values[i])) : bits_of(values[i]));
    if (voids[i] != VoidKind::none) values[i] = std::numeric_limits<double>::quiet_NaN();
  }
}

std::uint64_t RawLayout::end() const {
  constexpr double kMost = 4e18;
  const double lines = double(height) * bands;
  double total = 0;
  if (tile_width > 0) {
    const std::uint64_t across = (std::uint64_t{width} + tile_width - 1) / tile_width;
    const std::uint64_t down = (std::uint64_t{height} + tile_height - 1) / tile_height;
    total = double(across) * double(down) * bands * tile_width * tile_height * type.bytes;
  } else if (order == Order::samples) {
    total = double(height) * (double(prefix) + double(suffix) + double(width) * bands * type.bytes);
  } else {
    total = lines * (double(prefix) + double(suffix) + double(width) * type.bytes);
  }
  if (double(start) + total > kMost) return 0;
  // below 2^62 the integers are exact
  if (tile_width > 0) {
    const std::uint64_t across = (std::uint64_t{width} + tile_width - 1) / tile_width;
    const std::uint64_t down = (std::uint64_t{height} + tile_height - 1) / tile_height;
    return start + across * down * bands * tile_width * tile_height * type.bytes;
  }
  if (order == Order::samples)
    return start + height * (prefix + suffix + std::uint64_t{width} * bands * type.bytes) - suffix;
  return start +
         std::uint64_t{height} * bands * (prefix + suffix + std::uint64_t{width} * type.bytes) -
         suffix;
}

namespace {

class RawSource : public RowSource {
 public:
  RawSource(MappedFile file, const RawLayout& layout, std::uint32_t band, const VoidRules& rules)
      : file_(std::move(file)), layout_(layout), band_(band - 1), decoder_(layout.type, rules) {}

  bool read(std::uint32_t first, std::uint32_t count, const RowsReceiver& to, DiagnosticLog&,
            const Job& job) const override {
    const RawLayout& l = layout_;
    const std::uint64_t row_bytes = std::uint64_t{l.width} * sizeof(double);
    const auto at_once = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(kBandBytes / row_bytes, 1, std::max(count, 1u)));
    std::vector<double> values(std::size_t{at_once} * l.width);
    std::vector<VoidKind> voids(values.size());
    for (std::uint32_t row = first; row < first + count;) {
      job.poll();
      const std::uint32_t rows = std::min(at_once, first + count - row);
      for (std::uint32_t k = 0; k < rows; ++k)
        decode_row(row + k, std::span(values).subspan(std::size_t{k} * l.width, l.width),
                   std::span(voids).subspan(std::size_t{k} * l.width, l.width));
      const std::size_t size = std::size_t{rows} * l.width;
      if (!to({row, rows, std::span(values).first(size), std::span(voids).first(size)}))
        return false;
      release(row, row + rows);
      row += rows;
    }
    return true;
  }

 private:
  void decode_row(std::uint32_t row, std::span<double> to, std::span<VoidKind> voids) const {
    const RawLayout& l = layout_;
    const std::byte* bytes = file_.bytes().data();
    const std::uint64_t size = l.type.bytes;
    if (l.tile_width > 0) {
      const std::uint64_t across = (std::uint64_t{l.width} + l.tile_width - 1) / l.tile_width;
      const std::uint64_t down = (std::uint64_t{l.height} + l.tile_height - 1) / l.tile_height;
      const std::uint64_t tile = std::uint64_t{l.tile_width} * l.tile_height * size;
      for (std::uint64_t k = 0; k < across; ++k) {
        const std::uint64_t left = k * l.tile_width;
        const std::uint64_t index = (band_ * down + row / l.tile_height) * across + k;
        const std::size_t wide =
            std::min<std::uint64_t>(l.tile_width, std::uint64_t{l.width} - left);
        decoder_.run(bytes + l.start + index * tile +
                         std::uint64_t{row % l.tile_height} * l.tile_width * size,
                     size, to.subspan(left, wide), voids.subspan(left, wide));
      }
      return;
    }
    decoder_.run(bytes + line_at(row), l.order == RawLayout::Order::samples ? l.bands * size : size,
                 to, voids);
  }
  std::uint64_t line_at(std::uint64_t row) const {
    const RawLayout& l = layout_;
    const std::uint64_t size = l.type.bytes;
    if (l.order == RawLayout::Order::samples)
      return l.start + row * (l.prefix + l.suffix + std::uint64_t{l.width} * l.bands * size) +
             l.prefix + band_ * size;
    const std::uint64_t line =
        l.order == RawLayout::Order::lines ? row * l.bands + band_ : band_ * l.height + row;
    return l.start + line * (l.prefix + l.suffix + l.width * size) + l.prefix;
  }
  // Gives back the memory of rows [from, to), which are not read again soon.
  void release(std::uint32_t from, std::uint32_t to) const {
    const std::uint64_t size = file_.bytes().size();
    const std::uint64_t begin = std::min(place_of(from), size), end = std::min(place_of(to), size);
    if (end > begin) file_.release(file_.bytes().subspan(begin, end - begin));
  }
  // First byte that a row and those below need.
  std::uint64_t place_of(std::uint32_t row) const {
    const RawLayout& l = layout_;
    if (l.tile_width == 0) return line_at(row) - l.prefix;
    const std::uint64_t across = (std::uint64_t{l.width} + l.tile_width - 1) / l.tile_width;
    const std::uint64_t down = (std::uint64_t{l.height} + l.tile_height - 1) / l.tile_height;
    return l.start + (band_ * down + row / l.tile_height) * across *
                         (std::uint64_t{l.tile_width} * l.tile_height * l.type.bytes);
  }

  MappedFile file_;
  RawLayout layout_;
  std::uint64_t band_;
  Decoder decoder_;
};

}  // namespace

std::unique_ptr<RowSource> raw_source(MappedFile file, const RawLayout& layout, std::uint32_t band,
                                      const VoidRules& rules) {
  return std::make_unique<RawSource>(std::move(file), layout, band, rules);
}

}  // namespace panwright::terrain
