// Cleaning of imported scenes; their unit, axes and place.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "base/axis_box.h"
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
//   scene    placed (see place()): lengths and spots are in its world
//   options  lengths in the world; a mesh takes the smallest of its instances
//   cache    of cleaned meshes; null: none. It changes no result
//
// Reports: N6301, W6302, W6303, W6305, once each for the scene. Fails: E0001, leaving the scene
// unusable.
Result<MeshReport> clean_up(scene::Scene& scene, const geometry::CleanOptions& options,
                            DiagnosticLog& log, const Job& job = {},
                            const WorkCache* cache = nullptr);

// Returns the bounds in the world, of meshes by their vertices and of exact shapes by their
// tessellation to a hundredth of their size.
AxisBox bounds_of(const scene::Scene& scene);
// The same of each instance.
std::vector<AxisBox> instance_bounds(const scene::Scene& scene);

// Unit that gives a spacecraft's size to a model.
struct UnitGuess {
  double unit = 1;              // metres
  std::string_view name = "m";  // as in --units
  bool plausible = true;        // false: none is; the unit stays as written
};
UnitGuess guessed_unit(double largest_extent);

// Returns a unit by its name: um, mm, cm, dm, m, km, in, ft, yd. Nothing for another name.
std::optional<double> unit_of(std::string_view name);

// Returns an axis by its name: y, z. Nothing for another name.
std::optional<UpAxis> up_of(std::string_view name);

// Applies unit, axes and position to a scene by a node "model" below the root, added only if
// something changes.
//
//   unit      metres that a number of the file measures; none: the file's, else its format's,
//             unless the size contradicts. Reports W6006 if the unit is assumed or the size
//             unlikely, W6013 if the given one contradicts that of the file or of its format
//   up        none: usual_up()
//   recentre  moves the middle of the bounds to the origin
//   returns   displacement of the model, in metres of the scene
Vec3 place(Imported& model, std::optional<double> unit, std::optional<UpAxis> up, bool recentre,
           DiagnosticLog& log);

}  // namespace panwright::importers
