// Blankets: sheets of foil draped over chosen faces of a mesh.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/job.h"
#include "base/result.h"
#include "geometry/mesh.h"
#include "mli/recipe.h"
#include "mli/statistics.h"
#include "mli/trim.h"

namespace panwright::mli {

// Recipe of a sheet at least as wide and high (metres). seed_offset: 0, 1, … by group, so that no
// two groups have the same sheet.
using RecipeFor = std::function<Recipe(double width, double height, std::uint32_t seed_offset)>;

// Adapts the recipe to sheets of other sizes: its cells, and with them its wrinkles, keep their
// size in metres. Sheets have 32 cells across at least.
RecipeFor fitted(Recipe recipe);

struct WrapOptions;

// Returns the stand-off, metres, that keeps heights which were scaled by less than 1.
double enough_stand_off(const WrapOptions& options, double scale);

// Free distance to other parts from a place on the faces along a unit direction, metres, at most
// `most`, in the mesh's frame. Thread-safe.
using FreeRoom = std::function<double(const Vec3& from, const Vec3& along, double most)>;

// Reach of a blanket as a share of the distance to another part.
inline constexpr double kWrapReach = 0.75;

// Faces of other meshes with blankets, as in Corners, in the mesh's frame. Thread-safe.
struct OtherCorners {
  std::function<double(const Vec3& from, const Vec3& along, double most)> room;
  std::function<bool(const Vec3& a, const Vec3& b, double tolerance)> crossed;
};

// Reach of a blanket at an inner corner, as a share of the distance to the middle between two
// faces.
inline constexpr double kCornerReach = 0.9;

struct WrapOptions {
  double stand_off = 0;  // metres from the faces to the blanket's mean height, above 0
  double border = 0;  // metres of fade-out at the border; 0: three times the stand-off, at most a
                      // quarter of the root of the group's area
  double margin = 0;  // metres of clearance below the lowest place; 0: a tenth of the stand-off
  double tolerance = 0;  // metres from a plane; 0: 1e-3 of a group's diagonal
  double weld = 0;       // metres within which vertices are welded; 0: 1e-6 of the mesh's diagonal
  double crease_angle = 35 * kDegree;  // limit between facets of one group
  double tape = 0;    // metres of tape from a group's border, its seams included; at most an eighth
                      // of the root of the group's area; 0: no tape
  bool edge = false;  // seams are Cover::edge: cut blankets, not closed ones
  double normals =
      0;  // radians, of compute_normals(); 0: the blanket has no normals, and no levels
  std::uint32_t levels = 0;    // coarser blankets, at most
  double max_triangles = 4e6;  // of all blankets together
  FreeRoom room = {};          // empty: no other parts
  OtherCorners corners = {};   // empty: no other blankets
  // false: the caller reports refusals and scaling (WrapTally), and no blanket at all is no failure
  bool tell = true;
};

enum class GroupKind : std::uint8_t { planar, cylinder, cone, curved, non_manifold, no_sheet };
std::string_view name_of(GroupKind kind);  // "planar", "curved"…

// Connected faces with one blanket, or none.
struct WrapGroup {
  GroupKind kind = GroupKind::curved;
  bool accepted = false;
  double area = 0;                   // m², of the faces
  Vec3 middle{0};                    // of them, metres
  std::vector<std::uint32_t> faces;  // indices of the mesh's triangles, ascending
  std::size_t first = 0, count = 0;  // triangles of the blanket, its seams included
  double scale = 1;                  // of the heights, below 1 if they met the base
  double mean = 0;                   // metres subtracted from the sheet's heights
  double held = 0;                   // m² lowered below other parts
  double cornered = 0;               // m² lowered beside another blanket's faces
  std::string reason;                // of a refusal
  // of the accepted sheet, with `scale` applied
  Recipe recipe;
  Statistics statistics;
};

// Blankets with longer edges, for pixel footprints of `detail` or more.
struct WrapLevel {
  geometry::Mesh blanket;     // with normals
  std::vector<Cover> covers;  // per triangle
  double detail = 0;          // metres
  // Metres: an upper bound of the distance from the finest one, the larger of both heights.
  double error = 0;
};

struct Wrap {
  // Blankets, counter-clockwise from outside; texture coordinates are positions on the flat group,
  // metres. Open at the seams' ends on the faces.
  geometry::Mesh blanket;
  std::vector<Vec3> roots;                     // per position: the places on the faces below
  std::vector<Cover> covers;                   // per triangle
  std::vector<WrapLevel> levels;               // from the finest
  std::vector<WrapGroup> groups;               // in order of search
  double area_accepted = 0, area_refused = 0;  // m²
  std::size_t without_area = 0;                // faces left out
};

// Summary of omissions and changes of several wraps.
struct WrapTally {
  std::size_t groups = 0, refused = 0, scaled = 0;
  double area = 0, area_refused = 0, held = 0;  // m²
  double least = 1;                             // of the scales
  std::map<std::string, std::size_t> reasons;   // of refusals

  void add(const Wrap& wrap);
  void add(const WrapTally& other);
  std::string refusals() const;  // a sentence; empty: nothing refused
  // enough: metres of stand-off that keep the heights
  std::string scalings(double enough) const;
  std::string holds() const;
};

// Drapes blankets over chosen faces, which stay as they are.
//
// Vertices are welded. Neighbours whose normals differ by at most the crease angle form a group. A
// group whose vertices lie on a plane, a cylinder or a cone is accepted, whatever its outline and
// holes. From a curved group, planar parts of 5 % of its area and more become groups of their own.
// A group with non-manifold or differently wound edges is refused. Faces of an accepted group are
// halved until no edge is longer than 1.5 cells of the sheet; so the blanket ends on the group's
// border and is conforming. A vertex is lifted along the normal by stand-off + height; heights fade
// out at the border, and a seam goes from there straight down to the base. Their mean by area is
// made 0, then they are scaled if one would lie below `margin`. If another part is nearer (`room`),
// the blanket passes below it, at three quarters of the way, with all adjacent vertices. It rises
// from there by at most half a metre per metre. If faces with blankets meet at an inner edge, or
// face each other, each blanket keeps to its own half (Corners), nine tenths of the way: both come
// down to the edge. Equal input gives equal bits; a moved mesh the moved blanket, to rounding.
//
// Levels are the same heights on edges of two, four, … times the cells, so that no further place
// meets the base. Their normals are those of the finest blanket at their vertices, tilted (TiltMap)
// to the same distribution of shaded slopes: variance and level share. A level is left out with
// fewer than 2,000 triangles, or more than 0.6 of those of the one before. It is also left out with
// an error of either above 3 %, or of the level share for narrow lobes above 5 %.
//
//   faces    indices of the mesh's triangles; repeated ones count once
//   returns  a blanket for one group at least
//
// Fails: E7001: an invalid number, no face, a face or corner that does not exist, a position that
// is not finite, no group accepted, more than max_triangles; E0001. Reports: W7002 with number,
// area and reasons of refusals, and for scaled heights. Cost: O(faces + triangles of the
// blankets), and the sheets, one at a time.
Result<Wrap> wrapped(const geometry::Mesh& mesh, std::span<const std::uint32_t> faces,
                     const RecipeFor& recipe, const WrapOptions& options, DiagnosticLog& log,
                     const SourceSpan& where = {}, const Job& job = {});

}  // namespace panwright::mli
