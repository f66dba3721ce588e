#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/file.h"
#include "base/text.h"
#include "compiler/compile.h"
#include "mli/preset.h"
#include "mli/sheet.h"
#include "pxn/materials.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/foil_fit.h"
#include "tools/foil_plot.h"
#include "tools/foil_scene.h"
#include "tools/height_file.h"
#include "tools/print.h"
#include "tools/words.h"
#include "workspace/drawer.h"
#include "workspace/open.h"

namespace panwright::tools {
namespace command_mli {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::string input;      // a preset of foil, or a .pxn or .pan file
  std::string sheet;      // of a file: its name or number; empty: all, or the only one
  std::string output;     // image
  std::string heights;    // .npy, .exr, .png
  std::string histogram;  // .svg
  std::string material;   // of the library; empty: the sheet's own
  std::string light = "sun";
  std::string fit;                    // "slope_rms=0.1 correlation=2cm"; empty: as it is
  std::uint32_t width = 400;          // pixels
  std::optional<std::string> seed;    // none: the recipe's
  std::optional<double> sheet_width;  // metres, of a preset
  std::optional<double> sheet_height;
  std::uint32_t cells = 0;  // 0: the recipe's
};

constexpr double kSide = 0.5;                // metres, of a preset
constexpr std::uint32_t kDrawnCells = 1200;  // along the longer side of an image
constexpr std::uint64_t kMostPixels = 100'000'000;

void declare_all(Arguments& arguments, Options& options) {
  arguments
      .add("input", options.input,
           "Preset of foil (crinkled, smooth, quilted, embossed, taped), or a .pxn or .pan file "
           "with sheets")
      .required()
      .type("FILE|SHEET");
  arguments
      .add("--sheet", options.sheet,
           "Sheet of the file: its name, or its number from 1 (default: all)")
      .type("NUMBER|NAME");
  arguments
      .add("-o,--output", options.output,
           "Draw the flat sheet from above: .png, .exr, .npy or .npz")
      .type("FILE.png");
  arguments
      .add("--height", options.heights,
           "Write the heights: .npy (float64, metres), .exr (float32, metres) or .png (16 bits; "
           "prints the scale)")
      .type("FILE.npy");
  arguments
      .add("--histogram", options.histogram,
           "Plot the slopes along both axes, each beside the Gaussian of its variance")
      .type("FILE.svg");
  arguments.add("--seed", options.seed, "Seed of the sheet (default: the recipe's, or 1)")
      .range(0, 4294967295.0)
      .type("N");
  arguments
      .add("--cells", options.cells,
           "Number of cells across: of a preset's grid, or of the coarser detail of a file's sheet")
      .range(2, 100000)
      .type("N");
  arguments
      .add("--sheet-width", options.sheet_width, "Width of a preset's sheet, metres (default 0.5)")
      .length()
      .positive()
      .type("METRES");
  arguments
      .add("--sheet-height", options.sheet_height,
           "Height of a preset's sheet, metres (default: its width)")
      .length()
      .positive()
      .type("METRES");
  arguments
      .add("--fit", options.fit,
           "Fit the recipe to mean statistics of its sheets, and print it: slope_rms=NUMBER, "
           "correlation=LENGTH, height_rms=LENGTH")
      .type("\"NAME=VALUE ...\"");
  arguments
      .add("--material", options.material,
           "Material of the library for the image (default: the preset's, or the file's)")
      .type("PRESET");
  arguments
      .add("--light", options.light,
           "Light: sun (default: the Sun alone, 48 degrees from the normal) or studio (lamps and "
           "walls too, slow and noisy)")
      .one_of({"sun", "studio"})
      .type("LIGHT");
  arguments.add("--width", options.width, "Image width, pixels (default 400)")
      .range(16, 8192)
      .type("PIXELS");
  declare(arguments, options.read);
  declare(arguments, options.common);
}

// A sheet that the command is about.
struct Subject {
  std::string name;
  std::string form = "flat";
  mli::Recipe recipe;
  materials::Material material;
};

bool is_file(const std::string& input) {
  const std::string extension = workspace::extension_of(input);
  return extension == ".pxn" || extension == ".pan";
}

constexpr const char* kForms[] = {"flat", "tube", "cone", "disc", "box"};

// ---- what there is

std::optional<Subject> preset_subject(const Options& options, CommandContext& context) {
  const auto presets = mli::presets();
  const auto preset = std::find_if(presets.begin(), presets.end(),
                                   [&](const mli::Preset& p) { return p.name == options.input; });
  if (preset == presets.end()) {
    const std::string extension = workspace::extension_of(options.input);
    if (!extension.empty()) {
      context.log().report_file(
          Code("E0202"), options.input,
          fmt::format("sheets of foil are read from .pxn and .pan files, not {}",
                      in_quotes(extension)));
      return std::nullopt;
    }
    std::vector<std::string_view> names;
    for (const mli::Preset& each : presets) names.push_back(each.name);
    const auto near = nearest_name(options.input, names);
    context.log().report(
        Code("E0201"), {},
        fmt::format("{} is not a preset of foil: {}, or a .pxn or .pan file",
                    in_quotes(options.input),
                    listed(std::vector<std::string>(names.begin(), names.end()), "or")),
        near ? fmt::format("did you mean '{}'?", *near) : "");
    return std::nullopt;
  }
  Subject subject;
  subject.name = preset->name;
  subject.recipe.width = options.sheet_width.value_or(options.sheet_height.value_or(kSide));
  subject.recipe.height = options.sheet_height.value_or(subject.recipe.width);
  // four cells where one is enough to show all
  const double cells = std::ceil(subject.recipe.width / preset->cell * 4 - 1e-6);
  subject.recipe.xgrid =
      options.cells > 0
          ? options.cells
          : static_cast<std::uint32_t>(std::clamp(cells, 2.0, double{mli::kMaxCells}));
  subject.recipe.seed = 1;
  subject.recipe.operations = *mli::preset_operations(preset->name, subject.recipe.height);
  auto material = pxn::preset(preset->material, context.log());
  if (!material) return std::nullopt;
  subject.material = material->material;
  return subject;
}

std::vector<Subject> subjects_of(const scene::Scene& scene) {
  std::vector<Subject> all;
  for (const scene::Foil& foil : scene.foils) {
    Subject subject;
    subject.form = kForms[foil.form.index()];
    subject.recipe = foil.recipe;
    const auto at = std::find_if(scene.instances.begin(), scene.instances.end(),
                                 [&](const auto& i) { return i.shape == foil.shape; });
    if (at != scene.instances.end()) {
      subject.name = scene.nodes[static_cast<std::size_t>(at->node)].name;
      subject.material = scene.materials[static_cast<std::size_t>(at->material)];
    }
    all.push_back(std::move(subject));
  }
  return all;
}

// The sheets that --sheet leaves, by their numbers; none, once reported.
std::vector<std::size_t> chosen(const std::vector<std::string>& names, const Options& options,
                                CommandContext& context) {
  std::vector<std::size_t> all;
  if (names.empty()) {
    context.log().report_file(Code("E1311"), options.input, "the file has no sheet of foil",
                              "sheets are made by <mli>");
    return all;
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if (options.sheet.empty() || names[i] == options.sheet) all.push_back(i);
  if (!options.sheet.empty() && all.size() > 1) return {all.front()};
  if (!all.empty()) return all;
  std::size_t number = 0;
  const char* const end = options.sheet.data() + options.sheet.size();
  const auto read = std::from_chars(options.sheet.data(), end, number);
  if (read.ec == std::errc() && read.ptr == end && number >= 1 && number <= names.size())
    return {number - 1};
  const std::vector<std::string_view> views(names.begin(), names.end());
  const auto near = nearest_name(options.sheet, views);
  context.log().report_file(
      Code("E1311"), options.input,
      fmt::format("no sheet is called {}; there {} {}, expected a name or a number from 1",
                  in_quotes(options.sheet), names.size() == 1 ? "is" : "are",
                  counted(names.size(), "sheet")),
      near && !near->empty() ? fmt::format("did you mean '{}'?", *near) : "");
  return all;
}

// ---- reports

Json two(const Vec2& v) { return Json::array({v.x, v.y}); }
Json three(const mli::Covariance& c) { return Json::array({c.xx, c.xy, c.yy}); }

double axis_rms(double variance, double mean) { return std::sqrt(variance + mean * mean); }

Json histogram_json(const SlopeHistogram& histogram) {
  const auto axis = [](const SlopeHistogram::Axis& a) {
    return Json{{"mean", a.mean},
                {"deviation", a.deviation},
                {"counts", a.counts},
                {"below", a.below},
                {"above", a.above}};
  };
  return {{"lowest", histogram.lowest},
          {"bin", histogram.bin},
          {"facets", histogram.facets},
          {"x", axis(histogram.x)},
          {"y", axis(histogram.y)}};
}

Json sheet_json(const Subject& subject, const mli::Sheet& sheet, const SlopeHistogram& histogram,
                double seconds) {
  const mli::Statistics& s = sheet.statistics;
  Json out;
  out["name"] = subject.name;
  out["form"] = subject.form;
  out["seed"] = subject.recipe.seed;
  out["width"] = subject.recipe.width;
  out["height"] = subject.recipe.height;
  out["cells"] = {sheet.columns - 1, sheet.rows - 1};
  out["heights"] = {s.lowest, s.highest};
  out["height_mean"] = s.height_mean;
  out["height_rms"] = s.height_rms;
  out["slope_mean"] = two(s.slope_mean);
  out["slope_covariance"] = three(s.slope_covariance);
  out["facet_slope_covariance"] = three(s.facet_slope_covariance);
  out["slope_rms"] = s.slope_rms;
  out["slope_rms_axes"] = {axis_rms(s.slope_covariance.xx, s.slope_mean.x),
                           axis_rms(s.slope_covariance.yy, s.slope_mean.y)};
  out["correlation_length"] = two(s.correlation_length);
  out["material"] = subject.material.name;
  out["operations"] = Json::array();
  for (const mli::Operation& each : subject.recipe.operations)
    out["operations"].push_back(mli::name_of(each));
  out["grid"] = subject.recipe.xgrid;
  out["facet_slope_rms"] = s.facet_slope_rms;
  out["mean_normal"] = {s.mean_normal.x, s.mean_normal.y, s.mean_normal.z};
  out["removed_slope_covariance"] = three(sheet.removed_slope_covariance);
  out["tilt_histogram"] = s.tilt_histogram;
  out["slope_histogram"] = histogram_json(histogram);
  out["checksum"] = fmt::format("{:016x}", mli::checksum(sheet.heights));
  out["seconds"] = seconds;
  return out;
}

// "1.52 mm"
std::string length_words(double metres) {
  const double size = std::fabs(metres);
  if (size == 0) return "0 m";
  if (size < 1e-3) return fmt::format("{:.4g} µm", metres * 1e6);
  if (size < 1) return fmt::format("{:.4g} mm", metres * 1e3);
  return fmt::format("{:.4g} m", metres);
}

void print_numbers(double lowest, double highest, double rms, double slope_rms, const Vec2& axes,
                   const Vec2& correlation) {
  print("heights       {} RMS, from {} to {}\n", length_words(rms), length_words(lowest),
        length_words(highest));
  print("slopes        {:.4f} RMS, {:.4f} along x, {:.4f} along y\n", slope_rms, axes.x, axes.y);
  print("correlation   {} along x, {} along y\n", length_words(correlation.x),
        length_words(correlation.y));
}

void print_sheet(const Subject& subject, const mli::Sheet& sheet, double seconds) {
  const mli::Statistics& s = sheet.statistics;
  std::string operations;
  for (const mli::Operation& each : subject.recipe.operations) {
    if (!operations.empty()) operations += ", ";
    operations += mli::name_of(each);
  }
  print("{}: {} by {} m, {} by {} cells of {}, seed {}{}\n",
        subject.name.empty() ? "sheet" : subject.name, subject.recipe.width, subject.recipe.height,
        sheet.columns - 1, sheet.rows - 1, length_words(sheet.spacing.x), subject.recipe.seed,
        subject.form == "flat" ? std::string() : ", bent over a " + subject.form);
  print("operations    {}\n", operations.empty() ? "none" : operations);
  print("material      {}\n", subject.material.name.empty() ? "none" : subject.material.name);
  print_numbers(s.lowest, s.highest, s.height_rms, s.slope_rms,
                {axis_rms(s.slope_covariance.xx, s.slope_mean.x),
                 axis_rms(s.slope_covariance.yy, s.slope_mean.y)},
                s.correlation_length);
  print("made in       {:.2f} s\n", seconds);
}

// ---- what is written

// The sheet as it is drawn: no more cells than an image shows.
mli::Sheet drawn_sheet(const mli::Sheet& sheet, CommandContext& context) {
  const std::uint32_t most = std::max(sheet.columns, sheet.rows) - 1;
  if (most <= kDrawnCells) return sheet;
  const double share = double{kDrawnCells} / most;
  const auto cells = std::max(1u, static_cast<std::uint32_t>((sheet.columns - 1) * share));
  return mli::filtered(sheet, cells, context.job());
}

bool write_image(const Subject& subject, const mli::Sheet& sheet, const Options& options,
                 CommandContext& context) {
  DiagnosticLog& log = context.log();
  const mli::Sheet shown = drawn_sheet(sheet, context);
  const std::uint32_t height = foil_image_height(shown, options.width);
  if (std::uint64_t{options.width} * height > kMostPixels) {
    log.report(Code("E5003"), {},
               fmt::format("an image of {} by {} pixels is more than {} megapixels; take a smaller "
                           "--width",
                           options.width, height, kMostPixels / 1'000'000));
    return false;
  }
  const auto light =
      options.light == "sun" ? workspace::SampleLight::sun : workspace::SampleLight::studio;
  const auto scene = foil_scene(shown, subject.material, light, log);
  if (!scene) return false;
  const auto bytes = compiler::compiled(*scene, {}, log, context.job());
  if (!bytes) return false;
  auto model = pan::Model::from_bytes(*bytes, subject.name, log);
  if (!model || !model->check(log)) return false;
  world::World world;
  if (!world.add("sheet", std::make_shared<const pan::Model>(*std::move(model)), log)) return false;
  world.set_sun(foil_sun());
  workspace::DrawOptions draw;
  draw.engine = workspace::Engine::reference;
  draw.reference.samples = light == workspace::SampleLight::sun ? 16 : 64;
  draw.reference.bounces = 1;
  workspace::Drawer drawer(draw);
  const auto drawn =
      drawer.draw(world, foil_camera(shown, options.width), false, log, context.job());
  if (!drawn || !image::write_image(options.output, drawn->image, 0, log)) return false;
  std::string detail = fmt::format("{}x{}", options.width, height);
  if (shown.columns != sheet.columns)
    detail += fmt::format(", drawn with {} by {} cells", shown.columns - 1, shown.rows - 1);
  context.wrote(options.output, detail);
  return true;
}

bool write_files(const Subject& subject, const mli::Sheet& sheet, const SlopeHistogram& histogram,
                 const Options& options, CommandContext& context) {
  if (!options.heights.empty()) {
    context.step("write " + options.heights);
    std::string detail;
    if (!write_heights(options.heights, sheet, detail, context.log())) return false;
    context.wrote(options.heights, detail);
  }
  if (!options.histogram.empty()) {
    context.step("write " + options.histogram);
    const std::string text = slope_plot(histogram, subject.name.empty() ? "sheet" : subject.name);
    if (!write_file(options.histogram, as_bytes(text), context.log())) return false;
    context.wrote(options.histogram);
  }
  if (options.output.empty()) return true;
  context.step("draw " + options.output);
  return write_image(subject, sheet, options, context);
}

// ---- the steps

bool writes(const Options& options) {
  return !options.output.empty() || !options.heights.empty() || !options.histogram.empty();
}

// Whether the options make sense, before anything is read.
bool check_options(const Options& options, CommandContext& context) {
  DiagnosticLog& log = context.log();
  if (is_file(options.input)) context.files().will_read(options.input);
  if (!options.output.empty() && !image::image_format(options.output)) {
    log.report_file(Code("E0202"), options.output,
                    fmt::format("images are written as .png, .exr, .npy or .npz, not {}",
                                in_quotes(workspace::extension_of(options.output))));
    return false;
  }
  if (!options.heights.empty() && !is_height_file(options.heights, log)) return false;
  if (!options.histogram.empty() && workspace::extension_of(options.histogram) != ".svg") {
    log.report_file(Code("E0202"), options.histogram,
                    fmt::format("histograms are written as .svg, not {}",
                                in_quotes(workspace::extension_of(options.histogram))));
    return false;
  }
  if (!context.files().will_write(options.output, "-o", log) ||
      !context.files().will_write(options.heights, "--height", log) ||
      !context.files().will_write(options.histogram, "--histogram", log))
    return false;
  const auto refuse = [&](const char* option, const char* words) {
    log.report(Code("E0201"), {}, fmt::format("{} {}", option, words));
    return false;
  };
  if (options.seed) {
    const double seed = parse_double(*options.seed).value_or(0);
    if (seed != std::floor(seed)) return refuse("--seed", "takes whole numbers");
  }
  if (is_file(options.input)) {
    if (options.sheet_width)
      return refuse("--sheet-width", "is of presets: a file's sheets have their own sizes");
    if (options.sheet_height)
      return refuse("--sheet-height", "is of presets: a file's sheets have their own sizes");
  } else if (!options.sheet.empty()) {
    return refuse("--sheet", "requires a .pxn or .pan file: a preset is one sheet");
  }
  return true;
}

// The statistics that a pan file holds of its sheets: their recipes are not in it.
void report_stored(const Options& options, CommandContext& context) {
  DiagnosticLog& log = context.log();
  const bool remade =
      options.seed || options.cells > 0 || !options.material.empty() || !options.fit.empty();
  if (writes(options) || remade) {
    log.report_file(
        Code("E0201"), options.input,
        fmt::format("{} the recipe of a sheet, and a pan file holds its statistics only",
                    writes(options) ? "images, heights and histograms require"
                                    : "--seed, --cells, --fit and --material require"),
        "name the .pxn file that it was compiled from");
    return;
  }
  auto opening = options.read.opening(log);
  if (!opening) return;
  const auto model = workspace::open(options.input, *opening, log, context.job());
  if (!model) return;
  std::vector<std::string> names;
  for (const pan::layout::Sheet& sheet : (*model)->sheets())
    names.emplace_back((*model)->mesh_name(sheet.mesh));
  const std::vector<std::size_t> numbers = chosen(names, options, context);
  for (const std::size_t i : numbers) {
    const pan::layout::Sheet& s = (*model)->sheets()[i];
    const Vec2 axes(axis_rms(s.slope_covariance[0], s.slope_mean[0]),
                    axis_rms(s.slope_covariance[2], s.slope_mean[1]));
    const char* const form = s.form < std::size(kForms) ? kForms[s.form] : "unknown";
    context.result()["sheets"].push_back({{"name", names[i]},
                                          {"form", form},
                                          {"seed", s.seed},
                                          {"width", s.width},
                                          {"height", s.height},
                                          {"cells", {s.columns, s.rows}},
                                          {"heights", {s.lowest, s.highest}},
                                          {"height_mean", s.height_mean},
                                          {"height_rms", s.height_rms},
                                          {"slope_mean", s.slope_mean},
                                          {"slope_covariance", s.slope_covariance},
                                          {"facet_slope_covariance", s.facet_slope_covariance},
                                          {"slope_rms", s.slope_rms},
                                          {"slope_rms_axes", {axes.x, axes.y}},
                                          {"correlation_length", s.correlation_length}});
    if (options.common.json) continue;
    if (i != numbers.front()) print("\n");
    print("{}: {} by {} m, {} by {} cells, seed {}{}; the recipe is not in a pan file\n",
          names[i].empty() ? "sheet" : names[i], s.width, s.height, s.columns, s.rows, s.seed,
          s.form == 0 ? std::string() : fmt::format(", bent over a {}", form));
    print_numbers(s.lowest, s.highest, s.height_rms, s.slope_rms, axes,
                  {s.correlation_length[0], s.correlation_length[1]});
  }
}

// The recipe that --fit asks for, in the place of the subject's own; false, once reported.
bool fit_subject(const Options& options, const mli::FitTarget& target, Subject& subject,
                 std::optional<mli::Fit>& found, CommandContext& context) {
  context.step("fit " + subject.name);
  const bool keep_size = is_file(options.input) || options.sheet_width || options.sheet_height;
  auto fit =
      mli::fit(subject.recipe, target, {.keep_size = keep_size}, context.log(), {}, context.job());
  if (!fit) return false;
  subject.recipe = fit->recipe;
  found = *std::move(fit);
  return true;
}

// The sheets that the options name, to be made.
std::vector<Subject> subjects(const Options& options, CommandContext& context) {
  if (!is_file(options.input)) {
    auto preset = preset_subject(options, context);
    if (!preset) return {};
    return {*std::move(preset)};
  }
  auto opening = options.read.opening(context.log());
  if (!opening) return {};
  opening->prune = false;
  opening->foil_levels = false;
  context.step("read " + options.input);
  auto scene = workspace::read_scene(options.input, *opening, context.log(), context.job());
  if (!scene) return {};
  const std::vector<Subject> all = subjects_of(*scene);
  // what is wrong with the text is why there is none
  if (all.empty() && context.log().has_errors()) return {};
  std::vector<std::string> names;
  for (const Subject& each : all) names.push_back(each.name);
  std::vector<Subject> out;
  for (const std::size_t i : chosen(names, options, context)) out.push_back(all[i]);
  if (out.size() > 1 && writes(options)) {
    context.log().report_file(
        Code("E0201"), options.input,
        fmt::format("the file has {}, expected one to write files of; name it by --sheet",
                    counted(out.size(), "sheet")),
        "as in --sheet 1; without -o, --height and --histogram all are listed");
    return {};
  }
  return out;
}

int run(const Options& options, const Host& host) {
  CommandContext context("mli", options.common, host);
  if (!check_options(options, context)) return context.finish();
  context.result()["sheets"] = Json::array();
  if (workspace::extension_of(options.input) == ".pan") {
    report_stored(options, context);
    return context.finish();
  }
  std::optional<materials::Material> material;
  if (!options.material.empty()) {
    auto found = pxn::preset(options.material, context.log());
    if (!found) return context.finish();
    material = found->material;
  }
  std::optional<mli::FitTarget> target;
  if (!options.fit.empty()) {
    target = fit_target(options.fit, context.log());
    if (!target) return context.finish();
  }
  bool first = true;
  for (Subject& subject : subjects(options, context)) {
    if (material) subject.material = *material;
    if (options.seed)
      subject.recipe.seed = static_cast<std::uint32_t>(parse_double(*options.seed).value_or(0));
    std::optional<mli::Fit> fit;
    if (target && !fit_subject(options, *target, subject, fit, context)) break;
    context.step("make " + subject.name);
    const auto start = std::chrono::steady_clock::now();
    mli::SheetOptions detail;
    detail.cells = options.cells;
    const auto sheet = mli::made(subject.recipe, detail, context.log(), {}, context.job());
    if (!sheet) break;
    const double seconds = seconds_since(start);
    const SlopeHistogram histogram = slope_histogram(*sheet);
    context.result()["sheets"].push_back(sheet_json(subject, *sheet, histogram, seconds));
    if (!options.common.json) {
      if (!first) print("\n");
      print_sheet(subject, *sheet, seconds);
    }
    if (fit) {
      const std::string text =
          recipe_text(subject.recipe, subject.material.name, material || !is_file(options.input));
      context.result()["sheets"].back()["fit"] = fit_json(*fit, *target, text);
      if (!options.common.json) print_fit(*fit, *target, text);
    }
    first = false;
    if (!write_files(subject, *sheet, histogram, options, context)) break;
  }
  return context.finish();
}

}  // namespace
}  // namespace command_mli

Command mli_command() {
  return command("mli", "Show a sheet of foil: statistics, image, heights, slopes",
                 command_mli::declare_all, command_mli::run);
}

}  // namespace panwright::tools
