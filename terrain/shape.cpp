#include "terrain/shape.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "base/file.h"
#include "base/text.h"
#include "ephemeris/dsk.h"
#include "terrain/internal/label.h"

namespace panwright::terrain {

namespace {

namespace fs = std::filesystem;

bool is_blank_char(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// Words of a text, by lines.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}

  // Words of the next line that has any; empty at the end. Those from a '#' on are left out.
  std::vector<std::string_view> line() {
    std::vector<std::string_view> out;
    while (out.empty() && !rest_.empty()) {
      const std::size_t size = std::min(rest_.find('\n'), rest_.size());
      std::string_view text = rest_.substr(0, size);
      rest_.remove_prefix(std::min(size + 1, rest_.size()));
      ++number_;
      text = text.substr(0, text.find('#'));
      std::size_t at = 0;
      while (at < text.size() && out.size() < kMostWords) {
        while (at < text.size() && is_blank_char(text[at])) ++at;
        const std::size_t begin = at;
        while (at < text.size() && !is_blank_char(text[at])) ++at;
        if (at > begin) out.push_back(text.substr(begin, at - begin));
      }
    }
    return out;
  }
  std::size_t number() const { return number_; }

 private:
  static constexpr std::size_t kMostWords = 64;
  std::string_view rest_;
  std::size_t number_ = 0;
};

std::optional<double> number_in(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  // Fortran writes D for E
  std::string copy;
  if (word.find_first_of("Dd") != word.npos) {
    copy = word;
    for (char& c : copy)
      if (c == 'D' || c == 'd') c = 'e';
    word = copy;
  }
  return parse_double(word);
}

enum class ShapeKind { obj, tab, plt, icq, dsk, none };

// By its first lines: "v x y z"; one number, then lines of 3 (ICQ) or 4 (plates).
ShapeKind kind_by(std::string_view bytes, const fs::path& path) {
  if (ephemeris::is_dsk(std::as_bytes(std::span(bytes.data(), bytes.size()))))
    return ShapeKind::dsk;
  if (std::memchr(bytes.data(), 0, std::min<std::size_t>(bytes.size(), 512)) != nullptr)
    return ShapeKind::none;
  Words words(bytes.substr(0, 1 << 16));
  constexpr std::string_view kObjWords[] = {"mtllib", "o", "g", "vn", "vt", "usemtl", "s", "v"};
  const auto first = words.line();
  if (first.empty()) return ShapeKind::none;
  if (std::find(std::begin(kObjWords), std::end(kObjWords), first[0]) != std::end(kObjWords)) {
    const std::string extension = path.extension().string();
    return extension == ".tab" || extension == ".TAB" ? ShapeKind::tab : ShapeKind::obj;
  }
  const auto is_number = [](std::string_view word) { return number_in(word).has_value(); };
  const auto second = words.line();
  if (!is_number(first[0]) || second.empty() || !is_number(second[0])) return ShapeKind::none;
  if (first.size() == 1 && second.size() == 3) return ShapeKind::icq;
  if (first.size() <= 2 && second.size() == 4) return ShapeKind::plt;
  return ShapeKind::none;
}

class ShapeReader {
 public:
  ShapeReader(const fs::path& path, const ShapeOptions& options, DiagnosticLog& log)
      : path_(path), name_(path.string()), options_(options), log_(log) {}

  Result<Shape> read() {
    auto file = MappedFile::open(path_, log_);
    if (!file) return failed;
    if (file->bytes().size() > options_.bytes) return fail("it is larger than the limit allows");
    const std::string_view text(reinterpret_cast<const char*>(file->bytes().data()),
                                file->bytes().size());
    const ShapeKind kind = text.empty() ? ShapeKind::none : kind_by(text, path_);
    bool good = false;
    is_table_ = kind == ShapeKind::tab || kind == ShapeKind::plt;
    switch (kind) {
      case ShapeKind::obj:
      case ShapeKind::tab:
        out_.format = kind == ShapeKind::obj ? "OBJ" : "plates (.tab)";
        good = read_lines(text);
        break;
      case ShapeKind::plt:
        out_.format = "plates (.plt)";
        good = read_counted(text);
        break;
      case ShapeKind::icq:
        out_.format = "ICQ";
        good = read_icq(text);
        break;
      case ShapeKind::dsk:
        good = read_kernel(file->bytes());
        break;
      case ShapeKind::none:
        return fail("it is no shape model: expected plates (.tab, .plt), OBJ, ICQ or a DSK");
    }
    if (!good) return failed;
    if (out_.vertices.size() < 3 || out_.plates.empty())
      return fail(fmt::format("it has {} vertices and {} plates", out_.vertices.size(),
                              out_.plates.size()));
    if (!settle_unit(kind)) return failed;
    return std::move(out_);
  }

 private:
  Failed fail(const std::string& message) {
    log_.report_file(Code("E9606"), name_, message);
    return failed;
  }
  bool fail_line(std::size_t line, const std::string& message) {
    (void)fail(fmt::format("line {}: {}", line, message));
    return false;
  }

  bool add_vertex(const std::vector<std::string_view>& words, std::size_t from, std::size_t line) {
    Vec3 p;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto value = from + k < words.size() ? number_in(words[from + k]) : std::nullopt;
      if (!value) return fail_line(line, "expected 3 coordinates");
      p[static_cast<int>(k)] = *value;
    }
    if (out_.vertices.size() >= 0x7fffffff) return fail_line(line, "it has too many vertices");
    out_.vertices.push_back(p);
    return true;
  }

  // Index of a word "12", "12//3" or "-1", from 0; none: not one.
  std::optional<std::uint32_t> index_in(std::string_view word) const {
    const auto number = number_in(word.substr(0, word.find('/')));
    if (!number || *number != std::floor(*number)) return std::nullopt;
    const double count = double(out_.vertices.size());
    // tables may count from 0, which is seen when all is read
    const double index = *number < 0 ? count + *number : *number - (is_table_ ? 0 : 1);
    if (index < 0 || index >= 2147483647.0) return std::nullopt;
    return static_cast<std::uint32_t>(index);
  }
  bool add_plate(const std::vector<std::string_view>& words, std::size_t from, std::size_t line) {
    if (words.size() < from + 3) return fail_line(line, "expected 3 vertices of a plate");
    std::vector<std::uint32_t> corners;
    for (std::size_t k = from; k < words.size(); ++k) {
      const auto index = index_in(words[k]);
      if (!index)
        return fail_line(line,
                         fmt::format("{} is no vertex, which count from 1", in_quotes(words[k])));
      corners.push_back(*index);
    }
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      out_.plates.push_back({corners[0], corners[k], corners[k + 1]});
    return true;
  }
  bool check_plates() {
    if (is_table_) count_from_one();
    for (const auto& plate : out_.plates)
      for (const std::uint32_t index : plate)
        if (index >= out_.vertices.size()) {
          (void)fail(
              fmt::format("a plate has vertex {} from 0, and there are {}: it may be cut short",
                          index, out_.vertices.size()));
          return false;
        }
    return true;
  }

  void count_from_one() {
    const auto has_zero = [](const auto& plate) {
      return plate[0] == 0 || plate[1] == 0 || plate[2] == 0;
    };
    if (std::any_of(out_.plates.begin(), out_.plates.end(), has_zero))
      return log_.report_file(Code("W9603"), name_,
                              "plates count vertices from 0, where the format counts from 1; they "
                              "are read so");
    for (auto& plate : out_.plates)
      for (std::uint32_t& index : plate) --index;
  }

  // "v x y z" and "f i j k": an OBJ's positions and facets alone; importers/meshes reads the rest.
  bool read_lines(std::string_view text) {
    Words words(text);
    for (auto line = words.line(); !line.empty(); line = words.line()) {
      if (line[0] == "v" && !add_vertex(line, 1, words.number())) return false;
      if (line[0] == "f" && !add_plate(line, 1, words.number())) return false;
    }
    return check_plates() && check_counts();
  }

  // Counts that a label beside the file states.
  bool check_counts() {
    const auto label = beside();
    if (!label) return true;
    for (const auto& [table, count] :
         {std::pair{"VERTEX_TABLE", out_.vertices.size()}, {"FACET_TABLE", out_.plates.size()}}) {
      const LabelItem* block = find_block(label->root, table);
      const auto rows = block == nullptr ? std::nullopt : count_of(*block, "ROWS");
      if (!rows || *rows == count) continue;
      (void)fail(
          fmt::format("its label states {} rows of {}, and the file has {}: it was cut short",
                      *rows, table, count));
      return false;
    }
    return true;
  }

  // A count, lines "number x y z"; a count, lines "number i j k". Both counts may stand in the
  // first line.
  bool read_counted(std::string_view text) {
    Words words(text);
    const auto head = words.line();
    const auto count_in = [&](std::string_view word) {
      const auto number = number_in(word);
      const bool good = number && *number >= 1 && *number == std::floor(*number) && *number < 2e9;
      return good ? static_cast<std::size_t>(*number) : 0;
    };
    const std::size_t vertices = count_in(head[0]);
    for (std::size_t k = 0; k < vertices; ++k) {
      const auto line = words.line();
      if (line.size() != 4)
        return fail_line(words.number(), fmt::format("expected the number and 3 coordinates of "
                                                     "vertex {} of {}",
                                                     k + 1, vertices));
      if (!add_vertex(line, 1, words.number())) return false;
    }
    std::size_t plates = head.size() > 1 ? count_in(head[1]) : 0;
    if (plates == 0) {
      const auto line = words.line();
      plates = line.size() == 1 ? count_in(line[0]) : 0;
      if (plates == 0) return fail_line(words.number(), "expected the number of plates");
    }
    for (std::size_t k = 0; k < plates; ++k) {
      const auto line = words.line();
      if (line.size() != 4)
        return fail_line(words.number(), fmt::format("expected the number and 3 vertices of plate "
                                                     "{} of {}",
                                                     k + 1, plates));
      if (!add_plate(line, 1, words.number())) return false;
    }
    return check_plates();
  }

  // Implicitly connected quadrilaterals (Gaskell): q, then six faces of (q + 1)² points. Points on
  // the edges of faces are repeated there; each is one vertex.
  bool read_icq(std::string_view text) {
    Words words(text);
    const auto head = words.line();
    const auto count = number_in(head[0]);
    if (!count || *count < 1 || *count > 8192 || *count != std::floor(*count))
      return fail_line(
          1, fmt::format("{} is no number of cells of a face, 1 to 8192", in_quotes(head[0])));
    const auto q = static_cast<std::size_t>(*count), n = q + 1;
    std::map<std::array<double, 3>, std::uint32_t> edges;
    std::vector<std::uint32_t> index(6 * n * n);
    for (std::size_t k = 0; k < index.size(); ++k) {
      const auto line = words.line();
      if (line.empty())
        return fail_line(words.number(),
                         fmt::format("the file ends at point {} of {}", k, index.size()));
      if (!add_vertex(line, 0, words.number())) return false;
      const std::size_t i = k / n % n, j = k % n;
      index[k] = static_cast<std::uint32_t>(out_.vertices.size() - 1);
      if (i != 0 && j != 0 && i != q && j != q) continue;
      const Vec3 p = out_.vertices.back();
      const auto [at, fresh] = edges.emplace(std::array<double, 3>{p.x, p.y, p.z}, index[k]);
      if (fresh) continue;
      out_.vertices.pop_back();
      index[k] = at->second;
    }
    for (std::size_t face = 0; face < 6; ++face)
      for (std::size_t i = 0; i < q; ++i)
        for (std::size_t j = 0; j < q; ++j) {
          const std::size_t at = (face * n + i) * n + j;
          out_.plates.push_back({index[at], index[at + n], index[at + n + 1]});
          out_.plates.push_back({index[at], index[at + n + 1], index[at + 1]});
        }
    face_outwards();
    return true;
  }
  // The files do not say which side is out.
  void face_outwards() {
    if (survey_shape(out_).volume >= 0) return;
    for (auto& plate : out_.plates) std::swap(plate[1], plate[2]);
  }

  bool read_kernel(std::span<const std::byte> bytes) {
    out_.format = "DSK type 2";
    std::vector<ephemeris::DskPlates> segments;
    std::size_t skipped = 0;
    std::string problem;
    if (!ephemeris::read_dsk(bytes, segments, skipped, problem)) {
      (void)fail("the DSK is damaged: " + problem);
      return false;
    }
    if (segments.empty()) {
      (void)fail(fmt::format("the DSK has no segment of type 2 ({} of other types)", skipped));
      return false;
    }
    if (skipped > 0)
      log_.report_file(Code("W9603"), name_,
                       fmt::format("{} of the DSK of other types than 2 are left out",
                                   counted(skipped, "segment")));
    for (const auto& segment : segments) {
      if (segment.body != segments[0].body || segment.frame != segments[0].frame) {
        (void)fail("the segments of the DSK are of several bodies or frames");
        return false;
      }
      const auto first = static_cast<std::uint32_t>(out_.vertices.size());
      for (const auto& v : segment.vertices) out_.vertices.emplace_back(v[0], v[1], v[2]);
      for (const auto& p : segment.plates)
        out_.plates.push_back({p[0] + first, p[1] + first, p[2] + first});
    }
    out_.body = std::to_string(segments[0].body);
    out_.frame = std::to_string(segments[0].frame);
    return true;
  }

  // The PDS3 label of a table.
  std::optional<Label> beside() const {
    std::error_code none;
    for (const char* extension : {".lbl", ".LBL"}) {
      fs::path path = path_;
      path.replace_extension(extension);
      if (!fs::is_regular_file(path, none)) continue;
      DiagnosticLog quiet = log_.apart();
      const auto text = read_file(path, kMostLabel, quiet);
      if (text) return read_label(*text);
    }
    return std::nullopt;
  }

  bool settle_unit(ShapeKind kind) {
    std::optional<double> unit = options_.unit;
    if (!unit && kind == ShapeKind::dsk) unit = 1000;
    if (!unit && (kind == ShapeKind::tab || kind == ShapeKind::plt))
      if (const auto label = beside())
        if (const LabelItem* table = find_block(label->root, "VERTEX_TABLE"))
          unit = metres_of_unit(text_of(*table, "UNIT"));
    out_.unit_stated = unit.has_value() && !options_.unit;
    if (!unit && kind == ShapeKind::obj) {
      double most = 0;
      for (const Vec3& v : out_.vertices) most = std::max(most, glm::dot(v, v));
      log_.report_file(Code("E9602"), name_,
                       fmt::format("an OBJ has no unit, and a radius of {:.4g} may be metres or "
                                   "kilometres",
                                   std::sqrt(most)),
                       "--unit km, --unit m, or the metres of a number, as --unit 1110");
      return false;
    }
    if (!unit) {
      unit = 1000;
      log_.report_file(Code("N9604"), name_,
                       "the unit of the shape is not stated: kilometres are assumed, as its format "
                       "is used",
                       "--unit m");
    }
    out_.unit = *unit == 1000 ? "km" : *unit == 1 ? "m" : fmt::format("{} m", *unit);
    for (Vec3& v : out_.vertices) v *= *unit;
    return true;
  }

  fs::path path_;
  std::string name_;
  const ShapeOptions& options_;
  DiagnosticLog& log_;
  bool is_table_ = false;
  Shape out_;
};

LatLon place_of(const Vec3& p) {
  return {det::atan2(p.z, std::sqrt(p.x * p.x + p.y * p.y)) / kDegree,
          det::atan2(p.y, p.x) / kDegree};
}

}  // namespace

bool is_shape(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  DiagnosticLog quiet;
  const auto file = MappedFile::open(path, quiet);
  if (!file || file->bytes().empty()) return false;
  return kind_by({reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size()},
                 path) != ShapeKind::none;
}

Result<Shape> read_shape(const fs::path& path, const ShapeOptions& options, DiagnosticLog& log) {
  return ShapeReader(path, options, log).read();
}

ShapeSurvey survey_shape(const Shape& shape) {
  ShapeSurvey out;
  out.low = Vec3(std::numeric_limits<double>::infinity());
  out.high = -out.low;
  for (const Vec3& v : shape.vertices) {
    out.low = glm::min(out.low, v);
    out.high = glm::max(out.high, v);
    const double radius = std::sqrt(glm::dot(v, v));
    if (out.least.radius == 0 || radius < out.least.radius) out.least = {radius, place_of(v)};
    if (radius > out.largest.radius) out.largest = {radius, place_of(v)};
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * shape.plates.size());
  for (const auto& plate : shape.plates) {
    const Vec3 &a = shape.vertices[plate[0]], &b = shape.vertices[plate[1]],
               &c = shape.vertices[plate[2]];
    const Vec3 normal = glm::cross(b - a, c - a);
    const double area = std::sqrt(glm::dot(normal, normal)) / 2;
    const double volume = glm::dot(a, glm::cross(b, c)) / 6;
    out.area += area;
    out.volume += volume;
    out.centroid += (a + b + c) * (volume / 4);
    out.flat_plates += area > 0 ? 0 : 1;
    for (std::size_t k = 0; k < 3; ++k)
      edges.emplace_back(std::minmax(plate[k], plate[(k + 1) % 3]));
  }
  if (out.volume != 0) out.centroid /= out.volume;
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    out.open_edges += end - i == 2 ? 0 : 1;
    i = end;
  }
  return out;
}

std::vector<std::uint8_t> draw_shape(const Shape& shape, std::uint32_t side) {
  const ShapeSurvey about = survey_shape(shape);
  const Vec3 middle = (about.low + about.high) / 2.0, size = about.high - about.low;
  const double scale = 0.92 * side / std::max({size.x, size.y, size.z, 1e-300});
  const Vec3 axes[3][3] = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},   // from +x: y right, z up
                           {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},  // from +y
                           {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // from +z
  std::vector<std::uint8_t> out(std::size_t{9} * side * side, 0);
  const Vec3 sun = glm::normalize(Vec3(-1, 1, 1.2));
  for (std::size_t view = 0; view < 3; ++view) {
    std::vector<double> depth(std::size_t{side} * side, -std::numeric_limits<double>::infinity());
    for (const auto& plate : shape.plates) {
      Vec3 p[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 v = (shape.vertices[plate[k]] - middle) * scale;
        p[k] = {glm::dot(v, axes[view][0]) + side / 2.0, side / 2.0 - glm::dot(v, axes[view][1]),
                glm::dot(v, axes[view][2])};
      }
      // rows run down, so that the sign of areas turns
      const double area =
          (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
      if (!std::isfinite(area) || area == 0) continue;
      Vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
      normal = glm::normalize(Vec3(normal.x, -normal.y, normal.z)) * (normal.z < 0 ? -1.0 : 1.0);
      const auto code = static_cast<std::uint8_t>(
          20 + std::lround(225 * std::max(0.0, -glm::dot(normal * Vec3(-1, -1, -1), sun))));
      const auto low = [&](double a, double b, double c) {
        return std::max<std::int64_t>(0,
                                      static_cast<std::int64_t>(std::floor(std::min({a, b, c}))));
      };
      const auto high = [&](double a, double b, double c) {
        return std::min<std::int64_t>(side - 1,
                                      static_cast<std::int64_t>(std::ceil(std::max({a, b, c}))));
      };
      for (std::int64_t y = low(p[0].y, p[1].y, p[2].y); y <= high(p[0].y, p[1].y, p[2].y); ++y)
        for (std::int64_t x = low(p[0].x, p[1].x, p[2].x); x <= high(p[0].x, p[1].x, p[2].x); ++x) {
          const double px = double(x) + 0.5, py = double(y) + 0.5;
          const double u = ((p[1].x - px) * (p[2].y - py) - (p[2].x - px) * (p[1].y - py)) / area;
          const double v = ((p[2].x - px) * (p[0].y - py) - (p[0].x - px) * (p[2].y - py)) / area;
          const double w = 1 - u - v;
          if (u < 0 || v < 0 || w < 0) continue;
          const double z = u * p[0].z + v * p[1].z + w * p[2].z;
          double& nearest = depth[static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x)];
          if (z <= nearest) continue;
          nearest = z;
          std::uint8_t* pixel = &out[3 * (static_cast<std::size_t>(y) * 3 * side + view * side +
                                          static_cast<std::size_t>(x))];
          pixel[0] = pixel[1] = pixel[2] = code;
        }
    }
  }
  return out;
}

}  // namespace panwright::terrain
