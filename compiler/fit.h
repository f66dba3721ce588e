// What a budget lets a model do without: parts too small to tell, triangles of meshes that were
// read. compile() does it.
//
// Only for a budget with nearest, ifov and a term of pixels, flux or centroid.
//
// Parts are instances of exact shapes and pieces of meshes that hang together; of a mesh of several
// pieces that is shown several times, a piece goes everywhere or nowhere. One is left out where it
// is narrower than the budget's pixels from its nearest distance (its width: what its box has
// across its longest edge), and while all that are left out together show less than kLeftOutShare
// of the budget's flux, smallest first: by the sum of the largest areas that they show, each times
// twice the larger of its own reflectance and the model's (what it hides and what it shades may be
// as bright), against the least that the model shows in 32 directions, or a tenth of the most; and
// while the photocentre moves by less than that share of the budget's centroid. Without a term for
// flux nothing is left out. What stays: foil, decals and what they lie on, retroreflectors, parts
// with a tolerance of their own, parts that a joint can scale or move without limits.
//
// What stays shares kPartsShare of flux and centroid: a part may be off by the more, relative to
// itself, the less of the model's light it sends and the more triangles that saves. The sum over
// all parts of what they send (mean of 32 directions, what is hidden left out) times what they may
// be off is that share, with the fewest triangles that it can be had with. So a truss of a thousand
// thin members is not made as closely as the body.
//
// Meshes of 64 triangles and more, without decals and no foil, are replaced by the coarsest level
// (geometry/mesh/levels.h) whose bound is within the tolerance (compiler/tolerance.h), whose
// diffuse flux and projected area are off by their share of the budget's flux at most, and
// whose normals, RMS, by a quarter of the slope of the material's microfacets. Where no term of
// pixels or centroid gives a tolerance, it is a quarter of a pixel.
//
// Opaque textures of colour and reflectance are halved, by means of light, while the nearest pixel
// still sees two of their texels at least, but for a hundredth of the area that wears them, and
// while the light of the faces of a mesh that look along one axis changes by a quarter of the
// budget's flux at most (1 % without that term).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace panwright::compiler {

// Shares of a budget's flux and centroid: of all that is left out together, and of all that stays.
inline constexpr double kLeftOutShare = 0.25;
inline constexpr double kPartsShare = 0.75;

// A part that is left out: an instance of the scene, or pieces of a mesh that hang together.
struct LeftOut {
  std::string name;             // of the node
  std::uint64_t pieces = 0;     // that hang together
  std::uint64_t triangles = 0;  // of meshes, instances counted; 0: of an exact shape
  double area = 0;              // m²: the largest that it shows, of all pieces together
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
  std::uint64_t pieces = 0;       // of the scene: what could be left out
  std::uint64_t pieces_left_out = 0;
  std::uint64_t triangles_left_out = 0;
  double flux_left_out = 0;            // bound, of the model's
  double centroid_left_out = 0;        // bound, metres
  double flux_simplified = 0;          // of the model's: what meshes are off, by what they send
  std::vector<Simplified> simplified;  // from the most triangles saved
  std::uint64_t texels_before = 0, texels_after = 0;  // bytes of textures
  double seconds = 0;
};

// Whether it does more than copy.
bool asks_to_fit(const scene::Budget& budget);

}  // namespace panwright::compiler
