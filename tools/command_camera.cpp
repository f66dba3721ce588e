#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/text.h"
#include "light/light.h"
#include "sensor/camera_file.h"
#include "sensor/focus.h"
#include "sensor/psf.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/plot.h"
#include "tools/print.h"

namespace panwright::tools {

namespace command_camera {
namespace {

using Json = nlohmann::ordered_json;
using sensor::Detector;
using sensor::DetectorStage;

struct Options {
  CommonOptions common;
  std::string file;
  std::string svg;
  std::string output;
  std::optional<std::string> format;
  double albedo = 0.3;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("camera", options.file, "Camera file (docs/cameras.md)").required().type("FILE");
  arguments
      .add("-o,--output", options.output, "File to write the size and the lens into, in --format")
      .type("FILE");
  arguments
      .add(
          "--format", options.format,
          "Format of the file: toml (default; the only one with optics and detector), opencv, ros, "
          "kalibr or speed (camera.json)")
      .type("NAME");
  arguments
      .add("--svg", options.svg,
           "Folder to write plots of photon transfer, MTF and encircled energy into")
      .type("FOLDER");
  arguments
      .add("--albedo", options.albedo,
           "Albedo of a Lambert plate in full sunlight at 1 AU, which is to be exposed (default "
           "0.3)")
      .type("A");
  declare(arguments, options.common);
}

// Standard deviations of one pixel, electrons.
struct Noise {
  double signal = 0, shot = 0, prnu = 0, dark = 0, dsnu = 0, read = 0, rounding = 0;
  double total() const {
    return std::sqrt(shot * shot + prnu * prnu + dark * dark + dsnu * dsnu + read * read +
                     rounding * rounding);
  }
};

double dark_electrons(const Detector& d) {
  return d.has(DetectorStage::dark)
             ? d.dark_e_per_s * sensor::dark_ratio(d.temperature_k) * d.exposure_s
             : 0;
}

Noise noise_at(const Detector& d, double signal) {
  const double dark = dark_electrons(d);
  Noise noise;
  noise.signal = signal;
  if (d.has(DetectorStage::shot)) noise.shot = std::sqrt(signal), noise.dark = std::sqrt(dark);
  if (d.has(DetectorStage::prnu)) noise.prnu = d.prnu * signal;
  if (d.has(DetectorStage::dsnu)) noise.dsnu = d.dsnu * dark;
  if (d.has(DetectorStage::read)) noise.read = d.read_noise_e;
  noise.rounding = 1 / (d.dn_per_e * std::sqrt(12.0));
  return noise;
}

// Electrons at which the well or the numbers end.
double most_electrons(const Detector& d) {
  return std::min(d.full_well_e,
                  (static_cast<double>((1u << d.bits) - 1) - d.bias_dn) / d.dn_per_e);
}

class CameraReport {
 public:
  CameraReport(const sensor::CameraFile& camera, const Options& options, CommandContext& context)
      : camera_(camera), options_(options), context_(context), out_(context.result()) {
    grid_ = {camera.width, camera.height, camera.lens.focal, camera.lens.principal, &map_};
    if (camera.imager) blocks_ = sensor::detector_of_blocks(camera.imager->detector);
  }

  bool run() {
    geometry();
    if (!camera_.imager) return true;
    const sensor::Optics& optics = camera_.imager->optics;
    for (std::size_t k = 0; k < sensor::kBands; ++k)
      airy_[k] = sensor::airy_px(optics, grid_, blocks_.pixel_um, sensor::kBandNm[k]);
    optics_report();
    detector_report();
    exposure();
    return options_.svg.empty() || plots();
  }

 private:
  bool json() const { return options_.common.json; }
  template <class... Args>
  void say(fmt::format_string<Args...> text, Args&&... args) const {
    if (!json()) print("{}\n", fmt::format(text, std::forward<Args>(args)...));
  }

  // Angle to the boresight of a place of the image, degrees; negative: no direction falls there.
  double angle_at(const Vec2& pixel) const {
    const auto ray = map_.ray((pixel - grid_.principal) / grid_.focal);
    return ray ? angle_between(ray->direction, Vec3(0, 0, 1)) / kDegree : -1;
  }

  void geometry() {
    const double width = camera_.width, height = camera_.height;
    out_["size"] = {camera_.width, camera_.height};
    say("{}{} x {} pixels", camera_.name.empty() ? "" : camera_.name + ": ", width, height);
    if (camera_.width_m > 0) {
      out_["width_m"] = camera_.width_m;
      say("orthographic, {} m across the image", camera_.width_m);
      return;
    }
    const Vec2& c = grid_.principal;
    const double left = angle_at({0, c.y}), right = angle_at({width, c.y});
    const double top = angle_at({c.x, 0}), bottom = angle_at({c.x, height});
    const double pixel = 1 / grid_.focal.x;  // radians on the axis
    out_["pixel_rad"] = pixel;
    out_["range_of_1m"] = grid_.focal.x;
    if (std::min({left, right, top, bottom}) >= 0) {
      out_["field_of_view_deg"] = {left + right, top + bottom};
      say("field of view    {:.4g} x {:.4g} degrees", left + right, top + bottom);
    } else {
      say("field of view    the lens ends {:.4g} degrees off its axis, inside the image",
          map_.domain() / kDegree);
    }
    say("pixel            {:.4g} µrad on the axis; 1 m is one pixel at {:.4g} m", 1e6 * pixel,
        grid_.focal.x);
  }

  void optics_report() {
    const sensor::Optics& o = camera_.imager->optics;
    const Vec2& pitch = blocks_.pixel_um;
    const double focal_mm = 1e-3 * grid_.focal.x * pitch.x;
    constexpr double kNyquist = 0.5;
    const double airy = airy_[1];
    Json mtf;
    mtf["pixel"] = sensor::mtf_of_pixel(kNyquist);
    if (o.diffraction) mtf["diffraction"] = sensor::mtf_of_diffraction(kNyquist, airy);
    if (o.gaussian_px() > 0) mtf["gaussian"] = sensor::mtf_of_gaussian(kNyquist, o.gaussian_px());
    if (o.defocus_px > 0) mtf["defocus"] = sensor::mtf_of_defocus(kNyquist, o.defocus_px);
    mtf["system"] = sensor::mtf_of_pixel(kNyquist) * sensor::mtf_of_optics(o, airy, kNyquist);
    out_["focal_length_mm"] = focal_mm;
    out_["aperture_mm"] = o.aperture_mm;
    out_["f_number"] = focal_mm / o.aperture_mm;
    out_["airy_px"] = airy;
    say("lens             f = {:.4g} mm, aperture {:.4g} mm, f/{:.3g}; λN = {:.3g} pixels at 550 "
        "nm",
        focal_mm, o.aperture_mm, focal_mm / o.aperture_mm, airy);
    std::string parts;
    for (const auto& [name, value] : mtf.items())
      parts += fmt::format("{}{} {:.3f}", parts.empty() ? "" : ", ", name, value.get<double>());
    say("MTF at Nyquist   {}", parts);
    out_["mtf_nyquist"] = std::move(mtf);
    std::string energy;
    for (const double radius : {0.5, 1.0, 2.0, 5.0}) {
      const double share = sensor::encircled_energy(o, airy, radius);
      out_["encircled_energy"].push_back({{"radius_px", radius}, {"share", share}});
      energy += fmt::format("{}{:.3f} in {} px", energy.empty() ? "" : ", ", share, radius);
    }
    say("light within     {} (without the pixel{})", energy,
        o.kernel.side > 0 ? " and the measured kernel" : "");
    if (o.focus_m > 0) focus_report();
  }

  // Distances whose discs are at most a pixel.
  void focus_report() {
    const sensor::Optics& o = camera_.imager->optics;
    const double at_infinity = sensor::blur_px(o, grid_.focal.x, INFINITY);
    const double nearest = o.focus_m * at_infinity / (at_infinity + 1);
    Json focus{{"distance_m", o.focus_m}, {"infinity_px", at_infinity}, {"nearest_m", nearest}};
    std::string farthest = "infinity";
    if (at_infinity > 1) {
      focus["farthest_m"] = o.focus_m * at_infinity / (at_infinity - 1);
      farthest = fmt::format("{:.4g} m", focus["farthest_m"].get<double>());
    }
    out_["focus"] = std::move(focus);
    say("focus            {:.4g} m; discs of at most a pixel from {:.4g} m to {}, of {:.3g} pixels "
        "at infinity",
        o.focus_m, nearest, farthest, at_infinity);
  }

  void detector_report() {
    const Detector& d = blocks_;
    const double most = most_electrons(d), dark = dark_electrons(d);
    const double floor = noise_at(d, 0).total();
    out_["full_well_e"] = d.full_well_e;
    out_["saturation_e"] = most;
    out_["dn_per_e"] = d.dn_per_e;
    out_["dark_e_per_s"] = d.dark_e_per_s * sensor::dark_ratio(d.temperature_k);
    out_["dynamic_range_db"] = 20 * det::log10(most / floor);
    say("detector         {} bits, {:.4g} numbers per electron, saturates at {:.5g} of {:.5g} "
        "electrons, {:.3g} dB",
        d.bits, d.dn_per_e, most, d.full_well_e, 20 * det::log10(most / floor));
    say("dark current     {:.4g} e/s at {} K: {:.4g} electrons in {} s",
        d.dark_e_per_s * sensor::dark_ratio(d.temperature_k), d.temperature_k, dark, d.exposure_s);
    say("\nnoise, electrons RMS\n  signal    shot    PRNU    dark    DSNU    read  rounding   "
        "total     "
        "SNR");
    for (const double share : {0.0, 0.01, 0.1, 0.5, 1.0}) {
      const Noise n = noise_at(d, share * most);
      const double snr = n.signal / n.total();
      say("{:8.0f}{:8.1f}{:8.1f}{:8.1f}{:8.1f}{:8.1f}{:10.1f}{:8.1f}{:8.1f}", n.signal, n.shot,
          n.prnu, n.dark, n.dsnu, n.read, n.rounding, n.total(), snr);
      out_["noise"].push_back({{"signal_e", n.signal},
                               {"shot", n.shot},
                               {"prnu", n.prnu},
                               {"dark", n.dark},
                               {"dsnu", n.dsnu},
                               {"read", n.read},
                               {"rounding", n.rounding},
                               {"total", n.total()},
                               {"snr", snr}});
    }
  }

  // The time in which a plate that faces the Sun fills 0.8 of what the detector takes.
  void exposure() {
    const Detector& d = blocks_;
    const auto of_bands = sensor::electrons_of_irradiance(camera_.imager->optics);
    const double angle = 1 / (grid_.focal.x * grid_.focal.y);
    std::array<double, sensor::kBands> rates{};
    double rate = 0;
    for (std::size_t k = 0; k < sensor::kBands; ++k) {
      rates[k] = of_bands[k] * angle * options_.albedo / kPi *
                 light::kSolarIrradiance[static_cast<int>(k)];
      rate = d.is_mono() ? rate + rates[k] : std::max(rate, rates[k]);
    }
    const double seconds = 0.8 * most_electrons(d) / rate;
    out_["exposure"] = {{"albedo", options_.albedo}, {"e_per_s", rate}, {"seconds", seconds}};
    say("\nexposure         a plate of albedo {} facing the Sun at 1 AU: {:.4g} e/s, {:.3g} ms to "
        "80 % "
        "of saturation",
        options_.albedo, rate, 1e3 * seconds);
  }

  Plot transfer_plot() const {
    const Detector& d = blocks_;
    const double most = 1.15 * most_electrons(d), dark = dark_electrons(d);
    const double top = static_cast<double>((1u << d.bits) - 1);
    Plot plot;
    plot.title = "Photon transfer";
    plot.x_name = "mean, numbers above the bias";
    plot.y_name = "variance, numbers²";
    PlotCurve expected{{}, "#1f77b4", "expected", {}}, measured{{}, "#d62728", "simulated", {}};
    constexpr std::uint32_t kSide = 64, kLevels = 40;
    for (std::uint32_t k = 0; k <= kLevels; ++k) {
      const double signal = most * k / kLevels;
      const double variance =
          d.dn_per_e * d.dn_per_e * (signal + dark + d.read_noise_e * d.read_noise_e) + 1.0 / 12;
      if (signal <= most_electrons(d)) expected.points.emplace_back(d.dn_per_e * signal, variance);
      plot.top = std::max(plot.top, 1.1 * variance);
      // a pair of flat fields: their difference has no pattern
      const std::vector<float> values(kSide * kSide, static_cast<float>(signal));
      sensor::MeanElectrons means;
      means.width = means.height = kSide;
      means.values = values;
      Detector plain = camera_.imager->detector;
      plain.bayer = {};
      plain.compressed_bits = 0;
      const auto a = sensor::read_out(plain, means, 1, 2 * k);
      const auto b = sensor::read_out(plain, means, 1, 2 * k + 1);
      double sum = 0, squares = 0;
      for (std::size_t i = 0; i < a.dn.size(); ++i) {
        const double difference = double(a.dn[i]) - b.dn[i];
        sum += a.dn[i] + b.dn[i];
        squares += difference * difference;
      }
      const double count = 2.0 * kSide * kSide;
      measured.dots.emplace_back(sum / count - d.bias_dn - d.dn_per_e * dark, squares / count);
    }
    plot.right = std::min(top, 1.05 * d.dn_per_e * most);
    plot.curves = {expected, measured};
    return plot;
  }

  Plot mtf_plot() const {
    const sensor::Optics& o = camera_.imager->optics;
    Plot plot;
    plot.title = "MTF at 550 nm";
    plot.x_name = "cycles per pixel";
    plot.y_name = "MTF";
    PlotCurve pixel{{}, "#7f7f7f", "pixel", {}}, optics{{}, "#1f77b4", "optics", {}},
        system{{}, "#d62728", "system", {}};
    for (int k = 0; k <= 100; ++k) {
      const double f = 0.01 * k;
      const double a = sensor::mtf_of_pixel(f), b = sensor::mtf_of_optics(o, airy_[1], f);
      pixel.points.emplace_back(f, std::fabs(a));
      optics.points.emplace_back(f, std::fabs(b));
      system.points.emplace_back(f, std::fabs(a * b));
    }
    plot.curves = {pixel, optics, system};
    return plot;
  }

  Plot energy_plot() const {
    const sensor::Optics& o = camera_.imager->optics;
    Plot plot;
    plot.title = "Encircled energy";
    plot.x_name = "radius, pixels";
    plot.y_name = "share of the light";
    plot.right = 8;
    constexpr const char* kColors[] = {"#d62728", "#2ca02c", "#1f77b4"};
    for (std::size_t band = 0; band < sensor::kBands; ++band) {
      PlotCurve curve{{}, kColors[band], fmt::format("{} nm", sensor::kBandNm[band]), {}};
      for (int k = 0; k <= 40; ++k)
        curve.points.emplace_back(0.2 * k, sensor::encircled_energy(o, airy_[band], 0.2 * k));
      plot.curves.push_back(std::move(curve));
    }
    return plot;
  }

  bool plots() {
    const std::filesystem::path folder = options_.svg;
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    const std::string stem = std::filesystem::path(options_.file).stem().string();
    const auto write = [&](const char* name, const Plot& plot) {
      const std::string path = (folder / (stem + name)).string();
      if (!write_file(path, as_bytes(svg_of(plot)), context_.log())) return false;
      context_.wrote(path);
      return true;
    };
    return write("-transfer.svg", transfer_plot()) && write("-mtf.svg", mtf_plot()) &&
           write("-energy.svg", energy_plot());
  }

  const sensor::CameraFile& camera_;
  const Options& options_;
  CommandContext& context_;
  Json& out_;
  sensor::DistortionMap map_{camera_.lens.distortion};
  sensor::PixelGrid grid_;
  Detector blocks_;  // as its image has it
  std::array<double, sensor::kBands> airy_{};
};

std::optional<sensor::CameraFormat> format_of(const Options& options, DiagnosticLog& log) {
  using sensor::CameraFormat;
  constexpr std::pair<std::string_view, CameraFormat> kFormats[] = {
      {"toml", CameraFormat::toml},
      {"opencv", CameraFormat::opencv},
      {"ros", CameraFormat::ros},
      {"kalibr", CameraFormat::kalibr},
      {"speed", CameraFormat::speed}};
  if (options.format && options.output.empty())
    log.report(Code("E0201"), {}, "--format needs -o, the file to write");
  const std::string name = options.format.value_or("toml");
  for (const auto& [known, format] : kFormats)
    if (name == known) return format;
  log.report(
      Code("E0201"), {},
      fmt::format("--format is {}, expected toml, opencv, ros, kalibr or speed", in_quotes(name)));
  return std::nullopt;
}

void write_camera(const sensor::CameraFile& camera, sensor::CameraFormat format,
                  const Options& options, CommandContext& context) {
  if (camera.imager && format != sensor::CameraFormat::toml)
    context.log().report_file(Code("W0221"), options.file,
                              "the format holds no optics and no detector: they are left out",
                              "--format toml");
  const auto text = sensor::camera_text(camera, format, context.log());
  if (text && write_file(options.output, as_bytes(*text), context.log()))
    context.wrote(options.output);
}

int run(const Options& options, const Host& host) {
  CommandContext context("camera", options.common, host);
  DiagnosticLog& log = context.log();
  const auto format = format_of(options, log);
  if (!options.output.empty()) context.files().will_write(options.output, "-o", log);
  if (!(options.albedo > 0 && options.albedo <= 1))
    log.report(Code("E0201"), {},
               fmt::format("--albedo is {}, expected above 0 to 1", options.albedo));
  constexpr std::uint64_t kMostBytes = 1 << 20;
  const auto text = read_file(options.file, kMostBytes, log);
  if (!text || log.has_errors()) return context.finish();
  const auto camera = sensor::read_camera(*text, options.file, log);
  if (camera && CameraReport(*camera, options, context).run() && !options.output.empty())
    write_camera(*camera, *format, options, context);
  return context.finish();
}

}  // namespace
}  // namespace command_camera

Command camera_command() {
  return command("camera", "Show what a camera file makes: field, MTF, noise, exposure; convert it",
                 command_camera::declare_all, command_camera::run);
}

}  // namespace panwright::tools
