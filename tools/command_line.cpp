// The command line. The only translation unit that includes CLI11, which is slow to compile.

#include <fmt/format.h>
#include <cmath>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <new>

#include "base/parallel.h"
#include "tools/commands.h"
#include "tools/completion.h"
#include "tools/run.h"
#include "tools/session.h"
#include "tools/view.h"

namespace panwright::tools {

namespace {

// Refuses what is no finite number: ranges let "nan" pass.
const CLI::Validator kNumber(
    [](std::string& text) {
      const auto number = parse_numbers(text, 1);
      return number && std::isfinite((*number)[0]) ? std::string() : text + " is no finite number";
    },
    "");

// note: CLI11 reads "-1" as the largest unsigned number
const CLI::Validator kNotNegative(
    [](std::string& text) { return text.starts_with('-') ? text + " is negative" : std::string(); },
    "");

constexpr int kUsage = 2;
constexpr int kInternal = 70;

struct AllOptions {
  CompileOptions compile;
  ImportOptions import;
  ExportOptions export_;
  CheckOptions check;
  InfoOptions info;
  MaterialOptions material;
  RenderOptions render;
  DiffOptions diff;
  FmtOptions fmt;
  UpgradeOptions upgrade;
  ExpandOptions expand;
  ExplainOptions explain;
  std::string completion_shell = "bash";
  bool json_version = false;
};

void add_common(CLI::App* app, CommonOptions& common) {
  app->add_flag("--json", common.json, "Print the result and the diagnostics as one JSON object");
  app->add_option("--sarif", common.sarif, "Also write the diagnostics to FILE as SARIF 2.1.0")
      ->type_name("FILE");
  app->add_flag("-q,--quiet", common.quiet, "Leave out notes");
  app->add_flag("--timings", common.timings, "Say how long each step took");
  app->add_option("--color", common.color, "auto, always or never (auto respects NO_COLOR)")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->type_name("WHEN");
  app->add_option("-j,--threads", common.threads, "Threads to use; 0: all cores")
      ->check(CLI::Range(0, 1024))
      ->type_name("N");
}

void add_read(CLI::App* app, ReadOptions& read) {
  app->add_option("--root", read.root,
                  "Folder that included files must lie in (default: the file's)")
      ->type_name("DIR");
  app->add_option("-D,--define", read.parameters,
                  "Give a <param> of the model another value, as -D span=2.4m; may stand often")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  app->add_option("--max-input", read.max_input, "Most bytes of input to read, e.g. 512MB")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("BYTES");
  app->add_option("--max-error", read.max_error,
                  "Metres that a mesh may lie from its shape, in the world: overrides the model's "
                  "budget (default: the budget, or 0.001)")
      ->check(kNumber)
      ->check(CLI::PositiveNumber)
      ->type_name("METRES");
  app->add_option("--max-triangles", read.max_triangles, "Most triangles in the file")
      ->check(CLI::Range(1.0, 1e12))
      ->type_name("N");
}

void add_cad(CLI::App* app, CadOptions& cad) {
  const auto option = [&](const char* name, auto& value, const char* type, const char* help) {
    return app->add_option(name, value, help)->type_name(type)->group("CAD files");
  };
  option("--units", cad.units, "UNIT",
         "What a number of the file measures: auto (default), m, mm, cm, dm, km, um, in or ft")
      ->check(CLI::IsMember({"auto", "m", "mm", "cm", "dm", "km", "um", "in", "ft"}));
  // not "--up", which is the camera's
  option("--up-axis", cad.up, "AXIS",
         "The file's axis that points up: y or z (default auto: z in STL, PLY and STEP, else y)")
      ->check(CLI::IsMember({"auto", "y", "z"}));
  app->add_flag("--keep-hidden", cad.keep_hidden, "Keep faces that nobody outside can see")
      ->group("CAD files");
  auto* no_weld =
      app->add_flag("--no-weld", cad.no_weld, "Leave meshes as they are")->group("CAD files");
  option("--weld", cad.weld, "METRES",
         "Vertices this far apart in the file become one (default 0: at one place)")
      ->check(kNumber)
      ->check(CLI::NonNegativeNumber)
      ->excludes(no_weld);
  option("--crease", cad.crease_deg, "DEG",
         "Faces without normals look smooth where they meet at no more (default 30)")
      ->check(kNumber)
      ->check(CLI::Range(0.0, 180.0));
  app->add_flag("--crease-normals", cad.crease_normals,
                "Compute all normals anew with the crease angle, not only those that are missing")
      ->excludes(no_weld)
      ->group("CAD files");
  option("--scene", cad.scene, "NAME|N", "glTF: the scene (default: the file's own)");
  option("--primitives", cad.primitives, "N",
         "VRML: segments around spheres, cylinders and cones (default 0: exact shapes)")
      ->check(CLI::Range(0u, 100000u));
  option("--deflection", cad.deflection, "METRES",
         "STEP: triangles lie this close to their surfaces (default 0: 1e-4 of the model's size)")
      ->check(kNumber)
      ->check(CLI::NonNegativeNumber);
  option("--assume", cad.assume, "KIND",
         "What a file is that does not say: vrml97, vrml1, gltf, obj, stl, ply or step")
      ->check(CLI::IsMember({"vrml97", "vrml1", "gltf", "obj", "stl", "ply", "step"}));
  app->add_flag("--recentre", cad.recentre, "Put the middle of the model at the origin")
      ->group("CAD files");
}

void add_import(CLI::App* app, ImportOptions& options) {
  app->add_option(
         "input", options.input,
         "VRML 97, VRML 1.0, glTF 2.0, GLB, OBJ, STL, PLY (STEP where built in), packed or not")
      ->required()
      ->type_name("FILE");
  app->add_option("-o,--output", options.output,
                  "The compiled model (.pan), or a pxn text that imports and dresses it (.pxn)")
      ->type_name("OUT");
  app->add_option("--report", options.report,
                  "Write what cleaning found: .txt, .json, or .html with pictures")
      ->type_name("FILE");
  app->add_flag("--compress", options.compress,
                "A smaller .pan, slower to load, that programs of format 1.0 refuse");
  app->add_option("--root", options.read.cad.root,
                  "Folder that files named by the model must lie in (default: the model's)")
      ->type_name("DIR");
  app->add_option("--max-error", options.read.max_error,
                  "Metres that a mesh may lie from an exact shape (default 0.001)")
      ->check(kNumber)
      ->check(CLI::PositiveNumber)
      ->type_name("METRES");
  app->add_option("--max-triangles", options.read.max_triangles, "Most triangles in the file")
      ->check(CLI::Range(1.0, 1e12))
      ->type_name("N");
  add_cad(app, options.read.cad);
  // the camera has no say here, so that the short name is free
  app->get_option("--up-axis")->group("CAD files");
  app->add_option("--up", options.read.cad.up, "The same as --up-axis")
      ->check(CLI::IsMember({"auto", "y", "z"}))
      ->type_name("AXIS")
      ->group("CAD files");
  add_common(app, options.common);
}

void add_export(CLI::App* app, ExportOptions& options) {
  app->add_option("input", options.input, "A .pan, .pxn or CAD file")
      ->required()
      ->type_name("FILE");
  app->add_option("-o,--output", options.output, "The glTF file")
      ->required()
      ->type_name("FILE.glb");
  add_read(app, options.read);
  add_cad(app, options.read.cad);
  add_common(app, options.common);
}

void add_compile(CLI::App* app, CompileOptions& options) {
  app->add_option("input", options.input, "The model, a .pxn file")
      ->required()
      ->type_name("FILE.pxn");
  app->add_option("-o,--output", options.output,
                  "The pan file (default: the input's name with .pan)")
      ->type_name("FILE.pan");
  app->add_option("-M,--depfile", options.depfile,
                  "Write the files that were read, as a Make and Ninja dependency file")
      ->type_name("FILE");
  app->add_flag("--strip-sources", options.strip_sources, "Leave out where parts were written");
  app->add_flag("--compress", options.compress,
                "A smaller file, slower to load, that programs of format 1.0 refuse");
  add_read(app, options.read);
  add_common(app, options.common);
}

void add_view(CLI::App* app, ViewOptions& view) {
  const auto add = [&](const char* name, std::optional<std::string>& value, const char* type,
                       const char* help) {
    return app->add_option(name, value, help)->type_name(type)->group("Camera and Sun");
  };
  add("--camera", view.camera, "\"X Y Z\"",
      "Where the camera is, metres, world axes (default: in front of the model)");
  add("--look-at", view.look_at, "\"X Y Z\"",
      "The point that the boresight passes through (default: the origin)");
  add("--up", view.up, "\"X Y Z\"", "Direction that is up in the image (default 0 0 1)");
  add("--quat", view.quat, "\"W X Y Z\"",
      "Attitude world_from_camera instead of --look-at; x right, y down, z boresight");
  add("--camera-frame", view.camera_frame, "NAME", "Put the camera into a frame of the model");
  add("--pose", view.pose, "\"X Y Z W I J K\"",
      "Position and attitude world_from_model of the model");
  add("--sun", view.sun, "\"X Y Z\"",
      "Direction to the Sun, world axes (default: from behind the camera's left shoulder)");
  add("--sun-distance", view.sun_distance, "AU", "Distance to the Sun (default 1)");
  add("--sun-irradiance", view.sun_irradiance, "E|R,G,B",
      "In-band irradiance at the target, W/m²; radiance is then W/(m² sr), otherwise per unit "
      "irradiance, 1/sr");
  add("--fov", view.fov, "DEG",
      "Full horizontal field of view, degrees (default: the model fills the image)");
  add("--ifov", view.ifov, "ANGLE",
      "Angle of the pixel on the axis, as 0.2mrad; a bare number is degrees");
  add("--intrinsics", view.intrinsics, "FX,FY,CX,CY", "Pinhole intrinsics in pixels");
  add("--ortho", view.ortho, "METRES", "Orthographic image of this width");
  add("--size", view.size, "WxH", "Image size in pixels (default 1024x1024)");
  add("--ev", view.ev, "STOPS", "Exposure of PNG output: 2^EV (default 0)");
}

void add_reference(CLI::App* app, RenderOptions& options) {
  app->add_option_function<std::string>(
         "--engine",
         [&options](const std::string& name) { options.reference = name == "reference"; },
         "gl: OpenGL (default); reference: path tracing on the CPU, slow and with error bars")
      ->check(CLI::IsMember({"gl", "reference"}))
      ->type_name("NAME");
  app->add_option("--until-error", options.until_error,
                  "Reference: go on until the flux is known this well, as 0.1%")
      ->type_name("SHARE");
  app->add_option("--max-samples", options.max_samples,
                  "Reference: most samples of a pixel with --until-error (default 67108864)")
      ->check(CLI::Range(32u, 1u << 30))
      ->type_name("N");
  app->add_option("--bounces", options.bounces,
                  "Reference: interreflections that are followed (default 3)")
      ->check(CLI::Range(0u, 1000u))
      ->type_name("N");
  app->add_option("--seed", options.seed, "Reference: which random numbers (default 0)")
      ->check(kNotNegative)
      ->type_name("N");
  app->add_option("--filter", options.filter,
                  "Reference: box, a pixel is the mean over its square (default), or "
                  "gaussian:SIGMA, of the image blurred by that many pixels")
      ->type_name("FILTER");
  app->add_option("--limb-darkening", options.limb_darkening,
                  "Reference: u of I = 1 - u (1 - cos) over the Sun's disc (default 0)")
      ->check(kNumber)
      ->check(CLI::Range(0.0, 1.0))
      ->type_name("U");
  app->add_flag("--no-sun-disc", options.no_sun_disc, "Reference: the Sun is a point");
}

void add_render(CLI::App* app, RenderOptions& options) {
  app->add_option("input", options.input,
                  "A .pan file, or a .pxn or CAD file to compile on the way")
      ->required()
      ->type_name("FILE");
  app->add_option("-o,--output", options.view.output,
                  "The picture: .png, .exr, .npy (radiance) or .npz (radiance and truth layers)")
      ->type_name("FILE");
  add_view(app, options.view);
  app->add_option("--views", options.views,
                  "JSON list of views, each an object of camera and Sun options and an output")
      ->type_name("FILE.json");
  app->add_option("--samples", options.samples,
                  "N x N samples in each pixel (default 1; with --engine reference 8)")
      ->check(CLI::Range(1u, 64u))
      ->type_name("N");
  add_reference(app, options);
  app->add_flag("--flat", options.flat, "Shade with the triangles' own normals");
  auto* no_shadows =
      app->add_flag("--no-shadows", options.no_shadows, "Let the Sun shine through everything");
  app->add_option("--shadow-side", options.shadow_side,
                  "Texels a side of the shadow map that spans the model (default 2048)")
      ->check(CLI::Range(16u, 16384u))
      ->excludes(no_shadows)
      ->type_name("N");
  app->add_option("--max-image-memory", options.max_image_bytes,
                  "Most memory of one image, e.g. 2GB (default 12GB)")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("BYTES");
  app->add_option("--gl", options.gl, "OpenGL context: auto, egl or osmesa")
      ->check(CLI::IsMember({"auto", "egl", "osmesa"}))
      ->type_name("KIND");
  add_read(app, options.read);
  add_cad(app, options.read.cad);
  add_common(app, options.common);
}

void add_max_input(CLI::App* app, std::uint64_t& bytes) {
  app->add_option("--max-input", bytes, "Most bytes of input to read, e.g. 512MB")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("BYTES");
}

void add_fmt(CLI::App* app, FmtOptions& options) {
  app->add_option("inputs", options.inputs, "Files to format; -: standard input to standard output")
      ->required()
      ->type_name("FILE.pxn…");
  app->add_flag("--check", options.check,
                "Write nothing; name the files that would change, with exit code 1");
  app->add_option("-o,--output", options.output,
                  "Write here instead (-: standard output); for one file")
      ->type_name("FILE");
  add_max_input(app, options.max_input);
  add_common(app, options.common);
}

void add_upgrade(CLI::App* app, UpgradeOptions& options) {
  app->add_option("inputs", options.inputs,
                  "Files to upgrade: a model, and those of its included files that are meant too")
      ->required()
      ->type_name("FILE.pxn…");
  app->add_option("-o,--output", options.output,
                  "Write here instead (-: standard output); for one file")
      ->type_name("FILE");
  app->add_option("--root", options.root,
                  "Folder that included files must lie in (default: the file's)")
      ->type_name("DIR");
  add_max_input(app, options.max_input);
  add_common(app, options.common);
}

void add_material(CLI::App* app, MaterialOptions& options) {
  app->add_option("inputs", options.inputs, "A .pxn file, or a material of the library")
      ->type_name("FILE|PRESET…");
  app->add_option("--name", options.name, "Only this material of the files")->type_name("NAME");
  app->add_flag("--all", options.all, "Every material of the library");
  app->add_flag("--list", options.list, "List the library");
  app->add_flag("--show", options.show, "Print the text of a library's material");
  app->add_option("--albedo", options.albedo, "Cosines of the directions whose albedo is printed")
      ->type_name("MU,MU…");
  app->add_option("--svg", options.svg, "Write plots of albedo and lobes into this folder")
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
  app->add_option("--fit", options.fit, "Fit our laws to a table of measured reflectance")
      ->type_name("TABLE");
  app->add_option("--render", options.render,
                  "Draw a sphere, a tilted tile and a wrinkled tile of each")
      ->type_name("FILE.png");
  app->add_option("--width", options.width, "Pixels across one material's picture")
      ->check(CLI::Range(60, 4096))
      ->type_name("PIXELS");
  app->add_option("--engine", options.engine, "gl or reference")
      ->check(CLI::IsMember({"gl", "reference"}))
      ->type_name("ENGINE");
  add_common(app, options.common);
}

void add_expand(CLI::App* app, ExpandOptions& options) {
  app->add_option("input", options.input, "The model, a .pxn file")
      ->required()
      ->type_name("FILE.pxn");
  app->add_option(
         "-o,--output", options.output,
         "The text; pictures are written beside it as PNG, unless they are there (-: standard "
         "output, without pictures)")
      ->required()
      ->type_name("FILE.pxn");
  add_read(app, options.read);
  add_common(app, options.common);
}

// Lets values begin with a minus sign: "--sun -1,0,0" and "--sun '-1 0 0'" become one word.
std::vector<std::string> joined_values(int argc, const char* const* argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    std::string word = argv[i];
    const bool negative = word.size() > 1 && word[0] == '-' &&
                          (std::isdigit(static_cast<unsigned char>(word[1])) || word[1] == '.');
    const bool after_option = !words.empty() && words.back().starts_with("--") &&
                              words.back().find('=') == std::string::npos &&
                              words.back().size() > 2;
    if (negative && after_option)
      words.back() += "=" + word;
    else if (word == "-lic")
      words.emplace_back("--lic");
    else
      words.push_back(std::move(word));
  }
  return words;
}

// --json promises one object on standard output, whatever happens.
int usage_error(const CLI::App& app, const CLI::ParseError& error, bool json) {
  if (!json) {
    app.exit(error);
    return kUsage;
  }
  const auto used = app.get_subcommands();
  CommonOptions common;
  common.json = true;
  Session session(used.empty() ? app.get_name() : used[0]->get_name(), common);
  session.log().report(Code::E0201, {}, error.what());
  return session.finish();
}

int parse_and_run(CLI::App& app, std::vector<std::string> words, const std::function<int()>& go) {
  const bool json = std::find(words.begin(), words.end(), "--json") != words.end();
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help
    return usage_error(app, error, json);
  }
  return go();
}

int run_importer(const std::string& name, std::vector<std::string> words) {
  ImportOptions options;
  CLI::App app(
      fmt::format("{}: makes a pan file of a CAD file; the same as 'panwright import'", name),
      name);
  add_import(&app, options);
  return parse_and_run(app, std::move(words), [&] {
    set_thread_count(options.common.threads);
    if (options.output.empty())
      options.output = std::filesystem::path(options.input).replace_extension(".pan").string();
    return import_cad(options);
  });
}

int run_converter(const std::string& name, std::vector<std::string> words) {
  CompileOptions options;
  CLI::App app(
      fmt::format("{}: compiles a pxn model into a pan file; the same as 'panwright compile'",
                  name),
      name);
  add_compile(&app, options);
  app.add_option("--lic", options.license, "A licence file (-lic FILE): accepted and ignored")
      ->type_name("FILE");
  return parse_and_run(app, std::move(words), [&] {
    set_thread_count(options.common.threads);
    return compile(options);
  });
}

void add_subcommands(CLI::App& app, AllOptions& all) {
  auto* compile_app = app.add_subcommand("compile", "Compile a pxn model into a pan file");
  add_compile(compile_app, all.compile);

  add_import(app.add_subcommand("import", "Read a CAD file: VRML or glTF, into a pan or pxn file"),
             all.import);
  add_export(app.add_subcommand("export", "Write a model as a glTF file"), all.export_);

  auto* check_app =
      app.add_subcommand("check", "Say everything that is wrong with pxn, pan and CAD files");
  check_app->add_option("inputs", all.check.inputs, "Files to check")
      ->required()
      ->type_name("FILE…");
  add_read(check_app, all.check.read);
  add_cad(check_app, all.check.read.cad);
  add_common(check_app, all.check.common);

  auto* info_app = app.add_subcommand("info", "Show what is in a model");
  info_app->add_option("input", all.info.input, "A .pan, .pxn or CAD file")
      ->required()
      ->type_name("FILE");
  info_app->add_flag("--meshes", all.info.meshes, "List all meshes, not the heaviest only");
  add_read(info_app, all.info.read);
  add_cad(info_app, all.info.read.cad);
  add_common(info_app, all.info.common);

  auto* render_app = app.add_subcommand("render", "Render a model as a camera sees it");
  add_render(render_app, all.render);

  add_material(
      app.add_subcommand("material", "Certify materials: albedo, energy, reciprocity, precision"),
      all.material);

  auto* diff_app = app.add_subcommand("diff", "Compare two models; exit code 1 when they differ");
  diff_app->add_option("a", all.diff.a, "A .pan or .pxn file")->required()->type_name("A");
  diff_app->add_option("b", all.diff.b, "A .pan or .pxn file")->required()->type_name("B");
  diff_app->add_flag("--all", all.diff.all, "Count differences of provenance and storage too");
  add_read(diff_app, all.diff.read);
  add_common(diff_app, all.diff.common);

  add_fmt(app.add_subcommand("fmt", "Lay pxn files out in their canonical form, comments and all"),
          all.fmt);
  add_upgrade(app.add_subcommand("upgrade", "Rewrite pxn files of level 0 in level 1"),
              all.upgrade);
  add_expand(
      app.add_subcommand("expand",
                         "Write a model as one pxn file without parts, repeats, includes and "
                         "expressions"),
      all.expand);

  auto* explain_app = app.add_subcommand("explain", "Explain a diagnostic code, or list them all");
  explain_app->add_option("code", all.explain.code, "A code such as E1101")->type_name("CODE");
  add_common(explain_app, all.explain.common);

  auto* completion_app = app.add_subcommand("completion", "Print a shell completion script");
  completion_app->add_option("shell", all.completion_shell, "bash, zsh or fish")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->type_name("SHELL");
}

// Every command with its options, for completion scripts.
std::vector<CommandWords> command_words(const CLI::App& app) {
  std::vector<CommandWords> commands;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    CommandWords words{sub->get_name(), sub->get_description(), {}};
    for (const CLI::Option* option : sub->get_options())
      for (const std::string& name : option->get_lnames())
        words.options.push_back({"--" + name, option->get_description()});
    commands.push_back(std::move(words));
  }
  return commands;
}

int run_panwright(std::vector<std::string> words) {
  AllOptions all;
  CLI::App app(
      "panwright: spacecraft models from pxn text and CAD files to checked pan files and "
      "radiometric "
      "pictures",
      "panwright");
  app.footer(
      "Examples:\n"
      "  panwright compile examples/paper/figure8.pxn -o f.pan\n"
      "  panwright render f.pan -o f.png --camera \"0 -5 1\" --sun \"1 -1 1\"\n"
      "  panwright import iss.glb -o iss.pxn\n"
      "  panwright explain E1101\n"
      "Exit codes: 0 ok, 1 errors in a model, 2 usage, 3 I/O, 4 damaged pan file, 70 internal.\n"
      "The language: docs/pxn-reference.md. Conventions of cameras, axes and units: "
      "docs/conventions.md.");
  app.require_subcommand(0, 1);
  bool version_flag = false;
  app.add_flag("--version", version_flag, "Print the version; with --json, the features too");
  app.add_flag("--json", all.json_version, "With --version: print JSON");
  add_subcommands(app, all);
  return parse_and_run(app, std::move(words), [&]() -> int {
    if (version_flag) return version(all.json_version);
    const auto with_threads = [](const CommonOptions& common) { set_thread_count(common.threads); };
    if (app.got_subcommand("compile"))
      return with_threads(all.compile.common), compile(all.compile);
    if (app.got_subcommand("import"))
      return with_threads(all.import.common), import_cad(all.import);
    if (app.got_subcommand("export"))
      return with_threads(all.export_.common), export_cad(all.export_);
    if (app.got_subcommand("check")) return with_threads(all.check.common), check(all.check);
    if (app.got_subcommand("material"))
      return with_threads(all.material.common), material(all.material);
    if (app.got_subcommand("info")) return with_threads(all.info.common), info(all.info);
    if (app.got_subcommand("render")) return with_threads(all.render.common), render(all.render);
    if (app.got_subcommand("diff")) return with_threads(all.diff.common), diff(all.diff);
    if (app.got_subcommand("fmt")) return format(all.fmt);
    if (app.got_subcommand("upgrade")) return upgrade(all.upgrade);
    if (app.got_subcommand("expand")) return with_threads(all.expand.common), expand(all.expand);
    if (app.got_subcommand("explain")) return explain(all.explain);
    if (app.got_subcommand("completion")) {
      fmt::print("{}", completion_script(all.completion_shell, command_words(app)));
      return 0;
    }
    fmt::print("{}", app.help());
    return kUsage;
  });
}

int run_unchecked(int argc, const char* const* argv) {
  try {
    const std::string name =
        argc > 0 ? std::filesystem::path(argv[0]).filename().string() : std::string("panwright");
    std::vector<std::string> words = joined_values(argc, argv);
    if (name == "pxntopan" || name == "pxn2pan") return run_converter(name, std::move(words));
    if (name == "vrmltopan" || name == "gltftopan") return run_importer(name, std::move(words));
    return run_panwright(std::move(words));
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "panwright: out of memory\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "panwright: internal error: {}\n", error.what());
  }
  return kInternal;
}

}  // namespace

int run(int argc, const char* const* argv) {
  const int code = run_unchecked(argc, argv);
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  fmt::print(stderr, "panwright: standard output could not be written\n");
  return code == 0 ? 3 : code;
}

}  // namespace panwright::tools
