// Scene → pan.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "base/work_cache.h"
#include "compiler/fit.h"
#include "pan/storage.h"
#include "scene/scene.h"

namespace panwright::compiler {

struct Options {
  std::optional<double> max_error;           // metres in the world: overrides the scene's budget
  std::uint64_t max_triangles = 1ull << 27;  // of all meshes in the file together
  bool strip_sources = false;                // leaves out the source map
  bool check_size = false;   // reports sizes that no spacecraft and its parts have: W2022, W2023
  bool mesh_levels = false;  // levels of detail of all larger meshes, not of foil alone
  pan::StorageForm storage;  // of the file; streams of meshes are part of the identity
  std::string origin;        // import options that the inputs do not record: " units=mm"
  // Of what earlier compilations made; null: none. It changes no byte.
  const WorkCache* cache = nullptr;
};

// A mesh of the file, all instances together.
struct PartReport {
  std::string mesh;  // its name in the file
  std::string name;  // of the first node that shows it
  std::uint64_t instances = 0;
  std::uint64_t triangles = 0;  // instances counted
  std::uint64_t bytes = 0;      // of vertices and indices, as a GPU needs them
  double nearest = 0;           // metres: the nearest that a camera comes; 0: not said
  double asked = 0;             // metres, in the world; 0: as given
  double achieved = 0;          // metres, in the world
  std::string reason;           // of what was asked: pan::reason_name
  double seconds = 0;           // of one core, to make it
};

// What storing meshes as streams has cost.
struct StorageReport {
  double position_error = 0;  // metres in the frame of a mesh: no vertex moved further
  double normal_error = 0;    // radians: no normal turned further
  std::uint64_t bytes = 0;    // of positions, normals and indices in the file
  std::uint64_t meshes_with_more_bits = 0;  // than asked, or floats, for the budget
};

// The result of a compilation.
struct Report {
  std::uint64_t unique_meshes = 0;
  std::uint64_t instances = 0;
  std::uint64_t triangles = 0;         // instances counted
  std::uint64_t unique_triangles = 0;  // in the file
  std::uint64_t levels = 0;            // of detail, of instances
  std::uint64_t bytes = 0;             // of the file
  double worst_error = 0;              // metres, in the mesh's own frame; levels left out
  double flux_shapes =
      0;          // bound, of the model's: what shapes are off, by what they send; with flux
  FitReport fit;  // what the budget let go
  std::vector<PartReport> parts;  // where triangles and bytes are, from the most triangles
  StorageReport storage;          // 0 unless meshes are stored as streams
  double seconds_tessellate = 0;
  double seconds_write = 0;  // without the final fsync
  double seconds_sync = 0;
};

// Compiles a scene and writes it, atomically. Equal scenes and options give equal bytes, whatever
// the number of threads. A shape that cannot be made is reported and left out with the decals on
// it, the others are written.
//
// How closely a mesh follows its shape is decided by compiler/tolerance.h, in metres in the world.
// Equal shapes with equal needs of texture are stored once, for the smallest tolerance of their
// instances, divided by how far each is stretched into the world. What the budget lets the model do
// without is left out (compiler/fit.h). Surfaces of revolution that meet
// at a circular edge get the same vertices there. The budget and the tolerance of each mesh are
// stored when the scene, an instance or max_error gives one.
//
// Storage of few bits is part of the error: it may take a quarter of a tolerance, which the
// tessellation then does without, and meshes that need more bits get them.
//
// Fails: E0001, E0103, E2003, E2010.
Result<Report> compile(const scene::Scene& scene, const Options& options,
                       const std::filesystem::path& output, DiagnosticLog& log,
                       const Job& job = {});

// The same bytes, in memory.
//
// Fails: E0001, E2003, E2010.
Result<std::vector<std::byte>> compiled(const scene::Scene& scene, const Options& options,
                                        DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::compiler
