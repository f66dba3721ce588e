#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "base/text.h"
#include "geometry/mesh/strip.h"
#include "image/srgb.h"
#include "importers/internal/reader_context.h"
#include "importers/meshes/ply_values.h"
#include "importers/meshes/readers.h"

// note: no reader of Debian's is used. OpenMesh's and assimp's round doubles to single precision;
// both hang on damaged files, and assimp's crashes on some.

namespace panwright::importers::meshes {

namespace {

using geometry::Mesh;
using Got = PlyValues::Got;

constexpr std::uint64_t kPollFaces = 1u << 14;  // faces between questions whether to go on
constexpr int kMostCopies = 32;  // copies of a vertex that are compared before one more is made

// What a property of a vertex is read into.
enum Slot : std::uint8_t { kX, kY, kZ, kNx, kNy, kNz, kRed, kGreen, kBlue, kU, kV, kSlots };

constexpr std::pair<std::string_view, Slot> kSlotNames[] = {
    {"x", kX},
    {"y", kY},
    {"z", kZ},
    {"nx", kNx},
    {"ny", kNy},
    {"nz", kNz},
    {"red", kRed},
    {"green", kGreen},
    {"blue", kBlue},
    {"r", kRed},
    {"g", kGreen},
    {"b", kBlue},
    {"diffuse_red", kRed},
    {"diffuse_green", kGreen},
    {"diffuse_blue", kBlue},
    {"s", kU},
    {"t", kV},
    {"u", kU},
    {"v", kV},
    {"texture_u", kU},
    {"texture_v", kV},
};

class PlyReader {
 public:
  PlyReader(ReaderContext& context, PlyHeader header)
      : s_(context),
        assembly_(context, Format::ply),
        header_(std::move(header)),
        text_(header_.order == PlyOrder::text),
        values_(header_.body, header_.order) {}

  Result<Imported> read() {
    for (const std::string& texture : header_.textures)
      declare(s_.files, s_.file.path, texture, false);
    for (const PlyElement& element : header_.elements) {
      if (!going_ || s_.full) break;
      if (element.name == "vertex" && mesh_.positions.empty())
        read_vertices(element);
      else if (element.name == "face" && find(element, "vertex_indices", "vertex_index"))
        read_faces(element);
      else if (element.name == "tristrips" && find(element, "vertex_indices", "vertex_index"))
        read_strips(element);
      else
        skip_element(element);
    }
    s_.served(s_.file.bytes->size());
    const bool faces = !ends_.empty() || !strips_.empty();
    if (!s_.full) make_faces();
    if (!faces && !mesh_.positions.empty())
      s_.trouble(Code("E6501"), "no faces", s_.at(header_.body.substr(0, 0)), [&] {
        return fmt::format("{} and no face: they make no surface",
                           counted(mesh_.positions.size(), "point"));
      });
    if (!mesh_.triangles.empty()) add_mesh();
    return assembly_.finished();
  }

 private:
  static const PlyProperty* find(const PlyElement& element, std::string_view name,
                                 std::string_view other = {}) {
    for (const PlyProperty& property : element.properties)
      if (property.count && (property.name == name || property.name == other)) return &property;
    return nullptr;
  }

  SourceSpan here() const { return s_.at(values_.last()); }
  // "byte 12: " of a binary file, whose places have no lines
  std::string byte() const { return text_ ? std::string() : byte(values_.offset()); }
  std::string byte(std::size_t in_body) const {
    const std::size_t header = s_.file.bytes->size() - header_.body.size();
    return text_ ? std::string() : fmt::format("byte {}: ", header + in_body);
  }

  void cut_short(const PlyElement& element, std::uint64_t i) {
    going_ = false;
    s_.trouble(Code("E6501"), "end", here(), [&] {
      return fmt::format("{}the file ends in {} {} of {}", byte(), in_quotes(element.name), i,
                         element.count);
    });
  }

  // How many elements the rest of the file can hold.
  std::uint64_t count_of(const PlyElement& element) {
    const std::uint64_t least = element.least_bytes(text_);
    if (least == 0) return 0;
    // the last number of a text needs no blank behind it
    const std::uint64_t most = (values_.left() + (text_ ? 1 : 0)) / least;
    return std::min(element.count, most);
  }

  // One number. Words count as none, with a problem; false at the end of the file.
  bool number(PlyType type, double& out) {
    const Got got = values_.next(type, out);
    if (got == Got::word) {
      out = std::numeric_limits<double>::quiet_NaN();
      s_.trouble(Code("E6501"), "word", here(), [&] {
        return fmt::format("{} is not a number; the element is left out",
                           in_quotes(values_.last()));
      });
    }
    return got != Got::end;
  }

  // A list's length; −1 where there is none to go on with. false: the file cannot be read on.
  bool length(const PlyProperty& property, std::int64_t& out) {
    double value = 0;
    if (!number(*property.count, value)) return false;
    const double most = static_cast<double>((values_.left() + (text_ ? 1 : 0)) /
                                            (text_ ? 2 : bytes_of(property.type)));
    if (value >= 0 && value <= most && value == std::floor(value)) {
      out = static_cast<std::int64_t>(value);
      return true;
    }
    if (!std::isnan(value))
      s_.trouble(Code("E6501"), "length", here(), [&] {
        return fmt::format("{}a list of {} numbers, which exceeds the file", byte(),
                           format_double(value));
      });
    if (!text_) going_ = false;
    values_.skip_line();
    out = -1;
    return true;
  }

  bool skip_list(const PlyProperty& property) {
    std::int64_t size = 0;
    if (!length(property, size)) return false;
    if (!text_)
      return values_.skip(static_cast<std::uint64_t>(std::max<std::int64_t>(size, 0)) *
                          bytes_of(property.type));
    double ignored = 0;
    for (std::int64_t k = 0; k < size; ++k)
      if (!number(property.type, ignored)) return false;
    return true;
  }

  bool skip_property(const PlyProperty& property) {
    double ignored = 0;
    return property.count ? skip_list(property) : number(property.type, ignored);
  }

  void skip_element(const PlyElement& element) {
    if (element.count > 0) s_.skipped(element.name, element.count);
    const std::uint64_t count = count_of(element);
    for (std::uint64_t i = 0; i < count && going_; ++i)
      for (const PlyProperty& property : element.properties)
        if (going_ && !skip_property(property)) return cut_short(element, i);
    if (count < element.count && !element.properties.empty()) cut_short(element, count);
  }

  // ---- vertices

  std::vector<Slot> slots_of(const PlyElement& element) {
    std::vector<Slot> slots;
    std::array<bool, kSlots> taken{};
    for (const PlyProperty& property : element.properties) {
      Slot slot = kSlots;
      for (const auto& [name, known] : kSlotNames)
        if (property.name == name && !property.count && !taken[known]) slot = known;
      if (slot == kSlots)
        s_.lost(fmt::format("vertex property {}", in_quotes(property.name)), s_.at(property.place));
      else
        taken[slot] = true;
      slots.push_back(slot);
    }
    const auto all = [&](std::initializer_list<Slot> wanted) {
      return std::all_of(wanted.begin(), wanted.end(), [&](Slot slot) { return taken[slot]; });
    };
    has_places_ = all({kX, kY, kZ});
    has_normals_ = all({kNx, kNy, kNz});
    has_colours_ = all({kRed, kGreen, kBlue});
    has_texcoords_ = all({kU, kV});
    return slots;
  }

  // Whole numbers are sRGB, parts of the largest of their type; others are linear.
  static double color_of(double value, PlyType type) {
    if (is_float(type)) return std::clamp(value, 0.0, 1.0);
    const double most = bytes_of(type) == 1 ? 255 : bytes_of(type) == 2 ? 65535 : 255;
    return image::linear_from_srgb(std::clamp(value / most, 0.0, 1.0));
  }

  void read_vertices(const PlyElement& element) {
    const std::vector<Slot> slots = slots_of(element);
    if (!has_places_) {
      s_.trouble(Code("E6501"), "xyz", s_.at(0, 0), [] { return "vertices have no x, y and z"; });
      return skip_element(element);
    }
    const std::uint64_t count = count_of(element);
    if (count >= kNoIndex || !s_.charge(count * (3 + has_normals_ + has_colours_) * sizeof(Vec3)))
      return;
    mesh_.positions.reserve(count);
    std::array<double, 256> linear;
    for (std::size_t k = 0; k < linear.size(); ++k)
      linear[k] = color_of(static_cast<double>(k), PlyType::uint8);
    std::array<double, kSlots> at{};
    for (std::uint64_t i = 0; i < count && going_; ++i) {
      for (std::size_t k = 0; k < slots.size() && going_; ++k) {
        const PlyProperty& property = element.properties[k];
        double value = 0;
        if (slots[k] == kSlots) {
          if (!skip_property(property)) return cut_short(element, i);
          continue;
        }
        if (!number(property.type, value)) return cut_short(element, i);
        if (slots[k] >= kRed && slots[k] <= kBlue) {
          const bool byte = property.type == PlyType::uint8 && value >= 0 && value <= 255;
          value = byte ? linear[static_cast<std::size_t>(value)] : color_of(value, property.type);
        }
        at[slots[k]] = value;
      }
      add_vertex(at);
    }
    if (count < element.count) cut_short(element, count);
  }

  void add_vertex(const std::array<double, kSlots>& at) {
    const auto finite = [](double value) { return std::isfinite(value) ? value : 0; };
    mesh_.positions.push_back({at[kX], at[kY], at[kZ]});
    if (has_normals_) mesh_.normals.push_back({at[kNx], at[kNy], at[kNz]});
    if (has_colours_)
      mesh_.colors.push_back({finite(at[kRed]), finite(at[kGreen]), finite(at[kBlue])});
    if (has_texcoords_) mesh_.texcoords.push_back({finite(at[kU]), finite(at[kV])});
  }

  // ---- faces

  // Appends a list to `out`; false: the file ends.
  bool read_list(const PlyProperty& property, std::vector<double>& out, bool& whole) {
    std::int64_t size = 0;
    out.clear();
    if (!length(property, size)) return false;
    whole = size >= 0;
    double value = 0;
    for (std::int64_t k = 0; k < size; ++k) {
      if (!number(property.type, value)) return false;
      out.push_back(value);
    }
    return true;
  }

  static std::uint32_t index_of(double value) {
    return value >= 0 && value < kNoIndex && value == std::floor(value)
               ? static_cast<std::uint32_t>(value)
               : kNoIndex;
  }

  // The property that numbers the texture of a face, as MeshLab writes it; null: one for all.
  const PlyProperty* texture_numbers(const PlyElement& element) {
    if (header_.textures.size() < 2) return nullptr;
    for (const PlyProperty& property : element.properties)
      if (!property.count && property.name == "texnumber") return &property;
    s_.trouble(Code("W6502"), "texnumber", s_.at(0, 0), [&] {
      return fmt::format("{} are named, and no 'texnumber' of a face says which; the first is used",
                         counted(header_.textures.size(), "texture"));
    });
    return nullptr;
  }

  void read_faces(const PlyElement& element) {
    const PlyProperty* indices = find(element, "vertex_indices", "vertex_index");
    const PlyProperty* wedges = find(element, "texcoord");
    const PlyProperty* numbers = texture_numbers(element);
    for (const PlyProperty& property : element.properties)
      if (&property != indices && &property != wedges && property.name != "texnumber")
        s_.lost(fmt::format("face property {}", in_quotes(property.name)), s_.at(property.place));
    const std::uint64_t count = count_of(element);
    if (!s_.charge(count * (sizeof(Face) + 3 * sizeof(std::uint32_t)))) return;
    ends_.reserve(ends_.size() + count);
    std::vector<double> face, uvs;
    for (std::uint64_t i = 0; i < count && going_ && !s_.full; ++i) {
      if (i % kPollFaces == 0) s_.file.job.poll();
      bool whole = true;
      std::size_t where = 0;
      double texture = 0;
      for (const PlyProperty& property : element.properties) {
        if (!going_ || !whole) break;
        const bool is_face = &property == indices;
        if (is_face || &property == wedges) {
          if (!read_list(property, is_face ? face : uvs, whole)) return cut_short(element, i);
          if (is_face) where = values_.offset();
        } else if (&property == numbers) {
          if (!number(property.type, texture)) return cut_short(element, i);
        } else if (!skip_property(property)) {
          return cut_short(element, i);
        }
      }
      if (whole && going_)
        add_face(face, wedges ? &uvs : nullptr, where, texture_of(texture, where));
    }
    if (count < element.count && going_) cut_short(element, count);
  }

  // −1: none, as MeshLab has it.
  std::int32_t texture_of(double number, std::size_t where) {
    const auto count = static_cast<double>(header_.textures.size());
    if (number >= 0 && number < std::max(count, 1.0)) return static_cast<std::int32_t>(number);
    if (number != -1)
      s_.trouble(Code("W6502"), "texture number", s_.at(header_.body.substr(where, 1)), [&] {
        return fmt::format("{}the face has texture {} of {}; it has none", byte(where),
                           format_double(number), header_.textures.size());
      });
    return -1;
  }

  void add_face(const std::vector<double>& face, const std::vector<double>* uvs, std::size_t where,
                std::int32_t texture) {
    if (face.size() > 3 && !s_.charge((face.size() - 3) * sizeof(std::uint32_t))) return;
    for (const double value : face) corners_.push_back(index_of(value));
    ends_.push_back(
        {static_cast<std::uint32_t>(corners_.size()), static_cast<std::uint32_t>(where), texture});
    if (!uvs) return;
    wedges_.resize(corners_.size() - face.size(), Vec2(0));
    const bool fits = uvs->size() == 2 * face.size();
    if (!fits && !uvs->empty())
      s_.trouble(Code("W6502"), "wedges", s_.at(header_.body.substr(where, 1)), [&] {
        return fmt::format("{}{} texture coordinates for {} are not used", byte(where), uvs->size(),
                           counted(face.size(), "corner"));
      });
    const auto finite = [](double value) { return std::isfinite(value) ? value : 0; };
    for (std::size_t k = 0; k < face.size(); ++k)
      wedges_.push_back(fits ? Vec2(finite((*uvs)[2 * k]), finite((*uvs)[2 * k + 1])) : Vec2(0));
  }

  void read_strips(const PlyElement& element) {
    const PlyProperty* indices = find(element, "vertex_indices", "vertex_index");
    std::vector<double> strip;
    const std::uint64_t count = count_of(element);
    for (std::uint64_t i = 0; i < count && going_; ++i)
      for (const PlyProperty& property : element.properties) {
        bool whole = true;
        if (!going_) break;
        if (&property != indices) {
          if (!skip_property(property)) return cut_short(element, i);
          continue;
        }
        if (!read_list(property, strip, whole)) return cut_short(element, i);
        if (!s_.charge(strip.size() * (sizeof(std::uint32_t) + sizeof(geometry::Triangle)))) return;
        for (const double value : strip) strips_.push_back(index_of(value));
        strips_.push_back(kNoIndex);
      }
    if (count < element.count && going_) cut_short(element, count);
  }

  // ---- the mesh

  bool is_vertex(std::uint32_t v) const {
    return v < mesh_.positions.size() && is_usable(mesh_.positions[v]);
  }

  void make_faces() {
    const std::size_t vertices = mesh_.positions.size();
    std::uint64_t triangles = strips_.size();
    std::uint64_t begin = 0;
    for (const Face& face : ends_) {
      triangles += std::max<std::uint64_t>(face.end - begin, 2) - 2;
      begin = face.end;
    }
    if (!assembly_.has_room_for(triangles, s_.at(0, 0)) ||
        !s_.charge(triangles * sizeof(geometry::Triangle)))
      return;
    mesh_.triangles.reserve(triangles);
    make_strips();
    const bool several = header_.textures.size() > 1;
    if (several) textures_.assign(mesh_.triangles.size(), 0);
    if (!wedges_.empty()) split_by_wedges();
    FaceCutter cutter;
    begin = 0;
    for (const Face& face : ends_) {
      const std::span<const std::uint32_t> corners(corners_.data() + begin,
                                                   static_cast<std::size_t>(face.end - begin));
      begin = face.end;
      if (!is_sound(corners, face.where, vertices)) continue;
      cutter.cut(corners, mesh_.positions, mesh_.triangles);
      if (several) textures_.resize(mesh_.triangles.size(), face.texture);
    }
  }

  bool is_sound(std::span<const std::uint32_t> corners, std::uint32_t where, std::size_t vertices) {
    const SourceSpan place = s_.at(header_.body.substr(where, 1));
    if (corners.size() < 3) {
      s_.trouble(Code("W6502"), "few", place, [&] {
        return fmt::format("{}a face of {} is left out", byte(where),
                           counted(corners.size(), "corner"));
      });
      return false;
    }
    for (const std::uint32_t v : corners) {
      if (is_vertex(v)) continue;
      s_.trouble(Code("E6501"), "index", place, [&] {
        const std::string which = v == kNoIndex ? "no vertex" : fmt::format("vertex {}", v);
        return fmt::format("{}the face names {} of {}, and is left out", byte(where), which,
                           vertices);
      });
      return false;
    }
    return true;
  }

  // Vertices whose corners have different texture coordinates become several.
  void split_by_wedges() {
    const std::size_t points = mesh_.positions.size();
    mesh_.texcoords.assign(points, Vec2(0));
    std::vector<bool> used(points, false);
    std::vector<std::uint32_t> next(points, kNoIndex);
    for (std::size_t c = 0; c < corners_.size() && c < wedges_.size(); ++c) {
      const std::uint32_t point = corners_[c];
      if (point >= points) {
        corners_[c] = kNoIndex;  // more vertices must not make one of it
        continue;
      }
      std::uint32_t v = point;
      if (!used[point]) {
        used[point] = true;
        mesh_.texcoords[point] = wedges_[c];
      }
      for (int k = 0; k < kMostCopies && v != kNoIndex && mesh_.texcoords[v] != wedges_[c]; ++k)
        v = next[v];
      if (v == kNoIndex || mesh_.texcoords[v] != wedges_[c]) {
        v = static_cast<std::uint32_t>(mesh_.positions.size());
        mesh_.positions.push_back(mesh_.positions[point]);
        if (has_normals_) mesh_.normals.push_back(mesh_.normals[point]);
        if (has_colours_) mesh_.colors.push_back(mesh_.colors[point]);
        mesh_.texcoords.push_back(wedges_[c]);
        next.push_back(next[point]);
        next[point] = v;
      }
      corners_[c] = v;
    }
  }

  // Strips end at −1, and where they name what is not there.
  void make_strips() {
    std::vector<std::uint32_t> strip;
    for (const std::uint32_t v : strips_) {
      if (is_vertex(v)) {
        strip.push_back(v);
        continue;
      }
      if (v != kNoIndex)
        s_.trouble(Code("E6501"), "strip", s_.at(header_.body.substr(0, 0)), [&] {
          return fmt::format("a strip names vertex {} of {}, and is cut there", v,
                             mesh_.positions.size());
        });
      geometry::append_strip(strip, mesh_.triangles);
      strip.clear();
    }
  }

  void add_mesh() {
    corners_ = strips_ = {};
    ends_ = {};
    wedges_ = {};
    drop_unused(mesh_);
    finish_normals(mesh_, s_.options.crease_angle);
    const SourceSpan where = s_.at(0, 0);
    const std::int32_t node = assembly_.add_node(0, {}, "mesh", where);
    if (node < 0) return;
    if (header_.textures.size() < 2) {
      const std::int32_t one = material(0);  // before the mesh, which it looks at, is moved
      return assembly_.add_part(node, std::move(mesh_), one, where);
    }
    std::map<std::int32_t, std::vector<geometry::Triangle>> parts;
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
      parts[textures_[i]].push_back(mesh_.triangles[i]);
    std::vector<std::uint32_t> to(mesh_.positions.size(), kNoIndex);
    for (auto& [texture, triangles] : parts)
      assembly_.add_part(node, part(std::move(triangles), to), material(texture), where);
  }

  // Some triangles of the mesh with their vertices. to: work space, all kNoIndex before and after.
  Mesh part(std::vector<geometry::Triangle> triangles, std::vector<std::uint32_t>& to) const {
    Mesh out;
    std::vector<std::uint32_t> from;
    for (geometry::Triangle& t : triangles)
      for (std::uint32_t& v : t) {
        if (to[v] == kNoIndex) {
          to[v] = static_cast<std::uint32_t>(from.size());
          from.push_back(v);
        }
        v = to[v];
      }
    const auto take = [&](const auto& all, auto& list) {
      if (all.empty()) return;
      list.reserve(from.size());
      for (const std::uint32_t v : from) list.push_back(all[v]);
    };
    take(mesh_.positions, out.positions);
    take(mesh_.normals, out.normals);
    take(mesh_.texcoords, out.texcoords);
    take(mesh_.colors, out.colors);
    for (const std::uint32_t v : from) to[v] = kNoIndex;
    out.triangles = std::move(triangles);
    return out;
  }

  // The material of a texture; −1: of none.
  std::int32_t material(std::int32_t texture) {
    if (texture >= 0 && !header_.textures.empty() && !mesh_.texcoords.empty()) {
      const std::string& name = header_.textures[static_cast<std::size_t>(texture)];
      materials::Material textured;
      textured.name = name;
      textured.diffuse = Vec3(1);
      textured.maps.albedo =
          assembly_.texture({.text = name, .including = {s_.file.path}}, false, s_.at(0, 0));
      CadMaterial cad;
      cad.name = name;
      cad.base_color = Vec3(1);
      cad.textured = true;
      if (textured.maps.albedo >= 0)
        return assembly_.add_material(std::move(textured), std::move(cad));
    }
    return assembly_.plain_material(!mesh_.colors.empty());
  }

  struct Face {
    std::uint32_t end;     // in corners_
    std::uint32_t where;   // byte in the body
    std::int32_t texture;  // −1: none
  };

  ReaderContext& s_;
  Assembly assembly_;
  PlyHeader header_;
  bool text_;
  PlyValues values_;
  Mesh mesh_;
  bool going_ = true;  // the body can be read on
  bool has_places_ = false, has_normals_ = false, has_colours_ = false, has_texcoords_ = false;
  std::vector<std::uint32_t> corners_;  // kNoIndex: no vertex
  std::vector<Vec2> wedges_;            // of the corners, or empty
  std::vector<Face> ends_;
  std::vector<std::int32_t> textures_;  // of triangles
  std::vector<std::uint32_t> strips_;   // each ends in kNoIndex
};

}  // namespace

Result<Imported> read_ply(Files& files, const InputFile& file, const Options& options,
                          DiagnosticLog& log) {
  PlyHeader header = ply_header_of(*file.bytes);
  const bool text = header.order == PlyOrder::text;
  ReaderContext context(files, file, options, text, log);
  // note: Blender 2.41 writes "Created by Blender3D …" so
  if (!header.credit.empty())
    log.report(Code("W6502"), context.at(header.credit),
               fmt::format("{} has no 'comment' before it; it is taken for one",
                           in_quotes(header.credit)));
  if (header.problem.empty()) return PlyReader(context, std::move(header)).read();
  log.report(Code("E6501"), context.at(header.place), header.problem);
  return failed;
}

}  // namespace panwright::importers::meshes
