#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "workspace/run.h"

namespace panwright::tools {

namespace {

using workspace::Engine;

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::vector<std::string> targets;  // FILE or NAME=FILE
  ViewOptions view;
  std::string views;  // JSON file of many views
  std::string gl = "auto";
  std::optional<std::string> samples;      // "auto" or N; none: the engine's own
  std::optional<std::string> pixel_error;  // "1%" or a fraction; none: the engine's own
  bool adaptive = false;
  bool flat = false;
  bool no_shadows = false;
  unsigned shadow_side = 2048;  // texels
  std::uint64_t max_image_bytes = 12ull << 30;

  std::string engine = "gl";  // or reference, the path tracer; what follows is for it alone
  std::optional<std::string> until_error;  // "0.1%" or a fraction; none: no end by error
  std::uint64_t seed = 0;
  unsigned max_samples = 1u << 26;  // of a pixel, with until_error
  unsigned bounces = 3;
  std::string filter = "box";  // or "gaussian:σ" in pixels
  double limb_darkening = 0;   // u, 0 to 1
  bool no_sun_disc = false;

  bool is_traced() const { return engine == "reference"; }
};

void declare_reference(Arguments& arguments, Options& options) {
  constexpr const char* kGroup = "Reference engine (--engine reference)";
  arguments
      .add("--engine", options.engine,
           "gl: OpenGL (default); reference: path tracing on the CPU, slow and with error bars")
      .one_of({"gl", "reference"})
      .type("NAME");
  arguments
      .add("--until-error", options.until_error, "Go on until the flux is known this well, as 0.1%")
      .type("SHARE")
      .group(kGroup);
  arguments
      .add("--max-samples", options.max_samples,
           "Most samples of a pixel with --until-error (default 67108864)")
      .range(32u, 1u << 30)
      .type("N")
      .group(kGroup);
  arguments.add("--bounces", options.bounces, "Interreflections that are followed (default 3)")
      .range(0u, 1000u)
      .type("N")
      .group(kGroup);
  arguments.add("--seed", options.seed, "Which random numbers (default 0)").type("N").group(kGroup);
  arguments
      .add("--filter", options.filter,
           "box, a pixel is the mean over its square (default), or gaussian:SIGMA, of "
           "the image blurred by that many pixels")
      .type("FILTER")
      .group(kGroup);
  arguments
      .add("--limb-darkening", options.limb_darkening,
           "u of I = 1 - u (1 - cos) over the Sun's disc (default 0); the preview shows it in "
           "glints")
      .finite()
      .range(0.0, 1.0)
      .type("U")
      .group(kGroup);
  arguments.flag("--no-sun-disc", options.no_sun_disc, "The Sun is a point").group(kGroup);
}

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("input", options.targets,
           "The targets: .pan files, or .pxn or CAD files to compile on the way; NAME=FILE gives "
           "one another name than its file's")
      .required()
      .type("[NAME=]FILE…");
  arguments
      .add("-o,--output", options.view.text.output,
           "The image: .png, .exr, .npy (radiance) or .npz (radiance and ground truth)")
      .type("FILE");
  declare(arguments, options.view);
  arguments
      .add("--views", options.views,
           "JSON list of views, each an object of camera and Sun options, poses and an output")
      .type("FILE.json");
  arguments
      .add("--samples", options.samples,
           "N x N samples in each pixel, 1 to 64 (with --engine reference default 8); or auto "
           "(default): as many as --pixel-error asks for, pixel by pixel")
      .type("N|auto");
  arguments
      .add("--pixel-error", options.pixel_error,
           "With --samples auto: the error to meet (default 5%), of the pixels that show a target "
           "(RMS, in parts of the RMS of their radiance) and of their flux")
      .type("SHARE");
  arguments.flag("--adaptive", options.adaptive,
                 "With --samples N: N x N only where it changes the pixel");
  declare_reference(arguments, options);
  arguments.flag("--flat", options.flat, "Shade with the triangles' own normals");
  const Argument no_shadows =
      arguments.flag("--no-shadows", options.no_shadows, "Let the Sun shine through everything");
  arguments
      .add("--shadow-side", options.shadow_side,
           "Texels a side of a model's shadow map, or of each part of it (default 2048)")
      .range(16u, 16384u)
      .excludes(no_shadows)
      .type("N");
  arguments
      .add("--max-image-memory", options.max_image_bytes,
           "Most memory of one image, e.g. 2GB (default 12GB)")
      .bytes()
      .type("BYTES");
  arguments.add("--gl", options.gl, "OpenGL context: auto, egl or osmesa")
      .one_of({"auto", "egl", "osmesa"})
      .type("KIND");
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

// An option of the other engine; nullptr: none.
const char* stray_option(const Options& options) {
  const Options none;
  if (options.is_traced()) {
    if (options.no_shadows) return "--no-shadows";
    if (options.adaptive) return "--adaptive";
    if (options.pixel_error) return "--pixel-error";
    return options.shadow_side != none.shadow_side ? "--shadow-side" : nullptr;
  }
  if (options.until_error) return "--until-error";
  if (options.filter != none.filter) return "--filter";
  if (options.bounces != none.bounces) return "--bounces";
  if (options.seed != none.seed) return "--seed";
  return options.no_sun_disc ? "--no-sun-disc" : nullptr;
}

Result<preview::ReferenceOptions> reference_options(const Options& options, DiagnosticLog& log) {
  constexpr double kWidestPsf = 64;  // pixels
  const std::size_t errors = log.errors();
  preview::ReferenceOptions result;
  result.max_samples = options.max_samples;
  result.seed = options.seed;
  result.bounces = options.bounces;
  result.sun_disc = !options.no_sun_disc;
  result.flat = options.flat;
  result.max_bytes = options.max_image_bytes;
  if (options.until_error) {
    const auto share = workspace::parse_share(*options.until_error);
    if (share && *share > 0 && *share < 1)
      result.until_error = *share;
    else
      log.report(Code::E0201, {},
                 fmt::format("--until-error is {}, expected a share between 0 and 1, as 0.1%",
                             in_quotes(*options.until_error)));
  }
  if (options.filter != "box") {
    const std::string prefix = "gaussian:";
    const auto sigma = options.filter.starts_with(prefix)
                           ? workspace::parse_numbers(options.filter.substr(prefix.size()), 1)
                           : std::nullopt;
    if (sigma && (*sigma)[0] > 0 && (*sigma)[0] <= kWidestPsf)
      result.psf_sigma = (*sigma)[0];
    else
      log.report(Code::E0201, {},
                 fmt::format("--filter is {}, expected box, or gaussian:SIGMA of up to {} pixels",
                             in_quotes(options.filter), kWidestPsf));
  }
  if (log.errors() != errors) return failed;
  return result;
}

// N, or 0 for auto.
Result<unsigned> samples_of(const Options& options, DiagnosticLog& log) {
  if (!options.samples) return options.is_traced() ? 8u : 0u;
  if (*options.samples == "auto" && !options.is_traced()) return 0u;
  const auto number = workspace::parse_numbers(*options.samples, 1);
  if (number && (*number)[0] >= 1 && (*number)[0] <= 64 && (*number)[0] == std::floor((*number)[0]))
    return static_cast<unsigned>((*number)[0]);
  log.report(Code::E0201, {},
             fmt::format("--samples is {}, expected a whole number from 1 to 64{}",
                         in_quotes(*options.samples), options.is_traced() ? "" : ", or auto"));
  return failed;
}

// What is to be drawn with, as typed.
Result<workspace::DrawOptions> draw_options(const Options& options, DiagnosticLog& log) {
  workspace::DrawOptions draw;
  draw.context = *preview::context_kind_from_name(options.gl);
  const auto samples = samples_of(options, log);
  if (!samples) return failed;
  draw.samples = *samples;
  draw.gl.samples = *samples;
  if (options.pixel_error) {
    const auto share = workspace::parse_share(*options.pixel_error);
    if (*samples > 0 || !share || !(*share > 0 && *share < 1)) {
      log.report(Code::E0201, {},
                 *samples > 0
                     ? std::string("--pixel-error requires --samples auto")
                     : fmt::format("--pixel-error is {}, expected a share between 0 and 1, "
                                   "as 1%",
                                   in_quotes(*options.pixel_error)));
      return failed;
    }
    draw.gl.pixel_error = *share;
  }
  if (options.adaptive && *samples == 0) {
    log.report(Code::E0201, {}, "--adaptive requires --samples N; auto is adaptive by itself");
    return failed;
  }
  draw.gl.adaptive = options.adaptive;
  draw.gl.flat = options.flat;
  draw.gl.shadow_side = options.no_shadows ? 0 : options.shadow_side;
  draw.gl.max_bytes = options.max_image_bytes;
  if (!options.is_traced()) return draw;
  draw.engine = Engine::reference;
  const auto traced = reference_options(options, log);
  if (!traced) return failed;
  draw.reference = *traced;
  return draw;
}

// The views that are asked for, on the command line or in a file. All that is wrong is reported.
Result<std::vector<workspace::View>> views_of(const Options& options, const world::World& world,
                                              const std::filesystem::path& first_file,
                                              DiagnosticLog& log) {
  const std::size_t errors = log.errors();
  auto typed = options.view.typed(log);
  if (!typed) return failed;
  std::vector<workspace::ViewText> texts;
  if (options.views.empty()) {
    if (!typed->output) typed->output = first_file.filename().replace_extension(".png").string();
    texts.push_back(*std::move(typed));
  } else {
    if (typed->output)
      log.report(Code::E0201, {},
                 "-o cannot be combined with --views; each view has its own output");
    auto read = workspace::read_views(options.views, *typed, log);
    if (!read) return failed;
    texts = *std::move(read);
  }
  workspace::ViewMaker maker(world);
  std::vector<workspace::View> views;
  for (const workspace::ViewText& text : texts)
    if (auto view = maker.view(text, log)) {
      view->sun->limb_darkening = options.limb_darkening;
      views.push_back(*std::move(view));
    }
  if (log.errors() != errors) return failed;
  return views;
}

// One image that is written: what the reference measured, in words.
void tell(const workspace::Written& image, bool orthographic, CommandContext& context) {
  nlohmann::ordered_json& images = context.result()["images"];
  images.push_back({{"output", image.output},
                    {"width", image.width},
                    {"height", image.height},
                    {"unit", image.unit}});
  if (image.sampling) images.back()["samples"] = image.sampling->samples;
  if (image.sampling && image.sampling->rmse + image.sampling->flux > 0) {
    images.back()["pixel_error"] = image.sampling->rmse;
    images.back()["flux_error"] = image.sampling->flux;
    if (!context.options().json && !context.options().quiet)
      print(
          "{}: {:.3g} samples a pixel, estimated RMS error {:.2g} % of the radiance, of the flux "
          "at most {:.2g} %\n",
          image.output, image.sampling->samples, 100 * image.sampling->rmse,
          100 * image.sampling->flux);
  }
  if (!image.measured) return;
  const workspace::Measured& measured = *image.measured;
  const auto numbers = [](const Vec3& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
  nlohmann::ordered_json& entry = images.back();
  entry["flux"] = numbers(measured.flux);
  entry["flux_error"] = numbers(measured.flux_error);
  entry["samples"] = measured.samples;
  entry["rays"] = measured.rays;
  entry["seconds"] = measured.seconds;
  if (context.options().json) return;
  const bool unresolved = image.unit == "1/sr";
  const Vec3& flux = measured.flux;
  const Vec3& error = measured.flux_error;
  print("{}: flux {:.6g} {:.6g} {:.6g} ± {:.1e} {:.1e} {:.1e} {}, {:.3g} M rays/s\n", image.output,
        flux.x, flux.y, flux.z, error.x, error.y, error.z,
        orthographic ? (unresolved ? "m^2/sr" : "W/sr") : (unresolved ? "of the Sun's" : "W/m^2"),
        1e-6 * static_cast<double>(measured.rays) / std::max(measured.seconds, 1e-9));
}

int run(const Options& options, const Host& host) {
  CommandContext context("render", options.common, host);
  DiagnosticLog& log = context.log();
  if (const char* stray = stray_option(options)) {
    log.report(
        Code::E0201, {},
        fmt::format("{} requires --engine {}", stray, options.is_traced() ? "gl" : "reference"));
    return context.finish();
  }
  auto read = options.read.opening(log);
  if (!read) return context.finish();
  // what nobody outside sees costs an image less than its removal
  read->prune = false;
  std::vector<workspace::TargetFile> targets;
  for (const std::string& text : options.targets) targets.push_back(workspace::target_file(text));
  workspace::OpenReport report;
  const auto world = workspace::open_world(targets, *read, log, context.job(), &report);
  context.add_timings(report.steps);
  if (!world) return context.finish();
  const auto views = views_of(options, *world, targets[0].file, log);
  if (!views) return context.finish();
  const auto draw = draw_options(options, log);
  if (!draw) return context.finish();

  workspace::RunOptions run{*draw, {}};
  run.listener.step = [&](const workspace::Step& step) {
    context.add_timing(step.name, step.seconds);
  };
  run.listener.ready = [&](const workspace::EngineInfo& info) {
    if (info.engine == Engine::gl)
      context.result()["gl"] = {
          {"renderer", info.renderer}, {"version", info.version}, {"hardware", info.hardware}};
  };
  run.listener.written = [&](const workspace::Written& image) {
    const world::Camera& camera = (*views)[image.view].camera;
    tell(image, camera.projection == world::Projection::orthographic, context);
  };
  (void)workspace::run_views(*world, *views, run, log, context.job());
  return context.finish();
}

}  // namespace

Command render_command() {
  return command("render", "Render one or more models as a camera sees them", declare_all, run);
}

}  // namespace panwright::tools
