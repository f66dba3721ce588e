// Receivers of LiDARs: from the light of a pulse to its echoes. Private to instruments.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "instruments/lidar.h"

namespace panwright::instruments {

// Light of one sub-ray.
struct Returned {
  double range = 0;      // metres: half of the way
  double electrons = 0;  // mean
  double cosine = 0;     // of incidence
  trace::Ids ids;
  std::uint8_t flags = 0;  // kBloomed, kGhost
};

struct Echo {
  double range = 0, intensity = 0;
  double true_range = 0, share = 0, cosine = 0;
  trace::Ids ids;
  std::uint8_t flags = 0;
};

// Light beyond saturation.
struct Excess {
  double range = 0, electrons = 0;
};

// Stages of random numbers: functions of seed, frame, stage, pulse and number.
enum class LidarStage : std::uint32_t { turn = 1, samples, alarms, jitter, drop_out, counting };

struct LidarRandom {
  std::uint64_t seed = 0;
  std::uint32_t frame = 0;
  // Four uniform numbers in (0, 1).
  std::array<double, 4> uniform(LidarStage stage, std::uint32_t pulse, std::uint32_t number) const;
  double normal(LidarStage stage, std::uint32_t pulse, std::uint32_t number) const;
  std::uint32_t stage_word(LidarStage stage) const {
    return (frame << 8) | static_cast<std::uint32_t>(stage);
  }
};

// Share of the standard normal distribution above x >= 0, to a relative 1e-12.
double normal_tail(double x);

// Samples of a window that are one echo.
struct Piece {
  std::size_t begin = 0, end = 0, peak = 0;
};

class Receiver {
 public:
  // Memory of one thread.
  struct Scratch {
    std::vector<double> samples, numbers;
    std::vector<Piece> pieces;
    std::vector<Echo> echoes;
  };

  Receiver(const Lidar& lidar, const LidarRandom& random);

  // Sets scratch.echoes by range.
  //
  //   returned    sorted by range where it does not fall together
  //   background  electrons a second
  //   excess      set: light of the strongest saturated echo beyond saturation; 0: none
  PulseStatus receive(std::uint32_t pulse, std::vector<Returned>& returned, double background,
                      Scratch& scratch, Excess& excess) const;

 private:
  struct Window {
    std::int64_t first = 0, end = 0;  // samples; sample k is at k·step_ metres
    std::size_t from = 0, to = 0;     // of the light
  };
  void record(const Window& window, const std::vector<Returned>& returned, std::uint32_t pulse,
              double floor_e, Scratch& scratch, Excess& excess) const;
  void detect(const Window& window, const std::vector<Returned>& returned, double noise,
              Scratch& scratch) const;
  Echo measured(const Window& window, const Piece& piece, const std::vector<double>& samples) const;
  double crossing(const std::vector<double>& s, const Piece& piece, double level) const;
  void add_alarms(std::uint32_t pulse, double noise, std::vector<Echo>& echoes) const;
  bool count_photons(std::uint32_t pulse, const std::vector<Returned>& returned, double background,
                     std::vector<Echo>& echoes) const;
  PulseStatus choose(std::uint32_t pulse, std::vector<Echo>& echoes) const;

  const Lidar& lidar_;
  const LidarRandom random_;
  double sigma_ = 0;    // metres of range, of the waveform of one surface
  double step_ = 0;     // metres of range between samples
  double seconds_ = 0;  // the same in time
  double unit_ = 0;     // of a sample at the peak, for one electron
  double reach_ = 0;    // samples that a pulse has to each side
  // exp(-x²/2) from -kReach sigmas on: a row of samples_ for each place of the first one, from
  // there to a sample beyond, in phases_ steps
  std::vector<double> shapes_;
  std::size_t samples_ = 0, phases_ = 0;
  double rise_ = 0;  // samples from half of the peak to the peak
};

// Truth of an echo from the light in it. Sets flags of what is mixed, and of none a false alarm.
void set_truth(const std::vector<Returned>& returned, double from, double to, Echo& echo);

}  // namespace panwright::instruments
