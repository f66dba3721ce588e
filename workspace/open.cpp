#include "workspace/open.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string_view>

#include "base/file.h"
#include "base/file_uses.h"
#include "base/text.h"
#include "importers/clean.h"
#include "importers/other_formats.h"
#include "importers/palette.h"
#include "pxn/pxn.h"
#include "terrain/shape.h"
#include "terrain/tiles.h"
#include "workspace/budget.h"
#include "workspace/internal/kept_import.h"
#include "workspace/internal/kept_work.h"
#include "workspace/internal/stopwatch.h"
#include "workspace/scene_settings.h"
#include "workspace/terrain.h"

namespace panwright::workspace {

namespace {

constexpr std::pair<std::string_view, importers::Format> kFormats[] = {
    {"vrml97", importers::Format::vrml97}, {"vrml1", importers::Format::vrml1},
    {"gltf", importers::Format::gltf},     {"obj", importers::Format::obj},
    {"stl", importers::Format::stl},       {"ply", importers::Format::ply},
    {"step", importers::Format::step},     {"urdf", importers::Format::urdf},
    {"mjcf", importers::Format::mjcf}};

void note_unused(const std::vector<std::string_view>& names, const std::string& path,
                 std::string_view kind, DiagnosticLog& log) {
  for (const std::string_view name : names)
    log.report_file(Code("N1405"), path, fmt::format("{} has no effect on a {} file", name, kind));
}

// Options for files of another format.
void note_other_formats(const CadOptions& cad, importers::Format format, const std::string& path,
                        DiagnosticLog& log) {
  using importers::Format;
  std::vector<std::string_view> unused;
  if (!cad.scene.empty() && format != Format::gltf) unused.push_back("--scene");
  if (!cad.animation.empty() && format != Format::gltf) unused.push_back("--animation");
  if (cad.time && format != Format::gltf) unused.push_back("--time");
  if (cad.primitives > 0 && format != Format::vrml97 && format != Format::vrml1)
    unused.push_back("--primitives");
  if (cad.deflection > 0 && format != Format::step) unused.push_back("--deflection");
  if (cad.max_seconds != CadOptions().max_seconds && format != Format::step)
    unused.push_back("--max-seconds");
  constexpr std::string_view kKinds[] = {"VRML", "VRML", "glTF", "OBJ", "STL",
                                         "PLY",  "STEP", "URDF", "MJCF"};
  note_unused(unused, path, kKinds[static_cast<std::size_t>(format)], log);
}

// Options of CAD files, for a file that is not a CAD file.
void note_cad_options(const CadOptions& cad, const std::filesystem::path& path,
                      DiagnosticLog& log) {
  const CadOptions usual;
  std::vector<std::string_view> unused;
  const auto look = [&](bool given, std::string_view name) {
    if (given) unused.push_back(name);
  };
  look(cad.units != usual.units, "--units");
  look(cad.up != usual.up, "--up-axis");
  look(!cad.scene.empty(), "--scene");
  look(!cad.animation.empty(), "--animation");
  look(cad.time.has_value(), "--time");
  look(!cad.assume.empty(), "--assume");
  look(cad.no_weld, "--no-weld");
  look(cad.weld != usual.weld, "--weld");
  look(cad.crease_deg != usual.crease_deg, "--crease");
  look(cad.primitives != usual.primitives, "--primitives");
  look(cad.deflection != usual.deflection, "--deflection");
  look(cad.max_seconds != usual.max_seconds, "--max-seconds");
  look(cad.crease_normals, "--crease-normals");
  look(cad.keep_hidden, "--keep-hidden");
  look(cad.recentre, "--recentre");
  note_unused(unused, path.string(), extension_of(path), log);
}

// Option values that the importers do not know. The program checks its own options before.
bool are_known(const CadOptions& cad, DiagnosticLog& log) {
  const auto require = [&](bool known, const char* name, const std::string& value,
                           const char* accepted) {
    if (!known)
      log.report(Code("E0201"), {},
                 fmt::format("the option '{}' of CAD files is {}, expected {}", name,
                             in_quotes(value), accepted));
    return known;
  };
  const bool format =
      cad.assume.empty() || std::any_of(std::begin(kFormats), std::end(kFormats),
                                        [&](const auto& each) { return each.first == cad.assume; });
  const bool units = require(cad.units == "auto" || importers::unit_of(cad.units), "units",
                             cad.units, "auto, m, mm, cm, dm, km, um, in, ft or yd");
  const bool up =
      require(cad.up == "auto" || importers::up_of(cad.up), "up", cad.up, "auto, y or z");
  return require(format, "assume", cad.assume,
                 "vrml97, vrml1, gltf, obj, stl, ply, step, urdf or mjcf") &&
         units && up;
}

importers::Options import_options(const OpenOptions& options) {
  const CadOptions& cad = options.cad;
  importers::Options read;
  read.root = options.root;
  read.limits.triangles = options.max_triangles;
  read.crease_angle = cad.crease_deg * kDegree;
  read.primitives = cad.primitives;
  read.deflection = cad.deflection;
  read.limits.seconds = cad.max_seconds;
  if (!cad.scene.empty()) read.scene = cad.scene;
  if (!cad.animation.empty()) read.animation = cad.animation;
  read.time = cad.time;
  for (const auto& [name, format] : kFormats)
    if (cad.assume == name) read.assume = format;
  return read;
}

// What replaced values of parameters, for the build identity; in any order the same.
std::string parameters_words(const OpenOptions& options) {
  auto sorted = options.parameters;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string out;
  for (const auto& [name, value] : sorted) out += fmt::format(" {}={}", name, in_quotes(value));
  return out;
}

// Before anything depends on it. Fails: as budget_of_text(), E0201 for an approach along no frame.
bool replace_budget(scene::Scene& scene, const OpenOptions& options, DiagnosticLog& log) {
  if (options.budget.empty()) return true;
  const auto budget = budget_of_text(options.budget, log);
  if (!budget) return false;
  scene.budget = *budget;
  const std::string& approach = scene.budget.approach;
  std::vector<std::string_view> names;
  for (const scene::Frame& frame : scene.frames) names.push_back(frame.name);
  if (approach.empty() || std::ranges::find(names, approach) != names.end()) return true;
  const auto near = nearest_name(approach, names);
  log.report(Code("E0201"), {}, fmt::format("--budget: unknown frame {}", in_quotes(approach)),
             near            ? fmt::format("did you mean '{}'?", *near)
             : names.empty() ? "the model has no frame"
                             : "");
  return false;
}

compiler::Options compile_options(const OpenOptions& options) {
  compiler::Options compile;
  compile.max_error = options.max_error;
  compile.max_triangles = options.max_triangles;
  compile.origin = parameters_words(options);
  if (!options.budget.empty())
    compile.origin += fmt::format(" budget={}", in_quotes(options.budget));
  return compile;
}

// The imports of which a log says that their unit is a guess.
std::size_t guessed_units(const DiagnosticLog& log) {
  return static_cast<std::size_t>(
      std::count_if(log.entries().begin(), log.entries().end(),
                    [](const Diagnostic& entry) { return entry.code == Code("W6006"); }));
}

Result<world::ModelPtr> open_pan(const std::filesystem::path& path, const OpenOptions& options,
                                 DiagnosticLog& log, const Job& job, OpenReport* report) {
  note_cad_options(options.cad, path, log);
  if (!options.budget.empty()) note_unused({"--budget"}, path.string(), ".pan", log);
  if (!options.parameters.empty() && options.declared == nullptr) {
    log.report_file(Code("E1225"), path.string(),
                    "-D has no effect on a .pan file: it was compiled with its parameters",
                    "compile its text again, or render that");
    return failed;
  }
  auto model = [&] {
    const Stopwatch watch(report, "open " + path.string());
    return pan::Model::open(path, log);
  }();
  if (!model) return failed;
  const Stopwatch watch(report, "check " + path.string());
  // tiles of terrain are hashed when they are looked at
  if (!model->check(log, job, terrain::kTilesSection)) return failed;
  // what the pan was made of, where it still lies beside it: no image may take its place
  if (log.files())
    for (const auto& input : model->inputs())
      log.files()->will_read(path.parent_path() / std::string(model->string(input.path)));
  world::ModelPtr shared = std::make_shared<const pan::Model>(*std::move(model));
  if (!terrain::Tiles::of(shared, log)) return failed;
  return shared;
}

}  // namespace

std::filesystem::path user_cache_folder() {
  namespace fs = std::filesystem;
  if (const char* chosen = std::getenv("PANWRIGHT_CACHE"))
    return std::string_view(chosen) == "off" ? fs::path() : fs::path(chosen);
  // relative ones are to be ignored, says the XDG Base Directory Specification
  if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder != nullptr && folder[0] == '/')
    return fs::path(folder) / "panwright";
  const char* home = std::getenv("HOME");
  std::error_code ignored;
  if (home == nullptr || home[0] != '/' || !fs::is_directory(home, ignored)) return {};
  return fs::path(home) / ".cache" / "panwright";
}

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

namespace {

bool is_gzip(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  std::ifstream file(path, std::ios::binary);
  return file.get() == 0x1f && file.get() == 0x8b;
}

}  // namespace

bool is_cad(const std::filesystem::path& path) {
  std::string extension = extension_of(path);
  if (extension == ".gz" || extension == ".gzip") extension = extension_of(path.stem());
  for (const char* known : {".wrl", ".wrz", ".vrml", ".glb", ".gltf", ".obj", ".stl", ".ply",
                            ".stp", ".step", ".urdf", ".mjcf", ".xml"})
    if (extension == known) return true;
  return extension != ".pan" && extension != ".pxn" && is_gzip(path);
}

namespace {

// The command that makes a pan file of a small body or an elevation file; empty: it is neither.
std::string how_to_tile(const std::filesystem::path& path) {
  constexpr std::string_view kElevations[] = {".lbl", ".img", ".cub", ".tif", ".tiff", ".hdr"};
  const bool shape = terrain::is_shape(path);
  if (!shape && std::ranges::find(kElevations, extension_of(path)) == std::end(kElevations))
    return {};
  return fmt::format("{}: panwright dem {} -o {}.pan", shape ? "a shape model" : "elevations",
                     path.string(), path.stem().string());
}

}  // namespace

void report_unknown_format(const std::filesystem::path& path, DiagnosticLog& log) {
  if (!require_file(path, log)) return;
  if (const auto other = importers::other_format_by_name(path.string()))
    log.report(Code("E0202"), {},
               fmt::format("{}: {} is not supported, expected .pan, .pxn, VRML, glTF, GLB, OBJ, "
                           "STL, PLY, STEP, URDF or MJCF",
                           in_quotes(path.string()), other->name),
               std::string(other->advice));
  else
    log.report(Code("E0202"), {},
               fmt::format("{} is not a supported model file, expected .pan, .pxn, .wrl, .wrz, "
                           ".vrml, .glb, .gltf, .obj, .stl, .ply, .step, .urdf or .xml (MJCF)",
                           in_quotes(path.string())),
               how_to_tile(path));
}

Result<importers::Imported> read_cad(const std::filesystem::path& path, const OpenOptions& options,
                                     DiagnosticLog& log, const Job& job, OpenReport* report) {
  const CadOptions& cad = options.cad;
  if (!are_known(cad, log)) return failed;
  auto imported = [&] {
    const Stopwatch watch(report, "read " + path.string());
    return importers::import_file(path, import_options(options), log, job);
  }();
  if (!imported) return failed;
  if (imported->scene.instances.empty())
    log.report_file(Code("E6011"), path.string(),
                    "the file holds no surface, or none that could be read");
  note_other_formats(cad, imported->format, path.string(), log);
  // before cleaning, whose lengths are metres in the world
  importers::place(*imported, importers::unit_of(cad.units), importers::up_of(cad.up), cad.recentre,
                   log);
  if (!cad.no_weld) {
    const Stopwatch watch(report, "clean");
    geometry::CleanOptions clean;
    clean.tolerance = cad.weld;
    clean.keep_normals = !cad.crease_normals;
    clean.crease_angle = cad.crease_deg * kDegree;
    const KeptWork work(options, report);
    auto found = importers::clean_up(imported->scene, clean, log, job, work.cache());
    if (!found) return failed;
    if (report != nullptr) report->mesh_report = *std::move(found);
  }
  if (!run_job(job, log, [&] {
        importers::split_palettes(*imported, log, job);
        return true;
      }))
    return failed;
  for (scene::Instance& instance : imported->scene.instances) instance.prunable = !cad.keep_hidden;
  return imported;
}

Result<bool> prune(scene::Scene& scene, const OpenOptions& options, DiagnosticLog& log,
                   const Job& job, OpenReport* report) {
  compiler::HiddenOptions hidden;
  for (const scene::Instance& instance : scene.instances)
    hidden.may_lose.push_back(static_cast<char>(instance.prunable));
  if (std::find(hidden.may_lose.begin(), hidden.may_lose.end(), 1) == hidden.may_lose.end())
    return false;
  const Stopwatch watch(report, "remove hidden parts");
  hidden.compile = compile_options(options);
  const KeptWork work(options, report);
  hidden.cache = work.cache();
  const auto found = compiler::prune_hidden(scene, hidden, log, job);
  if (!found) return failed;
  if (report != nullptr) report->hidden = *found;
  return true;
}

Result<scene::Scene> read_scene(const std::filesystem::path& path, const OpenOptions& options,
                                DiagnosticLog& log, const Job& job, OpenReport* report,
                                std::optional<pxn::TerrainText>* terrain) {
  if (is_cad(path)) {
    auto imported = read_cad(path, options, log, job, report);
    if (!imported) return failed;
    return std::move(imported->scene);
  }
  note_cad_options(options.cad, path, log);
  const Stopwatch watch(report, "read " + path.string());
  pxn::Options read;
  read.root = options.root;
  read.limits.bytes = options.max_input;
  read.parameters = options.parameters;
  read.declared = options.declared;
  read.unsaved = &options.unsaved;
  read.foil_levels = options.foil_levels;
  read.terrain = terrain;
  const KeptWork work(options, report);
  read.cache = work.cache();
  auto scene = pxn::read(path, read, log, job);
  if (scene) (void)check_scene(*scene, log);
  return scene;
}

namespace {

// A pan in memory as a model.
Result<world::ModelPtr> model_of(std::vector<std::byte> bytes, const std::filesystem::path& path,
                                 DiagnosticLog& log, const Job& job) {
  auto model = pan::Model::from_bytes(std::move(bytes), path.string(), log);
  if (!model || !model->check(log, job)) return failed;
  return world::ModelPtr(std::make_shared<const pan::Model>(*std::move(model)));
}

// Reads and compiles a pxn or CAD file.
Result<world::ModelPtr> open_source(const std::filesystem::path& path, const OpenOptions& given,
                                    DiagnosticLog& log, const Job& job, OpenReport* report) {
  const std::size_t guesses = guessed_units(log), errors = log.errors();
  OpenOptions options = given;
  std::set<std::string> declared;
  if (given.declared != nullptr) options.declared = &declared;
  std::optional<pxn::TerrainText> terrain;
  auto scene = read_scene(path, options, log, job, report, &terrain);
  if (!scene) return failed;
  if (given.declared != nullptr) {
    std::erase_if(options.parameters,
                  [&](const auto& parameter) { return !declared.contains(parameter.first); });
    given.declared->merge(declared);
  }
  if (terrain) {
    if (log.errors() > errors) return failed;
    const Stopwatch watch(report, "tile " + path.string());
    return terrain_model(*terrain, path.parent_path(), log, job);
  }
  if (!replace_budget(*scene, options, log)) return failed;
  if (options.prune && !prune(*scene, options, log, job, report)) return failed;
  const Stopwatch watch(report, "compile " + path.string());
  const KeptWork work(options, report);
  compiler::Options compile = compile_options(options);
  compile.cache = work.cache();
  // a guessed unit is already reported with the sizes; one cause has one warning
  // and what an error has left out, or a unit that was not read, leaves no size to judge
  compile.check_size = guessed_units(log) == guesses && log.errors() == errors;
  auto bytes = compiler::compiled(*scene, compile, log, job);
  if (!bytes) return failed;
  return model_of(*std::move(bytes), path, log, job);
}

}  // namespace

Result<world::ModelPtr> open(const std::filesystem::path& path, const OpenOptions& options,
                             DiagnosticLog& log, const Job& job, OpenReport* report) {
  const std::string extension = extension_of(path);
  if (extension == ".pan") return open_pan(path, options, log, job, report);
  if (extension == ".pxn") return open_source(path, options, log, job, report);
  if (!is_cad(path)) {
    report_unknown_format(path, log);
    return failed;
  }
  const KeptWork work(options, report);
  KeptImport kept(path, options, work.cache(), log);
  if (work.cache() != nullptr) {
    const Stopwatch watch(report, "recall " + path.string());
    DiagnosticLog apart = log.apart();
    if (auto bytes = kept.find())
      if (auto model = model_of(*std::move(bytes), path, apart, job)) {
        kept.report_again();
        return model;
      }
  }
  auto model = open_source(path, options, log, job, report);
  if (model) kept.keep(**model);
  return model;
}

Result<compiler::Report> write_pan(scene::Scene& scene, const OpenOptions& options,
                                   const WriteOptions& write, DiagnosticLog& log, const Job& job,
                                   OpenReport* report) {
  if (!replace_budget(scene, options, log)) return failed;
  if (options.prune && !prune(scene, options, log, job, report)) return failed;
  const KeptWork work(options, report);
  compiler::Options compile = compile_options(options);
  compile.cache = work.cache();
  compile.strip_sources = write.strip_sources;
  compile.mesh_levels = write.mesh_levels;
  compile.storage = write.storage;
  compile.origin += write.origin;
  compile.check_size = write.check_size && guessed_units(log) == 0 && !log.has_errors();
  const auto done = compiler::compile(scene, compile, write.output, log, job);
  if (done && report != nullptr) {
    report->steps.push_back({"tessellate", done->seconds_tessellate});
    report->steps.push_back({"write", done->seconds_write});
    report->steps.push_back({"sync to disk", done->seconds_sync});
  }
  return done;
}

}  // namespace panwright::workspace
