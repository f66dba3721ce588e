// Elevation files: PDS3, PDS4, ISIS cubes, GeoTIFF, ENVI, and what GDAL reads, as rows of heights
// in metres over a sphere.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "terrain/map.h"

namespace panwright::terrain {

// Reason why a post has no height.
enum class VoidKind : std::uint8_t {
  none,                 // it has one
  missing,              // the file's constant for missing data
  null,                 // ISIS special pixels
  low_instrument,       // LIS
  low_representation,   // LRS
  high_instrument,      // HIS
  high_representation,  // HRS
  out_of_range,         // below or above the valid range that the file states
  not_finite,           // NaN or infinite
  undeclared,           // beyond 1e30, so a special value that the file does not state
};
inline constexpr std::size_t kVoidKinds = 10;
const char* void_name(VoidKind kind);  // "missing"

enum class Quantity : std::uint8_t {
  height,  // over the sphere, or over the areoid or ellipsoid that the file means
  radius,  // from the centre of the body; heights are these less the sphere's radius
  plain,   // no elevations, as an albedo: numbers as they are
};

// Answers to what a file leaves in doubt.
struct DemOptions {
  std::uint32_t band = 1;                    // from 1
  std::optional<double> unit;                // metres of a number
  std::optional<Quantity> quantity;          // meaning of numbers
  std::optional<double> radius;              // metres, of the sphere
  std::optional<double> body_radius;         // metres, of images of a whole body
  std::optional<double> spacing;             // metres of a pixel, of files without a map; > 0
  std::optional<double> missing;             // one more value, as stored, that stands for none
  std::optional<bool> positive_west;         // longitudes count to the west
  std::optional<std::uint64_t> data_offset;  // bytes before the first sample
  // true: the stated bounds place a map whose offsets differ from them
  std::optional<bool> place_by_bounds;
  bool gdal = true;                   // files of other formats are tried with GDAL
  std::uint64_t memory = 1ull << 30;  // bytes of buffers, at most
};

struct DemInfo {
  std::string format;  // "PDS3", "PDS4", "ISIS cube", "GeoTIFF", "ENVI", "GDAL (driver)"
  std::uint32_t width = 0, height = 0, bands = 1, band = 1;
  std::string sample;      // "16-bit integer, little-endian"
  std::string target;      // body, as the file names it; may be empty
  std::string frame;       // coordinate system; may be empty
  std::string projection;  // as the file names it
  Quantity quantity = Quantity::height;
  std::string unit;  // of the file: "m", "km"; empty where it states none and plain
  bool unit_stated = false;
  double scale = 1, offset = 0;  // of stored numbers, in the file's unit
  Map map;
  std::optional<double> missing;   // constant for missing data, as stored
  std::vector<std::string> files;  // read, the label first
};

// Rows of a raster, from the top.
struct Rows {
  std::uint32_t first = 0, count = 0;
  std::span<const double> heights;  // width·count, metres over the sphere; NaN where void
  std::span<const VoidKind> voids;  // width·count
};

// Returns whether more is wanted.
using RowsReceiver = std::function<bool(const Rows&)>;

class RowSource;

// An opened file. Any number of threads may read it.
class Dem {
 public:
  // Opens a file, or the one its label names. Its kind follows from its first bytes.
  //
  // Fails: E0101, E9601 (damaged, cut short, or of no known kind), E9602 (in doubt: the message
  // names the option). Reports W9603, N9604. Cost: O(label), and 64 rows.
  static Result<Dem> open(const std::filesystem::path& path, const DemOptions& options,
                          DiagnosticLog& log, const Job& job = {});

  const DemInfo& info() const { return info_; }

  // Gives rows [first, first + count) in bands, from the top. True where all were given.
  //
  // Fails: E0001, E9601. Memory: a band of rows, strips or tiles.
  bool read(std::uint32_t first, std::uint32_t count, const RowsReceiver& to, DiagnosticLog& log,
            const Job& job = {}) const;

 private:
  Dem() = default;
  DemInfo info_;
  double factor_ = 1, shift_ = 0;  // metres = stored · factor + shift
  std::shared_ptr<const RowSource> source_;
};

// Returns whether files of other formats can be read: panwright-gdal is there (beside the running
// program, or in its installation) and finds GDAL. PANWRIGHT_GDAL names its library.
bool reads_gdal();

}  // namespace panwright::terrain
