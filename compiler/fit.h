// Reductions of a model within a budget: parts too small to tell, triangles of imported meshes,
// texels. compile() applies them.
//
// Only for a budget with nearest, ifov and a term of pixels, flux or centroid.
//
// Parts are instances of exact shapes and connected components of meshes; of a mesh of several
// components shown several times, a component goes everywhere or nowhere. The candidates are parts
// narrower than the budget's pixels at their nearest distance. The width of a part is the extent of
// its box across its longest edge. They are left out, smallest first, under two limits:
//
//   flux      all of them together show less than kLeftOutShare of the budget's flux. Each counts
//             with its largest projected area, times twice the larger of its own reflectance and
//             the model's. Surfaces that it hides and shades may be as bright. The reference is the
//             least that the model shows in 32 directions, or a tenth of the most.
//   centroid  the photocentre moves by less than that share of the budget's centroid.
//
// Without a term for flux nothing is left out. Always kept: foil, decals and what they lie on,
// retroreflectors, parts with a tolerance of their own, parts that a joint can scale or move
// without limits.
//
// Kept parts share kPartsShare of flux and centroid. The relative error of a part may be larger,
// the less of the model's light it sends and the more triangles that saves. The sum over parts of
// light sent (mean of 32 directions, hidden light excluded) times error equals that share, at the
// fewest triangles. Thin members of a truss are thus coarser than the body.
//
// Meshes of 64 triangles and more, without decals and no foil, are replaced by the coarsest level
// (geometry/mesh/levels.h) that meets three limits: its bound is within the tolerance
// (compiler/tolerance.h); its diffuse flux and projected area are within their share of the
// budget's flux; its RMS normal error is at most a quarter of the slope of the material's
// microfacets. Without a tolerance from pixels or centroid, it is a quarter of a pixel.
//
// Opaque textures of colour and reflectance are halved, by means of light, under two conditions:
// the nearest pixel covers two of their texels at least, but for a hundredth of their area; and the
// light of the faces of a mesh that look along one axis changes by at most a quarter of the
// budget's flux (1 % without that term).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace panwright::compiler {

// Shares of a budget's flux and centroid: of all left-out parts together, and of all kept ones.
inline constexpr double kLeftOutShare = 0.25;
inline constexpr double kPartsShare = 0.75;

// A part that is left out: an instance of the scene, or connected components of a mesh.
struct LeftOut {
  std::string name;             // of the node
  std::uint64_t pieces = 0;     // connected components
  std::uint64_t triangles = 0;  // of meshes, instances counted; 0: of an exact shape
  double area = 0;              // m²: largest projected area of all pieces together
};

struct Simplified {
  std::string name;                     // of the first node that shows it
  std::uint64_t before = 0, after = 0;  // triangles, once
  double error = 0;                     // metres, in the mesh's frame: a bound
  double flux = 0;     // largest relative error of diffuse light (geometry/mesh/diffuse_flux.h)
  double normals = 0;  // radians, RMS
  double seconds = 0;
};

struct FitReport {
  bool asked = false;             // by the budget
  std::vector<LeftOut> left_out;  // from the largest area
  std::uint64_t pieces = 0;       // of the scene: candidates
  std::uint64_t pieces_left_out = 0;
  std::uint64_t triangles_left_out = 0;
  double flux_left_out = 0;            // bound, of the model's
  double centroid_left_out = 0;        // bound, metres
  double flux_simplified = 0;          // of the model's: error of meshes, weighted by their flux
  std::vector<Simplified> simplified;  // from the most triangles saved
  std::uint64_t texels_before = 0, texels_after = 0;  // bytes of textures
  double seconds = 0;
};

// Returns true if the budget changes the scene.
bool asks_to_fit(const scene::Budget& budget);

}  // namespace panwright::compiler
