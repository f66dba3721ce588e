// Reference answers independent of the renderer: closed forms, sums over facets, sums over pixels.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/math.h"
#include "geometry/mesh.h"

namespace panwright::oracles {

// ---- closed forms of distant spheres (Sun and viewer infinitely far, phase in [0, π] rad)

// Intensity / (E·albedo·R²) of a Lambert sphere. Lommel-Seeliger geometry, Russell 1916.
double lambert_sphere_intensity(double phase);
// Its photocentre's offset towards the Sun in the image plane, / R.
double lambert_sphere_photocentre(double phase);
// Intensity / (E·R²) for f = (n·h)^shine, exact while the lobe is not cut by terminator or limb.
double blinn_phong_sphere_intensity(double shine, double phase);
// Intensity / (E·R²) of a Beckmann mirror sphere with F = G = 1 and D normalised (f = D/(4 μ0 μ)),
// not cut by terminator or limb.
double beckmann_sphere_intensity(double slope, double phase);

// Intensity / (E·R²) of the specular lobe of figure 8: Beckmann m = 0.15, n = 1.5, V-cavity
// G, F·D·G/(4 μ0 μ), by quadrature, good to 1e-9. Phases 0, 30, 60, 90, 120, 150 degrees.
std::optional<double> seed_lobe_intensity(double phase_deg);

// ---- sums

// f(n, l, v), 1/sr, for each channel. Unit vectors, pointing away from the surface.
using Brdf = std::function<Vec3(const Vec3& normal, const Vec3& to_light, const Vec3& to_viewer)>;

// The specular lobe of figure 8 (see seed_lobe_intensity), independent of materials/formulas. 0 for
// n·l ≤ 0; finite for n·v ≤ 0.
Vec3 seed_lobe(const Vec3& normal, const Vec3& to_light, const Vec3& to_viewer);

// Light of a body for a distant viewer, per unit of irradiance at it.
struct FarField {
  Vec3 intensity{0};             // m²/sr: W/sr per W/m², for each channel
  std::array<Vec3, 3> centre{};  // photocentre of each channel in the mesh's frame, metres
  double error = 0;              // estimate of the largest channel's error of quadrature, m²/sr
};

// A smooth sphere of radius 1 by Gauss-Legendre quadrature over its lit and visible lune,
// order*order points. error: the difference from half the order.
FarField sphere_sum(const Brdf& brdf, double phase, int order);

// A convex flat-shaded mesh: I = Σ A f max(0, n·l) max(0, n·v). Exact; no quadrature.
FarField facet_sum(const geometry::Mesh& mesh, const Brdf& brdf, const Vec3& to_light,
                   const Vec3& to_viewer);

// The same for a mesh shaded with interpolated, renormalised normals: facets are visible by their
// own plane, I = Σ max(0, n_facet·v) ∫ f(n) max(0, n·l) dA, subdivided until the estimate of the
// error is below tolerance·intensity (facets that the terminator cuts need it most). f is also
// evaluated for n·v ≤ 0, as at the limb, where the interpolated normal of a visible facet may point
// away.
//
// Expects: the mesh has normals.
FarField smooth_sum(const geometry::Mesh& mesh, const Brdf& brdf, const Vec3& to_light,
                    const Vec3& to_viewer, double tolerance = 1e-6);

// ---- images

struct Image {
  int width = 0;           // pixels
  int height = 0;          // pixels
  std::vector<float> rgb;  // 3·width·height, row 0 the top row
};

struct ImageSum {
  Vec3 sum{0};                   // Σ L·weight, for each channel
  std::array<Vec2, 3> centre{};  // of each channel, pixels, (0, 0) the image's top left corner
  std::uint64_t not_finite = 0;  // numbers left out
};

// Σ L Ω of a pinhole image, Ω = cos³θ/f² about the principal point: the irradiance at the camera
// per unit irradiance at the body. focal_px: f in pixels.
ImageSum pinhole_sum(const Image& image, double focal_px, const Vec2& principal_px);
// Σ L A of an orthographic image: the intensity per unit irradiance.
ImageSum orthographic_sum(const Image& image, double pixel_metres);

// Reads a .npy file of float32, C order, shape (H, W, 3). Nothing for other files.
std::optional<Image> read_npy(const std::filesystem::path& path);

}  // namespace panwright::oracles
