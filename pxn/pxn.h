// Reader of the pxn language: text → scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "base/work_cache.h"
#include "pxn/terrain.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Limits of a reader. Exceeding one is reported.
struct Limits {
  std::uint64_t bytes = 128ull << 20;      // of all files together; never 4 GiB or more
  std::uint64_t elements = 20'000'000;     // of all files together
  std::uint64_t nodes = 1'000'000;         // of the scene, includes multiplied out
  std::uint32_t depth = 256;               // of elements, includes counted; ≤ 1024
  std::uint32_t include_depth = 64;        // files inside files
  std::uint32_t includes = 10'000;         // of one model, includes multiplied out
  std::uint64_t texture_bytes = 1u << 30;  // of decoded textures together
};

struct Options {
  Limits limits;
  std::filesystem::path root;  // folder that includes may not leave; empty: the top file's
  // radians: larger angles between facets of meshes without normals stay sharp
  double crease_angle = 30 * kDegree;
  // values that replace those of <param>: name, and text as in its attribute
  std::vector<std::pair<std::string, std::string>> parameters;
  // if given, receives the names of all <param>, and an unknown name in `parameters` is no error:
  // another model may have it
  std::set<std::string>* declared = nullptr;
  // false: sheets of foil have only their finest mesh
  bool foil_levels = true;
  // of foil, materials and cleaned meshes; null: none. It does not change the scene
  const WorkCache* cache = nullptr;
  // if given, receives the terrain of the top file, which then has no nodes (E9613); else W9620
  std::optional<TerrainText>* terrain = nullptr;
  // unsaved texts of an editor that replace files on disk, by their paths, absolute and without
  // links; null: none. The files must exist
  const std::map<std::filesystem::path, std::shared_ptr<const std::string>>* unsaved = nullptr;
};

// Reads a pxn file with its includes.
//
//   returns  the readable part, valid by scene::check, if the top file has a known root element,
//            and the limits of elements and nodes hold; errors in the log mark it as incomplete.
//            Equal materials, spheres and textures are stored once, as are shapes of repeated
//            includes.
//
// Nodes: the root "root"; each group, transform, rotate and include, and each shape, as a node of
// its own; named "group1", "mesh2"… in the order of their kind, or by the stem of the included
// file.
//
// Fails: E0001, E01…, E1001, E1003, E1008, E1107. Reports E1…, W1…, N1…, E2…, W2…, N2…, E3….
// Cost: O(bytes); memory about 3 times the text.
[[nodiscard]] Result<scene::Scene> read(const std::filesystem::path& path, const Options& options,
                                        DiagnosticLog& log, const Job& job = {});

struct MemoryFile {
  std::string path;  // relative, '/' between parts
  std::string bytes;
};

// The same for files in memory, for tests and fuzzing: nothing is read from disk. The first file is
// the top one; includes find others by path.
//
// Expects: files not empty.
[[nodiscard]] Result<scene::Scene> read_memory(std::span<const MemoryFile> files,
                                               const Options& options, DiagnosticLog& log,
                                               const Job& job = {});

}  // namespace panwright::pxn
