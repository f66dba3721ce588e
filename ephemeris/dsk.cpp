#include "ephemeris/dsk.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>

namespace panwright::ephemeris {

namespace {

constexpr std::size_t kDasRecord = 1024;
// Types of data in a DAS file, in the order in which their clusters follow each other.
enum DasType : std::size_t { kCharacters, kDoubles, kIntegers };
constexpr std::size_t kDasWords[] = {1024, 128, 256};  // of a record
constexpr std::size_t kMostDskSegments = 10'000;

// Records of one type that lie beside each other.
struct DasCluster {
  std::uint64_t first = 0;  // address of its first word, from 1
  std::uint64_t words = 0;
  std::uint64_t record = 0;  // from 1
};

// Words of a DAS file by their addresses.
class Das {
 public:
  explicit Das(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool open(std::string& problem) {
    if (bytes_.size() < kDasRecord)
      return fail(problem, "it is shorter than a record of 1024 bytes");
    const std::string_view format(reinterpret_cast<const char*>(bytes_.data()) + 84, 8);
    if (format != "LTL-IEEE" && format != "BIG-IEEE")
      return fail(problem, "its byte order is neither LTL-IEEE nor BIG-IEEE");
    swap_ = (format == "BIG-IEEE") != (std::endian::native == std::endian::big);
    const std::int64_t reserved = raw<std::int32_t>(68), comments = raw<std::int32_t>(76);
    if (reserved < 0 || comments < 0) return fail(problem, "its counts of records are negative");
    std::int64_t directory = 2 + reserved + comments;
    std::uint64_t next[3] = {1, 1, 1};
    std::int64_t last = 0;
    while (directory > 0) {
      if (directory <= last || static_cast<std::uint64_t>(directory) * kDasRecord > bytes_.size())
        return fail(problem, fmt::format("directory record {} lies outside it", directory));
      last = directory;
      if (!read_directory(static_cast<std::uint64_t>(directory), next, problem)) return false;
      directory = word(directory, 1);
    }
    return true;
  }

  std::uint64_t size(DasType type) const { return ends_[type]; }

  // Copies words [address, address + count), which must exist.
  template <class T>
  bool read(DasType type, std::uint64_t address, std::uint64_t count, T* to) const {
    const auto& clusters = clusters_[type];
    auto at = std::upper_bound(clusters.begin(), clusters.end(), address,
                               [](std::uint64_t a, const DasCluster& c) { return a < c.first; });
    if (address == 0 || at == clusters.begin()) return false;
    --at;
    while (count > 0) {
      if (at == clusters.end() || address >= at->first + at->words) return false;
      const std::uint64_t inside = address - at->first;
      const std::uint64_t here = std::min(count, at->words - inside);
      const std::uint64_t byte = (at->record - 1) * kDasRecord + inside * sizeof(T);
      if (byte + here * sizeof(T) > bytes_.size()) return false;
      for (std::uint64_t k = 0; k < here; ++k) *to++ = raw<T>(byte + k * sizeof(T));
      address += here;
      count -= here;
      ++at;
    }
    return true;
  }

 private:
  static bool fail(std::string& problem, std::string why) {
    problem = std::move(why);
    return false;
  }
  template <class T>
  T raw(std::uint64_t at) const {
    std::array<std::byte, sizeof(T)> copy;
    std::memcpy(copy.data(), bytes_.data() + at, sizeof(T));
    if (swap_) std::reverse(copy.begin(), copy.end());
    T out;
    std::memcpy(&out, copy.data(), sizeof(T));
    return out;
  }
  std::int32_t word(std::int64_t record, std::size_t index) const {
    return raw<std::int32_t>((static_cast<std::uint64_t>(record) - 1) * kDasRecord + 4 * index);
  }

  // A directory: pointers, three ranges of addresses, the type of the first cluster, then numbers
  // of records, of which a negative one stands for the type before in the cycle, others for the
  // next.
  bool read_directory(std::uint64_t record, std::uint64_t* next, std::string& problem) {
    const auto at = static_cast<std::int64_t>(record);
    std::uint64_t end[3];
    for (std::size_t type = 0; type < 3; ++type) {
      const std::int32_t highest = word(at, 3 + 2 * type);
      end[type] = highest > 0 ? static_cast<std::uint64_t>(highest) : next[type] - 1;
      ends_[type] = std::max(ends_[type], end[type]);
    }
    std::int64_t type = word(at, 8) - 1;
    std::uint64_t first = record + 1;
    for (std::size_t k = 9; k < 256; ++k) {
      const std::int64_t count = word(at, k);
      if (count == 0) break;
      if (k > 9) type = (type + (count > 0 ? 1 : 2)) % 3;
      if (type < 0 || type > 2) return fail(problem, "a directory has an unknown type of data");
      const auto records = static_cast<std::uint64_t>(std::llabs(count));
      const auto kind = static_cast<std::size_t>(type);
      const std::uint64_t left = end[kind] + 1 > next[kind] ? end[kind] + 1 - next[kind] : 0;
      const std::uint64_t words = std::min(records * kDasWords[kind], left);
      if (words > 0) clusters_[kind].push_back({next[kind], words, first});
      next[kind] += words;
      first += records;
    }
    return true;
  }

  std::span<const std::byte> bytes_;
  bool swap_ = false;
  std::vector<DasCluster> clusters_[3];
  std::uint64_t ends_[3] = {0, 0, 0};
};

// DlaDescriptor of a segment in the integers: backward and forward pointers, then base and size of
// its integers, doubles and characters.
using DlaDescriptor = std::array<std::int32_t, 8>;

bool read_plates(const Das& das, const DlaDescriptor& d, const std::array<double, 24>& about,
                 DskPlates& out, std::string& problem) {
  const auto fail = [&](const char* why) {
    problem = why;
    return false;
  };
  const std::uint64_t integers = static_cast<std::uint64_t>(d[2]) + 1,
                      doubles = static_cast<std::uint64_t>(d[4]) + 1;
  std::array<std::int32_t, 10> counts;
  if (d[3] < 10 || !das.read(kIntegers, integers, 10, counts.data()))
    return fail("a segment has no counts of vertices and plates");
  const std::int64_t vertices = counts[0], plates = counts[1];
  // numbers and counts come first: 10 integers, then plates; 34 doubles, then vertices
  if (vertices < 3 || plates < 1 || 10 + 3 * plates > d[3] || 34 + 3 * vertices > d[5])
    return fail("a segment has more vertices or plates than it holds");
  out.surface = static_cast<int>(about[0]);
  out.body = static_cast<int>(about[1]);
  out.frame = static_cast<int>(about[4]);
  out.vertices.resize(static_cast<std::size_t>(vertices));
  if (!das.read(kDoubles, doubles + 34, static_cast<std::uint64_t>(3 * vertices),
                out.vertices.data()->data()))
    return fail("the vertices of a segment lie outside the file");
  std::vector<std::int32_t> corners(static_cast<std::size_t>(3 * plates));
  if (!das.read(kIntegers, integers + 10, static_cast<std::uint64_t>(3 * plates), corners.data()))
    return fail("the plates of a segment lie outside the file");
  for (const auto& vertex : out.vertices)
    for (const double x : vertex)
      if (!std::isfinite(x)) return fail("a vertex is not finite");
  for (std::size_t k = 0; k < corners.size(); ++k)
    if (corners[k] < 1 || corners[k] > vertices)
      return fail("a plate has a vertex that is not there");
  out.plates.resize(static_cast<std::size_t>(plates));
  for (std::size_t k = 0; k < out.plates.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c)
      out.plates[k][c] = static_cast<std::uint32_t>(corners[3 * k + c] - 1);
  return true;
}

}  // namespace

bool is_dsk(std::span<const std::byte> bytes) {
  return bytes.size() >= 8 && std::memcmp(bytes.data(), "DAS/DSK ", 8) == 0;
}

bool read_dsk(std::span<const std::byte> bytes, std::vector<DskPlates>& out, std::size_t& skipped,
              std::string& problem) {
  out.clear();
  skipped = 0;
  Das das(bytes);
  if (!das.open(problem)) return false;
  // integers: version, and addresses of the first and last descriptor
  std::array<std::int32_t, 3> head;
  if (!das.read(kIntegers, 1, 3, head.data())) {
    problem = "it has no list of segments";
    return false;
  }
  std::int64_t at = head[1];
  for (std::size_t k = 0; at > 0; ++k) {
    DlaDescriptor d;
    if (k == kMostDskSegments ||
        !das.read(kIntegers, static_cast<std::uint64_t>(at), 8, d.data())) {
      problem = "its list of segments leads outside the file, or never ends";
      return false;
    }
    std::array<double, 24> about;
    if (d[2] < 0 || d[4] < 0 || d[5] < 24 ||
        !das.read(kDoubles, static_cast<std::uint64_t>(d[4]) + 1, 24, about.data())) {
      problem = "a segment has no descriptor";
      return false;
    }
    for (const std::size_t index : {0, 1, 3, 4})
      if (!(std::fabs(about[index]) < 2e9)) {
        problem = "the descriptor of a segment is damaged";
        return false;
      }
    if (static_cast<int>(about[3]) == 2) {
      out.emplace_back();
      if (!read_plates(das, d, about, out.back(), problem)) return false;
    } else {
      ++skipped;
    }
    at = d[1];
  }
  return true;
}

}  // namespace panwright::ephemeris
