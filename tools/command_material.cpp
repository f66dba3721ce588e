#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "base/clock.h"
#include "base/file.h"
#include "base/text.h"
#include "compiler/compile.h"
#include "materials/brdf.h"
#include "materials/report.h"
#include "materials/spectra.h"
#include "pxn/materials.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/material_plots.h"
#include "tools/overlay_text.h"
#include "tools/print.h"
#include "workspace/drawer.h"
#include "workspace/material_scene.h"
#include "workspace/open.h"
#include "workspace/quantities.h"

namespace panwright::tools {
namespace command_material {
namespace {

using Json = nlohmann::ordered_json;
using pxn::DescribedMaterial;
using workspace::parse_numbers;

struct Options {
  CommonOptions common;
  std::vector<std::string> inputs;  // pxn files, and materials of the library
  std::string name;                 // of one in the files; empty: all
  bool all = false;                 // the whole library too
  bool list = false;
  bool show = false;                  // the text of a library's material
  std::optional<std::string> albedo;  // cosines, with commas
  std::string svg;                    // folder for plots
  std::string fit;                    // table of measured reflectance
  std::string render;                 // image of samples
  std::uint32_t width = 360;          // of one material in the image, pixels
  std::string light = "studio";
  std::string engine;  // empty: the one that the light needs
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("inputs", options.inputs, ".pxn files, or materials of the library")
      .type("FILE|PRESET…");
  arguments
      .add("--name", options.name, "Name of the material to report on (default: all of the files)")
      .type("NAME");
  arguments.flag("--all", options.all, "Report on all materials of the library");
  arguments.flag("--list", options.list, "List the materials of the library");
  arguments.flag("--show", options.show, "Print the pxn text of a material of the library");
  arguments.add("--albedo", options.albedo, "Cosines of the directions of printed albedos")
      .type("MU,MU…");
  arguments
      .add("--svg", options.svg, "Folder to write plots of albedo and lobes, or of the fit, into")
      .folder()
      .type("FOLDER");
  arguments
      .add("--fit", options.fit,
           "Fit all BRDFs to a table of measured reflectance, of one band or RGB")
      .type("TABLE");
  arguments
      .add("--render", options.render, "Draw a sphere, a tilted tile and a wrinkled tile of each")
      .type("FILE.png");
  arguments
      .add("--light", options.light,
           "Light: studio (default: Sun, lamps and grey walls, for display) or sun (the Sun alone)")
      .one_of({"studio", "sun"})
      .type("LIGHT");
  arguments.add("--width", options.width, "Width of one material's image, pixels (default 360)")
      .range(60, 4096)
      .type("PIXELS");
  arguments.add("--engine", options.engine, "Engine: gl or reference (the only one for the studio)")
      .one_of({"gl", "reference"})
      .type("ENGINE");
  declare(arguments, options.common);
}

Json as_json(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

std::string rgb_words(const Vec3& v) { return fmt::format("{:.4f} {:.4f} {:.4f}", v.x, v.y, v.z); }

// The materials that the command is about: of files, of the library, or all of that.
std::vector<DescribedMaterial> chosen(const Options& options, CommandContext& context) {
  std::vector<DescribedMaterial> all;
  std::vector<std::string> inputs = options.inputs;
  if (options.all)
    for (const std::string_view name : pxn::preset_names()) inputs.emplace_back(name);
  for (const std::string& input : inputs) {
    if (workspace::extension_of(input) != ".pxn") {
      if (auto preset = pxn::preset(input, context.log())) all.push_back(std::move(*preset));
      continue;
    }
    auto found = pxn::read_materials(input, {}, context.log(), context.job());
    if (!found) continue;
    std::vector<std::string_view> names;
    for (const DescribedMaterial& each : *found) names.push_back(each.material.name);
    if (options.name.empty()) {
      if (names.empty())
        context.log().report_file(Code("E1311"), input, "the file defines no material");
      for (DescribedMaterial& each : *found) all.push_back(std::move(each));
      continue;
    }
    const auto at = std::find(names.begin(), names.end(), options.name);
    if (at != names.end()) {
      all.push_back(std::move((*found)[static_cast<std::size_t>(at - names.begin())]));
      continue;
    }
    const auto near = nearest_name(options.name, names);
    context.log().report_file(Code("E1311"), input,
                              fmt::format("no material is called {}", in_quotes(options.name)),
                              near ? fmt::format("did you mean '{}'?", *near) : "");
  }
  return all;
}

std::optional<std::vector<double>> cosines(const Options& options, CommandContext& context) {
  if (!options.albedo) return std::vector<double>{0.02, 0.05, 0.1, 0.25, 0.5, 0.75, 1};
  std::vector<double> mus;
  const std::string& text = *options.albedo;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const auto number = parse_numbers(text.substr(at, comma - at), 1);
    if (!number || !((*number)[0] > 0 && (*number)[0] <= 1)) {
      context.log().report(Code("E0201"), {},
                           fmt::format("--albedo is {}, expected cosines above 0 and up to 1, with "
                                       "commas between them",
                                       in_quotes(text)));
      return std::nullopt;
    }
    mus.push_back((*number)[0]);
    at = comma + 1;
  }
  return mus;
}

// Nanoseconds of one evaluation, the median of several runs.
double nanoseconds(const std::function<Vec3(const Vec3&)>& evaluate) {
  constexpr int kEvaluations = 4000;
  std::vector<double> runs;
  Vec3 sum(0);
  for (int run = 0; run < 7; ++run) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < kEvaluations; ++i) {
      const double x = -0.6 + 1.2 * i / kEvaluations;
      sum += evaluate(Vec3(x, 0.1, std::sqrt(0.99 - x * x)));
    }
    const double seconds = seconds_since(start);
    runs.push_back(seconds / kEvaluations * 1e9);
  }
  std::sort(runs.begin(), runs.end());
  // note: the sum is used, so that nothing is optimised away
  return std::isfinite(sum.x) ? runs[runs.size() / 2] : 0;
}

struct Speed {
  double f64 = 0;  // ns an evaluation, one core
  double f32 = 0;
};

Speed speed_of(const materials::Material& material) {
  const Vec3 viewer(0.3, 0, std::sqrt(0.91));
  const Vec3 normal(0, 0, 1);
  const materials::ShadingContext local{Vec3(1, 0, 0)};
  Speed speed;
  speed.f64 = nanoseconds([&](const Vec3& light) {
    return materials::f64::brdf(material, materials::sunlight(light), viewer, normal, Vec3(1),
                                local);
  });
  speed.f32 = nanoseconds([&](const Vec3& light) {
    return Vec3(materials::f32::brdf(material, materials::sunlight(light), glm::vec3(viewer),
                                     glm::vec3(normal), glm::vec3(1), local));
  });
  return speed;
}

// The solar absorptance of a material whose constants are known over the spectrum.
std::optional<double> computed_absorptance(const DescribedMaterial& described) {
  const pxn::Provenance& from = described.provenance;
  if (from.metal.empty() || described.material.weights.x > 0) return std::nullopt;
  const auto metal = materials::optical_constants(from.metal);
  if (!metal) return std::nullopt;
  materials::Stack stack{*metal, std::nullopt, 0};
  if (described.material.coat) {
    if (from.film.empty()) return std::nullopt;
    stack.film = materials::optical_constants(from.film);
    if (!stack.film) return std::nullopt;
    stack.thickness = from.film_thickness;
  }
  return materials::solar_absorptance(stack, 1);
}

Json report_json(const DescribedMaterial& described, const materials::MaterialReport& c,
                 const Speed& speed) {
  const pxn::Provenance& from = described.provenance;
  Json out;
  out["name"] = described.material.name;
  out["brdf"] = materials::brdf_in_words(described.material);
  out["back"] = described.back.empty() ? Json(nullptr) : Json(described.back);
  out["verdict"] = {{"text", materials::verdict(c)},
                    {"energy_conserved", c.gain.albedo <= materials::kConserved},
                    {"reciprocal", c.reciprocity <= materials::kReciprocal},
                    {"safe_in_single_precision", c.f32_error <= materials::kSafeInSingle},
                    {"safe_slope", c.safe_slope ? Json(*c.safe_slope) : Json(nullptr)}};
  out["directional_albedo"] = Json::array();
  for (const auto& each : c.directional)
    out["directional_albedo"].push_back({{"mu", each.mu},
                                         {"rgb", as_json(each.rgb)},
                                         {"least", as_json(each.least)},
                                         {"largest", as_json(each.largest)}});
  out["hemispherical_albedo"] = as_json(c.hemispherical);
  out["largest_albedo"] = {{"albedo", c.gain.albedo}, {"mu", c.gain.mu}};
  out["reciprocity_residual"] = c.reciprocity;
  out["fit_error"] = c.fit_error;
  out["f32_error"] = {{"max", c.f32_error}, {"rms", c.f32_rms}};
  out["ns_per_evaluation"] = {{"f64", speed.f64}, {"f32", speed.f32}};
  const auto absorptance = computed_absorptance(described);
  out["solar_absorptance"] = {
      {"computed", absorptance ? Json(*absorptance) : Json(nullptr)},
      {"published", from.absorptance ? Json(*from.absorptance) : Json(nullptr)}};
  out["provenance"] = {{"source", from.source},
                       {"published", from.published},
                       {"fitted", from.fitted},
                       {"indicative", from.indicative}};
  return out;
}

void print_provenance(const pxn::Provenance& from) {
  const std::pair<const char*, const std::string*> lines[] = {{"source", &from.source},
                                                              {"published", &from.published},
                                                              {"fitted", &from.fitted},
                                                              {"indicative", &from.indicative}};
  for (const auto& [name, words] : lines)
    if (!words->empty()) print("{:<21} {}\n", name, *words);
}

void print_report(const DescribedMaterial& described, const materials::MaterialReport& c,
                  const Speed& speed) {
  print("{}: {}\n", described.material.name, materials::brdf_in_words(described.material));
  print("{}\n\n", materials::verdict(c));
  print_provenance(described.provenance);
  if (!described.back.empty()) print("{:<21} {}\n", "back", described.back);
  const bool anisotropic = materials::is_anisotropic(described.material);
  print("cosine  angle   directional albedo in red, green, blue{}\n",
        anisotropic ? ", least and largest over the azimuth" : "");
  for (const auto& each : c.directional)
    print("{:<7.4g} {:>5.2f}°  {}{}\n", each.mu, det::acos(each.mu) / kDegree,
          rgb_words(anisotropic ? each.least : each.rgb),
          anisotropic ? "   " + rgb_words(each.largest) : std::string());
  print("hemispherical albedo  {}\n", rgb_words(c.hemispherical));
  print("largest albedo        {:.6f} at cosine {:.4g}\n", c.gain.albedo, c.gain.mu);
  print("reciprocity           {:.1e} largest relative residual\n", c.reciprocity);
  print("single precision      {:.1e} largest, {:.1e} RMS relative error\n", c.f32_error,
        c.f32_rms);
  if (c.fit_error > 0)
    print("fits                  {:.1e} largest approximation error\n", c.fit_error);
  print("speed                 {:.0f} ns an evaluation in double, {:.0f} ns in single\n", speed.f64,
        speed.f32);
  const auto absorptance = computed_absorptance(described);
  const auto& published = described.provenance.absorptance;
  if (absorptance)
    print("solar absorptance     {:.3f} from n and k over 0.3 to 2.5 µm{}\n", *absorptance,
          published ? fmt::format(", published {:.2f}", *published) : std::string());
  else
    print("solar absorptance     visible albedo, not comparable{}\n",
          published ? fmt::format(" (published {:.2f})", *published) : std::string());
}

// A name without what a file's name must not have.
std::string plain_name(std::string name) {
  for (char& c : name)
    if (c == '/' || c == '\\' || c == '\0') c = '_';
  if (name.starts_with('.')) name.front() = '_';
  return name;
}

// Where it cannot be made, the file in it says so.
void make_folder(const std::string& folder) {
  std::error_code ignored;
  std::filesystem::create_directory(folder, ignored);
}

bool write_plots(const std::string& folder, const materials::Material& material,
                 CommandContext& context) {
  make_folder(folder);
  const std::filesystem::path base = std::filesystem::path(folder) / plain_name(material.name);
  const auto write = [&](const char* suffix, const std::string& text) {
    const std::string path = base.string() + suffix;
    if (!write_file(path, std::as_bytes(std::span(text)), context.log())) return false;
    context.wrote(path);
    return true;
  };
  return write("-albedo.svg", albedo_plot(material)) && write("-slices.svg", slices_plot(material));
}

constexpr std::uint32_t kLabelHeight = 28;
constexpr float kBackground = 0.0105f;  // 1/sr: a PNG shows 51 of 255
constexpr const char* kStudioCaption = "Sunlight and lamps of a studio, for display only.";

// A sheet of dark grey.
image::Image empty_sheet(std::uint32_t width, std::uint32_t height) {
  image::Image sheet;
  sheet.width = width;
  sheet.height = height;
  sheet.unit = "1/sr";
  sheet.radiance.assign(3 * sheet.pixels(), kBackground);
  sheet.coverage.assign(sheet.pixels(), 1.0f);
  return sheet;
}

// Lays an image on a sheet, whose grey shows where it is not covered.
void lay(const image::Image& image, std::uint32_t x, std::uint32_t y, image::Image& sheet) {
  for (std::uint32_t row = 0; row < image.height; ++row)
    for (std::uint32_t column = 0; column < image.width; ++column) {
      const std::size_t from = std::size_t{row} * image.width + column;
      const std::size_t to = std::size_t{y + row} * sheet.width + x + column;
      const float around = kBackground * (1 - std::clamp(image.coverage[from], 0.0f, 1.0f));
      for (std::size_t k = 0; k < 3; ++k)
        sheet.radiance[3 * to + k] = image.radiance[3 * from + k] + around;
    }
}

// One image of a material's samples.
Result<image::Image> sample_image(const DescribedMaterial& material, const Options& options,
                                  workspace::Drawer& drawer, CommandContext& context) {
  DiagnosticLog& log = context.log();
  const auto light =
      options.light == "sun" ? workspace::SampleLight::sun : workspace::SampleLight::studio;
  const auto bytes =
      compiler::compiled(workspace::sample_scene(material, light), {}, log, context.job());
  if (!bytes) return failed;
  auto model = pan::Model::from_bytes(*bytes, material.material.name, log);
  if (!model || !model->check(log)) return failed;
  world::World world;
  if (!world.add("samples", std::make_shared<const pan::Model>(*std::move(model)), log))
    return failed;
  world.set_sun(workspace::sample_sun());
  auto drawn =
      drawer.draw(world, workspace::sample_camera(options.width), false, log, context.job());
  if (!drawn) return failed;
  return std::move(drawn->image);
}

// The engine that the light needs, unless another is asked for that can do it too.
std::optional<workspace::DrawOptions> draw_options(const Options& options,
                                                   CommandContext& context) {
  workspace::DrawOptions draw;
  const bool studio = options.light == "studio";
  if (studio && options.engine == "gl") {
    context.log().report(Code("E0201"), {}, "--light studio requires --engine reference",
                         "OpenGL supports sunlight only: --light sun");
    return std::nullopt;
  }
  if (studio || options.engine == "reference") draw.engine = workspace::Engine::reference;
  draw.gl.samples = 4;
  draw.reference.samples = studio ? 32 : 64;
  draw.reference.bounces = 1;
  return draw;
}

// All images on one sheet, in columns, with their names and what lights them.
bool write_sheet(const std::vector<DescribedMaterial>& all, const Options& options,
                 CommandContext& context) {
  const auto draw = draw_options(options, context);
  if (!draw) return false;
  workspace::Drawer drawer(*draw);
  const std::uint32_t columns = all.size() > 12 ? 3 : all.size() > 4 ? 2 : 1;
  const auto rows = static_cast<std::uint32_t>((all.size() + columns - 1) / columns);
  const std::uint32_t cell_height = options.width / 3 + kLabelHeight;
  const std::uint64_t width = std::uint64_t{columns} * options.width;
  const std::uint64_t height = std::uint64_t{rows} * cell_height + kLabelHeight;
  constexpr std::size_t kMostPixels = 100'000'000;
  if (width * height > kMostPixels) {
    context.log().report(
        Code("E5003"), {},
        fmt::format("a sheet of {} by {} pixels is more than {} megapixels; take a "
                    "smaller --width or fewer materials",
                    width, height, kMostPixels / 1'000'000));
    return false;
  }
  image::Image sheet =
      empty_sheet(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
  for (std::size_t i = 0; i < all.size(); ++i) {
    context.step("render " + all[i].material.name);
    const auto image = sample_image(all[i], options, drawer, context);
    if (!image) return false;
    const auto x = static_cast<std::uint32_t>(i % columns) * options.width;
    const auto y = static_cast<std::uint32_t>(i / columns) * cell_height;
    const std::string& name = all[i].material.name;
    write_overlay_text(sheet, {x + 10, y + 3, options.width - 20, kLabelHeight - 6}, name);
    lay(*image, x, y + kLabelHeight, sheet);
  }
  const char* const caption =
      options.light == "sun" ? "Sunlight alone, as in space." : kStudioCaption;
  write_overlay_text(
      sheet, {10, sheet.height - kLabelHeight + 3, sheet.width - 20, kLabelHeight - 6}, caption);
  context.step("write " + options.render);
  if (!image::write_image(options.render, sheet, 0, context.log())) return false;
  context.wrote(options.render, fmt::format("{}x{}", sheet.width, sheet.height));
  return true;
}

// The best first in words: how far it is off on the average, and where it is worst; then the table,
// and the best as text.
void print_fits(const Options& options, const std::vector<materials::Reading>& readings,
                const std::vector<materials::Fit>& fits, double floor, const std::string& name) {
  const materials::Fit& best = fits.front();
  const auto factor = [](double decades) { return det::exp(decades * det::log(10.0)); };
  print(
      "{}: best described by {}, {} of {}\n"
      "Off by a factor of {:.3g} on the average (RMS), of {:.3g} at worst; readings below "
      "{:.2g}/sr count as that much.\n\n",
      name, best.brdf, counted(readings.size(), "reading"), options.fit, factor(best.rms_decades),
      factor(best.max_decades), floor);
  if (readings.size() > materials::kMostSearched)
    print(
        "About {} readings, spread over the table, decided on the parameters; the errors are of "
        "all.\n\n",
        materials::kMostSearched);
  print("{:<34} {:>12} {:>12} {:>12}\n", "", "RMS, decades", "max, decades", "RMS, 1/sr");
  for (const materials::Fit& fit : fits)
    print("{:<34} {:>12.3f} {:>12.3f} {:>12.4g}\n", fit.brdf, fit.rms_decades, fit.max_decades,
          fit.rms);
  print("\n<material name=\"{}\">\n{}\n</material>\n", markup_escaped(name), best.text);
}

// BRDFs fitted to a table.
void fit_table(const Options& options, CommandContext& context) {
  context.step("read " + options.fit);
  const auto readings = materials::read_measured(options.fit, context.log());
  if (!readings) return;
  context.step("fit");
  // where the surface is black all over, instruments see less of their own noise
  double brightest = 0;
  for (const materials::Reading& reading : *readings)
    brightest = std::max(brightest, reading.reflectance);
  const double floor = std::min(1e-3, 0.01 * brightest);
  if (!(floor > 0)) {
    context.log().report_file(Code("E1409"), options.fit, "every reading is 0");
    return;
  }
  const auto found =
      run_job(context.job(), context.log(), [&]() -> Result<std::vector<materials::Fit>> {
        return materials::fitted_brdfs(*readings, floor, context.job());
      });
  if (!found) return;
  const std::vector<materials::Fit>& fits = *found;
  const bool color = materials::has_color(*readings);
  // what the user calls it
  const std::string stem = std::filesystem::path(options.fit).stem().string();
  const std::string name = options.name.empty() ? stem : options.name;
  Json& out = context.result();
  out["readings"] = readings->size();
  out["bands"] = color ? 3 : 1;
  out["name"] = name;
  out["fits"] = Json::array();
  for (const materials::Fit& fit : fits)
    out["fits"].push_back({{"brdf", fit.brdf},
                           {"rms_decades", fit.rms_decades},
                           {"max_decades", fit.max_decades},
                           {"rms", fit.rms},
                           {"text", fit.text}});
  if (!context.options().json) print_fits(options, *readings, fits, floor, name);
  if (options.svg.empty()) return;
  make_folder(options.svg);
  constexpr const char* kBands[] = {"-red", "-green", "-blue"};
  for (int band = 0; band < (color ? 3 : 1); ++band) {
    const std::string text = fit_plot(*readings, fits.front(), name, color ? band : -1);
    const auto path = std::filesystem::path(options.svg) /
                      (plain_name(name) + "-fit" + (color ? kBands[band] : "") + ".svg");
    if (!write_file(path, std::as_bytes(std::span(text)), context.log())) return;
    context.wrote(path);
  }
}

void list(const CommandContext& context) {
  for (const std::string_view name : pxn::preset_names()) {
    DiagnosticLog log;
    const auto preset = pxn::preset(name, log);
    if (preset && !context.options().json)
      print("{:<24} {}\n", name, materials::brdf_in_words(preset->material));
  }
}

int run(const Options& options, const Host& host) {
  CommandContext context("material", options.common, host);
  Json& out = context.result();
  for (const std::string& input : options.inputs) context.files().will_read(input);
  if (!context.files().will_write(options.render, "--render", context.log()))
    return context.finish();
  if (options.list) {
    out["presets"] = pxn::preset_names();
    list(context);
    return context.finish();
  }
  if (!options.fit.empty()) {
    fit_table(options, context);
    return context.finish();
  }
  if (options.inputs.empty() && !options.all) {
    context.log().report(Code("E0201"), {}, "name a pxn file or a material of the library",
                         "`panwright material --list` lists its materials");
    return context.finish();
  }
  if (options.show) {
    for (const std::string& name : options.inputs)
      if (const auto text = pxn::preset_text(name))
        print("{}", *text);
      else
        (void)pxn::preset(name, context.log());
    return context.finish();
  }
  const auto mus = cosines(options, context);
  if (!mus) return context.finish();
  const std::vector<DescribedMaterial> all = chosen(options, context);
  out["materials"] = Json::array();
  for (const DescribedMaterial& each : all) {
    if (!options.render.empty() && all.size() > 4) break;  // a sheet is asked for, not its numbers
    if (context.job().cancelled()) {
      report_cancelled(context.log());
      break;
    }
    context.step("report on " + each.material.name);
    const materials::MaterialReport report = materials::material_report(each.material, *mus);
    const Speed speed = speed_of(each.material);
    out["materials"].push_back(report_json(each, report, speed));
    if (!options.common.json) {
      if (&each != &all.front()) print("\n");
      print_report(each, report, speed);
    }
    if (!options.svg.empty() && !write_plots(options.svg, each.material, context)) break;
  }
  // what one material says stands where a reader of one looks
  if (out["materials"].size() == 1) out.update(Json(out["materials"][0]));
  if (!options.render.empty() && !all.empty()) write_sheet(all, options, context);
  return context.finish();
}

}  // namespace
}  // namespace command_material

Command material_command() {
  return command("material", "Report on materials: albedo, energy, reciprocity, precision",
                 command_material::declare_all, command_material::run);
}

}  // namespace panwright::tools
