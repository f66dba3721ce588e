// Lenses: the pixel that a point falls on, and the ray of a pixel. Pure functions.
//
// Camera axes: x right, y down, z along the boresight; metres. Pixels: (0, 0) is the upper left
// corner of the image, pixel (i, j) covers [i, i+1) × [j, j+1) (docs/conventions.md). OpenCV, ROS
// and Kalibr put the centre of a pixel at whole numbers: their principal points are 0.5 less.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>

#include "base/math.h"

namespace panwright::sensor {

// Ideal coordinates below: x = X/Z, y = Y/Z, r² = x² + y².

// No distortion.
struct Pinhole {
  bool operator==(const Pinhole&) const = default;
};

// Radial, tangential, rational, thin-prism and tilt terms, in OpenCV's order:
// k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 τx τy (radians).
// Source: OpenCV 4, calib3d, "Detailed description"; Brown 1966.
struct Brown {
  std::array<double, 14> k{};
  bool operator==(const Brown&) const = default;
};

// r' = θ·(1 + k1·θ² + k2·θ⁴ + k3·θ⁶ + k4·θ⁸), θ the angle to the boresight: fields of view beyond
// 180 degrees too. Source: Kannala and Brandt 2006; OpenCV's "fisheye", Kalibr's "equidistant".
struct Fisheye {
  std::array<double, 4> k{};
  bool operator==(const Fisheye&) const = default;
};

// r = r'/(1 + k·r'²). Source: Fitzgibbon 2001.
struct Division {
  double k = 0;
  bool operator==(const Division&) const = default;
};

// r' = r + k1·r + k2·r² + … + k5·r⁵, r and r' in pixels from the principal point.
// Source: PANGU's -distortion, which does not document the unit; that of AMICA, whose published
// term is −2.8e-5·r², is the pixel.
struct RadialPowers {
  std::array<double, 5> k{};
  bool operator==(const RadialPowers&) const = default;
};

// CAHVOR and CAHVORE, in camera axes: A, H and V are the boresight, focal lengths and principal
// point of the lens; `axis` is O, `r` is R, `e` is E.
//
//   linearity  1: perspective (CAHVOR with e = 0); 0: fisheye; between: general
// E moves the entrance pupil along O, metres: rays do not meet in one point then.
// Source: Gennery 2006, "Generalized camera calibration including fish-eye lenses".
struct Cahvore {
  Vec3 axis{0, 0, 1};  // unit
  std::array<double, 3> r{};
  std::array<double, 3> e{};
  double linearity = 1;
  bool operator==(const Cahvore&) const = default;
};

using Distortion = std::variant<Pinhole, Brown, Fisheye, Division, RadialPowers, Cahvore>;

// Pixels of distorted coordinates: (focal.x·x' + skew·y' + principal.x, focal.y·y' + principal.y).
struct Lens {
  Vec2 focal{1024};     // pixels, > 0
  Vec2 principal{512};  // pixels
  double skew = 0;      // pixels
  Distortion distortion;
  bool operator==(const Lens&) const = default;
};

// Ray in camera axes.
struct LensRay {
  Vec3 origin{0};     // metres; not 0 only with Cahvore::e
  Vec3 direction{0};  // unit
};

// Lens with its domain: the largest angle to the axis up to which farther directions fall on
// farther points. Beyond it a polynomial folds back; directions and pixels there have no partner.
class LensMap {
 public:
  // Expects: finite numbers; focal lengths > 0; Cahvore's axis of unit length, within 60 degrees of
  // the boresight. Cost: some 10 µs.
  explicit LensMap(const Lens& lens);

  const Lens& lens() const { return lens_; }

  // Returns the pixel of a point; nothing: it lies behind the camera or outside the domain.
  std::optional<Vec2> project(const Vec3& point) const;

  // Returns the ray of a pixel: project() of its points is the pixel, within 1e-9 pixels. Nothing:
  // no direction of the domain falls there.
  std::optional<LensRay> ray(const Vec2& pixel) const;

  // Returns the solid angle of a pixel, steradians: that of the spherical quadrilateral of its
  // corners, so that pixels add up to the polygon of the outermost ones. 0: a corner has no ray.
  double pixel_solid_angle(std::uint32_t column, std::uint32_t row) const;

  // Returns the domain's largest angle to the axis of the distortion, radians, up to π. With
  // tangential terms it is that of the radial ones.
  double domain() const { return domain_; }

 private:
  Vec2 pixel_of(const Vec2& distorted) const;
  Vec2 distorted_of(const Vec2& pixel) const;

  Lens lens_;
  double domain_ = kPi;
  double limit_ = 0;          // domain in the variable of the distortion: r, θ or pixels
  double limit_image_ = 0;    // its distorted value
  Mat3 tilt_{1}, untilt_{1};  // of Brown
};

}  // namespace panwright::sensor
