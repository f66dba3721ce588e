#include "importers/meshes/obj_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "base/text.h"

namespace panwright::importers::meshes {

namespace {

using geometry::Mesh;
using geometry::Triangle;

constexpr std::int64_t kOwn = -2;   // the normals are the file's
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
  add(out.colours, mesh.colours);
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

ObjMesher::ObjMesher(Session& session, const ObjLists& lists) : s_(session), l_(lists) {
  first_.assign(l_.points.size(), kNoIndex);
}

Mesh ObjMesher::mesh_of(const std::vector<Range>& ranges) {
  mesh_ = {};
  keys_.clear();
  next_.clear();
  texcoords_ = bare_ = false;
  std::vector<ObjCorner> corners;
  for (const Range& range : ranges)
    for (std::size_t face = range.begin; face < range.end; ++face)
      if (take_face(face, corners)) add_face(corners, range.smoothing);
  for (const Key& key : keys_) first_[static_cast<std::size_t>(key.corner.point)] = kNoIndex;
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
      s_.trouble(Code::E6501, "point", s_.at(where, where + 1), [&] {
        return fmt::format("the face names vertex {} of {}, and is left out",
                           std::int64_t{c.point} + 1, l_.points.size());
      });
      return false;
    }
    if (!is_usable(l_.points[static_cast<std::size_t>(c.point)])) {
      s_.trouble(Code::E6501, "place", s_.at(where, where + 1), [&] {
        return fmt::format("the face names vertex {}, which has no place, and is left out",
                           std::int64_t{c.point} + 1);
      });
      return false;
    }
    if (c.texcoord >= 0 && !is_in(c.texcoord, l_.texcoords.size())) {
      s_.trouble(Code::E6501, "texcoord", s_.at(where, where + 1), [&] {
        return fmt::format("the face names texture coordinates {} of {}; it has none then",
                           std::int64_t{c.texcoord} + 1, l_.texcoords.size());
      });
      c.texcoord = -1;
    }
    if (c.normal >= 0 && !is_in(c.normal, l_.normals.size())) {
      s_.trouble(Code::E6501, "normal", s_.at(where, where + 1), [&] {
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

// The triangles of one smoothing, with all that their vertices have but computed normals.
Mesh ObjMesher::with_lists(std::span<const std::uint32_t> vertices,
                           std::span<const std::uint32_t> triangles,
                           std::vector<std::uint32_t>& to) const {
  Mesh out;
  out.positions.reserve(vertices.size());
  out.triangles.reserve(triangles.size());
  for (const std::uint32_t v : vertices) {
    const Key& key = keys_[v];
    to[v] = static_cast<std::uint32_t>(out.positions.size());
    out.positions.push_back(mesh_.positions[v]);
    if (key.smoothing == kOwn)
      out.normals.push_back(l_.normals[static_cast<std::size_t>(key.corner.normal)]);
    if (texcoords_)
      out.texcoords.push_back(key.corner.texcoord < 0
                                  ? Vec2(0)
                                  : l_.texcoords[static_cast<std::size_t>(key.corner.texcoord)]);
    if (!l_.colours.empty())
      out.colours.push_back(l_.colours[static_cast<std::size_t>(key.corner.point)]);
  }
  for (const std::uint32_t i : triangles) {
    const Triangle& t = mesh_.triangles[i];
    out.triangles.push_back({to[t[0]], to[t[1]], to[t[2]]});
  }
  return out;
}

Mesh ObjMesher::finished() {
  if (texcoords_ && bare_)
    s_.trouble(Code::W6502, "bare", s_.at(0, 0), [] {
      return "some corners of a part have no texture coordinates; they get (0, 0)";
    });
  // vertices and triangles of one smoothing behind one another
  const auto smoothing_of = [&](std::uint32_t v) { return keys_[v].smoothing; };
  std::vector<std::uint32_t> vertices(keys_.size()), triangles(mesh_.triangles.size());
  std::iota(vertices.begin(), vertices.end(), 0u);
  std::iota(triangles.begin(), triangles.end(), 0u);
  std::stable_sort(vertices.begin(), vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
    return smoothing_of(a) < smoothing_of(b);
  });
  std::stable_sort(triangles.begin(), triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
    return smoothing_of(mesh_.triangles[a][0]) < smoothing_of(mesh_.triangles[b][0]);
  });
  std::vector<std::uint32_t> to(keys_.size());
  Mesh out;
  for (std::size_t v = 0, t = 0; v < vertices.size();) {
    const std::int64_t smoothing = smoothing_of(vertices[v]);
    std::size_t v_end = v, t_end = t;
    while (v_end < vertices.size() && smoothing_of(vertices[v_end]) == smoothing) ++v_end;
    while (t_end < triangles.size() &&
           smoothing_of(mesh_.triangles[triangles[t_end]][0]) == smoothing)
      ++t_end;
    Mesh mesh = with_lists(std::span(vertices).subspan(v, v_end - v),
                           std::span(triangles).subspan(t, t_end - t), to);
    finish_normals(mesh, smoothing == kByCrease ? s_.options.crease_angle
                         : smoothing == kFlat   ? 0
                                                : kPi);
    append(out, std::move(mesh));
    v = v_end;
    t = t_end;
  }
  if (std::ranges::all_of(out.colours, [](const Vec3& c) { return c == Vec3(1); }))
    out.colours.clear();
  return out;
}

}  // namespace panwright::importers::meshes
