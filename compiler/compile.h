// Compiler: scene → pan.
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
  std::uint64_t max_triangles = 1ull << 27;  // of all meshes; 2^25 of a shape by formula at most
  bool strip_sources = false;                // leaves out the source map
  bool check_size = false;   // warns of sizes unlikely for spacecraft and parts: W2022, W2023
  bool mesh_levels = false;  // levels of detail of all larger meshes, not only of foil
  pan::StorageForm storage;  // of the file; streams of meshes are part of the identity
  std::string origin;        // import options that the inputs do not record: " units=mm"
  // Cache of earlier compilations; null: none. It changes no byte.
  const WorkCache* cache = nullptr;
};

// A mesh of the file, all instances together.
struct PartReport {
  std::string mesh;  // its name in the file
  std::string name;  // of the first node that shows it
  std::uint64_t instances = 0;
  std::uint64_t triangles = 0;  // instances counted
  std::uint64_t bytes = 0;      // of vertices and indices, as a GPU needs them
  double nearest = 0;           // metres: nearest distance of a camera; 0: not given
  double asked = 0;             // metres, in the world; 0: as given
  double achieved = 0;          // metres, in the world
  std::string reason;           // of the asked tolerance: pan::reason_name
  double seconds = 0;           // of one core, for tessellation
};

// Errors and size of meshes stored as streams.
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
      0;          // bound, of the model's: error of shapes, weighted by their flux; with flux
  FitReport fit;  // reductions allowed by the budget
  std::vector<PartReport> parts;  // triangles and bytes by part, from the most triangles
  StorageReport storage;          // 0 unless meshes are stored as streams
  double seconds_tessellate = 0;
  double seconds_write = 0;  // without the final fsync
  double seconds_sync = 0;
};

// Compiles a scene and writes it, atomically. Equal scenes and options give equal bytes, whatever
// the number of threads. An invalid shape is reported and left out with its decals; the others are
// written.
//
// The tolerance of a mesh is decided by compiler/tolerance.h, in metres in the world. Equal shapes
// with equal texture mappings are stored once, for the smallest tolerance of their instances
// divided by its stretch. Details below the budget are left out (compiler/fit.h). Surfaces of
// revolution that meet at a circular edge get the same vertices there. The budget and the tolerance
// of each mesh are stored when the scene, an instance or max_error gives one.
//
// Quantised storage is part of the error: it may take a quarter of a tolerance, tessellation the
// rest, and meshes that need more bits get them.
//
// Fails: E0001, E0103, E2003, E2010.
Result<Report> compile(const scene::Scene& scene, const Options& options,
                       const std::filesystem::path& output, DiagnosticLog& log,
                       const Job& job = {});

// Compiles to the same bytes, in memory.
//
// Fails: E0001, E2003, E2010.
Result<std::vector<std::byte>> compiled(const scene::Scene& scene, const Options& options,
                                        DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::compiler
