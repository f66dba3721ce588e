// Report of mesh cleaning, for people, programs and pages with images.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/mesh/clean.h"

namespace panwright::importers {

// One mesh of the scene.
struct MeshQuality {
  std::uint32_t shape = 0;       // in scene.shapes
  std::uint32_t instance = 0;    // the first that uses it
  std::uint32_t instances = 0;   // number of users
  std::string path;              // of that instance's node: "body/panel[2]"
  geometry::CleanReport report;  // lengths in the world, of the largest instance; spots in the mesh
};

// Place of a problem, in the world.
struct WorldSpot {
  geometry::SpotKind kind = geometry::SpotKind::hole;
  Vec3 at{0};         // metres
  double length = 0;  // metres
  std::uint64_t size = 0;
  std::uint32_t mesh = 0;  // in MeshReport::meshes
};

struct MeshReport {
  std::vector<MeshQuality> meshes;  // those with triangles, in order of shapes
  geometry::CleanReport total;      // sums; largest move; no spots
  std::vector<WorldSpot> spots;     // worst first: by kind as in SpotKind, then by length
};

const char* kind_name(geometry::SpotKind kind);  // "hole"

// Returns a summary in a few lines, then a line for each mesh that is not clean.
std::string to_text(const MeshReport& mesh_report);

// {"schema":1,"total":{…},"meshes":[{"path","shape","instances",…}],"spots":[{"kind","at","length",
// "size","mesh"}]}; members of reports are named as in CleanReport.
std::string to_json(const MeshReport& mesh_report);

}  // namespace panwright::importers
