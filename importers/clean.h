// Cleaning of imported scenes; their unit, axes and place.
#pragma once

#include <optional>
#include <string_view>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "base/work_cache.h"
#include "geometry/mesh/clean.h"
#include "importers/import.h"
#include "importers/mesh_report.h"

namespace panwright::importers {

// Cleans every mesh of a scene once, however many instances share it. Exact shapes stay as they
// are. Meshes that end without triangles are left out with their instances and decals.
//
//   scene    in its place (see place()): lengths and spots are told in its world
//   options  lengths in the world; a mesh takes the smallest that its instances ask for
//   cache    of meshes that were cleaned before; null: none. It changes nothing
//
// Reports: N6301, W6302, W6303, W6305, once each for the scene. Fails: E0001, with a scene that is
// of no more use.
Result<MeshReport> clean_up(scene::Scene& scene, const geometry::CleanOptions& options,
                            DiagnosticLog& log, const Job& job = {},
                            const WorkCache* cache = nullptr);

// Bounds in the world, of meshes by their vertices and of exact shapes by their tessellation to
// a hundredth of their size.
struct Bounds {
  Vec3 low{0};
  Vec3 high{0};
  bool any = false;
  double largest_extent() const;
};
Bounds bounds_of(const scene::Scene& scene);

// The unit that makes a spacecraft of a model of some size.
struct UnitGuess {
  double unit = 1;              // metres
  std::string_view name = "m";  // as --units takes it
  bool plausible = true;        // false: no unit does; it stays as written
};
UnitGuess guessed_unit(double largest_extent);

// A unit by its name: um, mm, cm, dm, m, km, in, ft, yd. Nothing for another name.
std::optional<double> unit_of(std::string_view name);

// An axis by its name: y, z. Nothing for another name.
std::optional<UpAxis> up_of(std::string_view name);

// Gives a scene its unit, its axes and its place by a node "model" between the root and what stands
// at the top, which is there only where something changes.
//
//   unit      metres; none: what the file says, else what its format prescribes, unless its size
//             tells otherwise. Reports W6006 where the unit is assumed or the size unlikely
//   up        none: usual_up()
//   recentre  whether the middle of the bounds comes to the origin
//   returns   how far the model was moved, in metres of the scene
Vec3 place(Imported& model, std::optional<double> unit, std::optional<UpAxis> up, bool recentre,
           DiagnosticLog& log);

}  // namespace panwright::importers
