#include <fmt/core.h>

#include <cstring>

#include "base/text.h"
#include "importers/internal/reader_context.h"
#include "importers/meshes/readers.h"
#include "importers/meshes/text.h"

// note: no reader of Debian's is used. OpenMesh's hangs on damaged files and never says that they
// are, takes 18 s for a text of a million triangles and forgets the names of solids; assimp's
// rounds what texts say to single precision and refuses a damaged file as a whole.

namespace panwright::importers::meshes {

namespace {

using geometry::Mesh;

constexpr std::size_t kHeader = 84;  // bytes: a comment, and the number of triangles
constexpr std::size_t kRecord = 50;  // bytes: a normal, three corners, two bytes of attributes

std::uint32_t word_at(std::string_view bytes, std::size_t i) {
  std::uint32_t out = 0;
  for (std::size_t k = 4; k-- > 0;) out = out << 8 | static_cast<std::uint8_t>(bytes[i + k]);
  return out;
}

Vec3 corner_at(std::string_view bytes, std::size_t i) {
  Vec3 out;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t bits = word_at(bytes, i + 4 * static_cast<std::size_t>(k));
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    out[k] = value;
  }
  return out;
}

bool is_binary(std::string_view bytes) {
  if (bytes.size() >= kHeader &&
      bytes.size() == kHeader + kRecord * std::uint64_t{word_at(bytes, 80)})
    return true;
  // a text begins with "solid"; its first facet or its end follows, and it holds no zeros
  const std::string_view head = bytes.substr(0, 4096);
  std::string_view rest = head;
  const std::string text = lower_case(head);
  return lower_case(next_word(rest)) != "solid" || head.find('\0') != head.npos ||
         (text.find("facet") == text.npos && text.find("endsolid") == text.npos);
}

class BinaryReader {
 public:
  BinaryReader(ReaderContext& context, std::string_view bytes) : s_(context), bytes_(bytes) {}

  Result<Imported> read() {
    Assembly assembly(s_, Format::stl);
    const SourceSpan where = s_.at(0, 0);
    const std::uint64_t count = triangles();
    if (count == 0 || !assembly.has_room_for(count, where) ||
        !s_.charge(count * (sizeof(geometry::Triangle) + sizeof(Vec3))))
      return assembly.finished();
    Mesh mesh;
    mesh.triangles.reserve(count);
    Welder welder;
    constexpr std::uint64_t kPoll = 1u << 16;  // triangles
    for (std::uint64_t i = 0; i < count; ++i) {
      if (i % kPoll == 0) s_.file.job.poll();
      const std::size_t begin = kHeader + kRecord * i;
      std::array<Vec3, 3> corners;
      bool usable = true;
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = corner_at(bytes_, begin + 12 + 12 * k);
        usable = usable && is_usable(corners[k]);
      }
      if (!usable) {
        s_.trouble(Code("E6501"), "corner", where, [&] {
          return fmt::format("byte {}: triangle {} has a corner out of range and is left out",
                             begin, i);
        });
        continue;
      }
      geometry::Triangle t;
      for (std::size_t k = 0; k < 3; ++k) t[k] = welder.vertex(corners[k], mesh.positions);
      mesh.triangles.push_back(t);
    }
    welder.clear();
    bytes_ = {};
    s_.served(s_.file.bytes->size());
    if (!mesh.triangles.empty()) {
      finish_normals(mesh, s_.options.crease_angle);
      const std::int32_t node = assembly.add_node(0, {}, "mesh", where);
      if (node >= 0)
        assembly.add_part(node, std::move(mesh), assembly.plain_material(false), where);
    }
    return assembly.finished();
  }

 private:
  // How many triangles the file holds; says where it claims another number.
  std::uint64_t triangles() {
    const SourceSpan where = s_.at(0, 0);
    if (bytes_.size() < kHeader) {
      s_.trouble(Code("E6501"), "size", where, [&] {
        return fmt::format("{} are too few for an STL file; a binary one has {} or more",
                           counted(bytes_.size(), "byte"), kHeader);
      });
      return 0;
    }
    const std::uint64_t said = word_at(bytes_, 80);
    const std::uint64_t held = (bytes_.size() - kHeader) / kRecord;
    const std::uint64_t extra = bytes_.size() - kHeader - kRecord * std::min(said, held);
    // what is written without knowing the number in advance has none, or all bits set
    const bool unknown = said == 0 || said == 0xffffffffu;
    if (unknown && held > 0 && (bytes_.size() - kHeader) % kRecord == 0) {
      s_.trouble(Code("W6502"), "count", where, [&] {
        return fmt::format("byte 80: the number of triangles is {}; the file holds {}", said, held);
      });
      return held;
    }
    if (said > held)
      s_.trouble(Code("E6501"), "count", where, [&] {
        return fmt::format("byte 80: {} are announced, and the file ends after {}",
                           counted(said, "triangle"), held);
      });
    else if (extra > 0)
      s_.trouble(Code("W6502"), "extra", where, [&] {
        return fmt::format("byte {}: {} after the last triangle", bytes_.size() - extra,
                           counted(extra, "byte"));
      });
    return std::min(said, held);
  }

  ReaderContext& s_;
  std::string_view bytes_;
};

class TextReader {
 public:
  TextReader(ReaderContext& context, std::string_view text)
      : s_(context), assembly_(context, Format::stl), lines_(text) {}

  Result<Imported> read() {
    std::string_view line;
    while (lines_.next(line) && !s_.full) {
      read_line(line);
      s_.served(s_.file.bytes->size() - lines_.rest().size());
    }
    if (!s_.full && in_solid_)
      s_.trouble(Code("E6501"), "end", s_.at(line),
                 [] { return "the file ends within a solid: 'endsolid' is missing"; });
    finish_solid();
    return assembly_.finished();
  }

 private:
  // Words may stand on lines of their own or together.
  void read_line(std::string_view line) {
    std::string_view rest = line;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const std::string key = lower_case(word);
      if (key == "vertex") {
        read_vertex(line, rest);
      } else if (key == "facet") {
        end_unfinished(word);
        skip_words(rest, "normal", 3);  // what follows is not used
      } else if (key == "outer") {
        end_unfinished(word);
        skip_words(rest, "loop", 0);
      } else if (key == "endfacet") {
        end_unfinished(word);
      } else if (key == "endloop") {
        end_loop(word);
      } else if (key == "solid") {
        finish_solid();
        in_solid_ = true;
        name_ = trimmed(rest);
        solid_at_ = s_.at(word);
        return;
      } else if (key == "endsolid") {
        finish_solid();
        return;
      } else {
        s_.trouble(Code("E6501"), "word", s_.at(word), [&] {
          return fmt::format("{} is not an STL keyword; the line is left out", in_quotes(word));
        });
        return;
      }
    }
  }

  static void skip_words(std::string_view& rest, std::string_view first, int more) {
    std::string_view ahead = rest;
    if (lower_case(next_word(ahead)) != first) return;
    rest = ahead;
    for (int k = 0; k < more; ++k) {
      const std::string_view word = next_word(ahead);
      if (word.empty() || lower_case(word) == "outer") return;
      rest = ahead;
    }
  }

  void read_vertex(std::string_view line, std::string_view& rest) {
    Vec3 p(0);
    bool usable = true;
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = next_word(rest);
      const auto number = parse_double(word);
      usable = usable && number;
      if (number) p[k] = *number;
      if (number) continue;
      s_.trouble(Code("E6501"), "number", s_.at(word.empty() ? line : word), [&] {
        return fmt::format("{} is not a number; the facet is left out", in_quotes(word));
      });
    }
    if (usable && !is_usable(p)) {
      usable = false;
      s_.trouble(Code("E6501"), "place", s_.at(line),
                 [] { return "a corner is out of range; the facet is left out"; });
    }
    broken_ = broken_ || !usable;
    if (!usable) return;
    if (!s_.charge(sizeof(Vec3))) return;
    face_.push_back(welder_.vertex(p, mesh_.positions));
  }

  void end_unfinished(std::string_view word) {
    if (!face_.empty() && !broken_)
      s_.trouble(Code("E6501"), "endloop", s_.at(word),
                 [] { return "'endloop' is missing before this word"; });
    if (!face_.empty() || broken_) end_loop(word);
  }

  void end_loop(std::string_view word) {
    if (!broken_ && face_.size() != 3)
      s_.trouble(face_.size() < 3 ? Code("E6501") : Code("W6502"),
                 face_.size() < 3 ? "few" : "many", s_.at(word), [&] {
                   return fmt::format(
                       "a facet of {}{}", counted(face_.size(), "corner"),
                       face_.size() < 3 ? ", which is left out" : "; STL has only triangles");
                 });
    if (!broken_ && face_.size() >= 3 &&
        assembly_.has_room_for(mesh_.triangles.size() + face_.size() - 2, s_.at(word)))
      cutter_.cut(face_, mesh_.positions, mesh_.triangles);
    face_.clear();
    broken_ = false;
  }

  void finish_solid() {
    if (!mesh_.triangles.empty()) {
      drop_unused(mesh_);
      finish_normals(mesh_, s_.options.crease_angle);
      const std::int32_t node = assembly_.add_node(0, name_, "solid", solid_at_);
      if (node >= 0)
        assembly_.add_part(node, std::move(mesh_), assembly_.plain_material(false), solid_at_);
    }
    mesh_ = {};
    welder_.clear();
    face_.clear();
    name_.clear();
    in_solid_ = broken_ = false;
  }

  ReaderContext& s_;
  Assembly assembly_;
  Lines lines_;
  Mesh mesh_;  // of the solid
  Welder welder_;
  FaceCutter cutter_;
  std::vector<std::uint32_t> face_;
  std::string name_;
  SourceSpan solid_at_;
  bool in_solid_ = false;
  bool broken_ = false;  // the facet
};

}  // namespace

Result<Imported> read_stl(Files& files, const InputFile& file, const Options& options,
                          DiagnosticLog& log) {
  const std::string_view bytes = *file.bytes;
  const bool binary = is_binary(bytes);
  ReaderContext context(files, file, options, !binary, log);
  if (binary) return BinaryReader(context, bytes).read();
  return TextReader(context, bytes).read();
}

}  // namespace panwright::importers::meshes
