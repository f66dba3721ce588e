// RADARs: echoes of a scene by range and speed, from rays that bounce between its surfaces. Pure
// functions of world, instrument, seed and frame: the same for any number of threads.
//
//   auto radar = instruments::read_radar(text, name, log);
//   auto histogram = instruments::measure(*radar, {world, pose}, nullptr, {}, log);
//
// Axes of an instrument are those of a camera: x right, y down, z along the boresight. Azimuth
// turns from z to x, elevation from there to -y (up). Speeds are of the range: receding is above 0.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "world/world.h"

namespace panwright::instruments {

inline constexpr double kLightSpeed = 299'792'458;  // m/s

// Law by which a surface scatters a wave back: metal by physical optics, with phase and bounces;
// the others by a cross-section of each square metre (sigma-nought) at random phases.
enum class ScatterLaw : std::uint8_t {
  metal,    // a smooth conductor: level is its reflectance
  lambert,  // 4 level cos²
  cosine,   // level cos^exponent
  hagfors,  // (C level / 2) (cos⁴ + C sin²)^(-3/2), C = 1 / slope²: rough ground of reflectance
            // level
};

struct RadarSurface {
  std::string material;  // its name in models; "terrain": terrain too; "*": all others
  ScatterLaw law = ScatterLaw::lambert;
  double level = 0.1;   // > 0
  double exponent = 2;  // of cosine
  double slope = 0.1;   // of hagfors: RMS, a tangent
};

// Returns sigma-nought at a cosine of incidence in (0, 1]; of metal 0.
//
// Source: T. Hagfors, "Backscattering from an undulating surface with applications to radar returns
// from the Moon", 1964.
double sigma_nought(const RadarSurface& surface, double cosine);

enum class BeamPattern : std::uint8_t {
  gaussian,
  aperture,  // uniform and rectangular: sinc², side lobes of -13 dB
  uniform,   // the same within an ellipse, 0 outside
};

struct Radar {
  std::string name;

  double frequency = 10e9;  // Hz
  double bandwidth = 50e6;  // Hz: cells of range are c/(2·bandwidth) wide
  double dwell = 0.02;   // seconds of coherent integration: cells of speed, wavelength/(2·dwell)
  double power = 1;      // watts, mean over the dwell
  double loss = 1;       // factor >= 1
  bool vertical = true;  // polarisation, sent and received: along y, else along x

  BeamPattern pattern = BeamPattern::gaussian;
  Vec2 beam{0.1, 0.1};  // radians, full width at half power in azimuth and elevation
  double gain = 0;      // factor; 0: of the pattern without loss

  double temperature = 290;  // kelvin
  double noise_figure = 1;   // factor >= 1; 0: no noise
  std::uint32_t looks = 1;   // averaged, with independent speckle and noise

  Vec2 range{0, 100};  // metres, of the histogram
  Vec2 speed{-1, 1};   // m/s

  std::uint32_t rays = 512;   // along the longer side of what is seen
  std::uint32_t bounces = 3;  // of metal, 1: none is followed

  std::vector<RadarSurface> surfaces;
  double altimeter = 0;  // share of the largest echo that is the first surface; 0: no altimeter

  double wavelength() const { return kLightSpeed / frequency; }
  // Of the histogram: half a cell, m and m/s.
  double range_step() const { return kLightSpeed / (4 * bandwidth); }
  double speed_step() const { return wavelength() / (4 * dwell); }
};

inline constexpr std::size_t kMostRadarCells = 1 << 18;

// Returns the one-way gain over the largest one in a direction, unit, of the instrument's axes.
double pattern_gain(const Radar& radar, const Vec3& direction);
// Returns the largest gain, of `gain` or the pattern.
double peak_gain(const Radar& radar);

// Reads a RADAR (docs/radar.md). Fails: E0263 with the member.
Result<Radar> read_radar(std::string_view text, const std::string& name, DiagnosticLog& log);

// State at one time.
struct RadarMoment {
  world::World world;
  world::Pose pose;  // world_from_instrument
};

// States at the begin and the end of the dwell: changes of the path between them are its speed. Of
// the targets and models of the state in the middle.
struct RadarMotion {
  RadarMoment begin, end;
};

// Truth of a target, wherever its echoes are, within the beam's edge and without its pattern.
struct RadarTarget {
  std::string name;
  double cross_section = 0;  // m²: |Σ of metal|² + Σ of other surfaces, at one frequency
  double range = std::numeric_limits<double>::quiet_NaN();  // metres, mean by power; NaN: no echo
  double speed = std::numeric_limits<double>::quiet_NaN();  // m/s, the same
};

// S rows of speed, R columns of range, both ascending; planes have S·R members.
struct RadarHistogram {
  std::uint32_t ranges = 0, speeds = 0;
  double first_range = 0, range_step = 0;  // metres, of the centres of columns
  double first_speed = 0, speed_step = 0;  // m/s, of the centres of rows
  std::vector<double> power;               // watts, as measured: with speckle and noise
  std::vector<double> mean_power;          // watts, without
  // Radians, mean directions by mean power, as of a monopulse antenna; NaN: no echo.
  std::vector<double> azimuth, elevation;
  double noise = 0;         // watts, mean of a cell
  double gain = 0;          // largest of the antenna
  double echo_power = 0;    // watts of all echoes, those inside and those outside
  double outside = 0;       // share of it that is outside of the histogram
  double response_sum = 0;  // sum over cells of an echo, where its largest cell is 1
  std::uint64_t rays = 0, hits = 0;
  double spacing = 0;                // radians between rays
  std::vector<RadarTarget> targets;  // of the world, in its order
  std::optional<double> altitude;    // metres, of an altimeter that has found a surface
};

struct RadarOptions {
  std::uint64_t seed = 0;
  std::uint32_t frame = 0;
  bool ideal = false;  // `power` is the mean: no speckle, no noise
};

// Measures a histogram.
//
//   motion  null: nothing moves
// Expects: a RADAR as read_radar() gives it; a sound world and pose.
// Reports: W0264 for materials without a surface. Fails: E0001.
// Cost: rays² times bounces rays, about; 160 bytes a cell.
Result<RadarHistogram> measure(const Radar& radar, const RadarMoment& moment,
                               const RadarMotion* motion, const RadarOptions& options,
                               DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::instruments
