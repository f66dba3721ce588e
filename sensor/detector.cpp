#include "sensor/detector.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/random.h"
#include "sensor/charge.h"
#include "sensor/draws.h"
#include "sensor/internal/binning.h"
#include "sensor/internal/lanes.h"
#include "sensor/internal/stages.h"
#include "sensor/internal/tracks.h"

namespace panwright::sensor {

namespace {

using Stage = DetectorStage;

constexpr std::size_t kPiece = 1 << 14;  // pixels that a task takes at once

// Pixels next to each other.
struct Piece {
  std::size_t begin = 0;  // in the part
  std::size_t count = 0;
  std::uint32_t pixel = 0;  // of the first, in the detector
  std::size_t number = 0;
};

double band_gap(double kelvin) {  // eV
  return 1.1557 - 7.021e-4 * kelvin * kelvin / (1108 + kelvin);
}

double janesick(double kelvin) {
  constexpr double kBoltzmann = 8.617333262e-5;  // eV/K
  return kelvin * std::sqrt(kelvin) * det::exp(-band_gap(kelvin) / (2 * kBoltzmann * kelvin));
}

// Electrons that the full well holds: whole ones, where charge is whole.
double well_of(const Detector& d) {
  return d.has(Stage::shot) || d.blooming ? std::floor(d.full_well_e) : d.full_well_e;
}

// The same as Readout::electrons has it.
float charge_of_full_well(const Detector& d) {
  if (!d.has(Stage::well)) return std::numeric_limits<float>::infinity();
  const double well = well_of(d), x = well * (1 / d.full_well_e);
  const bool bends = d.has(Stage::nonlinearity);
  return static_cast<float>(bends ? well * (1.0 + x * (d.nonlinearity[0] + x * d.nonlinearity[1]))
                                  : well);
}

// State of one readout: electrons, then numbers.
class ReadoutRun {
 public:
  ReadoutRun(const Detector& detector, const MeanElectrons& means, std::uint64_t seed,
             std::uint32_t frame, bool layers)
      : d_(detector), in_(means), seed_(seed), frame_(frame), layers_(layers) {
    detector_width_ = means.detector_width > 0 ? means.detector_width : means.width;
    detector_height_ = means.detector_height > 0 ? means.detector_height : means.height;
    const std::size_t pixels = std::size_t{means.width} * means.height;
    assert(means.values.size() == pixels * means.bands && (means.bands == 1 || means.bands == 3));
    state_.resize(pixels);
    out_.dn.resize(pixels);
    out_.electrons.resize(pixels);
    if (layers) {
      out_.signal.resize(pixels);
      for (std::size_t k = 0; k < kDetectorStages; ++k)
        if (has(static_cast<Stage>(k))) out_.added[k].assign(pixels, 0.0f);
    }
    const double ratio = dark_ratio(d_.temperature_k) * d_.exposure_s;
    dark_ = ratio * d_.dark_e_per_s;
    hot_ = ratio * d_.hot_e_per_s;
    telegraph_ = ratio * d_.telegraph_e_per_s;
    if (has(Stage::cosmic) && d_.cosmic_per_cm2_s > 0)
      deposits_ = cosmic_deposits(d_, detector_width_, detector_height_, seed, frame);
  }

  Readout run() {
    const bool smears = has(Stage::smear) && d_.smear_row_s > 0;
    const bool blooms = has(Stage::well) && d_.blooming;
    assert(!(smears || blooms) || (in_.y == 0 && in_.height == detector_height_));
    const auto light = [&](const Piece& piece, Scratch& scratch) {
      collect(piece);
      respond(piece, scratch);
    };
    const auto charge = [&](const Piece& piece, Scratch& scratch) {
      add_dark(piece, scratch);
      add_defects(piece, scratch);
      add_tracks(piece);
      draw(piece);
      if (!blooms) clip(piece);
    };
    const auto numbers = [&](const Piece& piece, Scratch& scratch) { convert(piece, scratch); };
    if (smears) {
      for_pieces(light);
      smear();
    }
    for_pieces([&](const Piece& piece, Scratch& scratch) {
      if (!smears) light(piece, scratch);
      charge(piece, scratch);
      if (!blooms) numbers(piece, scratch);
    });
    if (blooms) {
      spill();
      for_pieces(numbers);
    }
    for (const double each : lost_) out_.lost += each;
    out_.saturated = saturated_;
    out_.invalid = invalid_;
    return std::move(out_);
  }

 private:
  // Of one task.
  struct Scratch {
    std::vector<double> a, b;
    std::array<std::vector<std::uint32_t>, 4> words;
    std::vector<std::uint8_t> full;  // 1 at the full well
  };

  bool has(Stage stage) const { return d_.has(stage); }

  // Pixels of whole rows where rows follow each other in the detector, else of one row.
  template <class Body>
  void for_pieces(const Body& body) {
    const std::size_t width = in_.width;
    const bool whole = in_.width == detector_width_;
    const std::size_t rows = whole ? std::max<std::size_t>(kPiece / width, 1) : 1;
    const std::size_t pieces = (in_.height + rows - 1) / rows;
    lost_.resize(pieces);
    parallel_for(pieces, [&](std::size_t k) {
      Scratch scratch;
      const std::size_t y = k * rows;
      const std::size_t count = std::min<std::size_t>(rows, in_.height - y);
      const std::size_t pixel = (in_.y + y) * detector_width_ + in_.x;
      body(Piece{y * width, count * width, static_cast<std::uint32_t>(pixel), k}, scratch);
    });
  }

  std::span<double> state(const Piece& piece) {
    return std::span(state_).subspan(piece.begin, piece.count);
  }

  // Runs a stage on a piece and keeps what it added.
  template <class Body>
  void stage(Stage which, const Piece& piece, const Body& body) {
    const std::span<double> now = state(piece);
    if (!layers_) return body(now);
    const std::vector<double> before(now.begin(), now.end());
    body(now);
    keep(which, piece, before, now);
  }

  void keep(Stage which, const Piece& piece, std::span<const double> before,
            std::span<const double> now) {
    float* added = out_.added[static_cast<std::size_t>(which)].data() + piece.begin;
    for (std::size_t i = 0; i < now.size(); ++i) added[i] = static_cast<float>(now[i] - before[i]);
  }

  Stream pattern(StreamStage which) const {
    return {key_of(d_.serial), 0, static_cast<std::uint32_t>(which)};
  }
  Stream noise(StreamStage which) const {
    return {key_of(seed_), frame_, static_cast<std::uint32_t>(which)};
  }

  // Photoelectrons of each pixel: the sum of the bands, or that of its filter.
  void collect(const Piece& piece) {
    const std::span<double> now = state(piece);
    const float* from = in_.values.data() + piece.begin * in_.bands;
    std::size_t invalid = 0;
    const auto valid = [&](float value) {
      constexpr float kMost = 1e12f;  // fills any well
      const bool light = value >= 0;
      invalid += !light || value > std::numeric_limits<float>::max();
      return static_cast<double>(light ? (value < kMost ? value : kMost) : 0.0f);
    };
    if (in_.bands == 1) {
      for (std::size_t i = 0; i < now.size(); ++i) now[i] = valid(from[i]);
    } else if (d_.is_mono()) {
      for (std::size_t i = 0; i < now.size(); ++i)
        now[i] = valid(from[3 * i]) + valid(from[3 * i + 1]) + valid(from[3 * i + 2]);
    } else {
      for (std::size_t i = 0; i < now.size(); ++i) {
        const std::size_t pixel = piece.pixel + i;
        const std::size_t x = pixel % detector_width_, y = pixel / detector_width_;
        const char filter = d_.bayer[(y & 1) * 2 + (x & 1)];
        now[i] = valid(from[3 * i + (filter == 'r' ? 0 : filter == 'g' ? 1 : 2)]);
      }
    }
    invalid_ += invalid;
    if (layers_) std::copy(now.begin(), now.end(), out_.signal.begin() + piece_at(piece));
  }

  static std::ptrdiff_t piece_at(const Piece& piece) {
    return static_cast<std::ptrdiff_t>(piece.begin);
  }

  bool has_prnu() const { return has(Stage::prnu) && d_.prnu > 0; }
  bool has_dsnu() const { return has(Stage::dsnu) && has(Stage::dark) && d_.dsnu > 0 && dark_ > 0; }

  void draw_pattern(const Piece& piece, Scratch& scratch) const {
    if (scratch.a.size() == piece.count) return;  // of this piece already
    scratch.a.resize(piece.count);
    scratch.b.resize(piece.count);
    draw_normal_pairs(piece.pixel, pattern(StreamStage::pattern), scratch.a, scratch.b);
  }

  void respond(const Piece& piece, Scratch& scratch) {
    if (!has_prnu()) return;
    draw_pattern(piece, scratch);
    stage(Stage::prnu, piece, [&](std::span<double> now) {
      const double* number = scratch.a.data();
      const double prnu = d_.prnu;
      for (std::size_t i = 0; i < now.size(); ++i) {
        const double share = 1.0 + prnu * number[i];
        now[i] *= share > 0 ? share : 0.0;
      }
    });
  }

  void smear() {
    const std::vector<double> before = layers_ ? state_ : std::vector<double>();
    add_smear(state_, in_.width, {d_.smear_row_s / d_.exposure_s, d_.smear_flush});
    if (layers_) keep(Stage::smear, {0, state_.size(), 0}, before, state_);
  }

  void add_dark(const Piece& piece, Scratch& scratch) {
    if (!has(Stage::dark) || !(dark_ > 0)) return;
    stage(Stage::dark, piece, [&](std::span<double> now) {
      for (double& each : now) each += dark_;
    });
    if (!has_dsnu()) return;
    draw_pattern(piece, scratch);
    stage(Stage::dsnu, piece, [&](std::span<double> now) {
      const double* number = scratch.b.data();
      const double rms = d_.dsnu;
      for (std::size_t i = 0; i < now.size(); ++i) {
        const double share = rms * number[i];
        now[i] += dark_ * (share > -1.0 ? share : -1.0);
      }
    });
  }

  void add_defects(const Piece& piece, Scratch& scratch) {
    const bool hot = has(Stage::hot) && d_.hot_pixels > 0 && hot_ > 0;
    const bool jumps = has(Stage::telegraph) && d_.telegraph_pixels > 0 && telegraph_ > 0;
    if (!hot && !jumps) return;
    std::array<std::span<std::uint32_t>, 4> words;
    for (std::size_t k = 0; k < 4; ++k) {
      scratch.words[k].resize(piece.count);
      words[k] = scratch.words[k];
    }
    draw_words(piece.pixel, pattern(StreamStage::defects), words);
    const auto limit = [](double share) { return static_cast<std::uint64_t>(share * 0x1p32); };
    if (hot)
      stage(Stage::hot, piece, [&](std::span<double> now) {
        const std::uint64_t below = limit(d_.hot_pixels);
        for (std::size_t i = 0; i < now.size(); ++i)
          if (words[0][i] < below) now[i] -= hot_ * det::log(in_unit(words[1][i]));
      });
    if (jumps)
      stage(Stage::telegraph, piece, [&](std::span<double> now) {
        const std::uint64_t below = limit(d_.telegraph_pixels);
        for (std::size_t i = 0; i < now.size(); ++i)
          if (words[2][i] < below && is_up(piece.pixel + static_cast<std::uint32_t>(i)))
            now[i] -= telegraph_ * det::log(in_unit(words[3][i]));
      });
  }

  // The state of a telegraph pixel, which lasts some frames. Pixels change at different frames.
  bool is_up(std::uint32_t pixel) const {
    const std::uint64_t lasts = d_.telegraph_frames;
    const std::uint64_t epoch = (std::uint64_t{frame_} + pixel % lasts) / lasts;
    const Stream of = noise(StreamStage::telegraph);
    return (philox({0, pixel, static_cast<std::uint32_t>(epoch), of.stage}, of.seed)[0] & 1) != 0;
  }

  void add_tracks(const Piece& piece) {
    if (deposits_.empty()) return;
    stage(Stage::cosmic, piece, [&](std::span<double> now) {
      auto at = std::ranges::lower_bound(deposits_, piece.pixel, {}, &Deposit::pixel);
      for (; at != deposits_.end() && at->pixel - piece.pixel < now.size(); ++at)
        now[at->pixel - piece.pixel] += at->electrons;
    });
  }

  void draw(const Piece& piece) {
    if (!has(Stage::shot)) return;
    stage(Stage::shot, piece, [&](std::span<double> now) {
      draw_poisson(now, piece.pixel, noise(StreamStage::shot), now);
    });
  }

  void clip(const Piece& piece) {
    if (!has(Stage::well)) return;
    double lost = 0;
    stage(Stage::well, piece, [&](std::span<double> now) {
      const double most = well_of(d_);
      for (double& each : now) {
        lost += each > most ? each - most : 0.0;
        each = each > most ? most : each;
      }
    });
    lost_[piece.number] = lost;
  }

  void spill() {
    const std::vector<double> before = layers_ ? state_ : std::vector<double>();
    out_.lost = bloom(state_, in_.width, d_.full_well_e);
    if (layers_) keep(Stage::well, {0, state_.size(), 0}, before, state_);
  }

  void convert(const Piece& piece, Scratch& scratch) {
    scratch.full.assign(piece.count, 0);
    const std::span<double> now = state(piece);
    const double well = well_of(d_);
    if (has(Stage::well))
      for (std::size_t i = 0; i < now.size(); ++i) scratch.full[i] = now[i] >= well;
    if (has(Stage::nonlinearity) && d_.nonlinearity != std::array<double, 2>{})
      stage(Stage::nonlinearity, piece, [&](std::span<double> q) {
        const double a = d_.nonlinearity[0], b = d_.nonlinearity[1], inverse = 1 / d_.full_well_e;
        for (double& each : q) {
          const double x = each * inverse;
          each *= 1.0 + x * (a + x * b);
        }
      });
    for (std::size_t i = 0; i < now.size(); ++i)
      out_.electrons[piece.begin + i] = static_cast<float>(now[i]);
    if (has(Stage::read) && d_.read_noise_e > 0) {
      noise_of(piece, scratch);
      stage(Stage::read, piece, [&](std::span<double> q) {
        const double* number = scratch.b.data();
        const double rms = d_.read_noise_e;
        for (std::size_t i = 0; i < q.size(); ++i) q[i] += rms * number[i];
      });
    }
    quantise(piece, scratch);
  }

  void noise_of(const Piece& piece, Scratch& scratch) const {
    scratch.a.clear();  // the pattern's numbers go
    scratch.b.resize(piece.count);
    draw_normal(piece.pixel, noise(StreamStage::read), scratch.b);
  }

  void quantise(const Piece& piece, const Scratch& scratch) {
    const double gain = d_.dn_per_e, bias = d_.bias_dn;
    const double most = static_cast<double>((1u << d_.bits) - 1);
    std::uint16_t* dn = out_.dn.data() + piece.begin;
    const auto limited = [most](double value) {
      const double low = value > 0.0 ? value : 0.0;
      return lanes::down((low < most ? low : most) + 0.5);
    };
    stage(Stage::adc, piece, [&](std::span<double> q) {
      for (std::size_t i = 0; i < q.size(); ++i) {
        const double number = limited(q[i] * gain + bias);
        dn[i] = static_cast<std::uint16_t>(static_cast<int>(number));
        if (layers_) q[i] = (number - bias) / gain;
      }
    });
    const auto top = static_cast<std::uint16_t>(most);
    std::size_t saturated = 0;
    for (std::size_t i = 0; i < piece.count; ++i) saturated += dn[i] == top || scratch.full[i] != 0;
    saturated_ += saturated;
    if (d_.compressed_bits > 0) {
      const double scale = static_cast<double>((1u << d_.compressed_bits) - 1);
      for (std::size_t i = 0; i < piece.count; ++i)
        dn[i] = static_cast<std::uint16_t>(
            static_cast<int>(lanes::down(std::sqrt(dn[i] / most) * scale + 0.5)));
    }
  }

  const Detector& d_;
  const MeanElectrons& in_;
  const std::uint64_t seed_;
  const std::uint32_t frame_;
  const bool layers_;
  std::uint32_t detector_width_ = 0, detector_height_ = 0;
  double dark_ = 0, hot_ = 0, telegraph_ = 0;  // electrons of this exposure
  std::vector<Deposit> deposits_;
  std::vector<double> state_;
  std::atomic<std::size_t> saturated_ = 0, invalid_ = 0;
  std::vector<double> lost_;  // by piece
  Readout out_;
};

}  // namespace

double dark_ratio(double temperature_k) {
  return janesick(temperature_k) / janesick(kDarkReference);
}

double dark_current(double na_per_cm2, const Vec2& pixel_um, double temperature_k) {
  const double area = 1e-8 * pixel_um.x * pixel_um.y;  // cm²
  return 2.55e15 * area * na_per_cm2 * janesick(temperature_k);
}

Readout read_out(const Detector& detector, const MeanElectrons& means, std::uint64_t seed,
                 std::uint32_t frame, bool layers) {
  if (detector.binning > 1) return read_out_blocks(detector, means, seed, frame, layers);
  return ReadoutRun(detector, means, seed, frame, layers).run();
}

std::vector<std::uint8_t> saturated_pixels(const Detector& detector,
                                           std::span<const std::uint16_t> dn,
                                           std::span<const float> electrons) {
  const std::uint32_t most = detector.most_dn();
  const float full =
      charge_of_full_well(detector) * static_cast<float>(detector.binning * detector.binning);
  std::vector<std::uint8_t> out(dn.size());
  for (std::size_t i = 0; i < dn.size(); ++i) out[i] = dn[i] == most || electrons[i] >= full;
  return out;
}

}  // namespace panwright::sensor
