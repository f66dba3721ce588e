// Importers of CAD files: VRML 97, VRML 1.0, glTF 2.0 and GLB, OBJ, STL, PLY, STEP, URDF, MJCF →
// scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "importers/files.h"
#include "scene/scene.h"

namespace panwright::importers {

enum class Format : std::uint8_t { vrml97, vrml1, gltf, obj, stl, ply, step, urdf, mjcf };

// Limits of a reader. Exceeding one is E6002.
struct Limits {
  std::uint64_t bytes = 0xfffffffe;   // of all files together, unpacked; source places have 32 bits
  std::uint64_t memory = 8ull << 30;  // of arrays in memory
  std::uint64_t nodes = 1'000'000;    // of the scene, shared parts multiplied out
  std::uint64_t triangles = 1ull << 27;    // of all meshes together
  std::uint32_t depth = 256;               // of nodes
  std::uint32_t files = 10'000;            // inlines, prototypes, buffers and textures
  std::uint64_t texture_bytes = 1u << 30;  // of decoded textures together
  // STEP: processor time of the reading process; at most four times as long by the clock
  double seconds = 600;
};

// Axis of the file that becomes the scene's +z. y: (x, y, z) → (x, −z, y).
enum class UpAxis : std::uint8_t { y, z };

// Returns the axis that points up in most files of a format: z in STL, PLY, STEP, URDF and MJCF, y
// in the others.
UpAxis usual_up(Format format);

// Returns true if STEP files can be read: needs the program `panwright-step`, which is built with
// OpenCASCADE. It is found by PANWRIGHT_STEP_READER (its path), beside the running program, or in
// the installation.
bool reads_step();

struct Options {
  Limits limits;
  std::filesystem::path
      root;  // files named by the model lie in this folder; empty: the model's own
  std::optional<std::string> scene;  // glTF: a scene's name or number; none: the default one
  // glTF: the animation to apply, by name or number, or "none" for the nodes' own transforms; and
  // its time, in seconds. Default: all animations at their first frame, for nodes with another pose
  // at rest (N6216).
  std::optional<std::string> animation;
  std::optional<double> time;
  std::uint32_t primitives = 0;  // VRML: segments around surfaces of revolution; 0: exact shapes
  double crease_angle =
      30 * kDegree;  // radians, for meshes whose file gives neither normals nor a crease angle
  double deflection =
      0;  // STEP: metres, largest distance of triangles from surfaces; 0: 1e-4 of the size
  bool textures = true;          // textures are read
  std::optional<Format> assume;  // for a file without a telling header
};

// Property of a file that scenes do not have.
struct LostProperty {
  std::string what;
  SourceSpan where;  // in the log of the reading
};

// Properties of a CAD material beyond the scene's material. Linear colours.
struct CadMaterial {
  std::string name;  // as in the file; may be empty or repeated
  Vec3 base_color{0.8};
  double metallic = 0;       // 0 to 1
  double roughness = 1;      // 0 to 1, perceptual
  double opacity = 1;        // 0 to 1; 0: not visible
  bool see_through = false;  // partly transparent in other ways: textures, transmission
  bool textured = false;
  std::int32_t palette = -1;       // texture of the scene that gave its colour, by split_palettes()
  std::vector<LostProperty> lost;  // absent from the scene's material
  SourceSpan where;                // first use or definition, in the log of the reading
  std::string object;              // glTF: "/materials/3"
};

// A file as imported: its own axes and unit, its own shapes, nothing cleaned. Names are kept;
// unnamed nodes are named by kind and number ("Shape3", "mesh2"), and "/" becomes "_". Equal
// materials and shared shapes are stored once. The root is named "root" and has the identity as
// transform.
struct Imported {
  Format format = Format::gltf;
  bool in_metres = false;  // the file gives its unit or should, and lengths are metres by it
  // Metres of a number of the file, if in_metres. 0: the file has several units.
  double file_unit = 1;
  bool lacks_unit = false;   // file_unit is assumed
  bool z_up = false;         // unlike its format, as in glTF files that panwright wrote
  std::string assumed_unit;  // by place(), if neither file nor caller gives it: "mm"
  scene::Scene scene;
  std::vector<CadMaterial> materials;  // one for each of scene.materials
};

// Reads a CAD file and all files that it names. The format follows from its first bytes; OBJ and
// binary STL, which have no mark, from the name's extension. gzip is unpacked whatever the file's
// name.
//
//   returns  the readable part, valid by scene::check; errors in the log mark it as incomplete.
//
// Fails: E0001, E01…, E6001, E6002, E6003, E6101, E6201 to E6205, E6209, E6217, E6220, E6501,
// E6601. Reports E6…, W6…, N6…. Cost: O(bytes); memory about 3 times the scene's arrays.
[[nodiscard]] Result<Imported> import_file(const std::filesystem::path& path,
                                           const Options& options, DiagnosticLog& log,
                                           const Job& job = {});

// The same for files in memory, for tests and fuzzing: the first is the model.
//
// Expects: files not empty.
[[nodiscard]] Result<Imported> import_memory(std::span<const MemoryFile> files,
                                             const Options& options, DiagnosticLog& log,
                                             const Job& job = {});

// The same for the file `path` among `files`.
[[nodiscard]] Result<Imported> import_from(Files& files, const std::string& path,
                                           const Options& options, DiagnosticLog& log,
                                           SourceSpan included_at = {}, const Job& job = {});

}  // namespace panwright::importers
