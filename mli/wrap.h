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

// The recipe of a sheet at least so wide and high (metres). seed_offset: 0, 1, … by group, so that
// no two groups wear the same sheet.
using RecipeFor = std::function<Recipe(double width, double height, std::uint32_t seed_offset)>;

// The recipe on sheets of other sizes: its cells, and with them its wrinkles, keep their size in
// metres. Sheets have 32 cells across at least.
RecipeFor fitted(Recipe recipe);

// Metres that are free of other parts from a place on the faces along a unit direction, at most
// `most`, in the mesh's frame. Called from several threads.
using FreeRoom = std::function<double(const Vec3& from, const Vec3& along, double most)>;

// Of the way to another part: how far a blanket reaches.
inline constexpr double kWrapReach = 0.75;

// Faces of other meshes that wear blankets, as Corners has them, in the mesh's frame. Called from
// several threads.
struct OtherCorners {
  std::function<double(const Vec3& from, const Vec3& along, double most)> room;
  std::function<bool(const Vec3& a, const Vec3& b, double tolerance)> crossed;
};

// Of the way to the middle between two faces at an inner corner: how far a blanket reaches.
inline constexpr double kCornerReach = 0.9;

struct WrapOptions {
  double stand_off = 0;  // metres from the faces to the blanket's mean height, above 0
  double border = 0;     // metres over which heights fade out; 0: three times the stand-off, at
                         // most a quarter of the root of the group's area
  double margin = 0;     // metres that lie below the lowest place; 0: a tenth of the stand-off
  double tolerance = 0;  // metres from a plane; 0: 1e-3 of a group's diagonal
  double weld = 0;       // metres between vertices that are one; 0: 1e-6 of the mesh's diagonal
  double crease_angle = 35 * kDegree;  // groups end where facets meet at more
  double tape = 0;  // metres from a group's border that are taped, its seams too; at most an eighth
                    // of the root of the group's area; 0: no tape
  bool edge = false;  // seams are Cover::edge: blankets that end cut, not closed
  double normals =
      0;  // radians, of compute_normals(); 0: the blanket has no normals, and no levels
  std::uint32_t levels = 0;    // coarser blankets, at most
  double max_triangles = 4e6;  // of all blankets together
  FreeRoom room = {};          // empty: nothing else is there
  OtherCorners corners = {};   // empty: nothing else wears a blanket
  // false: what is refused or scaled is for the caller to say (WrapTally), and no blanket at all is
  // no failure
  bool tell = true;
};

enum class GroupKind : std::uint8_t { planar, cylinder, cone, curved, non_manifold, no_sheet };
std::string_view name_of(GroupKind kind);  // "planar", "curved"…

// Connected faces that wear one blanket, or none.
struct WrapGroup {
  GroupKind kind = GroupKind::curved;
  bool accepted = false;
  double area = 0;                   // m², of the faces
  Vec3 middle{0};                    // of them, metres
  std::vector<std::uint32_t> faces;  // indices of the mesh's triangles, ascending
  std::size_t first = 0, count = 0;  // triangles of the blanket, its seams included
  double scale = 1;                  // of the heights, below 1 where they met the base
  double mean = 0;                   // metres that the sheet's heights are lowered by
  double held = 0;                   // m² that lie lower, below other parts
  double cornered = 0;               // m² that lie lower, beside another blanket's faces
  std::string reason;                // of a refusal
  // of the sheet, where it is accepted; as it is worn, `scale` included
  Recipe recipe;
  Statistics statistics;
};

// All blankets with longer edges: for pixels that see `detail` or more.
struct WrapLevel {
  geometry::Mesh blanket;     // with normals
  std::vector<Cover> covers;  // of its triangles
  double detail = 0;          // metres
  // Metres: an upper bound of the distance from the finest one, the larger of both heights.
  double error = 0;
};

struct Wrap {
  // Counter-clockwise from outside; texture coordinates are the place on the flat group, metres.
  // Open where the seams meet the faces.
  geometry::Mesh blanket;
  std::vector<Vec3> roots;                     // of its positions: the places on the faces below
  std::vector<Cover> covers;                   // of its triangles
  std::vector<WrapLevel> levels;               // from the finest
  std::vector<WrapGroup> groups;               // in order of search
  double area_accepted = 0, area_refused = 0;  // m²
  std::size_t without_area = 0;                // faces that were left out
};

// What several wraps together left out or changed.
struct WrapTally {
  std::size_t groups = 0, refused = 0, scaled = 0;
  double area = 0, area_refused = 0, held = 0;  // m²
  double least = 1;                             // of the scales
  std::map<std::string, std::size_t> reasons;   // of refusals

  void add(const Wrap& wrap);
  void add(const WrapTally& other);
  std::string refusals() const;  // a sentence; empty: nothing refused
  std::string scalings() const;
  std::string holds() const;
};

// Drapes blankets over chosen faces, which stay as they are.
//
// Vertices are welded. Faces across whose common edge the normal turns by no more than the crease
// angle are a group. A group whose vertices lie on a plane, a cylinder or a cone is accepted,
// whatever its outline and holes. From a curved group, planar parts of 5 % of its
// area and more are taken as groups of their own. Faces at an edge that three share, or two that
// are wound differently, refuse their group. Each face of an accepted group is cut in halves until
// no edge is longer than 1.5 cells of the sheet; so the blanket ends on the group's border and is
// conforming. A vertex is lifted along the normal by stand-off + height; heights fade out at the
// border, and a seam goes from there straight down to the base. Their mean by area is made 0, then
// they are scaled where one would lie below `margin`. Where another part is nearer than that
// (`room`), the blanket goes below it, at three quarters of the way, with all vertices beside one
// that does, and rises from there by no more than half a metre a metre. Where faces that wear
// blankets meet at an inner edge, or look at each other, each blanket keeps to what is nearer to
// its own (Corners), nine tenths of the way: both come down to the edge. Equal input gives equal
// bits; a moved mesh the moved blanket, to rounding.
//
// Levels are the same heights on edges of two, four, … times the cells, so that nothing meets the
// base that did not. Their normals are those of the finest blanket at their vertices, leant
// (TiltMap) until the slopes that light sees are distributed as there: variance and share about
// level. There are none with fewer than 2,000 triangles, with more than 0.6 of those of the one
// before, and where either is off by more than 3 %, or what lies level for narrow lobes by 5 %.
//
//   faces    indices of the mesh's triangles; repeated ones count once
//   returns  a blanket for one group at least
//
// Fails: E7001: a number that cannot be, no face, a face or corner that does not exist, a position
// that is not finite, no group accepted, more than max_triangles; E0001. Reports: W7002 with
// number, area and reasons of what is refused, and where heights were scaled. Cost: O(faces +
// triangles of the blankets), and the sheets, one at a time.
Result<Wrap> wrapped(const geometry::Mesh& mesh, std::span<const std::uint32_t> faces,
                     const RecipeFor& recipe, const WrapOptions& options, DiagnosticLog& log,
                     const SourceSpan& where = {}, const Job& job = {});

}  // namespace panwright::mli
