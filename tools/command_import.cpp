#include <fmt/core.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "base/axis_box.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"
#include "compiler/size.h"
#include "importers/clean.h"
#include "pxn/import_template.h"
#include "pxn/material_guess.h"
#include "tools/budget_report.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/mesh_report_page.h"
#include "tools/print.h"
#include "workspace/budget.h"
#include "workspace/open.h"

namespace panwright::tools {

namespace command_import {
namespace {

using Json = nlohmann::ordered_json;
using workspace::CadOptions;

struct Options {
  CommonOptions common;
  workspace::OpenOptions open;
  std::string input;
  std::string output;  // .pan or .pxn; empty: none
  std::string budget_report;
  std::string report;  // .txt, .json or .html; empty: none
  CacheOption cache;
  bool mesh_levels = false;
  std::string compress;  // pan::StorageForm
  bool force = false;    // replaces a text that somebody has edited
};

void declare_all(Arguments& arguments, Options& options) {
  CadOptions& cad = options.open.cad;
  arguments
      .add("input", options.input,
           "CAD file: VRML 97, VRML 1.0, glTF 2.0, GLB, OBJ, STL, PLY, STEP, URDF or MJCF; gzip is "
           "accepted")
      .required()
      .type("FILE");
  arguments
      .add("-o,--output", options.output,
           "File to write: a compiled model (.pan), or a pxn text that imports it and assigns "
           "materials (.pxn)")
      .type("OUT");
  arguments
      .add("--report", options.report, "Write a mesh report: .txt, .json, or .html with images")
      .type("FILE");
  arguments.flag(
      "--mesh-levels", options.mesh_levels,
      "Add coarser meshes for far views, with error bounds (seconds per 100000 triangles)");
  declare_compress(arguments, options.compress);
  arguments.flag("--force", options.force,
                 "Overwrite a .pxn that was edited, or not written by 'import'");
  declare_root(arguments, options.open.root);
  arguments
      .add("--budget", options.open.budget,
           "Accuracy budget of a .pan: any of nearest=5km ifov=0.1mrad pixels=0.25 flux=0.1% "
           "centroid=0.01px")
      .type("TERMS");
  arguments
      .add("--budget-report", options.budget_report,
           "Write a report of the budget and of triangles by part: .txt, .json or .html")
      .type("FILE");
  arguments
      .add("--max-error", options.open.max_error,
           "Largest distance between mesh and exact shape, metres (default 0.001)")
      .length()
      .positive()
      .type("METRES");
  arguments.add("--max-triangles", options.open.max_triangles, "Limit of triangles in the file")
      .range(1.0, 1e12)
      .type("N");
  declare(arguments, cad);
  declare(arguments, options.cache);
  declare(arguments, options.common);
}

// What the command line said of the file, as attributes of <import>.
std::string attributes_of(const CadOptions& cad) {
  std::string out;
  if (cad.units != "auto") out += fmt::format(" units=\"{}\"", cad.units);
  if (cad.up != "auto") out += fmt::format(" up=\"{}\"", cad.up);
  if (cad.no_weld) out += " clean=\"no\"";
  if (cad.weld > 0) out += fmt::format(" weld=\"{}m\"", format_double(cad.weld));
  if (cad.crease_deg != 30) out += fmt::format(" crease=\"{}deg\"", format_double(cad.crease_deg));
  if (cad.crease_normals) out += " normals=\"crease\"";
  if (cad.keep_hidden) out += " hidden=\"keep\"";
  if (!cad.scene.empty()) out += fmt::format(" scene=\"{}\"", pxn::attribute_value(cad.scene));
  if (!cad.animation.empty())
    out += fmt::format(" animation=\"{}\"", pxn::attribute_value(cad.animation));
  if (cad.time) out += fmt::format(" time=\"{}\"", format_double(*cad.time));
  if (cad.primitives > 0) out += fmt::format(" primitives=\"{}\"", cad.primitives);
  if (cad.deflection > 0) out += fmt::format(" deflection=\"{}m\"", format_double(cad.deflection));
  return out;
}

// The same where everything that decides the model must stand, in one line.
std::string origin_of(const CadOptions& cad) {
  std::string out =
      attributes_of(cad) + (cad.recentre ? " recentre" : "") + " assume=" + cad.assume;
  return out;
}

std::uint64_t triangles_of(const scene::Scene& scene) {
  std::uint64_t count = 0;
  for (const scene::Instance& instance : scene.instances)
    if (const auto* mesh = std::get_if<geometry::MeshShape>(
            &scene.shapes[static_cast<std::size_t>(instance.shape)]))
      count += (*mesh)->triangles.size();
  return count;
}

Json as_json(const compiler::HiddenReport& hidden) {
  return {{"triangles_before", hidden.triangles_before},
          {"triangles_after", hidden.triangles_after},
          {"instances_before", hidden.instances_before},
          {"instances_after", hidden.instances_after},
          {"rays", hidden.rays},
          {"open_share_95", hidden.open_share},
          {"seconds", hidden.seconds},
          {"cached", hidden.cached}};
}

constexpr const char* kFormats[] = {"VRML 97", "VRML 1.0", "glTF", "OBJ", "STL",
                                    "PLY",     "STEP",     "URDF", "MJCF"};

// What a material covers: meshes, where they stand.
struct Covered {
  std::uint64_t triangles = 0;
  double area = 0;  // m²
};

std::vector<Covered> covered_by(const scene::Scene& scene) {
  std::vector<Covered> out(scene.materials.size());
  const std::vector<Mat4> worlds = scene::world_from_nodes(scene);
  for (const scene::Instance& one : scene.instances) {
    const auto* mesh =
        std::get_if<geometry::MeshShape>(&scene.shapes[static_cast<std::size_t>(one.shape)]);
    if (!mesh) continue;
    const Mat3 linear(worlds[static_cast<std::size_t>(one.node)]);
    Covered& covered = out[static_cast<std::size_t>(one.material)];
    covered.triangles += (*mesh)->triangles.size();
    for (const auto& [a, b, c] : (*mesh)->triangles) {
      const std::vector<Vec3>& at = (*mesh)->positions;
      covered.area +=
          glm::length(glm::cross(linear * (at[b] - at[a]), linear * (at[c] - at[a]))) / 2;
    }
  }
  return out;
}

void describe(const importers::Imported& imported, CommandContext& context) {
  const scene::Scene& scene = imported.scene;
  const AxisBox bounds = importers::bounds_of(scene);
  const Vec3 size = bounds.empty() ? Vec3(0) : bounds.extent();
  Json& out = context.result();
  out["format"] = kFormats[static_cast<std::size_t>(imported.format)];
  out["nodes"] = scene.nodes.size();
  out["instances"] = scene.instances.size();
  out["mesh_triangles"] = triangles_of(scene);
  out["textures"] = scene.textures.size();
  out["joints"] = scene.joints.size();
  out["size"] = {size.x, size.y, size.z};
  const std::vector<std::string> names = pxn::numbered_names(imported.materials);
  std::vector<pxn::Guess> guesses;
  Json materials = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const importers::CadMaterial& material = imported.materials[i];
    const pxn::GuessInput input = pxn::guess_input(imported, i);
    const pxn::Guess guess = pxn::guessed_preset(input);
    const Json color =
        input.color_known ? Json{input.color.x, input.color.y, input.color.z} : Json();
    guesses.push_back(guess);
    Json lost = Json::array();
    for (const importers::LostProperty& each : material.lost) lost.push_back(each.what);
    materials.push_back({{"name", to_utf8(names[i], Encoding::utf8)},
                         {"color", color},
                         {"metallic", input.metallic},
                         {"preset", guess.preset.empty() ? Json() : Json(guess.preset)},
                         {"reason", guess.reason},
                         {"lost", std::move(lost)}});
  }
  const std::vector<Covered> covered = covered_by(scene);
  for (std::size_t i = 0; i < names.size(); ++i) {
    materials[i]["triangles"] = covered[i].triangles;
    materials[i]["area"] = covered[i].area;
  }
  out["materials"] = std::move(materials);
  if (context.options().json) return;
  print("{}: {}, {}, {}, {}\n", kFormats[static_cast<std::size_t>(imported.format)],
        counted(scene.nodes.size(), "node"), counted(scene.instances.size(), "instance"),
        counted(triangles_of(scene), "mesh triangle"), counted(scene.joints.size(), "joint"));
  print("size: {:.6g} x {:.6g} x {:.6g} m\n", size.x, size.y, size.z);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Json& color = out["materials"][i]["color"];
    print("material {}: {} ({}; {}{})\n", in_quotes(names[i]),
          guesses[i].preset.empty() ? "as imported" : guesses[i].preset, guesses[i].reason,
          color.is_null() ? "colour not known"
                          : fmt::format("colour {:.3g} {:.3g} {:.3g}", color[0].get<double>(),
                                        color[1].get<double>(), color[2].get<double>()),
          covered[i].triangles == 0
              ? std::string()
              : fmt::format("; {}, {:.3g} m²", counted(covered[i].triangles, "triangle"),
                            covered[i].area));
  }
}

bool write_report(const importers::MeshReport& mesh_report, const scene::Scene& scene,
                  const Options& options, CommandContext& context) {
  context.step("report");
  const std::string extension = workspace::extension_of(options.report);
  std::string text;
  if (extension == ".json") {
    text = importers::to_json(mesh_report);
  } else if (extension == ".html") {
    auto page = mesh_report_page(mesh_report, scene, options.input, options.open, context.log(),
                                 context.job());
    if (!page) return false;
    text = *std::move(page);
  } else {
    text = importers::to_text(mesh_report);
  }
  if (!write_file(options.report, as_bytes(text), context.log())) return false;
  context.wrote(options.report);
  return true;
}

// Both with links resolved and in normal form, so that one is seen from the other as a reader does.
bool lies_in(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const std::filesystem::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

// Ends a text that nobody has edited: the mark, the hash of all before it, "-->" and a line feed.
constexpr std::string_view kMark = "<!-- panwright import: unedited ";

std::string mark_of(std::string_view text) {
  return fmt::format("{}{:016x} -->\n", kMark, hash64(as_bytes(text)));
}

// Whether a text is as `import` wrote it.
bool is_unedited(std::string_view text) {
  const std::size_t mark = text.rfind(kMark);
  return mark != text.npos && text.substr(mark) == mark_of(text.substr(0, mark));
}

// Refuses to replace what somebody wrote: a text that is there is kept unless it is as `import`
// wrote it, or as it would be written now.
bool may_replace(const Options& options, std::string_view fresh, DiagnosticLog& log) {
  std::error_code error;
  if (options.force || !std::filesystem::is_regular_file(options.output, error)) return true;
  constexpr std::uint64_t kMaxBytes = 64u << 20;
  DiagnosticLog apart;  // one that watches no files: an output is no input
  const auto old = read_file(options.output, kMaxBytes, apart);
  if (old && (*old == fresh || is_unedited(*old))) return true;
  log.report_file(Code("E0103"), options.output,
                  "the file was edited, or not written by 'import'; it is kept",
                  "write to another file, or replace it with --force");
  return false;
}

// The pxn text that stands around the file; the file's path as seen from the text's folder. A file
// that does not lie there or below must lie with the text in --root or in the working directory.
void write_import_template(const importers::Imported& imported, const Options& options,
                           CommandContext& context) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto resolved = [&](const fs::path& path) {
    const fs::path out = fs::weakly_canonical(fs::absolute(path, error), error);
    return out.has_filename() ? out : out.parent_path();
  };
  const fs::path folder = resolved(options.output).parent_path();
  const fs::path input = resolved(options.input);
  const fs::path file = input.lexically_relative(folder);
  const std::string& root = options.open.root;
  const bool apart = file.empty() || *file.begin() == "..";
  const auto is_outside = [&](const scene::Input& used) {
    return !lies_in(resolved((root.empty() ? input.parent_path() : resolved(root)) / used.path),
                    folder);
  };
  if (apart) {
    const fs::path both = resolved(root.empty() ? fs::path(".") : fs::path(root));
    if (file.empty() || !lies_in(input, both) || !lies_in(folder, both)) {
      context.log().report(
          Code("E0201"), {},
          fmt::format("{} does not lie in the folder of {} or below it, where imports are found, "
                      "nor do both lie in {}",
                      in_quotes(options.input), in_quotes(options.output),
                      root.empty() ? "the working directory" : in_quotes(root)),
          "give --root with a folder that holds both, or write the text beside the file");
      return;
    }
  }
  if ((apart || std::ranges::any_of(imported.scene.inputs, is_outside)) && !options.common.json &&
      !options.common.quiet)
    print("{} names a file outside its folder; read it with --root {}\n", options.output,
          root.empty() ? "." : root);
  // the text says what was assumed, so that it stays what it was seen to be
  CadOptions cad = options.open.cad;
  if (!imported.assumed_unit.empty()) cad.units = imported.assumed_unit;
  std::string text = pxn::import_template(imported, file.generic_string(), attributes_of(cad));
  text += mark_of(text);
  if (may_replace(options, text, context.log()) &&
      write_file(options.output, as_bytes(text), context.log()))
    context.wrote(options.output, counted(imported.materials.size(), "material"));
}

// What is said of a pan file that was written.
void describe_written(const Options& options, const compiler::Report& report,
                      const std::optional<compiler::HiddenReport>& hidden,
                      CommandContext& context) {
  if (report.triangles == 0 && !context.log().contains(Code("E6011")))
    context.log().report_file(
        Code("E6011"), options.input,
        "the model has no surface left, expected at least one that is visible from outside");
  context.wrote(
      options.output,
      counted(report.triangles, "triangle") +
          (options.mesh_levels ? fmt::format(", {} of detail", counted(report.levels, "level"))
                               : "") +
          storage_words(options.compress, report.storage));
  context.result()["output"] = options.output;
  if (hidden) context.result()["removed"] = as_json(*hidden);
  context.result()["storage"] = storage_json(options.compress, report.storage);
  context.result()["bytes"] = report.bytes;
  context.result()["triangles"] = report.triangles;
  context.result()["unique_triangles"] = report.unique_triangles;
}

// Before hidden parts go, as `check` does. A guessed unit has been reported with the sizes by it,
// and what an error has left out leaves no size to judge.
void check_sizes(const scene::Scene& scene, DiagnosticLog& log) {
  if (log.contains(Code("W6006")) || log.has_errors()) return;
  const std::vector<AxisBox> boxes = importers::instance_bounds(scene);
  std::vector<compiler::PartBox> parts;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    parts.push_back({scene.instances[i].node, boxes[i]});
  compiler::check_sizes(scene, parts, log);
}

int run(const Options& options, const Host& host) {
  CommandContext context("import", options.common, host);
  DiagnosticLog& log = context.log();
  const std::string extension = workspace::extension_of(options.output);
  if (!options.output.empty() && extension != ".pan" && extension != ".pxn") {
    log.report(Code("E0202"), {},
               fmt::format("{} is neither a .pan nor a .pxn file", in_quotes(options.output)));
    return context.finish();
  }
  context.files().will_read(options.input);
  context.files().will_write(options.output, "-o", log);
  context.files().will_write(options.report, "--report", log);
  context.files().will_write(options.budget_report, "--budget-report", log);
  if (extension != ".pan" && (!options.open.budget.empty() || !options.budget_report.empty()))
    log.report(Code("N1405"), {},
               "--budget and --budget-report have an effect on a .pan file only");
  if (log.has_errors()) return context.finish();
  workspace::OpenOptions open = options.open;
  open.cache = options.cache.folder();
  if (!open.budget.empty() && !workspace::budget_of_text(open.budget, log)) return context.finish();
  workspace::OpenReport found;
  auto imported = workspace::read_cad(options.input, open, log, context.job(), &found);
  context.add_timings(std::exchange(found.steps, {}));
  if (!open.cache.empty()) context.add_work(found.work);
  if (!imported) return context.finish();
  check_sizes(imported->scene, log);
  if (!options.report.empty() && !write_report(found.mesh_report.value_or(importers::MeshReport{}),
                                               imported->scene, options, context))
    return context.finish();
  if (options.output.empty()) {
    context.step({});
    describe(*imported, context);
    return context.finish();
  }
  context.result()["output"] = options.output;
  if (extension == ".pxn") {
    context.step("write");
    write_import_template(*imported, options, context);
  } else {
    context.step({});
    const workspace::WriteOptions write{.output = options.output,
                                        .strip_sources = false,
                                        .mesh_levels = options.mesh_levels,
                                        .storage = storage_of(options.compress),
                                        .check_size = false,
                                        .origin = origin_of(options.open.cad)};
    const auto report =
        workspace::write_pan(imported->scene, open, write, log, context.job(), &found);
    context.add_timings(found.steps);
    if (!open.cache.empty()) context.add_work(found.work);
    if (!report) {
      if (found.hidden) context.result()["removed"] = as_json(*found.hidden);
      return context.finish();
    }
    describe_written(options, *report, found.hidden, context);
    if (!options.budget_report.empty())
      write_budget_report(options.budget_report, options.input, imported->scene.budget, *report,
                          context);
    if (imported->scene.budget.any())
      context.result()["budget"] = budget_json(imported->scene.budget, *report);
  }
  return context.finish();
}

int run_importer(const Options& typed, const Host& host) {
  Options options = typed;
  if (options.output.empty())
    options.output =
        std::filesystem::path(options.input).filename().replace_extension(".pan").string();
  return run(options, host);
}

}  // namespace
}  // namespace command_import

Command import_command() {
  return command("import",
                 "Read a CAD file (glTF, VRML, STEP, OBJ, STL, PLY, URDF, MJCF) into pan or pxn",
                 command_import::declare_all, command_import::run);
}

Command importer_command(const std::string& name) {
  return command(
      name,
      fmt::format("{}: compile a CAD file into a pan file; the same as 'panwright import'", name),
      command_import::declare_all, command_import::run_importer);
}

}  // namespace panwright::tools
