// Kernels that tests write, and questions that every sound kernel answers.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/file.h"
#include "ephemeris/kernels.h"

namespace panwright::ephemeris::testing_support {

struct Segment {
  std::vector<std::int32_t> numbers;  // body, centre, frame, type; of its kind
  double begin = 0, end = 0;
  std::vector<double> data;
  std::string name = "TEST";
};

enum class Order { little, big };

// Binary file of arrays.
class DafWriter {
 public:
  DafWriter(std::string word, Order order, std::string format)
      : order_(order), word_(std::move(word)), format_(std::move(format)) {}

  std::string write(const std::vector<Segment>& segments) {
    constexpr std::size_t kRecord = 1024;
    const std::size_t integers = segments.front().numbers.size() + 2;
    const std::size_t size = 2 + (integers + 1) / 2;
    const std::size_t most = 125 / size;
    const std::size_t groups = (segments.size() + most - 1) / most;
    bytes_.assign(kRecord * (1 + 2 * groups), '\0');
    text(0, word_, 8);
    integer(8, 2);
    integer(12, static_cast<std::int32_t>(integers));
    text(16, "TEST", 60);
    integer(76, 2);
    integer(80, static_cast<std::int32_t>(2 * groups));
    text(88, format_, 8);
    for (std::size_t g = 0; g < groups; ++g) {
      const std::size_t at = kRecord * (1 + 2 * g);
      const std::size_t count = std::min(most, segments.size() - g * most);
      real(at, g + 1 < groups ? static_cast<double>(2 + 2 * (g + 1)) : 0);
      real(at + 8, g > 0 ? static_cast<double>(2 * g) : 0);
      real(at + 16, static_cast<double>(count));
      for (std::size_t k = 0; k < count; ++k) add(segments[g * most + k], at, k, size);
    }
    while (bytes_.size() % kRecord != 0) bytes_.push_back('\0');
    return bytes_;
  }

 private:
  void add(const Segment& segment, std::size_t record, std::size_t k, std::size_t size) {
    const std::size_t at = record + 24 + 8 * k * size;
    real(at, segment.begin);
    real(at + 8, segment.end);
    std::size_t place = at + 16;
    for (const std::int32_t number : segment.numbers) {
      integer(place, number);
      place += 4;
    }
    const std::size_t first = bytes_.size() / 8 + 1;
    integer(place, static_cast<std::int32_t>(first));
    integer(place + 4, static_cast<std::int32_t>(first + segment.data.size() - 1));
    text(record + 1024 + 8 * k * size, segment.name, 8 * size);
    for (const double value : segment.data) {
      bytes_.resize(bytes_.size() + 8);
      real(bytes_.size() - 8, value);
    }
  }
  template <class Bits>
  void put(std::size_t at, Bits bits) {
    for (std::size_t i = 0; i < sizeof bits; ++i) {
      const std::size_t shift = 8 * (order_ == Order::little ? i : sizeof bits - 1 - i);
      bytes_[at + i] = static_cast<char>(bits >> shift & 0xff);
    }
  }
  void integer(std::size_t at, std::int32_t value) { put(at, static_cast<std::uint32_t>(value)); }
  void real(std::size_t at, double value) { put(at, std::bit_cast<std::uint64_t>(value)); }
  void text(std::size_t at, const std::string& value, std::size_t length) {
    for (std::size_t i = 0; i < length; ++i) bytes_[at + i] = i < value.size() ? value[i] : ' ';
  }

  Order order_;
  std::string word_, format_;
  std::string bytes_;
};

inline std::string daf(const std::string& word, const std::vector<Segment>& segments,
                       Order order = Order::little) {
  return DafWriter(word, order, order == Order::little ? "LTL-IEEE" : "BIG-IEEE").write(segments);
}

// A straight and curved path whose states are known: cubic in t, km and s.
inline State path(double t) {
  const Vec3 a(7000, -20, 3), b(1, 7, -2), c(-3e-3, 2e-3, 1e-3), d(1e-6, -2e-6, 3e-6);
  return {a + t * (b + t * (c + t * d)), b + t * (2.0 * c + t * 3.0 * d)};
}
inline Vec3 acceleration(double t) {
  return Vec3(-6e-3, 4e-3, 2e-3) + t * Vec3(6e-6, -12e-6, 18e-6);
}

inline void append(std::vector<double>& out, const State& state) {
  for (int i = 0; i < 3; ++i) out.push_back(state.position[i]);
  for (int i = 0; i < 3; ++i) out.push_back(state.velocity[i]);
}

// Chebyshev coefficients of a cubic by its values at the zeros of T4.
inline std::vector<double> chebyshev_of(const std::vector<double>& values) {
  std::vector<double> out;
  for (int k = 0; k < 4; ++k) {
    double sum = 0;
    for (int i = 0; i < 4; ++i) sum += values[i] * std::cos(kPi * k * (i + 0.5) / 4);
    out.push_back(sum * (k == 0 ? 0.25 : 0.5));
  }
  return out;
}

// The path from 0 to 600 s as the numbers of a segment of a type.
std::vector<double> segment_numbers(int type);

inline Segment segment(int type, int body = -99, int centre = 399, int frame = 1) {
  return {{body, centre, frame, type}, 0, 600, segment_numbers(type)};
}

// Loads bytes as one kernel and asks for all that it may answer. What is answered is finite, unless
// it says why not. Returns whether it was loaded.
bool ask_all(const std::string& bytes, std::string& broken);

}  // namespace panwright::ephemeris::testing_support
