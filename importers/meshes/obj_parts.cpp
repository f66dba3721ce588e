#include "importers/meshes/obj_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "base/text.h"

namespace panwright::importers::meshes {

namespace {

using geometry::Mesh;
using geometry::Triangle;

constexpr std::int64_t kOwn = -1;   // the normals are the file's
constexpr int kLongestSearch = 32;  // vertices of one point that are compared before one more

void append(Mesh& out, Mesh&& mesh) {
  if (out.positions.empty()) {
    out = std::move(mesh);
    return;
  }
  const auto offset = static_cast<std::uint32_t>(out.positions.size());
  const auto add = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  add(out.positions, mesh.positions);
  add(out.normals, mesh.normals);
  add(out.texcoords, mesh.texcoords);
  add(out.colors, mesh.colors);
  for (Triangle t : mesh.triangles) {
    for (std::uint32_t& v : t) v += offset;
    out.triangles.push_back(t);
  }
}

}  // namespace

bool ObjMesher::Key::operator==(const Key& other) const {
  return corner.point == other.corner.point && corner.texcoord == other.corner.texcoord &&
         corner.normal == other.corner.normal && smoothing == other.smoothing;
}

ObjMesher::ObjMesher(ReaderContext& context, ObjLists& lists) : s_(context), l_(lists) {
  first_.assign(l_.points.size(), kNoIndex);
}

Mesh ObjMesher::mesh_of(const std::vector<Range>& ranges, bool last) {
  mesh_ = {};
  keys_.clear();
  next_.clear();
  texcoords_ = bare_ = false;
  std::vector<ObjCorner> corners;
  for (const Range& range : ranges)
    for (std::size_t face = range.begin; face < range.end; ++face)
      if (take_face(face, corners)) add_face(corners, range.smoothing);
  for (const Key& key : keys_) first_[static_cast<std::size_t>(key.corner.point)] = kNoIndex;
  if (last) {
    l_.corners = {};
    l_.faces = {};
    first_ = {};
    next_ = {};
  }
  return finished();
}

// The corners of a face, without what their lists do not have; false where there is no face.
bool ObjMesher::take_face(std::size_t face, std::vector<ObjCorner>& corners) {
  const std::size_t begin = face == 0 ? 0 : l_.faces[face - 1].end;
  const std::size_t where = l_.faces[face].where;
  const auto is_in = [](std::int32_t i, std::size_t size) {
    return static_cast<std::size_t>(i) < size;
  };
  corners.assign(l_.corners.begin() + static_cast<std::ptrdiff_t>(begin),
                 l_.corners.begin() + static_cast<std::ptrdiff_t>(l_.faces[face].end));
  for (ObjCorner& c : corners) {
    if (!is_in(c.point, l_.points.size())) {
      s_.trouble(Code("E6501"), "point", s_.at(where, where + 1), [&] {
        return fmt::format("the face names vertex {} of {}, and is left out",
                           std::int64_t{c.point} + 1, l_.points.size());
      });
      return false;
    }
    if (!is_usable(l_.points[static_cast<std::size_t>(c.point)])) {
      s_.trouble(Code("E6501"), "place", s_.at(where, where + 1), [&] {
        return fmt::format("the face names vertex {}, which has no position, and is left out",
                           std::int64_t{c.point} + 1);
      });
      return false;
    }
    if (c.texcoord >= 0 && !is_in(c.texcoord, l_.texcoords.size())) {
      s_.trouble(Code("E6501"), "texcoord", s_.at(where, where + 1), [&] {
        return fmt::format("the face names texture coordinates {} of {}; it has none then",
                           std::int64_t{c.texcoord} + 1, l_.texcoords.size());
      });
      c.texcoord = -1;
    }
    if (c.normal >= 0 && !is_in(c.normal, l_.normals.size())) {
      s_.trouble(Code("E6501"), "normal", s_.at(where, where + 1), [&] {
        return fmt::format("the face names normal {} of {}; it has none then",
                           std::int64_t{c.normal} + 1, l_.normals.size());
      });
      c.normal = -1;
    }
  }
  return true;
}

void ObjMesher::add_face(const std::vector<ObjCorner>& corners, std::int64_t smoothing) {
  const bool own =
      std::all_of(corners.begin(), corners.end(), [](const ObjCorner& c) { return c.normal >= 0; });
  outline_.clear();
  for (const ObjCorner& c : corners) {
    texcoords_ = texcoords_ || c.texcoord >= 0;
    bare_ = bare_ || c.texcoord < 0;
    outline_.push_back(
        vertex({{c.point, c.texcoord, own ? c.normal : -1}, own ? kOwn : smoothing}));
  }
  cutter_.cut(outline_, mesh_.positions, mesh_.triangles);
}

std::uint32_t ObjMesher::vertex(const Key& key) {
  std::uint32_t& first = first_[static_cast<std::size_t>(key.corner.point)];
  std::uint32_t v = first;
  for (int i = 0; v != kNoIndex && i < kLongestSearch; ++i, v = next_[v])
    if (keys_[v] == key) return v;
  v = static_cast<std::uint32_t>(keys_.size());
  keys_.push_back(key);
  next_.push_back(first);
  mesh_.positions.push_back(l_.points[static_cast<std::size_t>(key.corner.point)]);
  return first = v;
}

// Gives a mesh what its vertices have in the lists, and normals.
void ObjMesher::complete(Mesh& mesh, std::span<const Key> keys) const {
  const std::int64_t smoothing = keys.empty() ? kByCrease : keys[0].smoothing;
  for (const Key& key : keys) {
    if (smoothing == kOwn)
      mesh.normals.push_back(l_.normals[static_cast<std::size_t>(key.corner.normal)]);
    if (texcoords_)
      mesh.texcoords.push_back(key.corner.texcoord < 0
                                   ? Vec2(0)
                                   : l_.texcoords[static_cast<std::size_t>(key.corner.texcoord)]);
    if (!l_.colors.empty())
      mesh.colors.push_back(l_.colors[static_cast<std::size_t>(key.corner.point)]);
  }
  finish_normals(mesh, smoothing == kByCrease ? s_.options.crease_angle : kPi);
}

// One mesh for each smoothing, behind one another.
Mesh ObjMesher::by_smoothing() {
  const auto smoothing_of = [&](std::uint32_t v) { return keys_[v].smoothing; };
  std::vector<std::uint32_t> vertices(keys_.size()), triangles(mesh_.triangles.size());
  std::iota(vertices.begin(), vertices.end(), 0u);
  std::iota(triangles.begin(), triangles.end(), 0u);
  std::ranges::stable_sort(vertices, {}, smoothing_of);
  std::ranges::stable_sort(triangles, {},
                           [&](std::uint32_t i) { return smoothing_of(mesh_.triangles[i][0]); });
  std::vector<std::uint32_t> to(keys_.size());
  Mesh out;
  std::vector<Key> keys;
  for (std::size_t v = 0, t = 0; v < vertices.size();) {
    const std::int64_t smoothing = smoothing_of(vertices[v]);
    Mesh mesh;
    keys.clear();
    for (; v < vertices.size() && smoothing_of(vertices[v]) == smoothing; ++v) {
      to[vertices[v]] = static_cast<std::uint32_t>(keys.size());
      keys.push_back(keys_[vertices[v]]);
      mesh.positions.push_back(mesh_.positions[vertices[v]]);
    }
    for (; t < triangles.size(); ++t) {
      const Triangle& corners = mesh_.triangles[triangles[t]];
      if (smoothing_of(corners[0]) != smoothing) break;
      mesh.triangles.push_back({to[corners[0]], to[corners[1]], to[corners[2]]});
    }
    complete(mesh, keys);
    append(out, std::move(mesh));
  }
  return out;
}

Mesh ObjMesher::finished() {
  if (texcoords_ && bare_)
    s_.trouble(Code("W6502"), "bare", s_.at(0, 0), [] {
      return "some corners of a part have no texture coordinates; they get (0, 0)";
    });
  const bool one = std::ranges::all_of(
      keys_, [&](const Key& key) { return key.smoothing == keys_[0].smoothing; });
  Mesh out = one ? std::move(mesh_) : by_smoothing();
  if (one) complete(out, keys_);
  if (std::ranges::all_of(out.colors, [](const Vec3& c) { return c == Vec3(1); }))
    out.colors.clear();
  return out;
}

}  // namespace panwright::importers::meshes
