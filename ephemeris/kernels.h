// SPICE kernels: positions, attitudes and times of binary and text files.
//
// Read: SPK of types 1, 2, 3, 8, 9, 12, 13, 18, 19 and 21, CK of types 2 and 3, binary PCK of type
// 2, as binary files of either byte order and as transfer files; text kernels (LSK, SCLK, PCK, FK,
// IK, and meta-kernels). Other segment types are refused where they are asked for.
// Of two that give the same, the later segment wins, of files the later one.
// Sources: the Required Reading documents of NAIF for each kind; Archinal and others 2011 for the
// polynomials of text PCK.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "ephemeris/state.h"

namespace panwright::ephemeris {

inline constexpr double kLightSpeed = 299792.458;  // km/s
inline constexpr int kJ2000 = 1;                   // frame, and root of all others
inline constexpr std::uint64_t kMaxKernelBytes = 16ull << 30;

enum class Aberration : std::uint8_t {
  none,  // place of the target at the time
  lt,    // place as its light left: one iteration
  lt_s,  // the same, and turned by the observer's velocity
  cn,    // as lt, iterated to convergence
  cn_s,
};
// "none", "LT", "LT+S", "CN", "CN+S".
std::optional<Aberration> aberration_named(std::string_view name);

struct Apparent {
  State state;            // its velocity is without stellar aberration
  double light_time = 0;  // seconds
};

// Returns whether bytes begin as a kernel of any kind, read or not.
bool is_kernel(std::span<const std::byte> bytes);

// A segment, as lists show it.
struct SegmentInfo {
  std::string file;
  std::string kind;  // "SPK type 2"
  std::string name;
  int id = 0;                 // of a body, instrument or frame
  int relative = 0;           // its centre, or reference frame
  int frame = 0;              // of an SPK
  double begin = 0, end = 0;  // ET; of a CK without clock kernel ticks
  bool in_ticks = false;
  bool read = true;  // false: its type is not read
};

// A kernel in memory, for tests: the bytes must stay.
struct KernelBytes {
  std::string name;
  std::span<const std::byte> bytes;
};

// Kernels never change; any number of threads may read them. Questions that have no answer return
// nothing and a problem, one lower-case sentence.
class Kernels {
 public:
  // Maps files, in their order. A meta-kernel adds its own, relative to its folder.
  //
  // Reports: W8016. Fails: E0101, E0104, E8015 for one that is damaged or of another kind.
  static Result<Kernels> load(std::span<const std::filesystem::path> paths, DiagnosticLog& log);
  static Result<Kernels> of(std::span<const KernelBytes> kernels, DiagnosticLog& log);

  // Number of a body or frame by its name, of any letter case, or its number as text.
  std::optional<int> body(std::string_view name) const;
  std::optional<int> frame(std::string_view name) const;
  // Name of a body; its number where it has none.
  std::string body_name(int id) const;
  std::string frame_name(int id) const;

  // State of a target relative to an observer, in axes of a frame. With aberration the frame is
  // that of the time at which light left its centre.
  //
  // Cost: O(chain · log segments); a planet from the Earth 0.5 µs.
  std::optional<Apparent> state(int target, int observer, int frame, double et,
                                Aberration aberration, std::string& problem) const;
  std::optional<Attitude> attitude(int frame, double et, std::string& problem) const;
  // Semi-axes of a body, km.
  std::optional<Vec3> radii(int body) const;

  // ET of a date in UTC, and the other way: "2004-06-11T19:32:00.5", 9 decimals at most.
  std::optional<double> et_of_utc(std::string_view text, std::string& problem) const;
  std::optional<std::string> utc_of_et(double et, std::string& problem) const;
  // Encoded ticks of a spacecraft's clock, without partitions.
  std::optional<double> et_of_ticks(int clock, double ticks, std::string& problem) const;
  std::optional<double> ticks_of_et(int clock, double et, std::string& problem) const;

  // Times at which state() without aberration, and attitude(), have an answer: ascending, disjoint.
  std::vector<Interval> coverage(int target, int observer, int frame) const;
  std::vector<Interval> attitude_coverage(int frame) const;
  // All segments, in the order of files.
  std::vector<SegmentInfo> segments() const;
  // Names of the variables of text kernels, ascending.
  std::vector<std::string> variables() const;
  // State or angles of one segment of segments(), in its own axes, whatever wins. For tests.
  std::optional<State> segment_state(std::size_t segment, double et) const;
  std::optional<Attitude> segment_pointing(std::size_t segment, double ticks) const;

  struct Data;

 private:
  std::optional<double> et_of_ticks_or(int instrument, double ticks) const;
  explicit Kernels(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

}  // namespace panwright::ephemeris
