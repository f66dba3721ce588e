#include "tools/render_report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/clock.h"
#include "base/text.h"
#include "image/image.h"
#include "tools/print.h"

namespace panwright::tools {

namespace {

using Json = nlohmann::ordered_json;
using workspace::Engine;
using workspace::Written;

Json numbers(const Vec3& v) { return {v.x, v.y, v.z}; }

const char* unit_of_flux(const Written& image) {
  const bool unresolved = image.unit == "1/sr";
  if (image.orthographic) return unresolved ? "m^2/sr" : "W/sr";
  return unresolved ? "of the Sun's" : "W/m^2";
}

std::string outputs_of(const Written& image) {
  return fmt::format("{}", fmt::join(image.outputs, ", "));
}

bool is_png(const std::string& output) {
  return image::image_format(output) == image::ImageFormat::png;
}

std::string milliseconds(double seconds) {
  const double ms = 1e3 * seconds;
  return ms < 99.95 ? fmt::format("{:.3g} ms", ms) : fmt::format("{:.0f} ms", ms);
}

// "0.03", "20": one digit, and whole percents.
std::string percent_words(double share) {
  return share < 0.1 ? fmt::format("{:.1g}", 100 * share) : fmt::format("{:.0f}", 100 * share);
}

// "a.png: 640 x 480, gl, 9.4 samples a pixel (auto …), EV 0, 35 ms"
std::string line_of(const Written& image) {
  std::string line = fmt::format("{}: {} x {}, {}", outputs_of(image), image.width, image.height,
                                 image.engine == Engine::gl ? "gl" : "reference");
  if (image.moments > 1) line += fmt::format(", mean of {} moments", image.moments);
  if (image.sampling) {
    const preview::SamplingReport& sampling = *image.sampling;
    // of targets, where some are in view
    if (sampling.samples > 0)
      line += fmt::format(", {:.3g} samples a pixel", sampling.samples);
    else if (image.ground_rays == 0)
      line += ", no target in view";
    if (sampling.rmse == preview::kNothingLit)
      line += " (no sample is lit)";
    else if (sampling.rmse + sampling.flux > 0)
      line += fmt::format(
          " (estimated RMS error {:.2g} % of the radiance, of the flux at most {:.2g} %{})",
          100 * sampling.rmse, 100 * sampling.flux,
          sampling.limited ? "; --pixel-error 5% takes longer" : "");
    else if (image.samples == 0 && sampling.samples > 0)
      line += " (auto)";
    if (!sampling.imposters.empty()) {
      double flux_error = 0;
      for (const preview::ImposterReport& one : sampling.imposters)
        flux_error = std::max(flux_error, one.flux_error);
      line += fmt::format(", {} ({})", counted(sampling.imposters.size(), "imposter"),
                          flux_error == preview::kNothingLit
                              ? "no texel is lit"
                              : fmt::format("flux within {} %", percent_words(flux_error)));
    }
    if (sampling.shadow_edge > 0)
      line += fmt::format(", edges of shadows within {:.2g} pixels", sampling.shadow_edge);
    if (sampling.sun_points > 1)
      line += fmt::format(", penumbra of {} points of the Sun", sampling.sun_points);
  }
  if (image.ground_rays > 0)
    line += fmt::format(", terrain by {:.3g} rays a pixel", image.ground_rays);
  if (image.measured) {
    const workspace::Measured& measured = *image.measured;
    const Vec3& flux = measured.flux;
    const Vec3& error = measured.flux_error;
    line += fmt::format(
        ", {:.3g} samples a pixel, flux {:.6g} {:.6g} {:.6g} ± {:.1e} {:.1e} {:.1e} {}, {:.3g} M "
        "rays/s",
        static_cast<double>(measured.samples) / (double{1} * image.width * image.height), flux.x,
        flux.y, flux.z, error.x, error.y, error.z, unit_of_flux(image),
        1e-6 * static_cast<double>(measured.rays) / std::max(measured.seconds, 1e-9));
  }
  if (image.exposure_s > 0)
    line += fmt::format(", {} bits, exposure {:.4g} s, {} saturated", image.dn_bits,
                        image.exposure_s, counted(image.saturated, "pixel"));
  const bool png = std::any_of(image.outputs.begin(), image.outputs.end(), is_png);
  if (png && image.exposure_s == 0) line += fmt::format(", EV {}", image.ev);
  return line + ", " + milliseconds(image.seconds);
}

// What models gave the image: settings of a scene, lamps.
std::string explained_models(const Written& image) {
  std::string text;
  for (const std::string& setting : image.of_scene)
    text += fmt::format("  {}: from the scene of {}\n", setting, in_quotes(image.scene_target));
  if (!image.lamps_on.empty())
    text += fmt::format("  lamps of models: {}\n", fmt::join(image.lamps_on, ", "));
  if (!image.lamps_off.empty())
    text += fmt::format("  lamps of models that are off: {}\n", fmt::join(image.lamps_off, ", "));
  return text;
}

// How each target of an image was drawn, a line each.
std::string explained(const Written& image) {
  std::string text = explained_models(image);
  for (const std::string& line : image.sky) text += "  " + line + "\n";
  if (image.ground_light) {
    const workspace::GroundLight& light = *image.ground_light;
    text +=
        fmt::format("  light of terrain on targets: at most {:.2g} % of the Sun's{}\n",
                    100 * light.share, light.seconds > 0 ? ", " + milliseconds(light.seconds) : "");
  }
  if (image.between) {
    const workspace::LightBetween& between = *image.between;
    text += fmt::format(
        "  light between surfaces: {}, about {:.2g} % of the flux, {:.2g} % RMS of the radiance; "
        "{}{}{}\n",
        between.drawn ? "drawn" : "left out", 100 * between.flux, 100 * between.rms,
        counted(between.surfels, "surfel"), between.mirrors ? ", mirrors by rays" : "",
        between.seconds > 0 ? ", " + milliseconds(between.seconds) : "");
  }
  if (!image.sampling) return text;
  std::vector<bool> told(image.targets.size(), false);
  for (const preview::ImposterReport& one : image.sampling->imposters) {
    std::vector<std::string> names;
    for (const std::uint32_t target : one.targets) {
      names.push_back(image.targets[target]);
      told[target] = true;
    }
    text +=
        fmt::format("  {}: an imposter of {} x {} texels for {:.3g} pixels, flux within {} %, {}\n",
                    fmt::join(names, ", "), one.width, one.height, one.extent,
                    percent_words(one.flux_error), milliseconds(one.seconds));
  }
  for (std::size_t i = 0; i < told.size(); ++i)
    if (!told[i])
      text += fmt::format("  {}: with the image's own samples, or not in view\n", image.targets[i]);
  const preview::SamplingReport& sampling = *image.sampling;
  if (sampling.sun_points > 1)
    text += fmt::format(
        "  shadows: {} points of the Sun's disc, penumbra up to {:.3g} pixels, residual error at "
        "most {:.2g} RMS of the disc's light\n",
        sampling.sun_points, sampling.penumbra, sampling.sun_error);
  else if (sampling.penumbra > 0)
    text += fmt::format("  shadows: hard, the penumbra is {:.2g} pixels or narrower\n",
                        sampling.penumbra);
  if (sampling.lamps > 0)
    text += fmt::format("  lamps: {} on a target, {} of them too weak to cast shadows{}\n",
                        sampling.lamps, sampling.lamps_without_shadow,
                        sampling.lamps_left_out > 0
                            ? fmt::format(", {} weaker ones left out", sampling.lamps_left_out)
                            : "");
  if (sampling.lamps_soft > 0)
    text += fmt::format(
        "  shadows of lamps: {} points of a disc at most, penumbra up to {:.3g} pixels\n",
        sampling.lamps_soft, sampling.lamp_penumbra);
  else if (sampling.lamp_penumbra > 0)
    text += fmt::format("  shadows of lamps: hard, the penumbra is {:.2g} pixels or narrower\n",
                        sampling.lamp_penumbra);
  if (sampling.programs > 0)
    text += fmt::format("  {} shader programs built, {}\n", sampling.programs,
                        milliseconds(sampling.program_seconds));
  return text;
}

}  // namespace

void describe_image(const Written& image, Json& entry) {
  entry["width"] = image.width;
  entry["height"] = image.height;
  entry["unit"] = image.unit;
  entry["engine"] = image.engine == Engine::gl ? "gl" : "reference";
  entry["ev"] = image.ev;
  entry["ms"] = 1e3 * image.seconds;
  if (image.moments > 1) entry["moments"] = image.moments;
  if (image.exposure_s > 0) {
    entry["exposure_s"] = image.exposure_s;
    entry["bits"] = image.dn_bits;
    entry["saturated"] = image.saturated;
  }
  if (image.sampling) entry["samples"] = image.sampling->samples;
  if (image.ground_rays > 0) entry["ground_rays"] = image.ground_rays;
  if (image.between)
    entry["light_between"] = {{"drawn", image.between->drawn},
                              {"flux", image.between->flux},
                              {"mirrors", image.between->mirrors},
                              {"rms", image.between->rms},
                              {"surfels", image.between->surfels}};
  if (image.sampling && image.sampling->shadow_edge > 0)
    entry["shadow_edge"] = image.sampling->shadow_edge;
  if (image.sampling && image.sampling->penumbra > 0) {
    entry["penumbra"] = image.sampling->penumbra;
    entry["sun_points"] = image.sampling->sun_points;
  }
  if (image.sampling && image.sampling->lamps > 0) {
    entry["lamps"] = image.sampling->lamps;
    entry["lamps_without_shadow"] = image.sampling->lamps_without_shadow;
    if (image.sampling->lamps_left_out > 0)
      entry["lamps_left_out"] = image.sampling->lamps_left_out;
    if (image.sampling->lamp_penumbra > 0) {
      entry["lamp_penumbra"] = image.sampling->lamp_penumbra;
      entry["lamp_points"] = std::max(image.sampling->lamps_soft, 1u);
    }
  }
  if (image.sampling)
    for (const preview::ImposterReport& one : image.sampling->imposters) {
      Json targets = Json::array();
      for (const std::uint32_t target : one.targets) targets.push_back(image.targets[target]);
      entry["imposters"].push_back({{"targets", std::move(targets)},
                                    {"pixels", one.extent},
                                    {"texels", {one.width, one.height}},
                                    {"flux_error", one.flux_error},
                                    {"ms", 1e3 * one.seconds}});
    }
  if (image.sampling && image.sampling->programs > 0) {
    entry["programs"] = image.sampling->programs;
    entry["programs_ms"] = 1e3 * image.sampling->program_seconds;
  }
  if (image.sampling && image.sampling->rmse + image.sampling->flux > 0) {
    entry["pixel_error"] = image.sampling->rmse;
    entry["flux_error"] = image.sampling->flux;
  }
  if (!image.measured) return;
  entry["flux"] = numbers(image.measured->flux);
  entry["flux_error"] = numbers(image.measured->flux_error);
  entry["samples"] = image.measured->samples;
  entry["rays"] = image.measured->rays;
  entry["seconds"] = image.measured->seconds;
}

workspace::RunListener RenderReport::listener() {
  workspace::RunListener listener;
  listener.step = [this](const workspace::Step& step) {
    context_.add_timing(step.name, step.seconds);
  };
  listener.ready = [this](const workspace::EngineInfo& info) {
    if (!info.renderer.empty())
      context_.result()["gl"] = {
          {"renderer", info.renderer}, {"version", info.version}, {"hardware", info.hardware}};
  };
  listener.written = [this](const Written& written) { image(written); };
  return listener;
}

void RenderReport::image(const Written& image) {
  ++images_;
  if (context_.options().json) {
    Json entry = {{"output", image.outputs[0]}};
    if (image.outputs.size() > 1)
      entry["more_outputs"] = std::vector(image.outputs.begin() + 1, image.outputs.end());
    describe_image(image, entry);
    context_.result()["images"].push_back(std::move(entry));
  } else if (!context_.options().quiet) {
    // the progress line, which is drawn again
    if (many_ && isatty(STDERR_FILENO) == 1 && isatty(STDOUT_FILENO) == 1)
      print(stderr, "\r\x1b[K");
    // what could be read is drawn where the user named the output
    print("{}{}\n", line_of(image),
          context_.log().has_errors() ? ", without the parts and materials that failed" : "");
    if (explain_) print("{}", explained(image));
    if (many_) std::fflush(stdout);
  }
}

void RenderReport::summary() const {
  if (!many_ || context_.options().json || context_.options().quiet) return;
  const double seconds = seconds_since(start_);
  print("{} in {:.3g} s, {} each\n", counted(images_, "image"), seconds,
        milliseconds(seconds / static_cast<double>(std::max<std::size_t>(images_, 1))));
}

}  // namespace panwright::tools
