// Optics: photoelectrons of radiance. Pure functions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/math.h"
#include "sensor/lens.h"

namespace panwright::sensor {

// Bands of images: red, green, blue; middles of 600–700, 500–600 and 400–500 nm.
inline constexpr std::size_t kBands = 3;
inline constexpr std::array<double, kBands> kBandNm{650, 550, 450};

// Image of the aperture in the detector: `share` of the light again, mirrored or scaled about the
// principal point.
struct Ghost {
  double share = 0;
  double scale = -1;
  bool operator==(const Ghost&) const = default;
};

// Measured point spread function, in steps of 1/oversampling pixels; its middle is its centre.
struct PsfKernel {
  std::uint32_t side = 0;          // odd; 0: none
  std::uint32_t oversampling = 1;  // 1 or 3
  std::vector<double> values;      // side*side, rows downwards; >= 0; their sum is the energy, <= 1
  bool operator==(const PsfKernel&) const = default;
};

struct Optics {
  double aperture_mm = 10;  // diameter of the entrance pupil
  std::array<double, kBands> transmission{1, 1, 1};
  std::array<double, kBands> qe{0.5, 0.5, 0.5};  // electrons per photon
  // Mechanical vignetting: degrees off the axis, share; beside the law of cos⁴, which follows from
  // the solid angle of a pixel and the foreshortened pupil. Empty: none.
  std::vector<std::pair<double, double>> vignetting;
  double veiling_glare = 0;  // share of the light that is spread evenly over the image
  std::vector<Ghost> ghosts;
  bool diffraction = false;  // of a round pupil, at kBandNm
  double psf_px = 0;         // Gaussian, RMS
  double jitter_px = 0;      // RMS
  double diffusion_px = 0;   // of charge in the detector, RMS
  double defocus_px = 0;     // diameter of the disc
  double focus_m = 0;        // distance that is sharp, others have discs of their own; 0: all are
  PsfKernel kernel;

  bool operator==(const Optics&) const = default;

  // RMS of what is Gaussian, pixels.
  double gaussian_px() const;
  // Something else than Gaussian.
  bool has_kernel() const {
    return diffraction || defocus_px > 0 || focus_m > 0 || kernel.side > 0;
  }
};

// Geometry of a camera, pixels.
struct PixelGrid {
  std::uint32_t width = 0, height = 0;
  Vec2 focal{1};
  Vec2 principal{0};
  const DistortionMap* distortion = nullptr;  // null: none
};

// Diameter of the first dark ring over 2.44 · wavelength · f-number: wavelength · focal length /
// aperture in pixels.
double airy_px(const Optics& optics, const PixelGrid& grid, const Vec2& pixel_um, double nm);

// Electrons that a radiance of 1 W/(m² sr) makes in each pixel and second, by band:
// A cos θ Ω τ QE λ/(h c), A of the pupil, Ω of the pixel.
class Sensitivity {
 public:
  Sensitivity(const Optics& optics, const PixelGrid& grid);

  // Of pixels: sr. 0 where no direction falls.
  const std::vector<float>& projected() const { return projected_; }
  // Electrons per second of 1 W/(m² sr) in 1 sr, by band.
  const std::array<double, kBands>& of_bands() const { return of_bands_; }

 private:
  std::vector<float> projected_;
  std::array<double, kBands> of_bands_{};
};

// Electrons per second of an irradiance of 1 W/m² at the pupil: those of an unresolved source.
std::array<double, kBands> electrons_of_irradiance(const Optics& optics);

// Adds veiling glare and ghosts to radiance, in place, 3*width*height: (1 − g)·L + g·mean(L), and
// ghosts beside. Light from outside the image is unknown, and taken as none.
void add_glare(const Optics& optics, const PixelGrid& grid, std::span<float> radiance);

// Mean photoelectrons per pixel and band.
std::vector<float> mean_electrons(std::span<const float> radiance, const Sensitivity& sensitivity,
                                  double exposure_s);

}  // namespace panwright::sensor
