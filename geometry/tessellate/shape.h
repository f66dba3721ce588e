// Exact shapes, as authored.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/diagnostic.h"
#include "base/hash.h"
#include "geometry/mesh.h"

namespace panwright::geometry {

// All shapes stand about the origin, their axis on z unless stated otherwise; lengths in metres,
// angles in radians. Plain data, validated by problem_of(). Shapes with texture coordinates by
// parameter name them; (0, 0) is the texture's bottom left, and u runs eastward, counter-clockwise
// seen from +z, so that textures are not mirrored from outside.

// Angles about the z axis, from the first to the last, counter-clockwise from +x.
struct Sector {
  double begin = 0;
  double end = 2 * kPi;  // begin < end ≤ begin + 2π
  bool whole() const { return end - begin >= 2 * kPi * (1 - 1e-12); }
  bool operator==(const Sector&) const = default;
};

// Explicit tessellation; 0: by the allowed error. Given counts are obeyed exactly, and vertices
// then stand on the shape.
struct Counts {
  std::uint32_t around = 0;  // segments about the axis, over the sector; ≥ 3 for a whole turn
  std::uint32_t along = 0;   // segments along a curved profile
  bool operator==(const Counts&) const = default;
};

// Ends of a shape along z covered by a flat face.
enum class Caps : std::uint8_t { both, none, bottom, top };

// Explicit tessellation of a sphere: latitude bands from pole to pole, and segments around the
// axis, the first meridian at +x. 2·quads·(rings−1) triangles.
struct SphereCounts {
  std::uint32_t rings;  // ≥ 2
  std::uint32_t quads;  // ≥ 3
  bool operator==(const SphereCounts&) const = default;
};

// A sphere about the origin, poles on ±z, or the part of it between two latitudes in a sector: an
// open surface then. u = longitude over the sector, v = latitude from lowest to highest.
struct Sphere {
  double radius = 1;                   // > 0
  std::optional<SphereCounts> counts;  // none: by the allowed error
  double latitude_min = -kPi / 2;      // −π/2 ≤ min < max ≤ π/2
  double latitude_max = kPi / 2;
  Sector sector = {};
  bool whole() const {
    return sector.whole() && latitude_min <= -kPi / 2 && latitude_max >= kPi / 2;
  }
  bool operator==(const Sphere&) const = default;
};

// Ellipsoid. u, v as for the sphere: x = a cos v cos u, y = b cos v sin u, z = c sin v.
struct Ellipsoid {
  Vec3 radii{1};  // each > 0
  Counts counts = {};
  bool operator==(const Ellipsoid&) const = default;
};

// Block; bevelled edges are flat at 45 degrees, rounded ones arcs of that radius with spherical
// corners. Each face has its own unit square of texture, seen upright from outside: for the faces
// ±x and ±y with +z up, for ±z with +y up. Bevels continue the larger face they meet, of equals
// that of the first axis. Flat parts of faces are exact, whatever the allowed error.
struct Box {
  Vec3 size{1};        // each > 0
  double bevel = 0;    // 0 ≤ bevel ≤ half of the smallest size
  bool round = false;  // the bevel is an arc
  bool operator==(const Box&) const = default;
};

// Cylinder from z = −height/2 to height/2. u = angle over the sector, v = height; caps: as a Disc,
// each seen from outside with +y up. A sector with both caps is closed by two flat walls through
// the axis: u from the axis, v = height, seen from outside.
struct Cylinder {
  double radius = 1;  // > 0
  double height = 1;  // > 0
  Caps caps = Caps::both;
  Sector sector = {};
  Counts counts = {};
  bool operator==(const Cylinder&) const = default;
};

// A cone or frustum from z = −height/2 to height/2. u, v as for the cylinder.
struct Cone {
  double bottom_radius = 1;  // ≥ 0, not both 0
  double top_radius = 0;     // ≥ 0
  double height = 1;         // > 0
  Caps caps = Caps::both;
  Sector sector = {};
  Counts counts = {};
  bool operator==(const Cone&) const = default;
};

// A flat disc or ring in z = 0, facing +z, open. u, v: the square around it, x from −radius to
// radius.
struct Disc {
  double radius = 1;        // > 0
  double inner_radius = 0;  // 0 ≤ inner < radius
  Sector sector = {};
  Counts counts = {};
  bool operator==(const Disc&) const = default;
};

// A ring of circular section about the z axis. u = angle about the axis, v = angle about the
// section from the outermost circle upward.
struct Torus {
  double radius = 1;         // of the section's centre, > tube_radius
  double tube_radius = 0.1;  // > 0
  Sector sector = {};        // an open pipe when not whole
  Counts counts = {};
  bool operator==(const Torus&) const = default;
};

// A paraboloid that opens to +z, its vertex at the origin: z = r²/(4·focal_length). With a
// thickness a closed shell, whose back is the same surface moved to −z, with a flat circular edge;
// without one, open. u, v: the square around the dish seen from +z, x from −diameter/2 to
// diameter/2; its back seen from −z.
struct Dish {
  double diameter = 1;        // > 0
  double focal_length = 0.5;  // > 0
  double thickness = 0;       // ≥ 0, along z
  Counts counts = {};
  bool operator==(const Dish&) const = default;
};

// A rectangle in z = 0, facing +z, open. u along x, v along y.
struct Plane {
  double width = 1;   // along x, > 0
  double height = 1;  // along y, > 0
  bool operator==(const Plane&) const = default;
};

// A pipe of circular section along a path. Corners of a polyline are mitred; a spline passes
// through its points (centripetal Catmull-Rom, straight on beyond its ends) with no radius of
// curvature below the pipe's radius. u = angle about the path, v = length along it. Frames do not
// turn about the path. Angle 0 at its begin is along the axis x, y or z that is furthest from the
// path there, the first of equals (a pipe along z begins at +x); the twist of a closed path's
// frames is spread over its length, except whole segments. Caps: as a Disc, seen from outside.
struct Tube {
  std::vector<Vec3> path;   // 2 or more, neighbours apart; closed: 3 or more
  double radius = 0.01;     // > 0
  double inner_radius = 0;  // 0 ≤ inner < radius; > 0: a hollow pipe, closed at the ends by rings
  bool spline = false;
  bool closed = false;     // the last point joins the first; no caps then
  Caps caps = Caps::both;  // bottom: at the first point
  Counts counts = {};      // along: sections of a spline, equally far apart; ≥ 3 when closed
  bool operator==(const Tube&) const = default;
};

// A profile turned about the z axis. Points are (r, z) in the order that has the outside on the
// right, as the wall of a vase drawn from bottom to top. Closed where the profile begins and
// ends on the axis or at one point. u = angle, v = length along the profile. A spline is smooth on
// the axis too, runs straight into its other ends, and may not cross the axis.
struct Lathe {
  std::vector<Vec2> profile;  // 2 or more, r ≥ 0, neighbours apart
  bool spline = false;        // smooth through the points (centripetal Catmull-Rom)
  Sector sector = {};
  Counts counts = {};
  bool operator==(const Lathe&) const = default;
};

// An outline in x, y pushed from z = 0 to z = height. Loops may run either way round; holes lie
// inside the outline and apart from each other. Faces: u, v over the bounds of the outline, upright
// seen from outside; walls: u = length along the loop over its whole, v = z over the height.
// Neighbouring walls that meet at no more than smooth share normals.
struct Extrude {
  std::vector<Vec2> outline;             // 3 or more
  std::vector<std::vector<Vec2>> holes;  // each 3 or more
  double height = 1;                     // > 0
  double smooth = 0;                     // radians
  Caps caps = Caps::both;
  bool operator==(const Extrude&) const = default;
};

// Flat faces over a list of vertices. Loops are counter-clockwise seen from outside; holes either
// way. u, v: the bounds of each face in its own plane, upright seen from outside as for a Box.
struct Polygons {
  struct Face {
    std::vector<std::uint32_t> outline;             // 3 or more, each < V
    std::vector<std::vector<std::uint32_t>> holes;  // each 3 or more
    bool operator==(const Face&) const = default;
  };
  std::vector<Vec3> positions;  // V
  std::vector<Face> faces;      // 1 or more
  double smooth = 0;            // radians: two faces that meet at no more share normals
  bool operator==(const Polygons&) const = default;
};

// Sharpness from which on creases and corners stay sharp at every level.
inline constexpr double kInfinitelySharp = 10;

// The limit surface of a cage under Catmull-Clark subdivision ("Recursively generated B-spline
// surfaces on arbitrary topological meshes", 1978), with the semi-sharp creases of DeRose, Kass and
// Truong ("Subdivision surfaces in character animation", 1998). Two faces or one meet at an edge,
// all with the same side out, and those at a vertex join along edges. The border is the cubic
// B-spline of its vertices; vertices of a single face stay corners of it unless smooth_border. u,
// v: linear over each face between its corners'; without them as a Box has them, over the bounds.
struct Subdiv {
  struct Face {
    std::vector<std::uint32_t> outline;    // 3 or more, each < V, none twice
    std::vector<std::uint32_t> texcoords;  // one for each corner, each < the texcoords; or empty
    bool operator==(const Face&) const = default;
  };
  // Crease: subdivided as a curve of its own over `sharpness` levels, with a fraction at the last.
  struct Crease {
    std::vector<std::uint32_t> path;      // 2 or more: each with the next an edge of the cage
    double sharpness = kInfinitelySharp;  // 0 to kInfinitelySharp; kept in single precision
    bool operator==(const Crease&) const = default;
  };
  struct Corner {
    std::vector<std::uint32_t> vertices;  // fixed, over `sharpness` levels
    double sharpness = kInfinitelySharp;
    bool operator==(const Corner&) const = default;
  };
  std::vector<Vec3> positions;  // V; unused ones have no effect
  std::vector<Vec2> texcoords;
  std::vector<Face> faces;  // 1 or more
  std::vector<Crease> creases;
  std::vector<Corner> corners;
  bool smooth_border = false;
  // > 0: each edge of the cage in 2^levels segments, whatever error is allowed; ≤ kMaxLevels
  std::uint32_t levels = 0;
  static constexpr std::uint32_t kMaxLevels = 10;
  bool operator==(const Subdiv&) const = default;
};

// A mesh as written in a file: exact by definition. Never null.
using MeshShape = std::shared_ptr<const Mesh>;

using Shape = std::variant<Sphere, MeshShape, Ellipsoid, Box, Cylinder, Cone, Disc, Torus, Dish,
                           Plane, Tube, Lathe, Extrude, Polygons, Subdiv>;

// Returns the name of a shape's element in the language: "sphere", "mesh", "box"….
std::string_view kind_name(const Shape& shape);

// Problem of a shape, and the part that has it.
struct ShapeProblem {
  Code code;  // E2001, E2002, E2010 to E2018, E2026, E2027; W2006, W2007, W2009, W2019, W2028
  std::string message;    // one lower-case sentence
  std::string_view part;  // member: "radius", "outline", "faces"…; of counts "segments" or "rings"
  std::size_t item = 0;   // index in a list: of a point, hole, face, crease or corner
  std::size_t sub_item = 0;  // index of a point in a hole or crease
};

// Returns the first problem of a shape by the rules above, or nothing. Meshes are not examined.
// Decisions are exact, for crossings and for touches of an outline with itself.
//
// Cost: O(points log points) for outlines, else O(points).
std::optional<ShapeProblem> problem_of(const Shape& shape);

// Returns warnings of a shape without problems: parts so thin that their triangles have no area (as
// in MeshReport), inverted closed polygons and lathes; faces that look opposite ways; profiles that
// run through themselves (of splines, 16 chords for each piece). Each kind once. Meshes are not
// examined.
//
// Cost: O(points log points), of profiles that go to and fro O(points²), up to 20 million pairs.
std::vector<ShapeProblem> shape_warnings_of(const Shape& shape);

// Returns true if the surface has no border, by its parameters. A mesh: its closed mark.
bool is_closed(const Shape& shape);

// Bending of a cage: the area of its faces, m², and its total mean curvature, m: half of the length
// of each edge times the angle, 0 to π, between its faces; borders count nothing.
//
// Expects: no problem_of(shape). Cost: O(corners log corners).
struct CageTurn {
  double area = 0;
  double mean_curvature = 0;
};
CageTurn turn_of(const Subdiv& shape);

// Returns a 128-bit hash; equal shapes have equal ones.
Hash128 hash_of(const Shape& shape);

}  // namespace panwright::geometry
