#include "sensor/imager.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <vector>

#include "base/text.h"

namespace panwright::sensor {

namespace {

using Stage = DetectorStage;

constexpr std::uint32_t kMostKernel = 255;  // of a side
constexpr double kMostTracks = 1e7;

// Members that are one number within bounds. `take` is called with name, member, least, most.
template <class Of, class Take>
void each_optics_number(Of& o, const Take& take) {
  take("veiling_glare", o.veiling_glare, 0, 1);
  take("psf_px", o.psf_px, 0, 16);
  take("jitter_px", o.jitter_px, 0, 16);
  take("diffusion_px", o.diffusion_px, 0, 16);
  take("defocus_px", o.defocus_px, 0, 32);
  take("focus_m", o.focus_m, 0, 1e12);
}

template <class Of, class Take>
void each_detector_number(Of& d, const Take& take) {
  take("prnu", d.prnu, 0, 1);
  take("temperature_k", d.temperature_k, 100, 350);
  take("dsnu", d.dsnu, 0, 10);
  take("hot_pixels", d.hot_pixels, 0, 1);
  take("hot_e_per_s", d.hot_e_per_s, 0, 1e9);
  take("telegraph_pixels", d.telegraph_pixels, 0, 1);
  take("telegraph_e_per_s", d.telegraph_e_per_s, 0, 1e9);
  take("cosmic_per_cm2_s", d.cosmic_per_cm2_s, 0, 1e9);
  take("depth_um", d.depth_um, 0.1, 1000);
  take("full_well_e", d.full_well_e, 1, 1e9);
  take("smear_row_s", d.smear_row_s, 0, 1);
  take("read_noise_e", d.read_noise_e, 0, 1e6);
  take("bias_dn", d.bias_dn, 0, 65535);
}

template <class Of, class Take>
void each_detector_count(Of& d, const Take& take) {
  take("telegraph_frames", d.telegraph_frames, 1, 1e6);
  take("bits", d.bits, 2, 16);
  take("compressed_bits", d.compressed_bits, 2, 16);
  take("blocks", d.binning, 2, 16);
}

template <class Of, class Take>
void each_flag(Of& d, const Take& take) {
  take("blooming", d.blooming);
  take("smear_flush", d.smear_flush);
}

class ImagerReader {
 public:
  ImagerReader(const ConfigValue& detector, const ConfigValue* optics, const ImagerLens& lens,
               DiagnosticLog& log)
      : d_(detector, "[detector]", Code("E0220"), log),
        o_(optics != nullptr ? *optics : kNone, "[optics]", Code("E0220"), log),
        lens_(lens),
        log_(log) {}

  Result<Imager> read() {
    read_detector();
    read_optics();
    d_.finish();
    o_.finish();
    if (!d_.ok() || !o_.ok()) return failed;
    check();
    if (!d_.ok() || !o_.ok()) return failed;
    return std::move(out_);
  }

 private:
  static const ConfigValue kNone;

  static void bounded(ConfigTable& table, const char* name, double& to, double least, double most) {
    const ConfigValue* value = table.find(name);
    const auto number = table.number(value, name);
    if (!number) return;
    if (*number >= least && *number <= most)
      to = *number;
    else
      table.fail(*value, fmt::format("{} is {}, expected {} to {}", name, *number, least, most),
                 std::string_view(name) == "focus_m"
                     ? "without it, or with 0, all distances are sharp; 1e12 is infinity"
                     : "");
  }

  void shares(ConfigTable& table, const char* name, std::array<double, kBands>& to) {
    const ConfigValue* value = table.find(name);
    const auto given = table.numbers(value, name, {1, kBands});
    if (!given) return;
    for (std::size_t k = 0; k < kBands; ++k) {
      to[k] = (*given)[given->size() == 1 ? 0 : k];
      if (!(to[k] >= 0 && to[k] <= 1)) {
        table.fail(*value, fmt::format("{} is {}, expected shares from 0 to 1", name, to[k]));
        return;
      }
    }
  }

  void read_detector() {
    Detector& d = out_.detector;
    read_pixel();
    each_detector_number(d, [&](const char* name, double& to, double least, double most) {
      bounded(d_, name, to, least, most);
    });
    each_detector_count(d, [&](const char* name, std::uint32_t& to, double least, double most) {
      double number = to;
      bounded(d_, name, number, std::min<double>(least, to), most);
      if (number != std::floor(number))
        d_.fail(*d_.find(name), fmt::format("{} is {}, expected a whole number", name, number));
      to = static_cast<std::uint32_t>(number);
    });
    each_flag(d, [&](const char* name, bool& to) { to = d_.flag(name).value_or(to); });
    read_block_sum();
    shares(d_, "qe", out_.optics.qe);
    read_exposure();
    read_dark();
    read_gain();
    if (const auto terms = d_.numbers("nonlinearity", {1, 2}))
      d.nonlinearity = {terms->front(), terms->size() > 1 ? terms->back() : 0};
    if (const ConfigValue* value = d_.find("bayer"); value != nullptr) read_bayer(*value);
    if (const ConfigValue* value = d_.find("serial"); value != nullptr) {
      const auto number = d_.number(value, "serial");
      if (number && *number >= 0 && *number <= 0x1p53 && *number == std::floor(*number))
        d.serial = static_cast<std::uint64_t>(*number);
      else if (number)
        d_.fail(*value, "serial is not a whole number from 0 to 2^53");
    }
    if (const ConfigValue* value = d_.find("off"); value != nullptr) read_switches(*value);
  }

  void read_pixel() {
    const ConfigValue* value = d_.find("pixel_um");
    if (value == nullptr) {
      if (lens_.pixel_um)
        out_.detector.pixel_um = *lens_.pixel_um;
      else
        d_.require("pixel_um");
      return;
    }
    const auto pitch = d_.numbers(value, "pixel_um", {1, 2});
    if (!pitch) return;
    out_.detector.pixel_um = Vec2(pitch->front(), pitch->back());
    if (!(pitch->front() >= 0.1 && pitch->back() >= 0.1 &&
          std::max(pitch->front(), pitch->back()) <= 1000))
      d_.fail(*value, fmt::format("pixel_um is {}, expected 0.1 to 1000", pitch->front()));
  }

  void read_block_sum() {
    const ConfigValue* value = d_.find("block_sum");
    if (value == nullptr) return;
    const std::string name = d_.text(value, "block_sum").value_or("charge");
    out_.detector.sums_numbers = name == "numbers";
    if (name != "numbers" && name != "charge")
      d_.fail(*value,
              fmt::format("block_sum is {}, expected \"charge\" or \"numbers\"", in_quotes(name)));
  }

  void read_exposure() {
    const ConfigValue* value = d_.require("exposure_s");
    if (value == nullptr) return;
    if (const auto* word = std::get_if<std::string>(&value->data)) {
      out_.auto_exposure = *word == "auto";
      if (!out_.auto_exposure)
        d_.fail(*value,
                fmt::format("exposure_s is {}, expected seconds or \"auto\"", in_quotes(*word)));
      return;
    }
    bounded(d_, "exposure_s", out_.detector.exposure_s, 1e-9, 1e5);
  }

  // At kDarkReference, or as a density at 300 K.
  void read_dark() {
    const ConfigValue* rate = d_.find("dark_e_per_s");
    const ConfigValue* density = d_.find("dark_na_per_cm2");
    if (rate != nullptr && density != nullptr)
      return d_.fail(*density, "expected dark_e_per_s or dark_na_per_cm2, not both");
    double& to = out_.detector.dark_e_per_s;
    bounded(d_, "dark_e_per_s", to, 0, 1e9);
    if (density == nullptr) return;
    double given = 0;
    bounded(d_, "dark_na_per_cm2", given, 0, 1e6);
    to = dark_current(given, out_.detector.pixel_um, kDarkReference);
  }

  void read_gain() {
    Detector& d = out_.detector;
    const ConfigValue* value = d_.find("dn_per_e");
    // the full well at the largest number
    const double most = static_cast<double>((1u << std::clamp(d.bits, 2u, 16u)) - 1);
    d.dn_per_e = (most - d.bias_dn) / d.full_well_e;
    if (value != nullptr) bounded(d_, "dn_per_e", d.dn_per_e, 1e-6, 1e4);
    if (!(d.bias_dn < most))
      d_.fail(d_.value(), fmt::format("bias_dn is {}, expected less than the largest number {}",
                                      d.bias_dn, most));
  }

  void read_bayer(const ConfigValue& value) {
    const std::string name = d_.text(&value, "bayer").value_or("none");
    constexpr std::string_view kPatterns[] = {"rggb", "bggr", "grbg", "gbrg"};
    if (name == "none") return;
    if (std::ranges::find(kPatterns, name) == std::end(kPatterns))
      return d_.fail(value, fmt::format("bayer is {}, expected none, {}", in_quotes(name),
                                        fmt::join(kPatterns, ", ")));
    std::copy_n(name.begin(), 4, out_.detector.bayer.begin());
  }

  void read_switches(const ConfigValue& value) {
    const auto* list = std::get_if<ConfigValue::List>(&value.data);
    if (list == nullptr)
      return d_.fail(value, "off is no list of stages, as [\"cosmic\", \"smear\"]");
    const std::span<const std::string_view> names(kDetectorStageNames, kDetectorStages - 1);
    for (const ConfigValue& each : *list) {
      const std::string name = d_.text(&each, "off").value_or("");
      const auto found = std::ranges::find(names, name);
      if (found != names.end()) {
        out_.detector.off[static_cast<std::size_t>(found - names.begin())] = true;
        continue;
      }
      const auto near = nearest_name(name, names);
      d_.fail(each, fmt::format("off has {}, expected {}", in_quotes(name), fmt::join(names, ", ")),
              near ? fmt::format("did you mean '{}'?", *near) : "");
    }
  }

  void read_optics() {
    Optics& o = out_.optics;
    const ConfigValue* aperture = o_.find("aperture_mm");
    const ConfigValue* number = o_.find("f_number");
    if ((aperture == nullptr) == (number == nullptr)) {
      o_.fail(o_.value(), "expected aperture_mm or f_number in [optics]");
    } else if (aperture != nullptr) {
      bounded(o_, "aperture_mm", o.aperture_mm, 1e-3, 1e6);
    } else {
      double f = 1;
      bounded(o_, "f_number", f, 0.1, 1e4);
      o.aperture_mm = 1e-3 * lens_.focal_px * out_.detector.pixel_um.x / f;
    }
    shares(o_, "transmission", o.transmission);
    each_optics_number(o, [&](const char* name, double& to, double least, double most) {
      bounded(o_, name, to, least, most);
    });
    o.diffraction = o_.flag("diffraction").value_or(o.diffraction);
    read_pairs("vignetting", "degrees and shares", [&](double angle, double share) {
      o.vignetting.emplace_back(angle, share);
      const bool rises = o.vignetting.size() < 2 || angle > o.vignetting.end()[-2].first;
      return rises && angle >= 0 && angle <= 180 && share >= 0 && share <= 1;
    });
    read_pairs("ghosts", "shares and scales", [&](double share, double scale) {
      o.ghosts.push_back({share, scale});
      return share >= 0 && share <= 1 && std::fabs(scale) >= 1e-3 && std::fabs(scale) <= 1e3;
    });
    if (const ConfigValue* value = o_.find("kernel"); value != nullptr) read_kernel(*value);
  }

  template <class Take>
  void read_pairs(const char* name, const char* what, const Take& take) {
    const ConfigValue* value = o_.find(name);
    if (value == nullptr) return;
    const auto* list = std::get_if<ConfigValue::List>(&value->data);
    bool good = list != nullptr && list->size() <= 1000;
    for (std::size_t i = 0; good && i < list->size(); ++i) {
      const auto pair = o_.numbers(&(*list)[i], name, {2});
      if (!pair) return;
      good = take((*pair)[0], (*pair)[1]);
    }
    if (!good)
      o_.fail(*value, fmt::format("{} is no list of pairs of {} within their bounds", name, what));
  }

  void read_kernel(const ConfigValue& value) {
    PsfKernel& kernel = out_.optics.kernel;
    const auto* rows = std::get_if<ConfigValue::List>(&value.data);
    const std::size_t side = rows != nullptr ? rows->size() : 0;
    if (side % 2 == 0 || side > kMostKernel)
      return o_.fail(value, fmt::format("kernel is no list of an odd number of rows, at most {}",
                                        kMostKernel));
    for (const ConfigValue& row : *rows) {
      const auto numbers = o_.numbers(&row, "row of the kernel", {side});
      if (!numbers) return;
      for (const double each : *numbers)
        if (!(each >= 0))
          return o_.fail(row, fmt::format("the kernel has {}, expected 0 or more", each));
      kernel.values.insert(kernel.values.end(), numbers->begin(), numbers->end());
    }
    kernel.side = static_cast<std::uint32_t>(side);
    double energy = 1, steps = 1;
    bounded(o_, "kernel_energy", energy, 1e-6, 1);
    bounded(o_, "kernel_oversampling", steps, 1, 3);
    if (steps != 1 && steps != 3)
      o_.fail(*o_.find("kernel_oversampling"), "kernel_oversampling is neither 1 nor 3");
    kernel.oversampling = static_cast<std::uint32_t>(steps);
    const double sum = std::accumulate(kernel.values.begin(), kernel.values.end(), 0.0);
    if (std::fabs(sum - energy) > 1e-3 * energy)
      o_.fail(value, fmt::format("the kernel sums to {:.6g}, expected its energy {}", sum, energy),
              "scale it, or state the share of the light that it holds as kernel_energy");
  }

  void check() {
    const Detector& d = out_.detector;
    if (d.full_well_e <= d.read_noise_e)
      d_.fail(d_.value(), fmt::format("full_well_e is {}, expected more than the read noise {}",
                                      d.full_well_e, d.read_noise_e));
    if (d.compressed_bits > d.bits)
      d_.fail(d_.value(), fmt::format("compressed_bits is {}, expected at most bits, {}",
                                      d.compressed_bits, d.bits));
    constexpr double kCoarse = 0.46;  // where rounding takes 13 % of the variance
    if (d.read_noise_e > 0 && d.read_noise_e * d.dn_per_e < kCoarse)
      log_.report(Code("W0222"), d_.value().where,
                  fmt::format("read noise is {:.2g} of a number: rounding hides it",
                              d.read_noise_e * d.dn_per_e));
  }

  ConfigTable d_, o_;
  const ImagerLens& lens_;
  DiagnosticLog& log_;
  Imager out_;
};

const ConfigValue ImagerReader::kNone{ConfigValue::Map{}, {}};

std::string number(double value) {
  const std::string text = format_double(value);
  return text.find_first_of(".e") == text.npos ? text + ".0" : text;
}

template <class Range>
std::string list(const Range& values) {
  std::string out;
  for (const double value : values) out += (out.empty() ? "" : ", ") + number(value);
  return "[" + out + "]";
}

std::string optics_text(const Optics& o) {
  static const Optics standard;
  std::string out = fmt::format("[optics]\naperture_mm = {}\n", number(o.aperture_mm));
  if (o.transmission != standard.transmission)
    out += fmt::format("transmission = {}\n", list(o.transmission));
  each_optics_number(o, [&](const char* name, double value, double, double) {
    if (value != 0) out += fmt::format("{} = {}\n", name, number(value));
  });
  if (o.diffraction) out += "diffraction = true\n";
  const auto pairs = [&](const char* name, const auto& values, const auto& pair) {
    std::string text;
    for (const auto& each : values) text += (text.empty() ? "" : ", ") + list(pair(each));
    if (!text.empty()) out += fmt::format("{} = [{}]\n", name, text);
  };
  pairs("vignetting", o.vignetting, [](const auto& each) {
    return std::array{each.first, each.second};
  });
  pairs("ghosts", o.ghosts, [](const Ghost& each) { return std::array{each.share, each.scale}; });
  if (const std::size_t side = o.kernel.side; side > 0) {
    std::string rows;
    for (std::size_t y = 0; y < side; ++y)
      rows += (y > 0 ? ", " : "") + list(std::span(o.kernel.values).subspan(y * side, side));
    const double sum = std::accumulate(o.kernel.values.begin(), o.kernel.values.end(), 0.0);
    out += fmt::format("kernel = [{}]\nkernel_energy = {}\nkernel_oversampling = {}\n", rows,
                       number(std::min(sum, 1.0)), o.kernel.oversampling);
  }
  return out;
}

// Bounds of a detector that is read in blocks. side: of its image
std::string check_blocks(const Imager& imager, std::uint32_t side) {
  const Detector& d = imager.detector;
  if (d.binning == 1) return {};
  if (!d.is_mono()) return "a detector with colour filters has blocks, expected a mono one";
  if (imager.optics.kernel.side > 0)
    return "a measured kernel with blocks of pixels, expected one without, of the blocks";
  if (d.sums_numbers && d.compressed_bits > 0)
    return "sums of numbers are compressed, expected sums of charge or no compressed_bits";
  if (d.sums_numbers && d.stored_bits() > 16)
    return fmt::format("sums of {} numbers of {} bits take {} bits, expected at most 16",
                       d.binning * d.binning, d.bits, d.stored_bits());
  constexpr std::uint32_t kMostSide = 16384;
  if (std::uint64_t{side} * d.binning > kMostSide)
    return fmt::format("the detector has {} pixels across, expected at most {}",
                       std::uint64_t{side} * d.binning, kMostSide);
  return {};
}

}  // namespace

void bin(Imager& imager, std::uint32_t side) {
  Optics& o = imager.optics;
  for (double* length : {&o.psf_px, &o.jitter_px, &o.diffusion_px, &o.defocus_px}) *length /= side;
  imager.detector.binning *= side;
}

std::string check_imager(const Imager& imager, std::uint32_t width, std::uint32_t height) {
  const Detector& d = imager.detector;
  const double side = d.binning,
               area = 1e-8 * d.pixel_um.x * d.pixel_um.y * side * side * width * height;
  if (std::string why = check_blocks(imager, std::max(width, height)); !why.empty()) return why;
  if (const double tracks = d.cosmic_per_cm2_s * area * d.exposure_s; tracks > kMostTracks)
    return fmt::format("{:.3g} tracks of particles in an exposure, expected at most {}", tracks,
                       kMostTracks);
  if (d.smear_row_s >= d.exposure_s)
    return fmt::format("smear_row_s is {}, expected less than the exposure time {}", d.smear_row_s,
                       d.exposure_s);
  return {};
}

Result<Imager> read_imager(const ConfigValue& detector, const ConfigValue* optics,
                           const ImagerLens& lens, DiagnosticLog& log) {
  return ImagerReader(detector, optics, lens, log).read();
}

std::string imager_text(const Imager& imager) {
  static const Detector standard;
  const Detector& d = imager.detector;
  std::string out = optics_text(imager.optics);
  out += fmt::format("[detector]\npixel_um = {}\nqe = {}\nexposure_s = {}\n",
                     list(std::array{d.pixel_um.x, d.pixel_um.y}), list(imager.optics.qe),
                     imager.auto_exposure ? "\"auto\"" : number(d.exposure_s));
  std::vector<double> defaults;
  each_detector_number(
      standard, [&](const char*, double value, double, double) { defaults.push_back(value); });
  std::size_t at = 0;
  each_detector_number(d, [&](const char* name, double value, double, double) {
    if (value != defaults[at++]) out += fmt::format("{} = {}\n", name, number(value));
  });
  if (d.dark_e_per_s > 0) out += fmt::format("dark_e_per_s = {}\n", number(d.dark_e_per_s));
  each_detector_count(d, [&](const char* name, std::uint32_t value, double least, double) {
    if (value >= least) out += fmt::format("{} = {}\n", name, value);
  });
  each_flag(d, [&](const char* name, bool value) {
    if (value) out += fmt::format("{} = true\n", name);
  });
  out += fmt::format("dn_per_e = {}\n", number(d.dn_per_e));
  if (d.nonlinearity != standard.nonlinearity)
    out += fmt::format("nonlinearity = {}\n", list(d.nonlinearity));
  if (d.sums_numbers) out += "block_sum = \"numbers\"\n";
  if (!d.is_mono())
    out += fmt::format("bayer = \"{}\"\n", std::string_view(d.bayer.data(), d.bayer.size()));
  if (d.serial > 0) out += fmt::format("serial = {}\n", d.serial);
  std::string off;
  for (std::size_t k = 0; k < kDetectorStages; ++k)
    if (d.off[k]) off += fmt::format("{}\"{}\"", off.empty() ? "" : ", ", kDetectorStageNames[k]);
  if (!off.empty()) out += fmt::format("off = [{}]\n", off);
  return out;
}

Result<Imager> parse_imager(std::string_view text, DiagnosticLog& log) {
  SourceFile source;
  source.name = "detector";
  source.bytes = std::make_shared<const std::string>(text);
  const FileId file = log.sources().add(std::move(source));
  const auto root = parse_config(text, ConfigFormat::toml, file, Code("E0220"), log);
  if (!root) return failed;
  const ConfigValue* detector = root->find("detector");
  if (detector == nullptr) {
    log.report(Code("E0220"), root->where, "no table [detector]", "docs/detector.md");
    return failed;
  }
  return read_imager(*detector, root->find("optics"), {}, log);
}

}  // namespace panwright::sensor
