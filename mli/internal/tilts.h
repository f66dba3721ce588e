// Tilts of foil normals against the surface below.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "mli/levels.h"

namespace panwright::mli {

// Spread of slopes as shaded: with normals linear between a triangle's vertices.
struct TiltSpread {
  double variance = 0;  // both axes together
  double level = 0;     // mean of exp(−|slope|²/variance): the nearly level share
  double mirror = 0;    // mean of its ninth power: for narrow lobes
  Covariance slopes;    // about 0, along x and y
};

// Slopes of a mesh's normals against those of the surface below, with their visible areas.
class Tilts {
 public:
  // below: unit normals of the surface, per vertex; triangles that stand on it (seams) are left out
  Tilts(const geometry::Mesh& mesh, std::span<const Vec3> below);

  TiltSpread spread() const { return spread(TiltMap{}, true); }
  // Returns the map with the spread nearest to `wanted`, by two parameters for two targets. Slopes
  // between distant vertices are smaller, and more often near 0, than those at them.
  TiltMap towards(const TiltSpread& wanted, TiltSpread& reached) const;
  // The same of a flat mesh, with the covariance as well.
  TiltMap towards_all(const TiltSpread& wanted) const;

 private:
  struct Corner {
    Vec3 slope;
    double along;  // of the unit normal along the one below
  };
  TiltSpread spread(const TiltMap& map, bool with_level) const;
  // Sets the factor, from its present one on, that makes this variance.
  TiltSpread scaled_to(TiltMap& map, double variance) const;
  TiltMap shaped(TiltMap map, const TiltSpread& wanted, TiltSpread& reached) const;

  std::vector<Corner> corners_;                // of the triangles
  std::vector<geometry::Triangle> triangles_;  // by corners
  std::vector<double> weights_;                // their areas, seen from above
  double unit_ = 0;  // of TiltSpread::level: the variance of the original slopes
};

// Tilts normals in place.
//
//   along  directions along the sheet, of any length, one per vertex; not needed by a map that does
//          not lean
void tilt(std::vector<Vec3>& normals, std::span<const Vec3> below, std::span<const Vec3> along,
          const TiltMap& map);

// Returns directions along the sheet on the surface below, at the vertices of a mesh.
//   surface, lower  as of set_apart()
std::vector<Vec3> along_sheet(const geometry::Mesh& mesh, const geometry::Mesh& surface,
                              std::span<const char> lower);

// Returns for each triangle of a form's grid true if it lies below the diagonal of its cell. For a
// mesh without normals, whose vertices are the grid's.
std::vector<char> below_diagonals(const geometry::Mesh& mesh);

// Gives each vertex two normals (TiltMap::apart). Both meshes have normals; `below` is extended.
//   lower    below_diagonals()
//   surface  the same triangles without heights
void set_apart(geometry::Mesh& mesh, std::vector<Vec3>& below, const geometry::Mesh& surface,
               std::span<const char> lower, double apart);

// Slopes of a flat mesh's normals, linear between vertices.
struct Moments {
  double all = 0;     // variance over the mesh, both axes together
  double within = 0;  // in squares of a side: the mean variance about each square's own mean
};
// Returns the moments over squares from the mesh's middle on, and over those shifted by half a
// side.
Moments moments_of(const geometry::Mesh& mesh, const Vec2& side);

// Returns normals of a surface at the vertices of a mesh with copies from compute_normals().
// surface: the same triangles in the same order, with normals.
std::vector<Vec3> normals_below(const geometry::Mesh& mesh, const geometry::Mesh& surface);

}  // namespace panwright::mli
