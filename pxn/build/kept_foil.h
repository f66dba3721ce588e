// Sheets and blankets of foil, kept between runs.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/work_cache.h"
#include "mli/wrap.h"
#include "pxn/build/obstacles.h"
#include "pxn/build/shapes.h"

namespace panwright::pxn {

// Meshes of a sheet, and what was said while they were made: of the recipe's place.
struct MadeFoil {
  FoilMeshes meshes;
  std::vector<Diagnostic> said;
};

// A sheet as `make` makes it, or the same from a cache.
//
//   cache  null: none
//   room   vertices that may be made. What takes no more than a quarter of it is the same with more
//   make   nothing: it failed
std::optional<MadeFoil> kept_or_made(const WorkCache* cache, const FoilSheet& foil,
                                     double crease_angle, double room,
                                     const std::function<std::optional<MadeFoil>()>& make);

// What is used of a mli::Wrap.
struct WovenFoil {
  geometry::Mesh blanket;
  std::vector<Vec3> roots;
  std::vector<char> taped;
  std::vector<mli::WrapLevel> levels;
  mli::WrapTally tally;
  // of the largest group that has one; the recipe has no operations
  mli::Recipe recipe;
  mli::Statistics statistics;
};
WovenFoil woven_from(mli::Wrap wrap);

// What a blanket follows from: the mesh and its faces, how it is made, and what is near.
struct WovenFrom {
  const geometry::Mesh& metres;
  const std::vector<std::uint32_t>& faces;
  std::vector<double> how;  // key_of(Blanket), cell, seed, angles: numbers without the room
  double room = 0;          // triangles that may be made
  const Obstacles& obstacles;
  std::int32_t of = 0;  // the instance that is covered
  Mat4 world_from_metres{1};
};

// A blanket as `make` makes it, or the same from a cache, whatever the scene has further away.
//
//   make  given a place to note how far the blanket asked for free room, metres; nothing: it failed
std::optional<WovenFoil> kept_or_woven(
    const WorkCache* cache, const WovenFrom& from,
    const std::function<std::optional<WovenFoil>(double& farthest)>& make);

}  // namespace panwright::pxn
