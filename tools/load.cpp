#include "tools/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/text.h"
#include "compiler/compile.h"
#include "importers/clean.h"
#include "pxn/pxn.h"

namespace panwright::tools {

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

bool is_cad(const std::string& path) {
  std::string extension = extension_of(path);
  if (extension == ".gz") extension = extension_of(std::filesystem::path(path).stem().string());
  for (const char* known :
       {".wrl", ".wrz", ".vrml", ".glb", ".gltf", ".obj", ".stl", ".ply", ".stp", ".step"})
    if (extension == known) return true;
  return false;
}

namespace {

void note_unused(const std::vector<std::string_view>& names, const std::string& path,
                 std::string_view kind, DiagnosticLog& log) {
  for (const std::string_view name : names)
    log.report_file(Code::N1405, path, fmt::format("{} has no effect on a {} file", name, kind));
}

// Options that are for files of another format.
void note_other_formats(const CadOptions& cad, importers::Format format, const std::string& path,
                        DiagnosticLog& log) {
  using importers::Format;
  std::vector<std::string_view> unused;
  if (!cad.scene.empty() && format != Format::gltf) unused.push_back("--scene");
  if (cad.primitives > 0 && format != Format::vrml97 && format != Format::vrml1)
    unused.push_back("--primitives");
  if (cad.deflection > 0 && format != Format::step) unused.push_back("--deflection");
  constexpr std::string_view kKinds[] = {"VRML", "VRML", "glTF", "OBJ", "STL", "PLY", "STEP"};
  note_unused(unused, path, kKinds[static_cast<std::size_t>(format)], log);
}

// Options of CAD files, for a file that is none.
void note_cad_options(const CadOptions& cad, const std::string& path, DiagnosticLog& log) {
  const CadOptions usual;
  std::vector<std::string_view> unused;
  const auto look = [&](bool given, std::string_view name) {
    if (given) unused.push_back(name);
  };
  look(cad.units != usual.units, "--units");
  look(cad.up != usual.up, "--up-axis");
  look(!cad.scene.empty(), "--scene");
  look(!cad.assume.empty(), "--assume");
  look(cad.no_weld, "--no-weld");
  look(cad.weld != usual.weld, "--weld");
  look(cad.crease_deg != usual.crease_deg, "--crease");
  look(cad.primitives != usual.primitives, "--primitives");
  look(cad.deflection != usual.deflection, "--deflection");
  look(cad.crease_normals, "--crease-normals");
  look(cad.keep_hidden, "--keep-hidden");
  look(cad.recentre, "--recentre");
  note_unused(unused, path, extension_of(path), log);
}

}  // namespace

Result<importers::Imported> read_cad(const std::string& path, const ReadOptions& options,
                                     Session& session, importers::Hygiene* hygiene) {
  const CadOptions& cad = options.cad;
  importers::Options read;
  read.root = cad.root;
  read.limits.triangles = options.max_triangles;
  read.crease_angle = cad.crease_deg * kDegree;
  read.primitives = cad.primitives;
  read.deflection = cad.deflection;
  if (!cad.scene.empty()) read.scene = cad.scene;
  constexpr std::pair<std::string_view, importers::Format> kFormats[] = {
      {"vrml97", importers::Format::vrml97}, {"vrml1", importers::Format::vrml1},
      {"gltf", importers::Format::gltf},     {"obj", importers::Format::obj},
      {"stl", importers::Format::stl},       {"ply", importers::Format::ply},
      {"step", importers::Format::step}};
  for (const auto& [name, format] : kFormats)
    if (cad.assume == name) read.assume = format;
  session.step("read " + path);
  auto imported = importers::import_file(path, read, session.log());
  if (!imported) return failed;
  note_other_formats(cad, imported->format, path, session.log());
  // first, as lengths of cleaning are metres of the world
  importers::place(*imported, importers::unit_of(cad.units), importers::up_of(cad.up), cad.recentre,
                   session.log());
  if (!cad.no_weld) {
    session.step("clean");
    geometry::CleanOptions clean;
    clean.tolerance = cad.weld;
    clean.keep_normals = !cad.crease_normals;
    clean.crease_angle = read.crease_angle;
    importers::Hygiene found = importers::clean_up(imported->scene, clean, session.log());
    if (hygiene != nullptr) *hygiene = std::move(found);
  }
  for (scene::Instance& instance : imported->scene.instances) instance.prunable = !cad.keep_hidden;
  return imported;
}

bool prune(scene::Scene& scene, const ReadOptions& options, Session& session,
           compiler::HiddenReport* report) {
  compiler::HiddenOptions hidden;
  for (const scene::Instance& instance : scene.instances)
    hidden.may_lose.push_back(static_cast<char>(instance.prunable));
  if (std::find(hidden.may_lose.begin(), hidden.may_lose.end(), 1) == hidden.may_lose.end())
    return false;
  session.step("remove hidden parts");
  hidden.compile.max_error = options.max_error;
  hidden.compile.max_triangles = options.max_triangles;
  const compiler::HiddenReport found = compiler::prune_hidden(scene, hidden, session.log());
  if (report != nullptr) *report = found;
  return true;
}

Result<scene::Scene> read_scene(const std::string& path, const ReadOptions& options,
                                Session& session) {
  if (is_cad(path)) {
    auto imported = read_cad(path, options, session);
    if (!imported) return failed;
    return std::move(imported->scene);
  }
  note_cad_options(options.cad, path, session.log());
  session.step("read " + path);
  pxn::Options read;
  read.root = options.root;
  read.limits.bytes = options.max_input;
  for (const std::string& parameter : options.parameters) {
    const std::size_t sign = parameter.find('=');
    if (sign == std::string::npos || sign == 0) {
      session.log().report(
          Code::E0201, {},
          fmt::format("-D {}: NAME=VALUE is needed, as in -D span=2.4m", in_quotes(parameter)));
      return failed;
    }
    read.parameters.emplace_back(parameter.substr(0, sign), parameter.substr(sign + 1));
  }
  return pxn::read(path, read, session.log());
}

Result<pan::Model> load_model(const std::string& path, const ReadOptions& options,
                              Session& session) {
  const std::string extension = extension_of(path);
  if (extension == ".pan") {
    note_cad_options(options.cad, path, session.log());
    session.step("open " + path);
    auto model = pan::Model::open(path, session.log());
    if (!model) return failed;
    session.step("check " + path);
    if (!model->check(session.log())) return failed;
    return model;
  }
  if (extension != ".pxn" && !is_cad(path)) {
    session.log().report(
        Code::E0202, {},
        fmt::format("{} is no file of a model: .pan, .pxn, .wrl, .wrz, .vrml, .glb, "
                    ".gltf, .obj, .stl, .ply and .step are read",
                    in_quotes(path)));
    return failed;
  }
  auto scene = read_scene(path, options, session);
  if (!scene) return failed;
  if (options.prune) prune(*scene, options, session);
  session.step("compile " + path);
  compiler::Options compile;
  compile.max_error = options.max_error;
  compile.max_triangles = options.max_triangles;
  auto bytes = compiler::compiled(*scene, compile, session.log());
  if (!bytes) return failed;
  auto model = pan::Model::from_bytes(*bytes, path, session.log());
  if (!model || !model->check(session.log())) return failed;
  return model;
}

}  // namespace panwright::tools
