// Arithmetic of a few pixels at a time, in loops that compilers turn into vector instructions. Only
// operations that IEEE 754 rounds exactly, so that every instruction set gives the same bits.
// Private to sensor.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace panwright::sensor::lanes {

inline constexpr int kLanes = 64;

using Words = std::array<std::uint32_t, kLanes>;
using Doubles = std::array<double, kLanes>;

#define PANWRIGHT_LANES [[gnu::always_inline]] inline

// Philox4x32-10 (base/random.h) for counters c, whose words are replaced.
template <std::size_t N>
PANWRIGHT_LANES void philox_lanes(std::array<std::array<std::uint32_t, N>, 4>& c,
                                  std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    for (std::size_t i = 0; i < N; ++i) {
      const std::uint64_t a = std::uint64_t{0xD2511F53u} * c[0][i];
      const std::uint64_t b = std::uint64_t{0xCD9E8D57u} * c[2][i];
      const std::uint32_t c1 = c[1][i], c3 = c[3][i];
      c[0][i] = static_cast<std::uint32_t>(b >> 32) ^ c1 ^ key[0];
      c[1][i] = static_cast<std::uint32_t>(b);
      c[2][i] = static_cast<std::uint32_t>(a >> 32) ^ c3 ^ key[1];
      c[3][i] = static_cast<std::uint32_t>(a);
    }
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
}

// A number in (0, 1): the middle of one of 2^52 steps.
PANWRIGHT_LANES double unit(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t bits = (std::uint64_t{high} << 32 | low) >> 12;
  return (std::bit_cast<double>(bits | 0x3FF0000000000000u) - 1.0) + 0x1p-53;
}

// Rounds to the nearest whole number, and down. Expects: |x| < 2^51.
PANWRIGHT_LANES double nearest(double x) { return (x + 0x1.8p52) - 0x1.8p52; }
PANWRIGHT_LANES double down(double x) {
  const double r = nearest(x);
  return r - (r > x ? 1.0 : 0.0);
}

// Natural logarithm of a normal number above 0, within 1 ulp or so: x = 2^e m, m about 1,
// log m = 2 artanh((m − 1)/(m + 1)). Coefficients: FreeBSD's msun, e_log.c.
PANWRIGHT_LANES double log(double x) {
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t shifted = bits + (0x3FF0000000000000u - 0x3FE6A09E667F3BCDu);
  // the exponent as a double: a whole number into the mantissa of 2^52
  const double e = std::bit_cast<double>((shifted >> 52) | 0x4330000000000000u) - (0x1p52 + 1023.0);
  const double m = std::bit_cast<double>((shifted & 0x000FFFFFFFFFFFFFu) + 0x3FE6A09E667F3BCDu);
  const double f = m - 1.0;
  const double s = f / (2.0 + f), z = s * s, w = z * z;
  const double odd = w * (3.999999999940941908e-01 +
                          w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const double even = z * (6.666666666666735130e-01 +
                           w * (2.857142874366239149e-01 +
                                w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
  const double half = 0.5 * f * f;
  return e * 6.93147180369123816490e-01 -
         ((half - (s * (half + (odd + even)) + e * 1.90821492927058770002e-10)) - f);
}

// e^x for −700 < x <= 0, within 2 ulp: 2^k times the Taylor series of the rest.
PANWRIGHT_LANES double exp(double x) {
  const double k = nearest(x * 1.44269504088896338700);
  const double r = (x - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10;
  double p = 1.0 / 6227020800.0;
  constexpr double kTerms[] = {1.0 / 479001600,
                               1.0 / 39916800,
                               1.0 / 3628800,
                               1.0 / 362880,
                               1.0 / 40320,
                               1.0 / 5040,
                               1.0 / 720,
                               1.0 / 120,
                               1.0 / 24,
                               1.0 / 6,
                               0.5,
                               1.0,
                               1.0};
  for (const double term : kTerms) p = p * r + term;
  const std::uint64_t power = (std::bit_cast<std::uint64_t>(k + (0x1.8p52 + 1023.0)) << 52);
  return p * std::bit_cast<double>(power);
}

// sin and cos of 2 π u for u in (0, 1). Coefficients: FreeBSD's msun, k_sin.c, k_cos.c.
struct Turn {
  double sin;
  double cos;
};
PANWRIGHT_LANES Turn turn(double u) {
  const double q = nearest(4.0 * u);
  const double x = (u - 0.25 * q) * 6.28318530717958647693;
  const double z = x * x;
  const double s =
      x + x * z *
              (-1.66666666666666324348e-01 +
               z * (8.33333333332248946124e-03 +
                    z * (-1.98412698298579493134e-04 +
                         z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 +
                                                                z * 1.58969099521155010221e-10)))));
  const double c =
      1.0 - 0.5 * z +
      z * z *
          (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 +
                z * (2.48015872894767294178e-05 +
                     z * (-2.75573143513906633035e-07 +
                          z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
  // quarters 1 and 3 swap; 2 and 3 turn the sine, 1 and 2 the cosine
  const double odd = (q == 1.0 ? 1.0 : 0.0) + (q == 3.0 ? 1.0 : 0.0);
  const double sine = s * (1.0 - odd) + c * odd, cosine = c * (1.0 - odd) + s * odd;
  const double sine_sign = (q == 2.0 ? -1.0 : 1.0) * (q == 3.0 ? -1.0 : 1.0);
  const double cosine_sign = (q == 1.0 ? -1.0 : 1.0) * (q == 2.0 ? -1.0 : 1.0);
  return {sine * sine_sign, cosine * cosine_sign};
}

}  // namespace panwright::sensor::lanes
