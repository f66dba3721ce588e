#include "geometry/tessellate/mapping.h"
#include "geometry/internal/limits.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace panwright::geometry {

namespace {

struct Place {
  Vec2 uv;
  bool on_axis;
};

Place place_on_sphere(const Vec3& p) {
  const double across = std::sqrt(p.x * p.x + p.y * p.y);
  const double latitude = det::atan2(p.z, across);
  // note: a place this near the axis is on it but for rounding
  const bool on_axis = across <= 1e-12 * std::fabs(p.z);
  double u = det::atan2(p.y, p.x) / (2 * kPi);
  if (u < 0) u += 1;
  // a longitude of −1e−20 has become 1
  if (u >= 1) u = 0;
  return {{on_axis ? 0 : u, 0.5 + latitude / kPi}, on_axis};
}

class Mapper {
 public:
  explicit Mapper(Mesh& mesh) : mesh_(mesh), originals_(mesh.positions.size()) {}

  void run(const Mat4& texture_from_mesh) {
    std::vector<Vec3> positions(originals_);
    double size = 0;
    for (std::size_t i = 0; i < originals_; ++i) {
      positions[i] = Vec3(texture_from_mesh * Vec4(mesh_.positions[i], 1));
      size = std::max(
          {size, std::fabs(positions[i].x), std::fabs(positions[i].y), std::fabs(positions[i].z)});
    }
    on_axis_.resize(originals_);
    mesh_.texcoords.resize(originals_);
    for (std::size_t i = 0; i < originals_; ++i) {
      // about the largest coordinate, so that squares neither overflow nor vanish
      const Place place = place_on_sphere(size > 0 ? positions[i] / size : Vec3(0));
      mesh_.texcoords[i] = place.uv;
      on_axis_[i] = place.on_axis;
    }
    east_copy_.assign(originals_, kNone);
    pole_used_.assign(originals_, false);
    for (Triangle& t : mesh_.triangles) map_triangle(t);
  }

 private:
  void map_triangle(Triangle& t) {
    const double seam = seam_of(t);
    double sum = 0;
    int off_axis = 0;
    for (std::uint32_t& v : t) {
      if (on_axis_[v]) continue;
      if (mesh_.texcoords[v].x < seam) v = east_copy(v);
      sum += mesh_.texcoords[v].x;
      ++off_axis;
    }
    const double mean = off_axis > 0 ? sum / off_axis : 0;
    for (std::uint32_t& v : t)
      if (v < originals_ && on_axis_[v]) v = pole_vertex(v, mean);
  }

  // The u below which corners are taken a turn further east, so that the triangle lies on the
  // smallest arc that holds them; 0 for nearly all.
  double seam_of(const Triangle& t) const {
    double widest_gap = 0;
    double seam = 0;
    // the gap that ends at each corner; the one that begins at the last corner ends at the first
    for (const std::uint32_t v : t) {
      if (on_axis_[v]) continue;
      const double u = mesh_.texcoords[v].x;
      double below = -1;
      double highest = 0;
      for (const std::uint32_t w : t) {
        if (on_axis_[w]) continue;
        const double other = mesh_.texcoords[w].x;
        highest = std::max(highest, other);
        if (other < u) below = std::max(below, other);
      }
      const bool is_first = below < 0;
      const double gap = is_first ? u + 1 - highest : u - below;
      // note: of equal gaps the one across the meridian is taken, where nothing needs a copy
      if (gap < widest_gap || (gap == widest_gap && !is_first)) continue;
      widest_gap = gap;
      seam = is_first ? 0 : u;
    }
    return seam;
  }

  std::uint32_t east_copy(std::uint32_t v) {
    if (east_copy_[v] == kNone) east_copy_[v] = copy_vertex(v, mesh_.texcoords[v] + Vec2(1, 0));
    return east_copy_[v];
  }

  // the first triangle keeps the vertex
  std::uint32_t pole_vertex(std::uint32_t v, double u) {
    if (pole_used_[v]) return copy_vertex(v, {u, mesh_.texcoords[v].y});
    pole_used_[v] = true;
    mesh_.texcoords[v].x = u;
    return v;
  }

  std::uint32_t copy_vertex(std::uint32_t v, const Vec2& uv) {
    const auto copy = [v](auto& list) {
      if (list.empty()) return;
      const auto value = list[v];
      list.push_back(value);
    };
    copy(mesh_.positions);
    copy(mesh_.normals);
    copy(mesh_.colors);
    mesh_.texcoords.push_back(uv);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }

  Mesh& mesh_;
  std::size_t originals_;
  std::vector<bool> on_axis_;             // of the original vertices
  std::vector<std::uint32_t> east_copy_;  // of the original vertices
  std::vector<bool> pole_used_;           // of the original vertices
};

}  // namespace

void apply_sphere_mapping(Mesh& mesh, const Mat4& texture_from_mesh) {
  Mapper(mesh).run(texture_from_mesh);
}

void apply_box_mapping(Mesh& mesh) {
  const std::size_t originals = mesh.positions.size();
  mesh.texcoords.assign(originals, Vec2(0));
  if (originals == 0) return;
  Vec3 low = mesh.positions[0], high = low;
  for (const Vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const Vec3 size = high - low;
  const auto across = [&](const Vec3& p, int axis, bool turned) {
    const double x = size[axis] > 0 ? (p[axis] - low[axis]) / size[axis] : 0;
    return turned ? 1 - x : x;
  };
  // for each vertex and face: the vertex that stands for it
  std::vector<std::array<std::uint32_t, 6>> copies(originals,
                                                   {kNone, kNone, kNone, kNone, kNone, kNone});
  std::vector<char> used(originals);
  for (Triangle& t : mesh.triangles) {
    const Vec3 n = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                              mesh.positions[t[2]] - mesh.positions[t[0]]);
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (std::fabs(n[k]) > std::fabs(n[axis])) axis = k;
    const bool back = n[axis] < 0;
    const auto face = static_cast<std::size_t>(2 * axis + (back ? 1 : 0));
    for (std::uint32_t& v : t) {
      std::uint32_t& copy = copies[v][face];
      if (copy == kNone) {
        const Vec3 p = mesh.positions[v];
        // to the right, seen from outside: +x faces +y, +y faces −x, +z faces +x
        const int right = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
        const Vec2 uv(across(p, right, back != (axis == 1)), across(p, up, false));
        copy = v;
        if (used[v]) {
          copy = static_cast<std::uint32_t>(mesh.positions.size());
          mesh.positions.push_back(p);
          if (!mesh.normals.empty()) mesh.normals.push_back(Vec3(mesh.normals[v]));
          if (!mesh.colors.empty()) mesh.colors.push_back(Vec3(mesh.colors[v]));
          mesh.texcoords.emplace_back();
        }
        used[v] = 1;
        mesh.texcoords[copy] = uv;
      }
      v = copy;
    }
  }
}

}  // namespace panwright::geometry
