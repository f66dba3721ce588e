#include "sensor/draws.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "sensor/internal/lanes.h"

namespace panwright::sensor {

namespace {

using lanes::Doubles;
using lanes::kLanes;
using lanes::Words;

constexpr double kSmall = 10;  // below, inversion
constexpr double kMost = 1e12;

// ln k! below 10.
constexpr double kLogFactorial[] = {0,
                                    0,
                                    0.69314718055994530942,
                                    1.79175946922805500081,
                                    3.17805383034794561965,
                                    4.78749174278204599425,
                                    6.57925121201010099506,
                                    8.52516136106541430017,
                                    10.6046029027452502284,
                                    12.8018274800814696112};

// Pixels and their means, a few at a time.
struct Batch {
  int count = 0;
  Words pixel{};
  Words attempt{};
  Doubles mean{};
  Words slot{};  // place in the caller's span

  Batch() { mean.fill(kSmall); }
  void add(std::uint32_t which, std::uint32_t tried, double of, std::uint32_t where) {
    pixel[count] = which;
    attempt[count] = tried;
    mean[count] = of;
    slot[count++] = where;
  }
};

PANWRIGHT_LANES void block_lanes(const Words& pixel, const Words& block, const Stream& stream,
                                 std::array<Words, 4>& words) {
  for (int i = 0; i < kLanes; ++i) {
    words[0][i] = block[i];
    words[1][i] = pixel[i];
    words[2][i] = stream.frame;
    words[3][i] = stream.stage;
  }
  lanes::philox_lanes(words, stream.seed);
}

// Sums probabilities until they pass a uniform number.
PANWRIGHT_LANES void inversion_lanes(const Batch& batch, const Stream& stream, Doubles& counts) {
  constexpr int kGroup = 8;
  constexpr int kMostTerms = 80;  // the sum of 70 is 1 to its last bit for every mean below 10
  std::array<Words, 4> words;
  block_lanes(batch.pixel, Words{}, stream, words);
  Doubles u, p;
  for (int i = 0; i < kLanes; ++i) {
    u[i] = lanes::unit(words[0][i], words[1][i]);
    p[i] = lanes::exp(-batch.mean[i]);
  }
  for (int at = 0; at < batch.count; at += kGroup) {
    double part[kGroup], sum[kGroup], count[kGroup];
    for (int i = 0; i < kGroup; ++i) {
      part[i] = p[at + i];
      sum[i] = p[at + i];
      count[i] = 0;
    }
    for (int k = 1; k < kMostTerms; ++k) {
      const double inverse = 1.0 / k;
      double open = 0;
      for (int i = 0; i < kGroup; ++i) {
        const double more = u[at + i] > sum[i] ? 1.0 : 0.0;
        count[i] += more;
        open += more;
        part[i] *= batch.mean[at + i] * inverse;
        sum[i] += part[i];
      }
      if (open == 0) break;
    }
    for (int i = 0; i < kGroup; ++i) counts[at + i] = count[i];
  }
}

// Proposals of one attempt: whole numbers, and whether they are taken (1), refused (0) or to be
// compared with the law (−1); then `left` and `right` are the sides of that comparison.
struct Proposal {
  Doubles count, verdict, left, right;
};

PANWRIGHT_LANES void propose_lanes(const Batch& batch, const Stream& stream, Proposal& out) {
  std::array<Words, 4> words;
  block_lanes(batch.pixel, batch.attempt, stream, words);
  for (int i = 0; i < kLanes; ++i) {
    const double mean = batch.mean[i];
    const double b = 0.931 + 2.53 * std::sqrt(mean);
    const double a = -0.059 + 0.02483 * b;
    const double limit = 0.9277 - 3.6224 / (b - 2.0);
    const double u = lanes::unit(words[0][i], words[1][i]) - 0.5;
    const double v = lanes::unit(words[2][i], words[3][i]);
    const double us = 0.5 - std::fabs(u);
    const double k = lanes::down((2.0 * a / us + b) * u + mean + 0.43);
    const double taken = (us >= 0.07 ? 1.0 : 0.0) * (v <= limit ? 1.0 : 0.0);
    const double refused = (k < 0.0 ? 1.0 : 0.0) + (us < 0.013 ? 1.0 : 0.0) * (v > us ? 1.0 : 0.0);
    out.count[i] = k;
    out.verdict[i] = taken > 0.0 ? 1.0 : refused > 0.0 ? 0.0 : -1.0;
    // v·inverse_alpha / (a/us² + b), and the law's logarithm
    out.left[i] = v * (1.1239 + 1.1328 / (b - 3.4)) / (a / (us * us) + b);
    out.right[i] = mean;
  }
}

// The sides of the comparison, of logarithms: ln left, and k ln mean − mean − ln k!.
PANWRIGHT_LANES void law_lanes(const Doubles& count, Doubles& left, Doubles& right) {
  for (int i = 0; i < kLanes; ++i) {
    const double mean = right[i];
    const double k = count[i] < 10.0 ? 10.0 : count[i];
    const double inverse = 1.0 / k, square = inverse * inverse;
    // Stirling's series; its next term is 8e-13 at most
    const double rest =
        inverse * (1.0 / 12 - square * (1.0 / 360 - square * (1.0 / 1260 - square * (1.0 / 1680))));
    const double log_mean = lanes::log(mean), log_k = lanes::log(k);
    const double log_factorial = (k + 0.5) * log_k - k + 0.91893853320467274178 + rest;
    left[i] = lanes::log(left[i]);
    right[i] = count[i] < 10.0 ? log_mean : k * log_mean - mean - log_factorial;
  }
}

// The first `count` pixels, and perhaps some more: receivers of LiDARs want a dozen.
PANWRIGHT_LANES void normal_lanes(const Words& pixel, int count, const Stream& stream, Doubles& a,
                                  Doubles& b) {
  constexpr int kGroup = 8;
  for (int at = 0; at < count; at += kGroup) {
    std::array<std::array<std::uint32_t, kGroup>, 4> words;
    for (int i = 0; i < kGroup; ++i) {
      words[0][i] = 0;
      words[1][i] = pixel[at + i];
      words[2][i] = stream.frame;
      words[3][i] = stream.stage;
    }
    lanes::philox_lanes(words, stream.seed);
    for (int i = 0; i < kGroup; ++i) {
      const double u = lanes::unit(words[0][i], words[1][i]);
      const double v = lanes::unit(words[2][i], words[3][i]);
      const double length = std::sqrt(-2.0 * lanes::log(u));
      const lanes::Turn turn = lanes::turn(v);
      a[at + i] = length * turn.cos;
      b[at + i] = length * turn.sin;
    }
  }
}

// One set of kernels for each instruction set: the same text, the same bits.
struct Kernels {
  void (*inversion)(const Batch&, const Stream&, Doubles&);
  void (*propose)(const Batch&, const Stream&, Proposal&);
  void (*law)(const Doubles&, Doubles&, Doubles&);
  void (*normal)(const Words&, int, const Stream&, Doubles&, Doubles&);
  void (*block)(const Words&, const Stream&, std::array<Words, 4>&);
};

#define PANWRIGHT_KERNELS(NAME, TARGET)                                                         \
  TARGET void inversion_##NAME(const Batch& b, const Stream& s, Doubles& c) {                   \
    inversion_lanes(b, s, c);                                                                   \
  }                                                                                             \
  TARGET void propose_##NAME(const Batch& b, const Stream& s, Proposal& p) {                    \
    propose_lanes(b, s, p);                                                                     \
  }                                                                                             \
  TARGET void law_##NAME(const Doubles& c, Doubles& l, Doubles& r) { law_lanes(c, l, r); }      \
  TARGET void normal_##NAME(const Words& p, int n, const Stream& s, Doubles& a, Doubles& b) {   \
    normal_lanes(p, n, s, a, b);                                                                \
  }                                                                                             \
  TARGET void block_##NAME(const Words& p, const Stream& s, std::array<Words, 4>& w) {          \
    block_lanes(p, Words{}, s, w);                                                              \
  }                                                                                             \
  constexpr Kernels kernels_##NAME{inversion_##NAME, propose_##NAME, law_##NAME, normal_##NAME, \
                                   block_##NAME};

PANWRIGHT_KERNELS(plain, )
#if defined(__x86_64__)
PANWRIGHT_KERNELS(avx2, __attribute__((target("avx2"))))
#endif

const Kernels& kernels() {
#if defined(__x86_64__)
  static const bool wide = __builtin_cpu_supports("avx2") != 0;
  return wide ? kernels_avx2 : kernels_plain;
#else
  return kernels_plain;
#endif
}

Doubles ones() {
  Doubles out;
  out.fill(1);
  return out;
}

// Pixels whose numbers are still to be found: 2·kLanes at most.
struct Pending {
  std::uint32_t pixel = 0, slot = 0, attempt = 0;
  double mean = 0;
};
struct Undecided {
  Pending pixel;
  double count = 0, left = 0;
};

// Numbers of pixels, collected until batches are full. Which pixels share a batch changes nothing.
class PoissonDraws {
 public:
  PoissonDraws(const Stream& stream, std::span<double> counts) : stream_(stream), counts_(counts) {}

  void add(const Pending& pixel) {
    if (pixel.mean < kSmall) {
      small_.add(pixel.pixel, 0, pixel.mean, pixel.slot);
      if (small_.count == kLanes) invert();
    } else {
      waiting_[waiting_count_++] = pixel;
      while (waiting_count_ >= kLanes) propose();
    }
  }

  void finish() {
    if (small_.count > 0) invert();
    while (waiting_count_ > 0 || open_count_ > 0) {
      if (waiting_count_ > 0) propose();
      if (open_count_ > 0) compare();
    }
  }

 private:
  void invert() {
    kernels().inversion(small_, stream_, proposal_.count);
    for (int i = 0; i < small_.count; ++i) counts_[small_.slot[i]] = proposal_.count[i];
    small_.count = 0;
  }

  // One attempt of each pixel of a batch.
  void propose() {
    large_.count = 0;
    const int taken = std::min(waiting_count_, kLanes);
    waiting_count_ -= taken;
    for (int i = 0; i < taken; ++i) {
      const Pending& each = waiting_[waiting_count_ + i];
      large_.add(each.pixel, each.attempt, each.mean, each.slot);
    }
    kernels().propose(large_, stream_, proposal_);
    for (int i = 0; i < taken; ++i) {
      if (proposal_.verdict[i] > 0) {
        counts_[large_.slot[i]] = proposal_.count[i];
        continue;
      }
      const Pending next{large_.pixel[i], large_.slot[i], large_.attempt[i] + 1, large_.mean[i]};
      if (proposal_.verdict[i] < 0)
        open_[open_count_++] = {next, proposal_.count[i], proposal_.left[i]};
      else
        waiting_[waiting_count_++] = next;
    }
    if (open_count_ >= kLanes) compare();
  }

  // Compares proposals with the law. Pixels of refused ones wait for another attempt.
  void compare() {
    const int taken = std::min(open_count_, kLanes);
    open_count_ -= taken;
    const Undecided* from = open_.data() + open_count_;
    for (int i = 0; i < taken; ++i) {
      count_[i] = from[i].count;
      left_[i] = from[i].left;
      right_[i] = from[i].pixel.mean;
    }
    kernels().law(count_, left_, right_);
    for (int i = 0; i < taken; ++i) {
      const Pending& each = from[i].pixel;
      const int k = static_cast<int>(std::min(count_[i], 10.0));
      const double law = k < 10 ? k * right_[i] - each.mean - kLogFactorial[k] : right_[i];
      if (left_[i] <= law)
        counts_[each.slot] = count_[i];
      else
        waiting_[waiting_count_++] = each;
    }
  }

  const Stream& stream_;
  std::span<double> counts_;
  Batch small_, large_;
  std::array<Pending, 4 * kLanes> waiting_;
  std::array<Undecided, 4 * kLanes> open_;
  int waiting_count_ = 0, open_count_ = 0;
  Doubles count_ = ones(), left_ = ones(), right_ = ones();
  Proposal proposal_;
};

}  // namespace

void draw_poisson(std::span<const double> means, std::uint32_t first, const Stream& stream,
                  std::span<double> counts) {
  assert(counts.size() == means.size());
  PoissonDraws draws(stream, counts);
  for (std::size_t i = 0; i < means.size(); ++i) {
    const double mean = std::min(means[i], kMost);
    const auto slot = static_cast<std::uint32_t>(i);
    if (mean > 0)
      draws.add({first + slot, slot, 0, mean});
    else
      counts[i] = 0;
  }
  draws.finish();
}

void draw_normal(std::uint32_t first, const Stream& stream, std::span<double> numbers) {
  const std::size_t count = numbers.size();
  const std::size_t skip = first & 1;  // of the first pair
  Words pair;
  Doubles a, b;
  for (std::size_t at = 0; at < count + skip; at += 2 * kLanes) {
    for (int i = 0; i < kLanes; ++i)
      pair[i] = (first >> 1) + static_cast<std::uint32_t>(at / 2) + static_cast<std::uint32_t>(i);
    const std::size_t begin = at == 0 ? skip : 0;
    const std::size_t end = std::min<std::size_t>(2 * kLanes, count + skip - at);
    kernels().normal(pair, static_cast<int>(end + 1) / 2, stream, a, b);
    for (std::size_t i = begin; i < end; ++i)
      numbers[at + i - skip] = (i & 1) == 0 ? a[i / 2] : b[i / 2];
  }
}

void draw_normal_pairs(std::uint32_t first, const Stream& stream, std::span<double> a,
                       std::span<double> b) {
  assert(a.size() == b.size());
  Words pixel;
  Doubles one, other;
  for (std::size_t at = 0; at < a.size(); at += kLanes) {
    for (int i = 0; i < kLanes; ++i)
      pixel[i] = first + static_cast<std::uint32_t>(at) + static_cast<std::uint32_t>(i);
    const std::size_t end = std::min<std::size_t>(kLanes, a.size() - at);
    kernels().normal(pixel, static_cast<int>(end), stream, one, other);
    std::copy_n(one.begin(), end, a.begin() + static_cast<std::ptrdiff_t>(at));
    std::copy_n(other.begin(), end, b.begin() + static_cast<std::ptrdiff_t>(at));
  }
}

void draw_words(std::uint32_t first, const Stream& stream,
                const std::array<std::span<std::uint32_t>, 4>& words) {
  Words pixel;
  std::array<Words, 4> block;
  const std::size_t count = words[0].size();
  for (std::size_t at = 0; at < count; at += kLanes) {
    for (int i = 0; i < kLanes; ++i)
      pixel[i] = first + static_cast<std::uint32_t>(at) + static_cast<std::uint32_t>(i);
    kernels().block(pixel, stream, block);
    const std::size_t end = std::min<std::size_t>(kLanes, count - at);
    for (std::size_t k = 0; k < 4; ++k)
      std::copy_n(block[k].begin(), end, words[k].begin() + static_cast<std::ptrdiff_t>(at));
  }
}

}  // namespace panwright::sensor
