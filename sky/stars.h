// Stars of a view: apparent places, light, and their images.
#pragma once

#include <span>
#include <vector>

#include "base/math.h"
#include "image/image.h"
#include "sky/sky.h"
#include "sky/star_catalogue.h"
#include "world/camera.h"

namespace panwright::sky {

// Returns the apparent direction of a star, unit, ICRS axes: moved by its motion, and by the
// aberration of a velocity far below that of light (exact to special relativity). Parallax, up to
// 4e-6 rad, is left out.
//
//   years  since the catalogue's epoch
Vec3 apparent_direction(const Star& star, double years, const Vec3& velocity);

// Returns the irradiance, W/m² in bands of 100 nm about 650, 550 and 450 nm. A star of the Sun's
// colour, V −26.76 and B − V 0.65, has light::kSolarIrradiance; of another the bands follow V,
// R = V − 0.55·(B − V) and B. Unknown colours are the Sun's.
Vec3 star_irradiance(double v, double b_v);

// Star on the image plane of a camera.
struct StarInView {
  std::size_t index = 0;  // in the catalogue
  Vec3 direction{0};      // unit, world axes
  Vec2 pixel{0};          // of docs/conventions.md 4
  Vec3 irradiance{0};     // W/m² per band
};

// Returns the stars whose centre is within `margin` pixels of the image, from the brightest to the
// faintest. Nothing without a catalogue, or for an orthographic camera.
//
// Cost: 20 ns a star of the catalogue, a projection for each in the camera's cone.
std::vector<StarInView> stars_in_view(const light::Stars& stars, const world::Camera& camera,
                                      double margin);

// Removes the stars that bodies hide from a camera; air dims them.
void remove_hidden(const Sky& sky, const Vec3& camera, std::vector<StarInView>& stars);

// Adds the stars of a world to an image, as below. Cost: that of stars_in_view().
void add_stars(const Sky& sky, const light::Stars& stars, const world::Camera& camera,
               double psf_sigma, image::Image& image);

// Adds stars to an image of radiance: each by the Gaussian of `psf_sigma` pixels (0: none)
// integrated over the pixels, within 5.5 sigma; behind the coverage of the pixel of its centre.
//
//   unit  irradiance of 1 in the image's unit, W/m² per band: 1, or the Sun's where radiance is
//         per unit irradiance
// The sum of radiance × solid angle of a star inside the image is its irradiance to 1e-6.
void add_stars(std::span<const StarInView> stars, const world::Camera& camera, double psf_sigma,
               const Vec3& unit, image::Image& image);

// Adds one point of light in the same way, in front of everything.
//
//   irradiance  in the image's unit
void add_point(const Vec2& pixel, const Vec3& irradiance, const world::Camera& camera,
               double psf_sigma, image::Image& image);

}  // namespace panwright::sky
