// How the normals of foil lean against the surface below it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "mli/levels.h"

namespace panwright::mli {

// What light sees of slopes, as they are shaded: with normals linear between a triangle's vertices.
struct TiltSpread {
  double variance = 0;  // both axes together
  double level = 0;     // mean of exp(−|slope|²/variance): the share that lies about flat
  double mirror = 0;    // of the ninth power of that: as narrow lobes see it
};

// The slopes of a mesh's normals against those of the surface below, and where they are seen.
class Tilts {
 public:
  // below: unit normals of the surface, per vertex; triangles that stand on it (seams) are left out
  Tilts(const geometry::Mesh& mesh, std::span<const Vec3> below);

  TiltSpread spread() const { return spread(TiltMap{}, true); }
  // The map that brings the spread nearest to `wanted`. Two numbers are met by two: slopes between
  // vertices far apart are less, and more often near 0, than those at them.
  TiltMap towards(const TiltSpread& wanted, TiltSpread& reached) const;

 private:
  struct Corner {
    Vec3 slope;
    double along;  // of the unit normal along the one below
  };
  TiltSpread spread(const TiltMap& map, bool with_level) const;
  double factor_for(TiltMap map, double variance) const;

  std::vector<Corner> corners_;  // per vertex
  std::vector<geometry::Triangle> triangles_;
  std::vector<double> weights_;  // their areas, seen from above
  double unit_ = 0;              // of TiltSpread::level: the variance of slopes as they are
};

// Normals that lean otherwise, in place.
void tilt(std::vector<Vec3>& normals, std::span<const Vec3> below, const TiltMap& map);

// Of each triangle of a form's grid: whether it lies below the diagonal of its cell. Of a mesh
// without normals, whose vertices are the grid's.
std::vector<char> below_diagonals(const geometry::Mesh& mesh);

// Gives each vertex two normals (TiltMap::apart). Both meshes with normals; `below` follows.
//   lower    below_diagonals()
//   surface  the same triangles without heights
void set_apart(geometry::Mesh& mesh, std::vector<Vec3>& below, const geometry::Mesh& surface,
               std::span<const char> lower, double apart);

// Slopes of a flat mesh's normals, linear between vertices.
struct Moments {
  double all = 0;     // variance over the mesh, both axes together
  double within = 0;  // in squares of a side: the mean variance about each square's own mean
};
// Of squares from the mesh's middle on, and of those half a side off.
Moments moments_of(const geometry::Mesh& mesh, const Vec2& side);

// Normals of a surface at the vertices of a mesh that compute_normals() gave copies to. surface:
// the same triangles in the same order, with normals.
std::vector<Vec3> normals_below(const geometry::Mesh& mesh, const geometry::Mesh& surface);

}  // namespace panwright::mli
