#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "base/text.h"
#include "importers/meshes/mtl.h"
#include "importers/meshes/obj_parts.h"
#include "importers/meshes/readers.h"
#include "importers/meshes/text.h"

// note: tinyobjloader is not used. It refuses a whole file for one wrong index, takes what is no
// number for 0, tells no places, loses names that hold blanks and which of "o" and "g" gave a
// name, does not join lines, and rounds numbers several times; a pass before it that mends this
// has read the file already.

namespace panwright::importers::meshes {

namespace {

// Free-form curves and surfaces, which are not meshed.
constexpr std::string_view kFreeForm[] = {"vp",   "cstype", "deg",  "bmat", "step", "curv", "curv2",
                                          "surf", "parm",   "trim", "hole", "scrv", "sp",   "end",
                                          "con",  "bzp",    "bsp",  "cdc",  "cdp",  "res"};

// Words that say nothing of a surface.
constexpr std::string_view kIgnored[] = {"mg",    "bevel",      "c_interp",  "d_interp",
                                         "lod",   "shadow_obj", "trace_obj", "ctech",
                                         "stech", "usemap",     "maplib"};

template <std::size_t kSize>
bool is_in(const std::string_view (&list)[kSize], std::string_view word) {
  return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

class ObjReader {
 public:
  ObjReader(ReaderContext& context, std::string_view text)
      : s_(context),
        assembly_(context, Format::obj),
        libraries_(context, assembly_),
        lines_(text) {}

  Result<Imported> read() {
    std::string_view line, first;
    std::string scratch;
    while (!s_.full && lines_.next_joined(line, first, scratch)) {
      line_ = first;
      read_line(line);
      s_.served(s_.file.bytes->size() - lines_.rest().size());
    }
    if (!s_.full) make_parts();
    return assembly_.finished();
  }

 private:
  // Whatever of the line a problem is about: of joined lines no part can be told.
  SourceSpan at(std::string_view part) const {
    const std::string_view all = *s_.file.bytes;
    const std::less<> before;
    const bool inside = !before(part.data(), all.data()) &&
                        !before(all.data() + all.size(), part.data() + part.size());
    return s_.at(inside && !part.empty() ? part : line_);
  }

  void read_line(std::string_view line) {
    std::string_view rest = line;
    const std::string_view word = next_word(rest);
    if (word.empty() || word[0] == '#') return;
    if (word == "v") return read_vertex(rest);
    if (word == "f" || word == "fo") return read_face(rest);
    if (word == "vn") return read_normal(rest);
    if (word == "vt") return read_texcoord(rest);
    if (word == "o") return begin_object(rest, word);
    if (word == "g") return begin_group(rest, word);
    if (word == "s") return begin_smoothing(rest, word);
    if (word == "usemtl") return use_material(rest, word);
    if (word == "mtllib") return libraries_.read(rest, at(trimmed(rest)));
    if (word == "l" || word == "p") return s_.skipped(word == "l" ? "line" : "point");
    if (is_in(kFreeForm, word)) return s_.skipped("free-form statement");
    if (is_in(kIgnored, word)) return;
    s_.trouble(Code("E6501"), "word", at(word), [&] {
      return fmt::format("{} is not an OBJ statement; the line is left out", in_quotes(word));
    });
  }

  // ---- lists

  // Numbers of a line up to its end or a comment, `most` of them; −1 where one is none.
  int read_numbers(std::string_view rest, double* out, int most) {
    int count = 0;
    for (std::string_view word = next_word(rest); !word.empty() && word[0] != '#' && count < most;
         word = next_word(rest), ++count) {
      const auto value = parse_double(word);
      if (!value) {
        s_.trouble(Code("E6501"), "number", at(word), [&] {
          return fmt::format("{} is not a number; elements that use this line are left out",
                             in_quotes(word));
        });
        return -1;
      }
      out[count] = *value;
    }
    return count;
  }

  bool is_enough(int count, int wanted, std::string_view rest) {
    if (count >= wanted) return true;
    if (count >= 0)
      s_.trouble(Code("E6501"), "few numbers", at(rest), [&] {
        return fmt::format("{}, expected {}; elements that use this line are left out",
                           counted(static_cast<std::size_t>(count), "number"), wanted);
      });
    return false;
  }

  void read_vertex(std::string_view rest) {
    double n[6] = {};
    const int count = read_numbers(rest, n, 6);
    const bool sound = is_enough(count, 3, rest);
    if (!s_.charge(sizeof(Vec3))) return;
    // note: its number is used up even when it has no place
    l_.points.push_back(sound ? Vec3(n[0], n[1], n[2])
                              : Vec3(std::numeric_limits<double>::quiet_NaN()));
    if (count < 6 && l_.colors.empty()) return;
    if (l_.colors.empty() && !s_.charge(l_.points.size() * sizeof(Vec3))) return;
    l_.colors.resize(l_.points.size(), Vec3(1));
    if (count == 6) l_.colors.back() = glm::clamp(Vec3(n[3], n[4], n[5]), Vec3(0), Vec3(1));
  }

  void read_normal(std::string_view rest) {
    double n[3] = {};
    const bool sound = is_enough(read_numbers(rest, n, 3), 3, rest);
    if (s_.charge(sizeof(Vec3))) l_.normals.push_back(sound ? Vec3(n[0], n[1], n[2]) : Vec3(0));
  }

  void read_texcoord(std::string_view rest) {
    double n[2] = {};
    const bool sound = is_enough(read_numbers(rest, n, 2), 1, rest);
    if (s_.charge(sizeof(Vec2))) l_.texcoords.push_back(sound ? Vec2(n[0], n[1]) : Vec2(0));
  }

  // ---- faces

  // "7", "7/2", "7//3", "7/2/3", each counted from 1, or from −1 back from the last so far.
  bool read_corner(std::string_view word, ObjCorner& out) const {
    const std::size_t sizes[] = {l_.points.size(), l_.texcoords.size(), l_.normals.size()};
    std::int32_t* const places[] = {&out.point, &out.texcoord, &out.normal};
    const char* at = word.data();
    const char* const end = at + word.size();
    for (int k = 0; k < 3 && at != end; ++k) {
      if (k > 0 && *at++ != '/') return false;
      if (at == end || (k > 0 && *at == '/')) continue;
      std::int32_t index = 0;
      const auto [stop, error] = std::from_chars(at, end, index);
      if (error != std::errc() || index == 0) return false;
      at = stop;
      if (index < 0) {
        const std::int64_t place = static_cast<std::int64_t>(sizes[k]) + index;
        if (place < 0 || place > std::numeric_limits<std::int32_t>::max()) return false;
        *places[k] = static_cast<std::int32_t>(place);
      } else {
        *places[k] = index - 1;
      }
    }
    return at == end && out.point >= 0;
  }

  void read_face(std::string_view rest) {
    const std::string_view all = rest;
    const std::size_t begin = l_.corners.size();
    for (std::string_view word = next_word(rest); !word.empty() && word[0] != '#';
         word = next_word(rest)) {
      ObjCorner corner;
      if (!read_corner(word, corner)) {
        s_.trouble(Code("E6501"), "corner", at(word), [&] {
          return fmt::format(
              "{} is not a corner of a face, expected v, v/vt, v//vn or v/vt/vn, each "
              "a number in its list; the face is left out",
              in_quotes(word));
        });
        l_.corners.resize(begin);
        return;
      }
      l_.corners.push_back(corner);
    }
    const std::size_t size = l_.corners.size() - begin;
    if (size < 3) {
      s_.trouble(Code("W6502"), "few corners", at(all),
                 [&] { return fmt::format("a face of {} is left out", counted(size, "corner")); });
      l_.corners.resize(begin);
      return;
    }
    triangles_ += size - 2;
    const SourceSpan where = at(line_);
    if (!assembly_.has_room_for(triangles_, where) ||
        !s_.charge(sizeof(ObjFace) + size * sizeof(ObjCorner) +
                   (size - 2) * sizeof(geometry::Triangle)))
      return;
    if (changed_) begin_run(where);
    l_.faces.push_back({static_cast<std::uint32_t>(l_.corners.size()), where.begin});
  }

  // ---- parts

  void begin_object(std::string_view rest, std::string_view word) {
    object_ = trimmed(rest);
    group_.clear();
    object_at_ = at(word);
    changed_ = true;
  }

  void begin_group(std::string_view rest, std::string_view word) {
    // several names: the face is of all these groups; here it gets one place
    group_ = trimmed(rest);
    if (group_ == "default") group_.clear();
    group_at_ = at(word);
    changed_ = true;
  }

  void begin_smoothing(std::string_view rest, std::string_view word) {
    const std::string_view name = next_word(rest);
    std::int64_t group = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), group);
    if (name == "off") {
      group = kByCrease;
    } else if (error != std::errc() || end != name.data() + name.size() || group < 0) {
      s_.trouble(Code("W6502"), "smoothing", at(name.empty() ? word : name), [&] {
        return fmt::format("{} is not a smoothing group, expected a number or 'off'",
                           in_quotes(name));
      });
      return;
    }
    changed_ = changed_ || group != smoothing_;
    smoothing_ = group;
  }

  void use_material(std::string_view rest, std::string_view word) {
    const std::string_view name = trimmed(rest);
    material_ = name.empty() ? -1 : libraries_.number_of(name, at(name.empty() ? word : name));
    changed_ = true;
  }

  // The node that faces stand at now; made when the first of them comes.
  std::int32_t node() {
    if (object_.empty() && group_.empty()) return child(0, {}, at(line_));
    const std::int32_t at_object = object_.empty() ? 0 : child(0, object_, object_at_);
    return at_object < 0 || group_.empty() ? at_object : child(at_object, group_, group_at_);
  }

  std::int32_t child(std::int32_t parent, const std::string& name, SourceSpan where) {
    const auto [place, is_new] = nodes_.try_emplace({parent, name}, scene::kNone);
    if (is_new) place->second = assembly_.add_node(parent, name, "mesh", where);
    return place->second;
  }

  void begin_run(SourceSpan where) {
    changed_ = false;
    const auto [place, is_new] = part_of_.try_emplace({node(), material_}, parts_.size());
    if (is_new) parts_.push_back({place->first.first, material_, where, {}});
    std::vector<ObjMesher::Range>& ranges = parts_[place->second].ranges;
    close_run();
    last_part_ = place->second;
    ranges.push_back({l_.faces.size(), 0, smoothing_});
  }

  void close_run() {
    if (last_part_ < parts_.size() && !parts_[last_part_].ranges.empty())
      parts_[last_part_].ranges.back().end = l_.faces.size();
  }

  void make_parts() {
    close_run();
    libraries_.resolve_names();
    ObjMesher mesher(s_, l_);
    for (Part& part : parts_) {
      geometry::Mesh mesh = mesher.mesh_of(part.ranges, &part == &parts_.back());
      if (mesh.triangles.empty() || part.node < 0) continue;
      const std::int32_t material =
          libraries_.scene_material(part.material, !mesh.colors.empty(), !mesh.texcoords.empty());
      assembly_.add_part(part.node, std::move(mesh), material, part.where);
    }
  }

  // Faces at one node, of one material.
  struct Part {
    std::int32_t node;
    std::int32_t material;  // of the libraries; −1: none
    SourceSpan where;
    std::vector<ObjMesher::Range> ranges;
  };

  ReaderContext& s_;
  Assembly assembly_;
  MtlLibraries libraries_;
  Lines lines_;
  ObjLists l_;
  std::string_view line_;  // that is read now, or the first of those joined
  std::string object_, group_;
  SourceSpan object_at_, group_at_;
  std::int32_t material_ = -1;
  std::int64_t smoothing_ = kByCrease;
  bool changed_ = true;  // the next face begins a run
  std::map<std::pair<std::int32_t, std::string>, std::int32_t> nodes_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> part_of_;
  std::vector<Part> parts_;
  std::size_t last_part_ = 0;
  std::uint64_t triangles_ = 0;
};

}  // namespace

Result<Imported> read_obj(Files& files, const InputFile& file, const Options& options,
                          DiagnosticLog& log) {
  ReaderContext context(files, file, options, true, log);
  return ObjReader(context, *file.bytes).read();
}

}  // namespace panwright::importers::meshes
