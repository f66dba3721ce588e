#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/axis_box.h"
#include "base/parallel.h"
#include "base/text.h"
#include "importers/gltf/draco.h"
#include "importers/gltf/primitives.h"
#include "importers/gltf/read.h"

namespace panwright::importers::gltf {

namespace {

using geometry::Triangle;

// Triangles that one byte of a Draco stream may stand for, and so many in any case. Real models
// have about one; a flat grid at the best compression about 20.
constexpr std::uint64_t kFacesPerByte = 64;
constexpr std::uint64_t kFreeFaces = 4096;
// What a vertex and a triangle take in memory, with what decoding and normals need beside them.
constexpr std::uint64_t kVertexBytes = 3 * 24 + 16;
constexpr std::uint64_t kTriangleBytes = 3 * 4;

constexpr std::uint32_t kNoIndex = 0xffffffffu;

// Where the numbers of a primitive come from: views, or a Draco stream.
class Source {
 public:
  Source(Document& document, const tinygltf::Primitive& primitive, std::string object)
      : d_(document), primitive_(primitive), object_(std::move(object)) {}

  // False, once reported: the stream is damaged and there are no views instead of it.
  bool open() {
    const auto found = primitive_.extensions.find("KHR_draco_mesh_compression");
    if (found == primitive_.extensions.end()) return true;
    const tinygltf::Value& names = found->second.Get("attributes");
    for (const std::string& name : names.Keys())
      ids_[name] = static_cast<std::uint32_t>(names.Get(name).GetNumberAsInt());
    const View& view =
        d_.views[static_cast<std::size_t>(found->second.Get("bufferView").GetNumberAsInt())];
    if (view.sound && decode(view.bytes)) return true;
    const int position = accessor("POSITION");
    return position >= 0 && d_.accessors[static_cast<std::size_t>(position)].view >= 0;
  }

  int accessor(const std::string& name) const {
    const auto found = primitive_.attributes.find(name);
    return found == primitive_.attributes.end() ? -1 : found->second;
  }

  bool packed() const { return draco_.has_value(); }
  const DracoMesh& draco() const { return *draco_; }

  // From now on, reads the vertices at `places` alone. Expects: not packed.
  void pick(std::vector<std::uint32_t> places) { places_ = std::move(places); }

  // Numbers of an accessor of vertices; `count` of them without pick().
  template <class Vector>
  std::vector<Vector> read(std::size_t accessor, std::uint64_t count, const std::string& at) {
    if (!places_) return read_vectors<Vector>(d_, accessor, at);
    if (d_.accessors[accessor].count != count) return {};
    if (!d_.judged.insert(accessor).second)
      return read_vectors_at<Vector>(d_, accessor, *places_, at);
    const std::vector<Vector> all = read_vectors<Vector>(d_, accessor, at);
    std::vector<Vector> out;
    if (all.empty()) return out;
    out.reserve(places_->size());
    for (const std::uint32_t place : *places_) out.push_back(all[place]);
    return out;
  }

  template <class Vector>
  std::vector<Vector> read(const std::string& name, std::uint64_t count) {
    const int index = accessor(name);
    if (index < 0) return {};
    const std::string at = object_ + "/attributes/" + name;
    const auto id = ids_.find(name);
    if (!draco_ || id == ids_.end())
      return read<Vector>(static_cast<std::size_t>(index), count, at);
    const Accessor& a = d_.accessors[static_cast<std::size_t>(index)];
    std::vector<Vector> out(draco_->points(), Vector(0));
    DracoAttribute attribute{id->second, scale_of(a.component, a.normalised), a.normalised,
                             reinterpret_cast<double*>(out.data()),
                             sizeof(Vector) / sizeof(double)};
    if (!draco_->read(attribute)) {
      d_.report(Code("E6210"), a.json, at,
                fmt::format("the Draco stream has no attribute {}", id->second));
      return {};
    }
    const auto whole = [](const Vector& v) {
      for (int k = 0; k < Vector::length(); ++k)
        if (!std::isfinite(v[k])) return false;
      return true;
    };
    if (std::all_of(out.begin(), out.end(), whole)) return out;
    d_.report(Code("E6207"), a.json, at, "the Draco stream holds numbers that are not finite");
    return {};
  }

 private:
  bool refuse(std::string message) {
    d_.report(Code("E6210"), nullptr, object_ + "/extensions/KHR_draco_mesh_compression",
              "Draco: " + std::move(message));
    return false;
  }

  bool decode(std::span<const std::byte> bytes) {
    const auto head = draco_head(bytes);
    if (!head) return refuse("the head of the stream is damaged");
    if (!head->mesh) return refuse("the stream holds points, not triangles");
    const std::uint64_t most = std::max(kFreeFaces, kFacesPerByte * bytes.size());
    if (head->faces > most || head->points > 3 * most || head->faces > d_.options.limits.triangles)
      return refuse(fmt::format("{} bytes promise {} triangles and {} points", bytes.size(),
                                head->faces, head->points));
    if (!d_.charge(head->points * kVertexBytes + head->faces * 2 * kTriangleBytes, object_))
      return false;
    std::string problem;
    draco_ = DracoMesh::decoded(bytes, problem);
    if (!draco_) return refuse(problem);
    return true;
  }

  Document& d_;
  const tinygltf::Primitive& primitive_;
  std::string object_;
  std::map<std::string, std::uint32_t> ids_;
  std::optional<DracoMesh> draco_;
  std::optional<std::vector<std::uint32_t>> places_;
};

// Makes the triangles' indices those of the vertices in use, which are returned, ascending.
std::vector<std::uint32_t> compacted(std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> used;
  used.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) used.insert(used.end(), t.begin(), t.end());
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (Triangle& t : triangles)
    for (std::uint32_t& v : t)
      v = static_cast<std::uint32_t>(std::ranges::lower_bound(used, v) - used.begin());
  return used;
}

// ---- topology

// Triangles of a list, strip or fan of indices. `restart` ends a run.
class Assembler {
 public:
  Assembler(std::uint64_t vertices, std::uint32_t restart, std::vector<Triangle>& out)
      : vertices_(vertices), restart_(restart), out_(out) {}

  template <class At>
  void list(std::uint64_t count, const At& at) {
    out_.resize(count / 3);
    for (std::uint64_t i = 0; i + 2 < count; i += 3) {
      Triangle& t = out_[i / 3];
      t = {at(i), at(i + 1), at(i + 2)};
      const std::uint32_t largest = std::max({t[0], t[1], t[2]});
      suspect_ = suspect_ || largest >= vertices_ || largest == restart_;
    }
    if (suspect_) std::erase_if(out_, [&](const Triangle& t) { return !good(t); });
  }

  template <class At>
  void run(std::uint64_t count, bool fan, const At& at) {
    std::uint64_t first = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      if (at(i) == restart_) {
        ++restarts_;
        first = i + 1;
        continue;
      }
      if (i < first + 2) continue;
      const bool odd = (i - first) % 2 != 0;
      const Triangle t = fan   ? Triangle{at(i - 1), at(i), at(first)}
                         : odd ? Triangle{at(i - 1), at(i - 2), at(i)}
                               : Triangle{at(i - 2), at(i - 1), at(i)};
      if (good(t)) out_.push_back(t);
    }
  }

  std::uint64_t restarts() const { return restarts_; }
  std::uint64_t beyond() const { return beyond_; }
  std::uint32_t worst() const { return worst_; }

 private:
  bool good(const Triangle& t) {
    for (const std::uint32_t index : t) {
      if (index == restart_) {
        ++restarts_;
        return false;
      }
      if (index < vertices_) continue;
      ++beyond_;
      worst_ = std::max(worst_, index);
      return false;
    }
    return true;
  }

  std::uint64_t vertices_;
  std::uint32_t restart_;
  std::vector<Triangle>& out_;
  bool suspect_ = false;
  std::uint64_t restarts_ = 0;
  std::uint64_t beyond_ = 0;
  std::uint32_t worst_ = 0;
};

std::uint32_t restart_value(int component) {
  return component == 5121 ? 0xff : component == 5123 ? 0xffff : 0xffffffffu;
}

// ---- one primitive

class SurfaceReader {
 public:
  SurfaceReader(Document& document, const tinygltf::Primitive& primitive, std::string object)
      : d_(document),
        primitive_(primitive),
        object_(std::move(object)),
        source_(document, primitive, object_) {}

  Surface read(bool shared, const std::vector<double>& weights, const TexcoordChoice& texcoords) {
    Surface out;
    const int position = source_.accessor("POSITION");
    if (primitive_.mode < 4) {
      out.skipped = true;
      if (position >= 0) check_lines(static_cast<std::size_t>(position));
      return out;
    }
    shared = shared && primitive_.indices >= 0 &&
             !primitive_.extensions.contains("KHR_draco_mesh_compression");
    if (position < 0 || !within_limits(static_cast<std::size_t>(position), shared) ||
        !source_.open())
      return out;
    geometry::Mesh& mesh = out.mesh;
    elements_ = d_.accessors[static_cast<std::size_t>(position)].count;
    if (shared) {
      if (!check_whole(static_cast<std::size_t>(position)) || !triangles(mesh, elements_))
        return Surface{};
      source_.pick(compacted(mesh.triangles));
    }
    mesh.positions = source_.read<Vec3>("POSITION", elements_);
    if (mesh.positions.empty()) return Surface{};
    vertices_ = mesh.positions.size();
    if (!source_.packed() && !shared)
      compare_bounds(static_cast<std::size_t>(position), mesh.positions);
    mesh.normals = source_.read<Vec3>("NORMAL", elements_);
    keep_if_fitting(mesh.normals, "NORMAL");
    mesh.colors = source_.read<Vec3>("COLOR_0", elements_);
    keep_if_fitting(mesh.colors, "COLOR_0");
    clamp_colors(mesh.colors);
    read_texcoords(texcoords, out);
    if (!shared && !triangles(mesh, mesh.positions.size())) return Surface{};
    morph(weights, mesh);
    unit_normals(mesh);
    read_skin(out);
    return out;
  }

 private:
  void wrong(Code code, std::string_view below, std::string message) {
    d_.report(code, nullptr, object_ + std::string(below), std::move(message));
  }

  // Points and lines are left out, and problems of their indices are reported.
  void check_lines(std::size_t position) {
    if (primitive_.indices < 0) return;
    const auto index = static_cast<std::size_t>(primitive_.indices);
    const std::uint32_t restart = restart_value(d_.accessors[index].component);
    const std::uint64_t vertices = d_.accessors[position].count;
    std::uint64_t bad = 0;
    for (const std::uint32_t i : read_indices(d_, index, object_ + "/indices"))
      if (i == restart || i >= vertices) ++bad;
    if (bad > 0)
      wrong(Code("E6207"), "/indices",
            fmt::format("{} of points or lines are not vertices", counted(bad, "index value")));
  }

  // Positions that several primitives share are read in full once. False: they are unreadable.
  bool check_whole(std::size_t position) {
    if (!d_.judged.insert(position).second) return d_.accessors[position].sound;
    if (!d_.charge(d_.accessors[position].count * sizeof(Vec3), object_)) return false;
    const auto all = read_vectors<Vec3>(d_, position, object_ + "/attributes/POSITION");
    if (!all.empty()) compare_bounds(position, all);
    return !all.empty();
  }

  bool within_limits(std::size_t position, bool shared) {
    const std::uint64_t vertices = d_.accessors[position].count;
    const std::uint64_t corners =
        primitive_.indices < 0 ? vertices
                               : d_.accessors[static_cast<std::size_t>(primitive_.indices)].count;
    const std::uint64_t triangles = primitive_.mode == 4 ? corners / 3 : corners;
    if (triangles > d_.options.limits.triangles) {
      wrong(Code("E6002"), "",
            fmt::format("{} triangles are over the limit of {}", triangles,
                        d_.options.limits.triangles));
      return false;
    }
    if (primitive_.extensions.contains("KHR_draco_mesh_compression")) return true;
    const std::uint64_t read = shared ? std::min(vertices, corners) : vertices;
    return d_.charge(read * kVertexBytes + triangles * kTriangleBytes, object_);
  }

  // The bounds that the file gives are those of its positions, as single precision holds them.
  void compare_bounds(std::size_t accessor, const std::vector<Vec3>& positions) {
    const Accessor& a = d_.accessors[accessor];
    if (a.view < 0 && !a.is_sparse) return;  // all 0, whatever the file says
    const Json* least = a.json->find("min");
    const Json* most = a.json->find("max");
    if (!least || !most || least->items.size() != 3 || most->items.size() != 3) return;
    AxisBox box{positions[0], positions[0]};
    for (const Vec3& p : positions) box.add(p);
    const double scale = scale_of(a.component, a.normalised);
    for (int k = 0; k < 3; ++k) {
      const auto place = static_cast<std::size_t>(k);
      const auto same = [&](double given, double found) {
        // note: −128 and −127 are both −1 once normalised
        return static_cast<float>(std::max(given * scale, a.normalised ? -1.0 : given)) ==
               static_cast<float>(found);
      };
      if (same(least->items[place].number, box.low[k]) &&
          same(most->items[place].number, box.high[k]))
        continue;
      wrong(Code("W6212"), "/attributes/POSITION",
            fmt::format("positions lie between {} and {} along axis {}, the file says {} and {}",
                        format_double(box.low[k]), format_double(box.high[k]), k,
                        format_double(least->items[place].number),
                        format_double(most->items[place].number)));
      return;
    }
  }

  template <class Vector>
  void keep_if_fitting(std::vector<Vector>& list, const std::string& name) {
    if (list.empty() || list.size() == vertices_) return;
    wrong(Code("E6211"), "/attributes/" + name,
          fmt::format("{} elements for {} vertices", list.size(), vertices_));
    list.clear();
  }

  void clamp_colors(std::vector<Vec3>& colors) {
    std::size_t beyond = 0;
    for (Vec3& color : colors) {
      const Vec3 within = glm::clamp(color, Vec3(0), Vec3(1));
      if (within != color) ++beyond;
      color = within;
    }
    if (beyond > 0)
      wrong(Code("W6212"), "/attributes/COLOR_0",
            fmt::format("{} are not within 0 to 1", counted(beyond, "colour")));
  }

  void read_texcoords(const TexcoordChoice& choice, Surface& out) {
    if (choice.set < 0) return;
    const std::string name = fmt::format("TEXCOORD_{}", choice.set);
    std::vector<Vec2>& uv = out.mesh.texcoords;
    uv = source_.read<Vec2>(name, elements_);
    keep_if_fitting(uv, name);
    out.has_texcoords = !uv.empty();
    const auto [sine, cosine] = det::sincos(choice.rotation);
    for (Vec2& p : uv) {
      const Vec2 scaled = p * choice.scale;
      // counter-clockwise as textures are seen, v downwards
      const Vec2 turned(cosine * scaled.x + sine * scaled.y, cosine * scaled.y - sine * scaled.x);
      const Vec2 moved = turned + choice.offset;
      const bool finite = std::isfinite(moved.x) && std::isfinite(moved.y);
      p = finite ? Vec2(moved.x, 1 - moved.y) : Vec2(0);
    }
  }

  bool triangles(geometry::Mesh& mesh, std::uint64_t vertices) {
    if (source_.packed()) {
      mesh.triangles = source_.draco().triangles();
      for (const Triangle& t : mesh.triangles)
        if (std::max({t[0], t[1], t[2]}) >= vertices) {
          wrong(Code("E6210"), "", "Draco: an index past the last vertex");
          return false;
        }
      return true;
    }
    std::vector<std::uint32_t> indices;
    std::uint64_t count = vertices;
    std::uint32_t restart = kNoIndex;
    if (primitive_.indices >= 0) {
      const auto index = static_cast<std::size_t>(primitive_.indices);
      indices = read_indices(d_, index, object_ + "/indices");
      if (indices.empty()) return false;
      count = indices.size();
      restart = restart_value(d_.accessors[index].component);
    }
    Assembler assembler(vertices, restart, mesh.triangles);
    const auto at = [&](std::uint64_t i) { return indices[i]; };
    const auto self = [](std::uint64_t i) { return static_cast<std::uint32_t>(i); };
    const bool fan = primitive_.mode == TINYGLTF_MODE_TRIANGLE_FAN;
    const bool list = primitive_.mode == TINYGLTF_MODE_TRIANGLES;
    if (indices.empty())
      list ? assembler.list(count, self) : assembler.run(count, fan, self);
    else
      list ? assembler.list(count, at) : assembler.run(count, fan, at);
    if (list ? count % 3 != 0 : count < 3)
      wrong(Code("W6215"), "", fmt::format("{} vertices do not make whole triangles", count));
    if (assembler.restarts() > 0)
      wrong(Code("E6207"), "/indices",
            fmt::format("the value {} for a primitive restart occurs {}", restart,
                        counted(assembler.restarts(), "time")));
    if (assembler.beyond() > 0)
      wrong(Code("E6207"), "/indices",
            fmt::format("{} with indices up to {}, of {} vertices; left out",
                        counted(assembler.beyond(), "triangle"), assembler.worst(), vertices));
    return true;
  }

  void morph(const std::vector<double>& weights, geometry::Mesh& mesh) {
    for (std::size_t t = 0; t < std::min(weights.size(), primitive_.targets.size()); ++t) {
      if (weights[t] == 0) continue;
      const std::string at = fmt::format("{}/targets/{}", object_, t);
      for (const auto& [name, accessor] : primitive_.targets[t]) {
        std::vector<Vec3>* to = name == "POSITION" ? &mesh.positions
                                : name == "NORMAL" ? &mesh.normals
                                                   : nullptr;
        if (!to || to->empty()) continue;
        const auto moves =
            source_.read<Vec3>(static_cast<std::size_t>(accessor), elements_, at + "/" + name);
        if (moves.size() != to->size()) continue;
        for (std::size_t i = 0; i < moves.size(); ++i) {
          const Vec3 moved = (*to)[i] + weights[t] * moves[i];
          if (is_finite(moved)) (*to)[i] = moved;
        }
      }
    }
  }

  // Makes normals unit; those of no length follow the triangles around them.
  void unit_normals(geometry::Mesh& mesh) {
    // quantised normals have the length that rounding to 8 bits leaves
    constexpr double kUnit = 0.02;
    std::vector<std::size_t> lost;
    std::size_t off = 0;
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
      Vec3& n = mesh.normals[i];
      const double length = glm::length(n);
      if (!(length > 1e-12) || !std::isfinite(length)) {
        lost.push_back(i);
        continue;
      }
      if (std::fabs(length - 1) > kUnit) ++off;
      n /= length;
    }
    if (off + lost.size() > 0)
      wrong(Code("W6212"), "/attributes/NORMAL",
            fmt::format("{} of {} normals are not unit vectors", off + lost.size(),
                        mesh.normals.size()));
    if (lost.empty()) return;
    for (const std::size_t i : lost) mesh.normals[i] = Vec3(0);
    std::vector<bool> is_lost(mesh.normals.size());
    for (const std::size_t i : lost) is_lost[i] = true;
    for (const Triangle& t : mesh.triangles) {
      if (!is_lost[t[0]] && !is_lost[t[1]] && !is_lost[t[2]]) continue;
      const Vec3& a = mesh.positions[t[0]];
      const Vec3 area = glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
      for (const std::uint32_t index : t)
        if (is_lost[index] && is_finite(area)) mesh.normals[index] += area;
    }
    for (const std::size_t i : lost) {
      const double length = glm::length(mesh.normals[i]);
      const bool usable = length > 1e-300 && std::isfinite(length);
      mesh.normals[i] = usable ? mesh.normals[i] / length : Vec3(0, 0, 1);
    }
  }

  void read_skin(Surface& out) {
    for (int set = 0; source_.accessor(fmt::format("JOINTS_{}", set)) >= 0; ++set) {
      auto joints = source_.read<Vec4>(fmt::format("JOINTS_{}", set), elements_);
      auto weights = source_.read<Vec4>(fmt::format("WEIGHTS_{}", set), elements_);
      if (joints.size() != vertices_ || weights.size() != vertices_) return;
      out.skin.joints.insert(out.skin.joints.end(), joints.begin(), joints.end());
      out.skin.weights.insert(out.skin.weights.end(), weights.begin(), weights.end());
      ++out.skin.sets;
    }
  }

  Document& d_;
  const tinygltf::Primitive& primitive_;
  std::string object_;
  Source source_;
  std::uint64_t elements_ = 0;  // of the positions' accessor
  std::size_t vertices_ = 0;    // of the mesh
};

}  // namespace

Surface surface_of(Document& document, const tinygltf::Primitive& primitive, bool shared,
                   const std::vector<double>& weights, const TexcoordChoice& texcoords,
                   const std::string& object) {
  return SurfaceReader(document, primitive, object).read(shared, weights, texcoords);
}

std::string surface_key(const tinygltf::Primitive& primitive, const std::vector<double>& weights,
                        const TexcoordChoice& texcoords) {
  std::string key = fmt::format("{}:{}:", primitive.mode, primitive.indices);
  for (const auto& [name, accessor] : primitive.attributes)
    key += fmt::format("{}={},", name, accessor);
  const auto draco = primitive.extensions.find("KHR_draco_mesh_compression");
  if (draco != primitive.extensions.end())
    key += fmt::format("draco{}", draco->second.Get("bufferView").GetNumberAsInt());
  for (std::size_t t = 0; t < std::min(weights.size(), primitive.targets.size()); ++t) {
    if (weights[t] == 0) continue;
    key += fmt::format(";{}", format_double(weights[t]));
    for (const auto& [name, accessor] : primitive.targets[t])
      key += fmt::format("{}={},", name, accessor);
  }
  const TexcoordChoice& uv = texcoords;
  return key + fmt::format("|{} {} {} {} {} {}", uv.set, format_double(uv.offset.x),
                           format_double(uv.offset.y), format_double(uv.rotation),
                           format_double(uv.scale.x), format_double(uv.scale.y));
}

}  // namespace panwright::importers::gltf
