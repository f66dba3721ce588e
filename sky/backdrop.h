// Bodies behind the targets of an image.
#pragma once

#include <cstdint>
#include <vector>

#include "base/job.h"
#include "image/image.h"
#include "sky/sky.h"
#include "world/camera.h"

namespace panwright::sky {

// Returns the radiance of the bodies and, if visible, the Sun's disc in the pixels of a camera:
// means over pixels, 3·height·width, row 0 the top row. Nearer bodies hide others. Limbs have the
// covered area of their pixels. Discs below two pixels have their exact flux. Bodies that the
// camera is in are not drawn. Air about bodies shines beside their limbs and dims what is behind.
// Any lens.
//
//   psf_sigma  RMS width of a Gaussian PSF, pixels; 0: none
//   coverage   H·W, of targets: without a PSF pixels that they cover are left black; null: none
// Error: limbs 0.02 px, flux of a disc 1e-3. Lets Cancelled pass. Cost: O(pixels).
std::vector<float> backdrop(const Sky& sky, const world::Camera& camera, double psf_sigma,
                            const Job& job = {}, const std::vector<float>* coverage = nullptr);

// Adds a backdrop to an image of targets, by the share of each pixel that they leave. Coverage and
// the truth layers stay those of the targets.
void add_behind(const std::vector<float>& backdrop, image::Image& image);

// Returns whether a body may stand before something at a distance from a point, metres. Bodies that
// the point is in do not.
bool may_hide(const Sky& sky, const Vec3& point, double distance);

// Adds the bodies to an image of targets as above, those before a target over it, by the depth of
// its pixel; pixels without have that of their neighbours. Where a body covers more than half of a
// pixel, the truth layers are those of the background.
//
// Expects: truth layers. Lets Cancelled pass. Cost: twice that of backdrop().
void add_around(const Sky& sky, const world::Camera& camera, double psf_sigma, image::Image& image,
                const Job& job = {});

}  // namespace panwright::sky
