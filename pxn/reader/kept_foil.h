// Cache of sheets and blankets of foil between runs.
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

// Meshes of a sheet, and the diagnostics of their making, at the recipe's place.
struct MadeFoil {
  FoilMeshes meshes;
  std::vector<Diagnostic> said;
};

// Returns a sheet made by `make`, or the same from a cache.
//
//   cache  null: none
//   room   limit of vertices. Results within a quarter of it are the same with more
//   make   nothing: it failed
std::optional<MadeFoil> kept_or_made(const WorkCache* cache, const FoilSheet& foil,
                                     double crease_angle, double room,
                                     const std::function<std::optional<MadeFoil>()>& make);

// Largest queried distances from a blanket's faces, metres: for room below other parts, and for the
// faces of other blankets.
struct Asked {
  double parts = 0, corners = 0;
};

// Faces of a blanket in the world, and its possible obstacles.
struct Surroundings {
  const geometry::Mesh& metres;
  const std::vector<std::uint32_t>& faces;  // of the mesh
  Mat4 world_from_metres{1};
  std::int32_t of = 0;  // the covered instance
  const Obstacles& obstacles;
  const mli::Corners& corners;

  // Adds to a key all that a blanket can find within these distances, and the faces' place; nothing
  // without obstacles, when the place does not matter. Returns true if there are any.
  bool add_near(const Asked& asked, KeyHasher& key) const;
};

// Stored part of a mli::Wrap.
struct WovenFoil {
  FoilMeshes meshes;          // in the shape's frame; statistics as of `recipe`
  std::size_t triangles = 0;  // of the finest ones, tape and edges included
  mli::Recipe recipe;         // of the largest group with one, without its operations
  mli::WrapTally tally;
  bool cornered = false;  // lower at places beside another shape's blanket
  Asked asked;            // largest
  // if others may share it: its vertices and the places below them, metres
  std::vector<Vec3> tops, roots;
};
// shape_from_metres: of the covered shape. Leaves `cornered` and `asked` unchanged.
WovenFoil woven_from(mli::Wrap wrap, const Mat3& shape_from_metres);

// Inputs of a blanket.
struct WovenFrom {
  Surroundings around;
  Mat3 shape_from_metres{1};
  std::vector<double> how;  // key_of(Blanket), cell, seed, angles: numbers without the room
  double room = 0;          // limit of triangles
  bool shared = false;      // true: tops and roots are needed
};

// Returns a blanket made by `make`, or the same from a cache, independent of the scene beyond its
// queried distances.
//
//   cache  null: none
//   room   as above
//   make   nothing: it failed
std::optional<WovenFoil> kept_or_woven(const WorkCache* cache, const WovenFrom& from,
                                       const std::function<std::optional<WovenFoil>()>& make);

// Serialisation to bytes and back. Readers fail on bytes not from write().
//
//   returns  true if all of it could be written
//   places   of the present sheet
bool write(const MadeFoil& made, const mli::RecipePlaces& places, ByteWriter& to);
MadeFoil read_made(const mli::RecipePlaces& places, ByteReader& from);
// Writes without tops and roots.
void write(const WovenFoil& woven, ByteWriter& to);
WovenFoil read_woven(ByteReader& from);

}  // namespace panwright::pxn
