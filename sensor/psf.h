// Point spread functions: their transfer functions, and images blurred by them. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sensor/optics.h"

namespace panwright::sensor {

// Modulation transfer functions at a frequency in cycles per pixel, each in [−1, 1].
double mtf_of_pixel(double frequency);  // a square of one pixel
double mtf_of_gaussian(double frequency, double rms_px);
double mtf_of_diffraction(double frequency, double airy_px);  // a round pupil
double mtf_of_defocus(double frequency, double diameter_px);  // a uniform disc
double mtf_of_motion(double frequency, double length_px);     // along it

// MTF of the optics, without the pixel and the measured kernel, which has no symmetry.
double mtf_of_optics(const Optics& optics, double airy_px, double frequency);

// Share of a source's light within a distance of its centre (pixels), by optics with that transfer
// function. Without the pixel.
double encircled_energy(const Optics& optics, double airy_px, double radius_px);

// Blur of images by optics. An image has `fine` steps a pixel, and the renderer has blurred it by a
// Gaussian already: the rest of the transfer function is applied, by Fourier transforms of tiles.
// So a source much smaller than a step has its exact image, wherever it is on the pixels.
class Blur {
 public:
  static constexpr std::uint32_t kFine = 3;  // odd: the middle step is the centre of the pixel

  // airy_px: by band.
  Blur(const Optics& optics, const std::array<double, kBands>& airy_px, std::uint32_t fine = kFine);

  std::uint32_t fine() const { return fine_; }
  // Gaussian that the renderer is to apply, RMS in steps.
  double rendered_sigma() const { return sigma_; }
  // Share of the light within the reach of the kernel; the rest is spread evenly over the image.
  double energy(std::size_t band) const { return energy_[band]; }
  std::uint32_t reach() const { return reach_; }  // steps

  // Blurs an image in place, 3*width*height. Outside it is dark. Values below 0 may come out, of
  // the size of roundings. Expects: finite values.
  void apply(std::span<float> radiance, std::uint32_t width, std::uint32_t height) const;

  // Returns the kernel of a band, (2·reach + 1)² steps, beside the Gaussian of the renderer.
  std::vector<double> kernel(std::size_t band) const;

 private:
  using Plane = std::vector<std::array<double, 2>>;
  Plane transfer(const Optics& optics, double airy_px, std::size_t side,
                 bool sharpens = true) const;

  std::uint32_t fine_;
  double sigma_ = 0;
  std::uint32_t reach_ = 0;
  std::size_t side_ = 0;  // of a tile
  std::array<double, kBands> energy_{};
  std::array<Plane, kBands> spectra_;
};

}  // namespace panwright::sensor
