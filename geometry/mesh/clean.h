// Repair of imported meshes.
#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "geometry/mesh.h"

namespace panwright::geometry {

struct CleanOptions {
  bool weld = true;
  double tolerance = 0;  // metres; 0: welds only vertices at equal positions
  // Drops triangles without area (as in MeshReport), except those with three distinct corners that
  // connect a surface.
  bool drop_degenerate = true;
  // Drops triangles with the same corners as an earlier one. Back-to-back pairs, CAD's two-sided
  // sheets, are dropped only if colours and texture coordinates agree.
  bool drop_duplicates = true;
  bool orient = true;
  bool fill_holes = false;
  double crease_angle = 0.5235987755982988;  // radians (30 degrees): see compute_normals()
  bool keep_normals = true;                  // of the mesh; else all are recomputed
  bool reorder = true;                       // for the caches of GPUs; removes unused vertices
  bool examine = true;                       // searches for T-junctions and holes
  double junction = 0;                       // metres to an edge; 0: 1e-6 of the mesh's diagonal
  std::uint32_t max_spots = 64;              // kept for each kind, the longest or first
};

enum class SpotKind : std::uint8_t { non_manifold_edge, hole, t_junction, flipped };

// The location of a problem.
struct Spot {
  SpotKind kind = SpotKind::hole;
  Vec3 at{0};         // the middle of the problem, in the mesh's frame
  double length = 0;  // metres: of the edge, of the hole's boundary loop; of a flipped component
                      // the root of its area
  std::uint64_t size = 0;  // edges of a hole's boundary loop, faces of a component or at an edge
};

struct CleanReport {
  std::uint64_t vertices_before = 0;
  std::uint64_t vertices_after = 0;
  std::uint64_t triangles_before = 0;
  std::uint64_t triangles_after = 0;
  std::uint64_t welded = 0;  // vertices merged into another one
  double largest_move = 0;   // metres, of a vertex; ≤ tolerance
  std::uint64_t degenerate = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t flipped = 0;         // triangles
  std::uint64_t normals_turned = 0;  // triangles whose normals pointed away from their outside
  std::uint64_t components = 0;      // connected by edges that two triangles share
  std::uint64_t closed_components = 0;
  std::uint64_t one_sided = 0;  // components without two sides, such as Möbius strips: left alone
  std::uint64_t non_manifold_edges = 0;  // shared by three triangles or more
  std::uint64_t border_edges = 0;        // of one triangle
  std::uint64_t boundary_loops = 0;      // closed loops of border edges
  std::uint64_t holes = 0;   // boundary loops whose length² is below the area of their component
  double hole_length = 0;    // metres, of their boundary loops
  std::uint64_t filled = 0;  // holes
  std::uint64_t t_junctions = 0;  // border vertices inside other border edges; a lower bound
  std::vector<Spot> spots;        // by kind, limited by max_spots
};

// Welds, drops, orients, fills, computes normals and reorders, in this order.
//
// Welding takes vertices in order: each joins the first kept vertex within the tolerance, so none
// moves further. Vertices that differ in normal, texture coordinates or colour stay separate, at
// the same position. Orientation: neighbours across an edge that two triangles share are wound
// alike. Closed components then enclose a positive volume. An open component is flipped if the
// cones from its centroid give a negative volume and most rays from outside hit its back; else it
// keeps the winding of most of its area. Given normals are flipped where they then point away from
// the outside of their triangle, on the mean of its corners. Equal meshes give equal bytes,
// whatever the number of threads.
//
//   mesh  closed is set anew; error grows by the largest move
//   job   polled between the steps; when cancelled, Cancelled is thrown and the mesh is unusable
//
// Expects: a mesh without bad lengths, bad indices or numbers that are not finite (check()); V +
// 3*T < 2^32. Cost: O(V + T) expected; 250 bytes a triangle. Reordering: Sander, Nehab, Barczak,
// "Fast triangle reordering for vertex locality and reduced overdraw", 2007, in whole numbers.
CleanReport clean(Mesh& mesh, const CleanOptions& options, const Job& job = {});

}  // namespace panwright::geometry
