#include <fmt/core.h>
#include <algorithm>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>

#include "base/child_process.h"
#include "base/text.h"
#include "terrain/internal/found.h"
#include "terrain/internal/gdal_wire.h"

namespace panwright::terrain {

namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "panwright-gdal";
constexpr std::size_t kMostHead = 1u << 20;
// GDAL's libraries take address space before it reads
constexpr std::uint64_t kMemory = 8ull << 30;
constexpr double kSeconds = 3600;

std::optional<fs::path> reader_program() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& folder :
       {self, self / PANWRIGHT_LIBEXEC_FROM_BIN, fs::path(PANWRIGHT_LIBEXEC)})
    if (fs::is_regular_file(folder / kProgram, error)) return folder / kProgram;
  return std::nullopt;
}

using Head = std::map<std::string, std::string>;

// Asks the program for rows of a file. head: of the answer. Returns the problem; empty: none.
std::string ask(const std::string& path, std::uint32_t band, std::uint32_t first,
                std::uint32_t count, Head& head, const std::function<bool(std::string_view)>& take,
                const Job& job) {
  const auto program = reader_program();
  if (!program) return "absent";
  const char* library = std::getenv(kGdalVariable);
  const std::string request = fmt::format("{}\n{}\n{}\n{}\n{}\n", path, band, first, count,
                                          library == nullptr ? "" : library);
  const std::string_view input[] = {request};
  std::string text;
  bool in_rows = false, refused = false;
  const auto end = run_process(
      *program, input, {kMemory, kSeconds, 4 * kSeconds},
      [&](std::string_view bytes) {
        if (in_rows) return take(bytes);
        text += bytes;
        const std::size_t blank = text.find("\n\n");
        if (blank == text.npos) return text.size() < kMostHead;
        in_rows = true;
        std::string_view rest = std::string_view(text).substr(0, blank + 1);
        if (!rest.starts_with(kGdalMark)) return false;
        rest.remove_prefix(kGdalMark.size());
        while (!rest.empty()) {
          const std::string_view line = rest.substr(0, rest.find('\n'));
          rest.remove_prefix(line.size() + 1);
          const std::size_t space = std::min(line.find(' '), line.size());
          head.emplace(line.substr(0, space), line.substr(std::min(space + 1, line.size())));
        }
        refused = head.contains("error");
        return !refused && take(std::string_view(text).substr(blank + 2));
      },
      job);
  if (refused) return head["error"];
  if (!in_rows || end.how == ProcessEnd::How::not_started || end.how == ProcessEnd::How::killed ||
      end.how == ProcessEnd::How::out_of_time)
    return "it ended without an answer";
  return {};
}

double head_number(const Head& head, const char* key, double otherwise) {
  const auto found = head.find(key);
  return found == head.end() ? otherwise : parse_double(found->second).value_or(otherwise);
}
std::string head_text(const Head& head, const char* key) {
  const auto found = head.find(key);
  return found == head.end() ? std::string() : found->second;
}

class GdalRows : public RowSource {
 public:
  GdalRows(std::string path, std::uint32_t width, std::uint32_t band, Decoder decoder)
      : path_(std::move(path)), width_(width), band_(band), decoder_(std::move(decoder)) {}

  bool read(std::uint32_t first, std::uint32_t count, const RowsReceiver& to, DiagnosticLog& log,
            const Job& job) const override {
    std::vector<double> values(width_);
    std::vector<VoidKind> voids(width_);
    std::string left;
    Head head;
    std::uint32_t next = first;
    bool wanted = true;
    const std::size_t row_bytes = std::size_t{width_} * sizeof(double);
    const std::string problem = ask(
        path_, band_, first, count, head,
        [&](std::string_view bytes) {
          left += bytes;
          std::size_t at = 0;
          for (; wanted && left.size() - at >= row_bytes && next < first + count; at += row_bytes) {
            std::memcpy(values.data(), left.data() + at, row_bytes);
            decoder_.judge(values, voids);
            wanted = to({next++, 1, values, voids});
          }
          left.erase(0, at);
          return wanted;
        },
        job);
    if (wanted && next < first + count)
      log.report_file(Code("E9601"), path_,
                      fmt::format("GDAL gave {} of {} rows{}{}", next - first, count,
                                  problem.empty() ? "" : ": ", problem));
    return next == first + count;
  }

 private:
  std::string path_;
  std::uint32_t width_, band_;
  Decoder decoder_;
};

SampleType type_named(const std::string& name) {
  using K = SampleType::Kind;
  const auto bits =
      parse_double(name.substr(std::min(name.find_first_of("0123456789"), name.size())));
  const unsigned bytes =
      name == "Byte" ? 1 : static_cast<unsigned>(std::clamp(bits.value_or(64), 8.0, 64.0)) / 8;
  const K kind = name.starts_with("Float") ? K::real
                 : name.starts_with("Int") ? K::signed_integer
                                           : K::unsigned_integer;
  return {kind, bytes == 0 ? 8 : bytes, false};
}

bool is_absent(const std::string& problem) { return problem == "absent"; }

}  // namespace

bool reads_gdal() {
  Head head;
  return !is_absent(ask("", 1, 0, 0, head, [](std::string_view) { return true; }, {}));
}

Result<Found> read_gdal(const Opening& o) {
  constexpr const char* kRead =
      "PDS3, PDS4, ISIS cubes, GeoTIFF and ENVI are read, and by GDAL, where libgdal is installed, "
      "its own formats";
  if (o.name.find('\n') != o.name.npos) return o.fail("the name of the file has a line break");
  const std::string path = fs::absolute(o.path).string();
  Head head;
  const std::string problem = ask(
      path, o.options.band, 0, 0, head, [](std::string_view) { return true; }, o.job);
  if (is_absent(problem))
    return o.fail("the file is of no known kind, and GDAL is not installed here", kRead);
  if (!problem.empty())
    return o.fail(
        fmt::format("the file is of no known kind, and GDAL does not read it: {}", problem), kRead);
  Found found;
  DemInfo& info = found.info;
  info.format = fmt::format("GDAL ({})", head_text(head, "driver"));
  info.files = {o.name};
  const auto size = [&](const char* key) {
    const double value = head_number(head, key, 0);
    return value >= 1 && value < 2147483648.0 ? static_cast<std::uint32_t>(value) : 0u;
  };
  info.width = size("width");
  info.height = size("height");
  info.bands = size("bands");
  if (!o.check_size(info)) return failed;
  found.layout.type = type_named(head_text(head, "type"));
  info.scale = head_number(head, "scale", 1);
  info.offset = head_number(head, "offset", 0);
  if (const auto none = parse_double(head_text(head, "missing"))) {
    found.rules.values.emplace_back(*none, VoidKind::missing);
    info.missing = *none;
  }
  if (const auto asked = o.options.missing)
    found.rules.values.emplace_back(*asked, VoidKind::missing);
  found.unit = metres_of_unit(head_text(head, "unit"));
  info.unit_stated = found.unit.has_value();
  Map& m = info.map;
  const WktPlace place = read_wkt(head_text(head, "wkt"), info);
  found.cited = place.names;
  found.cited_radius = place.radius;
  if (const auto asked = o.options.radius) m.radius = m.polar_radius = *asked;
  found.unknown_radius = !(m.radius > 0);
  std::array<double, 6> t{};
  std::string numbers = head_text(head, "transform");
  std::size_t known = 0;
  for (std::size_t end = 0; known < 6 && (end = numbers.find(' ')) != numbers.npos; ++known) {
    t[known] = parse_double(numbers.substr(0, end)).value_or(0);
    numbers.erase(0, end + 1);
  }
  if (known < 6 || t[2] != 0 || t[4] != 0 || !(t[1] > 0) || !(t[5] < 0)) {
    o.warn("GDAL gives no place on a map, or one that is turned: heights have no places");
    m.kind = Map::Kind::none;
    m.dx = m.dy = 0;
  } else if (place.degrees) {
    place_in_degrees(info, t[0], t[3], t[1], -t[5]);
  } else {
    m.left = (t[0] - place.false_easting) * place.metres;
    m.top = (t[3] - place.false_northing) * place.metres;
    m.dx = t[1] * place.metres;
    m.dy = -t[5] * place.metres;
  }
  found.rows = std::make_shared<GdalRows>(path, info.width, info.band,
                                          Decoder(found.layout.type, found.rules));
  return found;
}

}  // namespace panwright::terrain
