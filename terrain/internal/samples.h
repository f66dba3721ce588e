// Stored numbers of rasters: types, layouts, and the values that stand for none. Private to
// terrain.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "terrain/dem.h"

namespace panwright::terrain {

struct SampleType {
  enum class Kind : std::uint8_t { unsigned_integer, signed_integer, real, vax_real };
  Kind kind = Kind::real;
  unsigned bytes = 4;  // 1, 2, 4 or 8
  bool big_endian = false;

  std::string words() const;  // "16-bit integer, big-endian"
};

// Values of stored numbers that stand for none.
struct VoidRules {
  std::vector<std::pair<std::uint64_t, VoidKind>> patterns;  // bits of the stored number
  std::vector<std::pair<double, VoidKind>> values;           // rounded to the sample type
  double least = -std::numeric_limits<double>::infinity();
  double largest = std::numeric_limits<double>::infinity();
  bool undeclared = true;  // real numbers beyond 1e30 are none

  void add_isis(const SampleType& type);
};

// Decoder of a run of stored numbers.
class Decoder {
 public:
  Decoder(SampleType type, const VoidRules& rules);
  // from: of stored numbers `stride` bytes apart. to: as stored, NaN where void.
  void run(const std::byte* from, std::size_t stride, std::span<double> to,
           std::span<VoidKind> voids) const;
  // The same for numbers that another library has decoded.
  void judge(std::span<double> values, std::span<VoidKind> voids) const;

 private:
  template <class T>
  void run_as(const std::byte* from, std::size_t stride, std::span<double> to,
              std::span<VoidKind> voids) const;
  VoidKind kind_of(double value, std::uint64_t bits) const;

  SampleType type_;
  VoidRules rules_;
};

// Order of the samples of a raster in a file.
struct RawLayout {
  enum class Order : std::uint8_t { bands, lines, samples };  // BSQ, BIL, BIP
  Order order = Order::bands;
  std::uint64_t start = 0;  // bytes before the first sample
  std::uint32_t width = 0, height = 0, bands = 1;
  std::uint64_t prefix = 0, suffix = 0;           // bytes before and after each line
  std::uint32_t tile_width = 0, tile_height = 0;  // of ISIS tiles; 0: lines
  SampleType type;

  // Bytes from the start of the file to the end of the last sample; 0 where beyond 2^62.
  std::uint64_t end() const;
};

// Source of rows of stored numbers.
class RowSource {
 public:
  virtual ~RowSource() = default;
  // Gives rows in bands; heights are stored numbers. True where all were given.
  virtual bool read(std::uint32_t first, std::uint32_t count, const RowsReceiver& to,
                    DiagnosticLog& log, const Job& job) const = 0;
};

// Rows of uncompressed samples. Expects: layout.end() is not 0 and within the file, and band is
// from 1 to layout.bands.
std::unique_ptr<RowSource> raw_source(MappedFile file, const RawLayout& layout, std::uint32_t band,
                                      const VoidRules& rules);

}  // namespace panwright::terrain
