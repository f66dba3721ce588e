// Lenses: the place on the image plane that a point falls on, and back. Pure functions.
//
// Camera axes: x right, y down, z along the boresight; metres. The image plane: at distance 1, so
// that without distortion a point falls on (X/Z, Y/Z); pixels are focal·place + principal.
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "base/math.h"

namespace panwright::sensor {

// Below: x = X/Z, y = Y/Z, r² = x² + y²; x', y', r' are places with distortion.

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

// r' = r + k1·r + k2·r² + … + k5·r⁵. Source: PANGU's -distortion.
struct RadialPowers {
  std::array<double, 5> k{};
  bool operator==(const RadialPowers&) const = default;
};

// CAHVOR and CAHVORE, in camera axes: A, H and V are the boresight, focal lengths and principal
// point of the camera; `axis` is O, `r` is R, `e` is E.
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

// Ray in camera axes.
struct LensRay {
  Vec3 origin{0};     // metres; not 0 only with Cahvore::e
  Vec3 direction{0};  // unit
};

// Distortion with its domain: the largest angle to the axis up to which farther directions fall on
// farther places. Beyond it a polynomial folds back; directions and places there have no partner.
class DistortionMap {
 public:
  // Expects: finite numbers; Cahvore's axis of unit length, within 60 degrees of the boresight, and
  // its linearity from -1 to 1. Cost: some 100 µs.
  explicit DistortionMap(const Distortion& distortion);

  const Distortion& distortion() const { return distortion_; }

  // Returns the place of a point; nothing: it lies behind the camera or outside the domain.
  std::optional<Vec2> place(const Vec3& point) const;

  // Returns the ray of a place: place() of its points is the place, within 1e-14. Nothing: no
  // direction of the domain falls there.
  std::optional<LensRay> ray(const Vec2& place) const;

  // Returns the domain's largest angle to the axis of the distortion, radians, up to π. With
  // tangential terms it is that of the radial ones.
  double domain() const { return domain_; }

 private:
  Distortion distortion_;
  double domain_ = kPi;
  double limit_ = 0;          // domain in the variable of the distortion: r, θ or CAHVORE's χ
  double limit_image_ = 0;    // its distorted value
  Mat3 tilt_{1}, untilt_{1};  // of Brown
};

}  // namespace panwright::sensor
