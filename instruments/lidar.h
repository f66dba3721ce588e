// LiDARs: pulses of a scan, the light that surfaces return, and the echoes that a receiver makes of
// it. Pure functions of world, instrument, seed and frame: the same for any number of threads.
//
//   auto lidar = instruments::read_lidar(text, "scanner", folder, log);
//   auto cloud = instruments::measure(*lidar, world, pose, {}, log);
//
// Axes of an instrument are those of a camera: x right, y down, z along the boresight. Azimuth
// turns from z to x, elevation from there to -y (up); azimuth is the outer axis.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/math.h"
#include "base/result.h"
#include "trace/scene.h"
#include "world/world.h"

namespace panwright::instruments {

enum class ScanPattern : std::uint8_t {
  flash,      // all pixels of an array at once
  raster,     // line by line, or to and fro
  spiral,     // of Archimedes, at constant speed
  lissajous,  // two sines
  rotating,   // channels of fixed elevations about the vertical axis
  file,       // times and angles of a table
};

// Angles in radians, times in seconds.
struct Scan {
  ScanPattern pattern = ScanPattern::flash;
  std::uint32_t columns = 128, rows = 128;  // of flash and raster; rotating: columns a turn
  double fov = 20 * kDegree;                // flash: full horizontal angle
  Vec2 azimuth{-0.2, 0.2};                  // raster, rotating: first and last
  Vec2 elevation{-0.2, 0.2};                // raster
  bool zigzag = false;                      // raster: every other line runs back
  double rate_hz = 10'000;                  // pulses a second; rotating: of each channel
  std::uint32_t pulses = 10'000;            // spiral, lissajous
  double radius = 0.2;                      // spiral: largest angle off the boresight
  double turns = 50;                        // spiral
  Vec2 amplitude{0.2, 0.2};                 // lissajous: azimuth, elevation
  Vec2 frequency_hz{41, 37};                // lissajous
  double phase = 0;                         // lissajous: of the azimuth
  std::vector<double> channels;             // rotating: elevations
  std::vector<Vec3> table;                  // file: time, azimuth, elevation
};

enum class RangeMethod : std::uint8_t { threshold, fraction, peak, centroid };
enum class EchoChoice : std::uint8_t { first, strongest, last, all };

struct Lidar {
  std::string name;
  Scan scan;

  // Beam. Flash: the light of a pulse falls evenly on the pixels, and a pixel's field is the
  // footprint; else it is a Gaussian.
  double wavelength = 1064e-9;  // metres
  double pulse_energy = 1e-6;   // joules, at the aperture
  double eye_safe_energy = 0;   // joules: pulses have no more; 0: no limit
  double pulse_fwhm = 5e-9;     // seconds, of power
  double divergence = 1e-3;     // radians: full angle at 1/e² of the intensity
  std::uint32_t sub_rays = 16;  // 1 to 1024; 1: the axis alone
  int band = 0;                 // of materials: 0 red, 1 green, 2 blue

  // Receiver.
  double aperture = 0.05;           // metres, diameter
  double efficiency = 0.7;          // of all optics, both ways, and the filter
  double quantum_efficiency = 0.7;  // electrons of a photon
  double field = 1e-3;              // radians, full angle of the background; flash: of a pixel
  double filter_nm = 2;             // nanometres
  double response_fwhm = 0;         // seconds, of the electronics
  double sample = 0;                // seconds between samples; 0: half of the pulse's sigma
  bool photon_counting = false;     // the first electron of a pulse stops the clock

  // Noise.
  double electronics_e = 0;  // RMS electrons of a sample
  double excess_noise = 1;   // factor of the variance of shot noise; 0: no shot noise
  double dark_e_per_s = 0;
  bool sun = true;         // background of sunlit surfaces
  double sun_w_m2_nm = 0;  // at 1 AU; 0: of a black body of 5772 K
  double jitter = 0;       // metres RMS, of each range
  double drop_outs = 0;    // share of pulses without an answer

  // Detection.
  RangeMethod method = RangeMethod::fraction;
  double threshold_e = 0;  // electrons of a sample
  EchoChoice echoes = EchoChoice::strongest;
  std::uint32_t max_echoes = 5;    // of all; 1 to 16
  Vec2 gate{0, 1e9};               // metres
  double saturation_e = 0;         // electrons of a sample; 0: none
  double recovery = 0;             // metres without echoes behind a saturated one
  std::uint32_t bloom_pixels = 0;  // flash: around a saturated pixel, 0 to 32
  double bloom_share = 0;          // of the light beyond saturation
  double walk_reference = 10;      // method threshold: amplitude over threshold where
                                   // ranges are right
  double walk_residual = 1;        // share of the range walk that is not corrected
  double bias = 0;                 // metres
  double resolution = 0;           // metres: ranges are multiples; 0: none
};

// Pulse, or pixel of a flash.
struct Pulse {
  double time = 0;                    // seconds after the first
  Vec3 direction{0, 0, 1};            // unit, instrument axes
  std::uint32_t row = 0, column = 0;  // of flash, raster, rotating; else 0 and its number
};

inline constexpr std::size_t kMostPulses = 50'000'000;

// Returns the pulses of a scan in their order. Expects: as read_lidar() gives it.
std::vector<Pulse> pulses_of(const Scan& scan);

// Reads a LiDAR (docs/lidar.md). folder: of a table of pulses.
// Fails: E0261 with the member; E0262, E0101, E0104 for the table.
Result<Lidar> read_lidar(std::string_view text, const std::string& name,
                         const std::filesystem::path& folder, DiagnosticLog& log);

// Flags of points.
inline constexpr std::uint8_t kSaturated = 1;
inline constexpr std::uint8_t kFalseAlarm = 2;  // no surface: noise, or background
inline constexpr std::uint8_t kMixed = 4;       // light of several surfaces
inline constexpr std::uint8_t kBloomed = 8;     // of a neighbour's saturation
inline constexpr std::uint8_t kGhost = 16;      // by way of a mirror

struct LidarPoint {
  std::uint32_t pulse = 0;
  std::uint8_t echo = 0, echoes = 1;  // number from 0; echoes of the pulse
  std::uint8_t flags = 0;
  double time = 0;       // seconds, as the pulse
  double range = 0;      // metres, measured
  double intensity = 0;  // electrons, measured
  // Of a Lambert surface that faces the instrument and fills the footprint; counting photons: 0.
  double reflectance = 0;
  Vec3 position{0};  // metres, measured, in the frame of LidarOptions
  // Truth: mean range of the light, metres; its share of the surface that gives most; the cosine of
  // incidence there, and that surface. NaN, 0: a false alarm.
  double true_range = std::numeric_limits<double>::quiet_NaN();
  double share = 0;
  double cosine = 0;
  trace::Ids ids;
};

enum class PulseStatus : std::uint8_t { no_echo, echo, out_of_gate, dropped };

struct LidarCloud {
  std::vector<Pulse> pulses;
  std::vector<PulseStatus> status;      // of each
  std::vector<LidarPoint> points;       // by pulse and echo
  std::vector<world::Pose> poses;       // world_from_instrument: one, or one of each pulse
  std::uint32_t columns = 0, rows = 0;  // of flash and raster; else 0
  double energy = 0;                    // joules of a pulse, within the eye-safe limit
  double power = 0;                     // watts, mean over the scan; 0: of a single flash
};

// State at the time of a pulse.
struct LidarMoment {
  world::World world;
  world::Pose pose;  // world_from_instrument
};

struct LidarOptions {
  std::uint64_t seed = 0;
  std::uint32_t frame = 0;  // number of the scan: other noise
  bool ideal = false;       // the axis of each pulse alone, without receiver and noise
  // Frame of positions: the instrument's at the pulse, the world's, or that of a target's model.
  static constexpr std::int32_t kInstrument = -2, kWorld = -1;
  std::int32_t frame_of = kInstrument;
  // Sets the state at a time after the first pulse, beginning with that of the world and pose
  // given; called in the order of the pulses, on one thread; false: failed, and reported. Empty:
  // nothing moves. Copies of one world, so that stamps hold.
  std::function<bool(double time, LidarMoment& moment)> motion;
};

// Measures a cloud.
//
// Expects: a LiDAR as read_lidar() gives it; a sound world and pose.
// Fails: E0001; as options.motion.
// Cost: pulses · sub_rays rays; with motion also the placements of what moves, for each time.
Result<LidarCloud> measure(const Lidar& lidar, const world::World& world, const world::Pose& pose,
                           const LidarOptions& options, DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::instruments
