// Cells of a RADAR's histogram, from echoes. Private to instruments.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include "base/job.h"
#include "instruments/radar.h"

namespace panwright::instruments {

// Echo of one ray: of metal an amplitude whose square is watts, else watts.
struct RadarEcho {
  double range = 0;                 // metres, half of the way
  double speed = 0;                 // m/s
  double amplitude = 0, phase = 0;  // of metal, else 0; radians
  double power = 0;                 // of other surfaces, else 0
  double section = 0;  // cross-section without the pattern, m², or of metal its signed root
  double azimuth = 0, elevation = 0;
  std::uint32_t target = 0;
};

// Echoes are added in their order; cells overlap as the response of the receiver, a Gaussian of one
// cell's width at half power.
class RadarGrid {
 public:
  explicit RadarGrid(const Radar& radar);
  std::uint32_t ranges() const { return range_.count; }
  std::uint32_t speeds() const { return speed_.count; }

  void add(const RadarEcho& echo);
  // Returns whether an echo is within the histogram's edges.
  bool holds(const RadarEcho& echo) const {
    return range_.holds(echo.range) && speed_.holds(echo.speed);
  }
  // Sets the planes and axes, and what is of all echoes. Throws Cancelled.
  void finish(const RadarOptions& options, RadarHistogram& out, const Job& job);

 private:
  struct Axis {
    double first = 0, step = 0;         // of the histogram, centres
    std::uint32_t count = 0, fine = 0;  // fine: half steps, with margins
    // Place on the fine axis.
    double place(double value) const;
    bool holds(double value) const;
  };
  static Axis axis_of(const Vec2& window, double step);
  enum Plane : std::uint8_t { re, im, power, re_az, im_az, power_az, re_el, im_el, power_el };
  static constexpr std::size_t kPlanes = 9;

  void smooth(std::size_t plane, std::vector<double>& out) const;
  void draw(const RadarOptions& options, RadarHistogram& out,
            const std::array<std::vector<double>, kPlanes>& planes) const;

  const Radar& radar_;
  Axis range_, speed_;
  std::array<std::vector<double>, kPlanes> fine_;
};

}  // namespace panwright::instruments
