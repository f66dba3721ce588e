#include "instruments/internal/receiver.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "sensor/draws.h"

namespace panwright::instruments {

namespace {

constexpr double kLight = 299'792'458;  // m/s
constexpr double kReach = 5;            // sigmas that a pulse has to each side
constexpr double kFwhm = 2.3548200450309493;
constexpr int kSteps = 512;  // of tables, a sigma

// The normal distribution from -kReach to kReach sigmas.
struct GaussTables {
  std::vector<double> distribution;
  GaussTables() {
    const int count = static_cast<int>(kReach) * kSteps;
    for (int k = 0; k <= count + 1; ++k) {
      const double x = static_cast<double>(k) / kSteps;
      distribution.push_back(1 - normal_tail(x));
    }
  }
  static double at(const std::vector<double>& table, double x) {
    const double place = x * kSteps;
    const auto k = static_cast<std::size_t>(place);
    if (k + 1 >= table.size()) return table.back();
    return table[k] + (place - static_cast<double>(k)) * (table[k + 1] - table[k]);
  }
  double below(double x) const {
    const double share = at(distribution, std::fabs(x));
    return x < 0 ? 1 - share : share;
  }
};

const GaussTables& tables() {
  static const GaussTables made;
  return made;
}

bool same_surface(const trace::Ids& a, const trace::Ids& b) {
  return a.target == b.target && a.node == b.node && a.material == b.material &&
         a.instance == b.instance;
}

}  // namespace

std::array<double, 4> LidarRandom::uniform(LidarStage stage, std::uint32_t pulse,
                                           std::uint32_t number) const {
  const auto words =
      philox({0, number, pulse, stage_word(stage)},
             {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
  return {in_unit(words[0]), in_unit(words[1]), in_unit(words[2]), in_unit(words[3])};
}

double LidarRandom::normal(LidarStage stage, std::uint32_t pulse, std::uint32_t number) const {
  const auto u = uniform(stage, pulse, number);
  return std::sqrt(-2 * det::log(u[0])) * det::sincos(2 * kPi * u[1]).cos;
}

// The series near 0, the continued fraction of Laplace beyond.
double normal_tail(double x) {
  const double density = det::exp(-0.5 * x * x) / std::sqrt(2 * kPi);
  if (x < 2.5) {
    double term = x, sum = x;
    for (int k = 1; k < 60; ++k) {
      term *= x * x / (2 * k + 1);
      sum += term;
    }
    return 0.5 - density * sum;
  }
  double rest = x;
  for (int k = 80; k > 0; --k) rest = x + k / rest;
  return density / rest;
}

void set_truth(const std::vector<Returned>& returned, double from, double to, Echo& echo) {
  double sum = 0, moment = 0, best = 0;
  const Returned* most = nullptr;
  bool same = true;
  std::size_t first = returned.size(), end = 0;
  for (std::size_t i = 0; i < returned.size(); ++i) {
    const Returned& each = returned[i];
    if (!(each.range >= from && each.range <= to) || !(each.electrons > 0)) continue;
    first = std::min(first, i);
    end = i + 1;
    sum += each.electrons;
    moment += each.electrons * each.range;
    same = same && same_surface(each.ids, returned[first].ids);
    if (each.electrons > best) best = each.electrons, most = &each;
  }
  if (most == nullptr) {
    echo.flags |= kFalseAlarm;
    echo.true_range = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  double surface = sum;
  if (!same) {
    surface = 0;
    for (std::size_t i = first; i < end; ++i) {
      double all = 0;
      const Returned* strongest = nullptr;
      for (std::size_t k = first; k < end; ++k) {
        const Returned& each = returned[k];
        if (!same_surface(each.ids, returned[i].ids)) continue;
        if (!(each.range >= from && each.range <= to)) continue;
        all += each.electrons;
        if (strongest == nullptr || each.electrons > strongest->electrons) strongest = &each;
      }
      if (all > surface) surface = all, most = strongest;
    }
    echo.flags |= kMixed;
  }
  echo.true_range = moment / sum;
  echo.share = surface / sum;
  echo.cosine = most->cosine;
  echo.ids = most->ids;
  echo.flags |= most->flags;
}

Receiver::Receiver(const Lidar& lidar, const LidarRandom& random) : lidar_(lidar), random_(random) {
  const double fwhm =
      std::sqrt(lidar.pulse_fwhm * lidar.pulse_fwhm + lidar.response_fwhm * lidar.response_fwhm);
  sigma_ = 0.5 * kLight * fwhm / kFwhm;
  seconds_ = lidar.sample > 0 ? lidar.sample : 0.5 * fwhm / kFwhm;
  step_ = 0.5 * kLight * seconds_;
  unit_ = step_ / (sigma_ * std::sqrt(2 * kPi));
  reach_ = kReach * sigma_ / step_;
  samples_ = static_cast<std::size_t>(2 * reach_) + 1;
  phases_ = static_cast<std::size_t>(std::ceil(kSteps * step_ / sigma_));
  for (std::size_t phase = 0; phase <= phases_; ++phase)
    for (std::size_t k = 0; k < samples_; ++k) {
      const double after = static_cast<double>(phase) / static_cast<double>(phases_);
      const double x = (static_cast<double>(k) + after - reach_) * step_ / sigma_;
      shapes_.push_back(x <= kReach ? det::exp(-0.5 * x * x) : 0);
    }
  rise_ = sigma_ / step_ * std::sqrt(2 * det::log(2));
}

// Samples of a window: light, noise, saturation.
void Receiver::record(const Window& window, const std::vector<Returned>& returned,
                      std::uint32_t pulse, double floor_e, Scratch& scratch, Excess& excess) const {
  std::vector<double>& s = scratch.samples;
  s.assign(static_cast<std::size_t>(window.end - window.first), 0);
  for (std::size_t i = window.from; i < window.to; ++i) {
    const double centre = returned[i].range / step_;
    const auto first =
        std::max(window.first, static_cast<std::int64_t>(std::ceil(centre - reach_)));
    const double place = (static_cast<double>(first) - (centre - reach_)) * phases_;
    const auto phase = std::min(static_cast<std::size_t>(place), phases_ - 1);
    const double share = place - static_cast<double>(phase);
    const double height = returned[i].electrons * unit_;
    const double near = height * (1 - share), far = height * share;
    const double* const a = shapes_.data() + phase * samples_;
    const double* const b = a + samples_;
    // the window ends where the shape does, but for rounding
    double* const out = s.data() + (first - window.first);
    const std::size_t count = std::min(samples_, static_cast<std::size_t>(window.end - first));
    for (std::size_t k = 0; k < count; ++k) out[k] += near * a[k] + far * b[k];
  }
  const double electronics = lidar_.electronics_e * lidar_.electronics_e;
  if (lidar_.excess_noise > 0 || electronics > 0) {
    scratch.numbers.resize(s.size());
    const sensor::Stream stream{
        {static_cast<std::uint32_t>(random_.seed), static_cast<std::uint32_t>(random_.seed >> 32)},
        pulse,
        random_.stage_word(LidarStage::samples)};
    sensor::draw_normal(static_cast<std::uint32_t>(window.first), stream, scratch.numbers);
    for (std::size_t k = 0; k < s.size(); ++k)
      s[k] += std::sqrt(lidar_.excess_noise * (s[k] + floor_e) + electronics) * scratch.numbers[k];
  }
  if (!(lidar_.saturation_e > 0)) return;
  double beyond = 0, peak = 0;
  std::size_t at = 0;
  for (std::size_t k = 0; k < s.size(); ++k) {
    beyond += std::max(0.0, s[k] - lidar_.saturation_e);
    if (s[k] > peak) peak = s[k], at = k;
    s[k] = std::min(s[k], lidar_.saturation_e);
  }
  if (beyond > excess.electrons)
    excess = {(static_cast<double>(window.first) + static_cast<double>(at)) * step_, beyond};
}

// Range, in samples of the window, at which an echo first reaches a level: by the parabola through
// the logarithms of three samples, exact for a Gaussian; else by a line.
double Receiver::crossing(const std::vector<double>& s, const Piece& piece, double level) const {
  std::size_t j = piece.begin;
  while (j < piece.peak && s[j] < level) ++j;
  const auto place = static_cast<double>(j);
  if (j == 0 || !(s[j] > level) || !(s[j - 1] < level)) return place;
  const double low = s[j - 1], high = s[j];
  if (low > 0 && j + 1 < s.size() && s[j + 1] > 0) {
    const double a = det::log(low / level), b = det::log(high / level),
                 c = det::log(s[j + 1] / level);
    const double square = 0.5 * (a + c) - b, slope = 0.5 * (c - a);
    // square t² + slope t + b = 0, the root in [-1, 0]
    const double inside = slope * slope - 4 * square * b;
    if (inside >= 0 && slope > 0) {
      const double t = -2 * b / (slope + std::sqrt(inside));
      if (t >= -1 && t <= 0) return place + t;
    }
  }
  return place - (high - level) / (high - low);
}

Echo Receiver::measured(const Window& window, const Piece& piece,
                        const std::vector<double>& s) const {
  Echo echo;
  double amplitude = s[piece.peak], centre = static_cast<double>(piece.peak);
  const bool saturated = lidar_.saturation_e > 0 && amplitude >= lidar_.saturation_e;
  if (saturated) {
    std::size_t last = piece.peak;
    while (last + 1 < piece.end && s[last + 1] >= lidar_.saturation_e) ++last;
    centre = 0.5 * static_cast<double>(piece.peak + last);
    echo.flags |= kSaturated;
  } else if (piece.peak > 0 && piece.peak + 1 < s.size() && s[piece.peak - 1] > 0 &&
             s[piece.peak + 1] > 0 && s[piece.peak] > 0) {
    const double a = det::log(s[piece.peak - 1] / amplitude),
                 c = det::log(s[piece.peak + 1] / amplitude);
    if (a + c < 0) {
      const double off = std::clamp(0.5 * (a - c) / (a + c), -1.0, 1.0);
      centre += off;
      amplitude *= det::exp(-0.25 * (a - c) * off);
    }
  }
  const double sigma = sigma_ / step_;  // in samples
  double at = centre;
  if (lidar_.method == RangeMethod::fraction) {
    at = crossing(s, piece, 0.5 * amplitude) + rise_;
  } else if (lidar_.method == RangeMethod::threshold) {
    const double level = lidar_.threshold_e;
    const double right = sigma * std::sqrt(2 * det::log(lidar_.walk_reference));
    const double early = sigma * std::sqrt(2 * det::log(std::max(1.0, amplitude / level)));
    at = crossing(s, piece, level) + right + (1 - lidar_.walk_residual) * (early - right);
  } else if (lidar_.method == RangeMethod::centroid) {
    double sum = 0, moment = 0;
    for (std::size_t k = piece.begin; k < piece.end; ++k)
      sum += s[k], moment += s[k] * static_cast<double>(k);
    if (sum > 0) at = moment / sum;
  }
  echo.range = (static_cast<double>(window.first) + at) * step_;
  echo.intensity = amplitude / unit_;
  return echo;
}

// Echoes of a window: runs of samples at the threshold or above, parted where they fall between
// two maxima by more than three times the noise.
void Receiver::detect(const Window& window, const std::vector<Returned>& returned, double noise,
                      Scratch& scratch) const {
  const std::vector<double>& s = scratch.samples;
  const double threshold = lidar_.threshold_e;
  const auto depth = [&](double level) {
    return 3 * std::sqrt(noise * noise + lidar_.excess_noise * std::max(level, 0.0));
  };
  std::vector<Piece>& pieces = scratch.pieces;
  pieces.clear();
  for (std::size_t k = 0; k < s.size();) {
    if (!(s[k] >= threshold)) {
      ++k;
      continue;
    }
    Piece piece{k, k, k};
    std::size_t valley = k;
    for (; k < s.size() && s[k] >= threshold; ++k) {
      if (s[k] < s[valley]) valley = k;
      if (valley > piece.peak && s[k] - s[valley] > depth(s[valley]) &&
          s[piece.peak] - s[valley] > depth(s[valley])) {
        piece.end = valley;
        pieces.push_back(piece);
        piece = {valley, valley, k};
        valley = k;
      }
      if (s[k] > s[piece.peak]) piece.peak = k, valley = k;
    }
    piece.end = k;
    pieces.push_back(piece);
  }
  for (const Piece& piece : pieces) {
    Echo echo = measured(window, piece, s);
    const auto at = [&](std::size_t k, double off) {
      return (static_cast<double>(window.first) + static_cast<double>(k) + off) * step_;
    };
    set_truth(returned, at(piece.begin, -1), at(piece.end, 0), echo);
    scratch.echoes.push_back(echo);
  }
}

// Noise above the threshold away from all light.
void Receiver::add_alarms(std::uint32_t pulse, double noise, std::vector<Echo>& echoes) const {
  if (!(noise > 0)) return;
  const double level = lidar_.threshold_e / noise;
  const double length = lidar_.gate.y - lidar_.gate.x;
  // the tail is below half of the density's ratio to its peak, and exp(-m) above 1 - m
  const double most = 0.5 * length / step_ * det::exp(-0.5 * level * level);
  if (random_.uniform(LidarStage::alarms, pulse, 0)[0] < 1 - most) return;
  const double mean = length / step_ * normal_tail(level);
  // arrivals of a Poisson process, at most those of all echoes
  double at = 0;
  for (std::uint32_t k = 0; k < 16; ++k) {
    const auto u = random_.uniform(LidarStage::alarms, pulse, k);
    at -= det::log(u[0]) / mean;
    if (at > 1) break;
    Echo echo;
    echo.range = lidar_.gate.x + at * length;
    // the tail of a Gaussian falls by this above its foot
    echo.intensity = (lidar_.threshold_e - noise * det::log(u[1]) / std::max(level, 1.0)) / unit_;
    echo.true_range = std::numeric_limits<double>::quiet_NaN();
    echo.flags = kFalseAlarm;
    echoes.push_back(echo);
  }
}

// The first electron within the gate.
bool Receiver::count_photons(std::uint32_t pulse, const std::vector<Returned>& returned,
                             double background, std::vector<Echo>& echoes) const {
  const double rate = (background + lidar_.dark_e_per_s) * 2 / kLight;  // a metre
  const double begin = lidar_.gate.x, end = lidar_.gate.y;
  const auto before = [&](double range) {
    double sum = rate * (range - begin);
    for (const Returned& each : returned)
      sum += each.electrons * (tables().below((range - each.range) / sigma_) -
                               tables().below((begin - each.range) / sigma_));
    return sum;
  };
  const double wanted = -det::log(random_.uniform(LidarStage::counting, pulse, 0)[0]);
  if (!(before(end) >= wanted)) return false;
  double low = begin, high = end;
  while (high - low > 1e-6 * sigma_ && high - low > 1e-15 * high) {
    const double middle = 0.5 * low + 0.5 * high;
    (before(middle) >= wanted ? high : low) = middle;
  }
  Echo echo;
  echo.range = 0.5 * low + 0.5 * high;
  echo.intensity = 1;
  set_truth(returned, echo.range - kReach * sigma_, echo.range + kReach * sigma_, echo);
  echoes.push_back(echo);
  return true;
}

// Gate, dead time, choice, and errors of ranges.
PulseStatus Receiver::choose(std::uint32_t pulse, std::vector<Echo>& echoes) const {
  std::ranges::stable_sort(echoes, {}, &Echo::range);
  const bool any = !echoes.empty();
  std::erase_if(echoes, [&](const Echo& each) {
    return !(each.range >= lidar_.gate.x && each.range <= lidar_.gate.y);
  });
  if (echoes.empty()) return any ? PulseStatus::out_of_gate : PulseStatus::no_echo;
  if (lidar_.recovery > 0) {
    double blind = -1;
    std::erase_if(echoes, [&](const Echo& each) {
      if (each.range <= blind) return true;
      if ((each.flags & kSaturated) != 0) blind = each.range + lidar_.recovery;
      return false;
    });
  }
  switch (lidar_.echoes) {
    case EchoChoice::first:
      echoes.resize(1);
      break;
    case EchoChoice::last:
      echoes.erase(echoes.begin(), echoes.end() - 1);
      break;
    case EchoChoice::strongest:
      std::swap(echoes[0], *std::ranges::max_element(echoes, {}, &Echo::intensity));
      echoes.resize(1);
      break;
    case EchoChoice::all:
      if (echoes.size() > lidar_.max_echoes) echoes.resize(lidar_.max_echoes);
      break;
  }
  for (std::uint32_t k = 0; k < echoes.size(); ++k) {
    double& range = echoes[k].range;
    range += lidar_.bias;
    if (lidar_.jitter > 0) range += lidar_.jitter * random_.normal(LidarStage::jitter, pulse, k);
    if (lidar_.resolution > 0)
      range = std::floor(range / lidar_.resolution + 0.5) * lidar_.resolution;
  }
  return PulseStatus::echo;
}

PulseStatus Receiver::receive(std::uint32_t pulse, std::vector<Returned>& returned,
                              double background, Scratch& scratch, Excess& excess) const {
  scratch.echoes.clear();
  excess = {};
  if (lidar_.drop_outs > 0 && random_.uniform(LidarStage::drop_out, pulse, 0)[0] < lidar_.drop_outs)
    return PulseStatus::dropped;
  if (lidar_.photon_counting) {
    count_photons(pulse, returned, background, scratch.echoes);
    return choose(pulse, scratch.echoes);
  }
  const double floor_e = (background + lidar_.dark_e_per_s) * seconds_;
  const double noise =
      std::sqrt(lidar_.excess_noise * floor_e + lidar_.electronics_e * lidar_.electronics_e);
  const double reach = kReach * sigma_;
  double near = std::numeric_limits<double>::infinity(), far = 0;
  for (const Returned& each : returned) {
    near = std::min(near, each.range);
    far = std::max(far, each.range);
  }
  const bool together = far - near <= 2 * reach;
  if (!together) std::ranges::stable_sort(returned, {}, &Returned::range);
  for (std::size_t i = 0; i < returned.size();) {
    Window window;
    window.from = i;
    const double from = together ? near : returned[i].range;
    double end = (together ? far : from) + reach;
    window.first = static_cast<std::int64_t>(std::floor((from - reach) / step_));
    while (i < returned.size() && (together || returned[i].range - reach <= end)) {
      end = std::max(end, returned[i].range + reach);
      ++i;
    }
    window.to = i;
    window.end = static_cast<std::int64_t>(std::ceil(end / step_)) + 1;
    record(window, returned, pulse, floor_e, scratch, excess);
    detect(window, returned, noise, scratch);
  }
  add_alarms(pulse, noise, scratch.echoes);
  return choose(pulse, scratch.echoes);
}

}  // namespace panwright::instruments
