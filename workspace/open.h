// Opening of any file as a model: pan files mapped and checked, pxn and CAD files read, cleaned,
// compiled.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "base/work_cache.h"
#include "compiler/compile.h"
#include "compiler/hidden.h"
#include "importers/import.h"
#include "importers/mesh_report.h"
#include "pxn/terrain.h"
#include "scene/scene.h"
#include "world/world.h"

namespace panwright::workspace {

// Options of CAD imports, with the defaults of the importers.
struct CadOptions {
  std::string units = "auto";  // or m, mm, cm, dm, km, um, in, ft, yd
  std::string up = "auto";     // or y, z
  std::string scene;           // glTF: name or number; empty: the default one
  std::string animation;       // glTF: name, number or none; empty: importers::Options
  std::optional<double> time;  // glTF: seconds
  std::string assume;    // fallback format: vrml97, vrml1, gltf, obj, stl, ply, step, urdf, mjcf
  bool no_weld = false;  // keeps meshes unchanged
  double weld = 0;       // metres in the world
  double crease_deg = 30;
  std::uint32_t primitives = 0;  // VRML; 0: exact shapes
  double deflection = 0;         // STEP; metres, 0: by the model's size
  double max_seconds = 600;      // STEP; importers::Limits::seconds
  bool crease_normals = false;   // computed instead of those of the file
  bool keep_hidden = false;
  bool recentre = false;
};

struct OpenOptions {
  std::string root;  // folder that files named by the model may not leave; empty: the model's
  std::uint64_t max_input = 128ull << 20;  // bytes of pxn files in all
  // Replaces the model's budget, as of budget_of_text(); empty: the model's. Ranks below max_error.
  std::string budget;
  // Values that replace those of <param>: name, and text as in its attribute.
  std::vector<std::pair<std::string, std::string>> parameters;
  // pxn::Options::declared, and unknown parameters are no part of the model's identity
  std::set<std::string>* declared = nullptr;
  std::optional<double> max_error;  // metres in the world; none: from the model's budget
  std::uint64_t max_triangles = 1ull << 27;
  CadOptions cad;  // for models that are CAD files
  // Removes hidden geometry from imports with hidden="remove" (the default) and from CAD files
  // unless keep_hidden. Needless for a model shown once and not stored.
  bool prune = true;
  bool foil_levels = true;  // pxn::Options::foil_levels
  // pxn::Options::unsaved
  std::map<std::filesystem::path, std::shared_ptr<const std::string>> unsaved;
  // Cache folder of long work: hidden triangles, and the results of base/work_cache.h. It changes
  // no result. Empty: none; user_cache_folder(): the user's own.
  std::filesystem::path cache;
};

// Returns the user's cache folder: panwright in $XDG_CACHE_HOME, or in ~/.cache; $PANWRIGHT_CACHE
// names another folder, or none by "off". Empty: none, or no home.
std::filesystem::path user_cache_folder();

// One step and its duration.
struct Step {
  std::string name;  // "compile cubesat.pxn"
  double seconds = 0;
};

// Results of opening a file, or of a part of it. Calls add to it.
struct OpenReport {
  std::vector<Step> steps;
  std::optional<importers::MeshReport> mesh_report;  // of a CAD file cleaned in this run
  std::optional<compiler::HiddenReport> hidden;      // if geometry could be removed in it
  WorkCounts work;                                   // with a cache: its statistics
};

// Returns the extension in lower case, with its point. Empty: none.
std::string extension_of(const std::filesystem::path& path);

// Returns true if a file is one for the importers, by its extension or as gzip of another name.
bool is_cad(const std::filesystem::path& path);

// Reports E0202 for a file that is_cad() and the readers of .pan and .pxn do not recognise, with a
// converter for a known format; E0101 where there is no file.
void report_unknown_format(const std::filesystem::path& path, DiagnosticLog& log);

// Opens a file as a model that worlds, renderers and threads share. The reader is chosen by the
// extension: .pan is mapped and checked, but for the
// tiles of its terrain, which are checked when they are looked at; .pxn and CAD files are read,
// cleaned, pruned and compiled in memory, to the same bytes as `panwright compile` and `import`
// write; their terrain into a file without a name.
//
//   returns  a model that is checked()
// Fails: E0001, E0202; .pan: E01…, E4…; else E01…, E1…, E2…, E3…, E6…. For a partly readable text
// or CAD file, that part is returned, and the log has errors.
Result<world::ModelPtr> open(const std::filesystem::path& path, const OpenOptions& options,
                             DiagnosticLog& log, const Job& job = {}, OpenReport* report = nullptr);

// ---- the steps of it

// Reads a pxn or CAD file. Of the latter, instances may be pruned unless keep_hidden.
//
//   terrain  pxn::Options::terrain
// Fails: E0001, E01…, E1…, E6…; E0201 for an unknown value of a CAD option. Returns the readable
// part; errors in the log mark it as incomplete. Reports N1405 for options without effect on the
// file.
Result<scene::Scene> read_scene(const std::filesystem::path& path, const OpenOptions& options,
                                DiagnosticLog& log, const Job& job = {},
                                OpenReport* report = nullptr,
                                std::optional<pxn::TerrainText>* terrain = nullptr);

// Reads a CAD file, places it and cleans it.
Result<importers::Imported> read_cad(const std::filesystem::path& path, const OpenOptions& options,
                                     DiagnosticLog& log, const Job& job = {},
                                     OpenReport* report = nullptr);

// Removes hidden geometry of prunable instances.
//
//   returns  true if there was any
// Fails: E0001, leaving the scene unchanged.
Result<bool> prune(scene::Scene& scene, const OpenOptions& options, DiagnosticLog& log,
                   const Job& job = {}, OpenReport* report = nullptr);

// Options of writing a pan file.
struct WriteOptions {
  std::string output;  // .pan; "-": standard output
  bool strip_sources = false;
  bool mesh_levels = false;  // compiler::Options
  pan::StorageForm storage;  // compiler::Options
  bool check_size = false;   // W2022, W2023, unless the log has W6006 or errors
  std::string origin;        // import options that the inputs do not record
};

// Prunes a scene and writes it atomically as a pan file.
//
// Fails: E0001, E0103, E2003, E2010.
Result<compiler::Report> write_pan(scene::Scene& scene, const OpenOptions& options,
                                   const WriteOptions& write, DiagnosticLog& log,
                                   const Job& job = {}, OpenReport* report = nullptr);

}  // namespace panwright::workspace
