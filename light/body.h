// Bodies of the sky: planets, moons and asteroids as ellipsoids that send sunlight on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"
#include "light/air.h"
#include "light/map_rows.h"
#include "light/photometry.h"

namespace panwright::light {

// Values over a body: equirectangular, north at the top, longitude 0 in the middle, eastern
// longitudes right of it. Levels of detail are means of areas.
class BodyMap {
 public:
  enum class Scale : std::uint8_t {
    mean_one,  // each band's mean over the sphere becomes 1; a band that is black everywhere is 1
    none,
  };
  // Cost: O(pixels).
  explicit BodyMap(MapPixels pixels, Scale scale = Scale::mean_one);

  // Returns the value at a direction from the centre, in the body's axes.
  //
  //   footprint  angle that is averaged, radians; 0: the finest level, bilinear
  Vec3 at(const Vec3& direction, double footprint) const;
  std::uint32_t width() const { return levels_[0].width; }

 private:
  Vec3 bilinear(const MapPixels& level, double u, double v) const;
  void add_levels();
  std::vector<MapPixels> levels_;  // from the finest, each half as wide
};

struct Body {
  std::string name;
  Vec3 centre{0};                    // world axes, metres
  Quat world_from_body{1, 0, 0, 0};  // unit; z to the north pole, x to longitude 0 on the equator
  Vec3 radii{1};                     // semi-axes along the body's axes, metres, > 0
  Photometry photometry;
  Vec3 albedo{0.3};  // per band, ≥ 0: factors of the law, for Lambert's the Bond albedo; with
                     // Photometry::rolo 1 is the Moon's
  std::shared_ptr<const BodyMap> map;  // factors of the albedo; null: none
  // The Earth's air above the ellipsoid; the albedo is that of both. Expects: Lambert's law.
  bool air = false;
  bool sunset = false;  // the last sunlight on targets comes through its air. Expects: air
  std::shared_ptr<const BodyMap> night;  // lights of the night, of kNightRadiance; null: none
  bool operator==(const Body&) const = default;
};

// Returns a body of kBodyPresets at the origin: `earth` (WGS 84, with air; albedo 0.3 and its
// colour), `moon` (ROLO).
std::optional<Body> body_preset(std::string_view name);
inline constexpr std::string_view kBodyPresets[] = {"earth", "moon"};

// Returns whether all numbers are finite and within the limits above, radii at most 1:100 of each
// other.
[[nodiscard]] bool is_sound(const Body& body);

// Radiance of a surface towards a viewer, in the unit of the irradiance per steradian.
//
//   place       direction from the centre in the body's axes, any length: the albedo's place
//   normal      unit; to_sun, to_viewer: unit; in one frame
//   irradiance  of the Sun on a plane that faces it
//   footprint   angle from the centre that the albedo is averaged over, radians
Vec3 reflected(const Body& body, const Vec3& place, double footprint, const Vec3& normal,
               const Vec3& to_sun, const Vec3& to_viewer, const Vec3& irradiance);

// Radiance of white in a map of the night, W/m²/sr in a band of 100 nm: towns have 1e-7 W/cm²/sr
// between 500 and 900 nm (C. Elvidge et al., "VIIRS night-time lights", 2017).
inline constexpr double kNightRadiance = 2.5e-4;
// Returns the lights of the night, W/m²/sr; lit where the Sun is below the horizon, all of them
// from six degrees on.
//
//   mu_sun  cosine of the Sun's zenith angle
Vec3 night_light(const Body& body, const Vec3& place, double footprint, double mu_sun);

// Air of a body; null: none.
std::shared_ptr<const Air> air_of(const Body& body);

// Returns the albedo of the ground that makes the albedo of a body with its air; 0 where the air
// alone has more.
Vec3 ground_albedo(const Body& body, const Air& air);

// Radiance of a body with air along a ray that meets its ground.
//
//   place    direction from the centre in the body's axes; footprint as above
//   mu_sun   cosine of the Sun's zenith angle in the space where the body is a unit sphere
//   mu       that of the ray's, towards the viewer
//   between  light of the air before the ground
Vec3 reflected_through(const Body& body, const Air& air, const Vec3& place, double footprint,
                       double mu_sun, double mu, const AirLight& between, const Vec3& irradiance);

}  // namespace panwright::light
