#include "pan/internal/scan.h"

#include <cstring>

namespace panwright::pan::internal {

namespace {

// four lanes, as GCC and Clang offer them on every processor
typedef float F4 __attribute__((vector_size(16)));
typedef std::int32_t I4 __attribute__((vector_size(16)));
typedef std::uint32_t U4 __attribute__((vector_size(16)));
typedef std::uint16_t U8 __attribute__((vector_size(16)));

template <class V, class T>
V load_lanes(const T* from) {
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

bool none(I4 mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) == 0; }

template <class V, class T>
bool below(const T* values, std::size_t n, std::uint32_t limit) {
  constexpr std::size_t kLanes = sizeof(V) / sizeof(T);
  if (limit > static_cast<T>(-1)) return true;
  const V bound = V{} + static_cast<T>(limit);
  V bad{};
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes) bad |= (V)(load_lanes<V>(values + i) >= bound);
  bool good = true;
  for (std::size_t k = 0; k < kLanes; ++k) good &= bad[k] == 0;
  for (; i < n; ++i) good &= values[i] < limit;
  return good;
}

}  // namespace

bool all_below(const std::uint16_t* values, std::size_t n, std::uint32_t limit) {
  return below<U8>(values, n, limit);
}

bool all_below(const std::uint32_t* values, std::size_t n, std::uint32_t limit) {
  return below<U4>(values, n, limit);
}

bool all_between(const float* values, std::size_t n, float low, float high) {
  const F4 least = F4{} + low, most = F4{} + high;
  I4 in = ~I4{};
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    const F4 v = load_lanes<F4>(values + i);
    in &= (v >= least) & (v <= most);
  }
  bool good = none(~in);
  for (; i < n; ++i) good &= values[i] >= low && values[i] <= high;
  return good;
}

bool all_within(const float* p, std::size_t n, const float low[3], const float high[3]) {
  // four vectors are three groups of four lanes, each with its own turn of x y z
  F4 l[3], h[3];
  for (int k = 0; k < 12; ++k) {
    l[k / 4][k % 4] = low[k % 3];
    h[k / 4][k % 4] = high[k % 3];
  }
  I4 in = ~I4{};
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    const F4 a = load_lanes<F4>(p + 3 * i), b = load_lanes<F4>(p + 3 * i + 4),
             c = load_lanes<F4>(p + 3 * i + 8);
    in &= (a >= l[0]) & (a <= h[0]) & (b >= l[1]) & (b <= h[1]) & (c >= l[2]) & (c <= h[2]);
  }
  bool good = none(~in);
  for (; i < n; ++i)
    for (int k = 0; k < 3; ++k) good &= p[3 * i + k] >= low[k] && p[3 * i + k] <= high[k];
  return good;
}

bool all_unit(const float* p, std::size_t n) {
  const F4 low = F4{} + (1.0f - kUnitTolerance), high = F4{} + (1.0f + kUnitTolerance);
  I4 in = ~I4{};
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    F4 a = load_lanes<F4>(p + 3 * i), b = load_lanes<F4>(p + 3 * i + 4),
       c = load_lanes<F4>(p + 3 * i + 8);
    a *= a;
    b *= b;
    c *= c;
    // a = x0 y0 z0 x1, b = y1 z1 x2 y2, c = z2 x3 y3 z3
    const F4 xx = __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 3, 6, 6), c, 0, 1, 2, 5);
    const F4 yy = __builtin_shufflevector(__builtin_shufflevector(a, b, 1, 4, 7, 7), c, 0, 1, 2, 6);
    const F4 zz = __builtin_shufflevector(__builtin_shufflevector(a, b, 2, 5, 5, 5), c, 0, 1, 4, 7);
    const F4 squared = (xx + yy) + zz;
    in &= (squared >= low) & (squared <= high);
  }
  bool good = none(~in);
  for (; i < n; ++i) {
    const float* v = p + 3 * i;
    const float squared = (v[0] * v[0] + v[1] * v[1]) + v[2] * v[2];
    good &= squared >= low[0] && squared <= high[0];
  }
  return good;
}

bool is_text(std::string_view bytes) {
  const auto* at = reinterpret_cast<const unsigned char*>(bytes.data());
  const unsigned char* const end = at + bytes.size();
  while (at < end) {
    const unsigned first = *at++;
    if (first == 0) return false;
    if (first < 0x80) continue;
    const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
    if (first < 0xc2 || first > 0xf4 || end - at < more) return false;
    // the second byte excludes overlong forms, surrogates and what lies above U+10FFFF
    const unsigned low = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
    const unsigned high = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
    if (*at < low || *at > high) return false;
    for (int i = 1; i < more; ++i)
      if (at[i] < 0x80 || at[i] > 0xbf) return false;
    at += more;
  }
  return true;
}

}  // namespace panwright::pan::internal
