#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "base/text.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/render_report.h"
#include "workspace/session.h"

namespace panwright::tools {

namespace command_render {
namespace {

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::vector<std::string> targets;  // FILE or NAME=FILE
  ViewOptions view;
  std::string views;  // JSON file of many views; "-": JSON Lines on standard input
  std::string again;  // image whose record is followed
  std::string gl = "auto";
  std::optional<std::string> quality;      // "draft", "standard" or "exact"
  std::optional<std::string> samples;      // "auto" or N; none: the engine's own
  std::optional<std::string> pixel_error;  // "1%" or a fraction; none: the engine's own
  bool compress = false;
  bool adaptive = false;
  bool flat = false;
  std::optional<std::string> shadows;
  std::optional<std::string> sun_points;
  // as typed: what is not given is the engine's own, or that of a record
  std::optional<std::string> shadow_side;  // texels
  std::optional<std::string> levels;
  std::optional<std::string> imposters;
  std::optional<std::string> flux_error;  // share
  std::optional<std::string> specular_filter;
  std::optional<std::string> psf;  // pixels
  bool explain = false;
  std::optional<std::string> max_image_bytes;

  std::optional<std::string> engine;       // gl, or reference, which alone takes what follows
  std::optional<std::string> until_error;  // "0.1%" or a fraction; none: no end by error
  std::optional<std::string> seed;
  std::optional<std::string> max_samples;  // of a pixel, with until_error
  std::optional<std::string> bounces;
  std::optional<std::string> limb_darkening;  // u, 0 to 1
  bool no_sun_disc = false;
};

void declare_reference(Arguments& arguments, Options& options) {
  constexpr const char* kGroup = "Reference engine (--engine reference)";
  arguments
      .add("--engine", options.engine,
           "Engine: gl (OpenGL, default) or reference (path tracing on the CPU, slow, with error "
           "bars)")
      .one_of({"gl", "reference"})
      .type("NAME");
  arguments
      .add("--until-error", options.until_error,
           "Largest relative error of the flux, as 0.1%: sample until it is reached")
      .type("SHARE")
      .group(kGroup);
  arguments
      .add("--max-samples", options.max_samples,
           "Limit of samples per pixel with --until-error (default 67108864)")
      .range(32u, 1u << 30)
      .type("N")
      .group(kGroup);
  arguments.add("--bounces", options.bounces, "Number of interreflections (default 3)")
      .range(0u, 1000u)
      .type("N")
      .group(kGroup);
  arguments.add("--seed", options.seed, "Seed of the random numbers (default 0)")
      .type("N")
      .group(kGroup);
  arguments
      .add("--limb-darkening", options.limb_darkening,
           "Coefficient u of I = 1 - u (1 - cos) over the Sun's disc (default 0); gl applies it to "
           "glints only")
      .finite()
      .range(0.0, 1.0)
      .type("U")
      .group(kGroup);
  arguments.flag("--no-sun-disc", options.no_sun_disc, "Treat the Sun as a point").group(kGroup);
}

void declare_images(Arguments& arguments, Options& options) {
  arguments
      .add("input", options.targets,
           "Targets: .pan, .pxn or CAD files; NAME=FILE names a target (default: the file's name)")
      .type("[NAME=]FILE…");
  arguments
      .add("-o,--output", options.view.text.output,
           "Image to write: .png, .exr, .npy (radiance) or .npz (radiance and ground truth)")
      .type("FILE");
  declare(arguments, options.view);
  arguments
      .add("--layers", options.view.text.layers,
           "Layers of .exr and .npz (default: all): radiance, coverage, depth, range, normal, "
           "target_id, node_id, material_id, standard_error; blanks or commas between names")
      .type("\"NAMES\"");
  arguments.flag("--compress", options.compress, "Compress the layers of .npz");
  arguments
      .add("--views", options.views,
           "JSON list of views (docs/views.md). -: read one view a line from standard input, write "
           "one reply a line to standard output")
      .type("FILE.json|-");
  arguments
      .add("--again", options.again,
           "Repeat an image from its record (.png, .exr, .npz); other options override the record")
      .type("IMAGE");
  arguments
      .add("--quality", options.quality,
           "Preset: draft (--samples 4 --adaptive --shadows hard --flux-error 1%), standard "
           "(default: --samples auto, in limited time), exact (--pixel-error 1% --sun-points 64 "
           "--flux-error 0.01%); options given beside it replace its parts")
      .type("draft|standard|exact");
  arguments
      .add("--samples", options.samples,
           "Samples per pixel: auto (default: as needed by --pixel-error), or N x N with N from 1 "
           "to 64 (reference: default 8)")
      .type("N|auto");
  arguments
      .add("--pixel-error", options.pixel_error,
           "Target error with --samples auto, however long it takes (default 5%, in limited time): "
           "RMS over the pixels of targets, relative to their RMS radiance, and of their flux")
      .type("SHARE");
  arguments.flag("--adaptive", options.adaptive,
                 "Take N x N samples only where they change the pixel, with --samples N");
}

void declare_shadows(Arguments& arguments, Options& options) {
  arguments.flag("--flat", options.flat, "Shade with the triangles' own normals");
  arguments
      .add("--shadows", options.shadows,
           "Shadows: auto (default: penumbrae where visible, with --samples auto), hard (the Sun's "
           "centre), soft (--sun-points of its disc) or off")
      .type("auto|off|hard|soft");
  arguments
      .add("--sun-points", options.sun_points,
           "Number of points of the Sun's disc that cast shadows (default 64; shadows auto: the "
           "largest number)")
      .range(2u, 256u)
      .type("N");
  arguments
      .add("--shadow-side", options.shadow_side,
           "Shadow map resolution (texels), of each model or part of it (default 2048; with "
           "--samples auto 2896; imposters: five times their texels)")
      .range(16u, 16384u)
      .type("N");
}

void declare_detail(Arguments& arguments, Options& options) {
  arguments
      .add("--levels", options.levels,
           "Level of detail: auto (pixel footprint), off (finest), or a footprint in metres")
      .type("auto|off|METRES");
  arguments
      .add("--imposters", options.imposters,
           "Draw small targets separately, finer than pixels: auto (default: up to 100 pixels, 511 "
           "where accurate, with --samples auto), off, always, or largest size")
      .type("auto|off|always|PIXELS");
  arguments
      .add("--flux-error", options.flux_error, "Target error of an imposter's flux (default 0.05%)")
      .type("SHARE");
  arguments
      .add("--specular-filter", options.specular_filter,
           "Filter of narrow highlights on curved surfaces, with --samples N: auto (default: "
           "averaged between samples that are too far apart) or off")
      .type("auto|off");
  arguments
      .add("--psf", options.psf,
           "Gaussian point spread function of the camera, RMS width in pixels (default 0: none)")
      .range(0.0, 64.0)
      .type("SIGMA");
}

void declare_all(Arguments& arguments, Options& options) {
  declare_images(arguments, options);
  declare_reference(arguments, options);
  declare_shadows(arguments, options);
  declare_detail(arguments, options);
  arguments.flag("--explain", options.explain,
                 "Print how each target was drawn, its estimated error and its time");
  arguments
      .add("--max-image-memory", options.max_image_bytes,
           "Limit of memory for one image, as 2GB (default 12GB)")
      .bytes()
      .type("BYTES");
  arguments.add("--gl", options.gl, "OpenGL context: auto (default), egl or osmesa")
      .one_of({"auto", "egl", "osmesa"})
      .type("KIND");
  declare(arguments, options.read);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

// The view of the command line, which stands for what views and records leave out.
Result<workspace::ViewText> typed_view(const Options& options, DiagnosticLog& log) {
  auto typed = options.view.typed(log);
  if (!typed) return failed;
  const auto flag = [](bool given) {
    return given ? std::optional<std::string>("true") : std::nullopt;
  };
  typed->targets = options.targets;
  typed->limb_darkening = options.limb_darkening;
  typed->compress = flag(options.compress);
  typed->engine = options.engine;
  typed->quality = options.quality;
  typed->samples = options.samples;
  typed->pixel_error = options.pixel_error;
  typed->adaptive = flag(options.adaptive);
  typed->flat = flag(options.flat);
  typed->shadows = options.shadows;
  typed->sun_points = options.sun_points;
  typed->shadow_side = options.shadow_side;
  typed->levels = options.levels;
  typed->imposters = options.imposters;
  typed->flux_error = options.flux_error;
  typed->psf = options.psf;
  typed->specular_filter = options.specular_filter;
  typed->until_error = options.until_error;
  typed->max_samples = options.max_samples;
  typed->bounces = options.bounces;
  typed->seed = options.seed;
  typed->no_sun_disc = flag(options.no_sun_disc);
  typed->max_image_memory = options.max_image_bytes;
  return typed;
}

// What is to be rendered.
struct Work {
  std::vector<workspace::ViewText>
      views;  // with --views -: one, which stands for what lines leave out
  workspace::OpenOptions open;
  preview::ContextKind context = preview::ContextKind::automatic;
  std::optional<workspace::Record> record;  // of --again
  std::vector<std::string> recorded_files;  // empty: those of the views
};

// The view of a record, with what the command line replaces.
bool follow_record(const Options& options, workspace::ViewText typed, Work& work,
                   DiagnosticLog& log) {
  auto record = workspace::read_record(options.again, log);
  if (!record) return false;
  if (!typed.output) {
    const std::filesystem::path image = options.again;
    typed.output = image.stem().string() + ".again" + image.extension().string();
  }
  if (typed.targets.empty())
    for (const workspace::RecordedTarget& target : record->targets) {
      if (target.file.empty()) {
        log.report_file(Code::E0207, options.again,
                        "the record does not name the file of " + in_quotes(target.name),
                        "name it, as in: render --again IMAGE " + target.name + "=FILE");
        return false;
      }
      const auto found = workspace::find_recorded(target.file, options.again);
      std::error_code ignored;
      if (!std::filesystem::exists(found, ignored)) {
        log.report_file(Code::E0101, options.again,
                        fmt::format("model {} of {} not found in the working directory, the folder "
                                    "of the image or those above it",
                                    in_quotes(target.file), in_quotes(target.name)),
                        "name it, as in: render --again IMAGE " + target.name + "=FILE");
        return false;
      }
      typed.targets.push_back(target.name + "=" + found.string());
      work.recorded_files.push_back(target.file);
    }
  const workspace::OpenOptions given = work.open;
  work.open = record->open;
  work.open.max_input = given.max_input;
  work.open.max_triangles = given.max_triangles;
  work.open.cache = given.cache;
  if (given.max_error) work.open.max_error = given.max_error;
  if (!given.budget.empty()) work.open.budget = given.budget;
  if (options.gl == "auto") work.context = *preview::context_kind_from_name(record->context);
  const bool lens = typed.fov || typed.ifov || typed.intrinsics || typed.ortho;
  const bool keeps = record->view.field_of_view && !lens;
  if (keeps && typed.size) workspace::keep_field_of_view(record->view, *typed.size);
  typed.field_of_view = keeps;
  work.views = {workspace::with_defaults(std::move(typed), record->view)};
  work.record = *std::move(record);
  return true;
}

bool check_usage(const Options& options, DiagnosticLog& log) {
  const auto refuse = [&](const char* message) { log.report(Code::E0201, {}, message); };
  const std::size_t errors = log.errors();
  if (!options.views.empty() && options.view.text.output)
    refuse("-o cannot be combined with --views; each view has its own output");
  if (!options.views.empty() && !options.again.empty())
    refuse("--again cannot be combined with --views");
  if (options.views == "-" && options.common.json)
    refuse("--json cannot be combined with --views -, whose replies are JSON");
  if (options.targets.empty() && options.views.empty() && options.again.empty())
    refuse("no model is given, expected FILE, as in: panwright render model.pan -o image.png");
  return log.errors() == errors;
}

Result<Work> work_of(const Options& options, DiagnosticLog& log) {
  if (!check_usage(options, log)) return failed;
  auto read = options.read.opening(log);
  auto typed = typed_view(options, log);
  if (!read || !typed) return failed;
  Work work;
  work.context = *preview::context_kind_from_name(options.gl);
  typed->defines = std::exchange(read->parameters, {});
  work.open = *std::move(read);
  if (!options.again.empty()) {
    if (!follow_record(options, *std::move(typed), work, log)) return failed;
  } else if (options.views == "-") {
    work.views = {*std::move(typed)};
  } else if (!options.views.empty()) {
    auto views = workspace::read_views(options.views, *typed, log);
    if (!views) return failed;
    work.views = *std::move(views);
    const std::size_t errors = log.errors();
    for (const workspace::ViewText& view : work.views)
      if (view.targets.empty())
        log.report_file(Code::E0203, view.file, view.label + ": no targets, and none are given",
                        "name a model on the command line, or as \"targets\"");
    if (log.errors() != errors) return failed;
  } else {
    if (!typed->output) {
      const auto first = workspace::target_file(typed->targets[0]).file;
      typed->output = std::filesystem::path(first).filename().replace_extension(".png").string();
    }
    work.views = {*std::move(typed)};
  }
  // hidden surfaces cost an image less than their removal
  work.open.prune = false;
  return work;
}

int run(const Options& options, const Host& host) {
  CommandContext context("render", options.common, host);
  DiagnosticLog& log = context.log();
  const auto work = work_of(options, log);
  if (!work) return context.finish();
  const auto is_text = [](const std::string& target) {
    return workspace::extension_of(workspace::target_file(target).file) == ".pxn";
  };
  const auto& targets = work->views[0].targets;
  if (std::all_of(targets.begin(), targets.end(), is_text)) context.summarise_imports();
  workspace::ViewSession session(work->open, work->context);
  session.set_recorded_files(work->recorded_files);
  RenderReport report(context, !options.views.empty(), options.explain);
  if (options.views == "-")
    return context.finish(serve_views(session, work->views[0], report.listener(), context));
  if (work->views.size() == 1 && !options.view.text.output && options.views.empty() &&
      !work->record) {
    const world::World* world =
        session.world(work->views[0], report.listener(), log, context.job());
    // what could be read is drawn only where the user named the output
    if (world == nullptr || log.has_errors()) {
      if (world != nullptr) context.left_out();
      return context.finish();
    }
  }
  if (work->record) {
    const world::World* world =
        session.world(work->views[0], report.listener(), log, context.job());
    if (world == nullptr) return context.finish();
    workspace::compare_with_record(*work->record, *world, options.again, log);
  }
  if (session.run(work->views, report.listener(), log, context.job())) report.summary();
  return context.finish();
}

}  // namespace
}  // namespace command_render

Command render_command() {
  return command("render", "Render one or more models", command_render::declare_all,
                 command_render::run);
}

}  // namespace panwright::tools
