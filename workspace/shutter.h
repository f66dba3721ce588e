// Shutter of a camera: times at which the rows of an image expose, and the moments drawn for them.
// docs/scenarios.md
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace panwright::workspace {

// Row r, counted along the readout, exposes over `exposure` seconds around r·|line_time| after the
// time of the frame.
struct Shutter {
  double exposure = 0;   // seconds, >= 0
  double line_time = 0;  // seconds from a row to that below it; negative: to that above it
  std::uint32_t rows = 1;
  // Of a line scanner: rows of its sensor, that all expose every row of the image, a line time
  // apart, as the image moves over them; 0: every row has a row of the sensor.
  std::uint32_t stages = 0;

  bool instant() const { return exposure == 0 && line_time == 0 && stages == 0; }
  // Seconds after the time of the frame.
  double begin() const;
  double end() const;
};

// Division of an image's exposure into moments of equal length. A row is the mean of the moments,
// weighted by the overlap of their time with its own. Its mean time is then exact, and no moment
// draws rows that it has no share in.
class ShutterMoments {
 public:
  // Limit of the moments of an image.
  static constexpr std::size_t kMost = 1024;
  // The same of a line scanner, which draws a few rows in each.
  static constexpr std::size_t kMostOfScanner = 16384;

  // Least motion in the exposure of a row, in steps, where rows differ in time: it is the mean of
  // two moments.
  static constexpr double kLeastBlur = 0.4;

  // speed: of the image, pixels a second. step: largest motion between moments, pixels.
  // cuts: seconds after the time of the frame at which the light changes: where rows differ in
  // time, no moment has one inside.
  ShutterMoments(const Shutter& shutter, double speed, double step,
                 std::span<const double> cuts = {});

  std::size_t count() const { return count_; }
  double step() const { return step_; }  // motion between moments, pixels

  // Time of a moment, seconds after that of the frame. The last one may be half a moment after the
  // end of the shutter, where rows differ in time.
  double time(std::size_t moment) const;
  // Its begin and end, the same.
  double begin(std::size_t moment) const;
  double end(std::size_t moment) const;
  // Rows that a moment has a share in: [first, end), numbered from the top.
  struct Rows {
    std::uint32_t first = 0, end = 0;
  };
  Rows rows(std::size_t moment) const;
  // Share of a moment in a row; those of a row add up to 1.
  double share(std::size_t moment, std::uint32_t row) const;
  // Moment that holds the middle of a row's exposure.
  std::size_t middle(std::uint32_t row) const;
  // Rows of the lens above that in which a moment sees the image's row 0: 0 but of line scanners,
  // whose sensor is in the middle of the lens.
  double sensor_offset(std::size_t moment) const;
  bool is_scanner() const { return shutter_.stages > 0; }

 private:
  void divide_scan(double speed, double step);
  void divide(double speed, double step);
  void cut(std::span<const double> cuts);
  double share_of_interval(std::size_t moment, std::uint32_t row) const;
  std::int64_t first_scanned(std::size_t moment) const;
  double row_time(std::uint32_t row) const;  // middle of a row's exposure, after the first row's
  double delay(std::uint32_t row) const;     // of a row's exposure, moments

  Shutter shutter_;
  std::size_t count_ = 1;
  double per_row_ = 1;  // moments in the exposure of a row, a whole number
  double length_ = 0;   // of a moment, seconds
  double first_ = 0;    // begin of the first moment, seconds after the time of the frame
  double step_ = 0;
  // Of moments of different lengths, ascending; empty: all are as long.
  std::vector<double> edges_;
};

}  // namespace panwright::workspace
