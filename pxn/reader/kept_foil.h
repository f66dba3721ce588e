// Sheets and blankets of foil, kept between runs.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/work_cache.h"
#include "mli/corners.h"
#include "mli/wrap.h"
#include "pxn/reader/obstacles.h"
#include "pxn/reader/shapes.h"

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

// How far a blanket asks from its faces, metres: for room below other parts, and for the faces of
// other blankets.
struct Asked {
  double parts = 0, corners = 0;
};

// The faces of a blanket in the world, and what may be in its way there.
struct Surroundings {
  const geometry::Mesh& metres;
  const std::vector<std::uint32_t>& faces;  // of the mesh
  Mat4 world_from_metres{1};
  std::int32_t of = 0;  // the instance that is covered
  const Obstacles& obstacles;
  const mli::Corners& corners;

  // Adds to a key what a blanket that asks so far can find, and where the faces are: not if there
  // is nothing, where the place does not matter. Returns whether there is anything.
  bool add_near(const Asked& asked, KeyHasher& key) const;
};

// What is used of a mli::Wrap.
struct WovenFoil {
  FoilMeshes meshes;          // in the shape's frame; statistics as of `recipe`
  std::size_t triangles = 0;  // of the finest ones, tape and edges included
  mli::Recipe recipe;         // of the largest group that has one, without its operations
  mli::WrapTally tally;
  bool cornered = false;  // lower somewhere, beside another shape's blanket
  Asked asked;            // at most
  // where others may share it: its vertices and the places below them, metres
  std::vector<Vec3> tops, roots;
};
// shape_from_metres: of the shape that is covered. Leaves `cornered` and `asked` as they are.
WovenFoil woven_from(mli::Wrap wrap, const Mat3& shape_from_metres);

// What a blanket follows from.
struct WovenFrom {
  Surroundings around;
  Mat3 shape_from_metres{1};
  std::vector<double> how;  // key_of(Blanket), cell, seed, angles: numbers without the room
  double room = 0;          // triangles that may be made
  bool shared = false;      // whether tops and roots are asked for
};

// A blanket as `make` makes it, or the same from a cache, whatever the scene has further away than
// it asks.
//
//   cache  null: none
//   room   as above
//   make   nothing: it failed
std::optional<WovenFoil> kept_or_woven(const WorkCache* cache, const WovenFrom& from,
                                       const std::function<std::optional<WovenFoil>()>& make);

// As bytes and back. The readers fail where it is nothing that write() had.
//
//   returns  whether all of it could be written
//   places   that the sheet has now
bool write(const MadeFoil& made, const mli::RecipePlaces& places, ByteWriter& to);
MadeFoil read_made(const mli::RecipePlaces& places, ByteReader& from);
// Without tops and roots.
void write(const WovenFoil& woven, ByteWriter& to);
WovenFoil read_woven(ByteReader& from);

}  // namespace panwright::pxn
