#include "labels/internal/ply.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>
#include <vector>

#include "geometry/mesh/convex_hull.h"

namespace panwright::labels {
namespace {

template <class T>
void append_bytes(std::string& out, const T& value) {
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}

// Largest distance of two points. Exact: pairs are left out by their distance to the middle alone.
double diameter_of(std::vector<Vec3> points, const Vec3& middle, const Job& job) {
  if (const auto hull = geometry::convex_hull(points, job)) {
    std::vector<std::uint8_t> used(points.size());
    for (const geometry::Triangle& triangle : *hull)
      for (int k = 0; k < 3; ++k) used[triangle[static_cast<std::size_t>(k)]] = 1;
    std::vector<Vec3> corners;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (used[i] != 0) corners.push_back(points[i]);
    points = std::move(corners);
  }
  std::vector<std::pair<double, Vec3>> sorted;
  for (const Vec3& point : points) sorted.emplace_back(glm::length(point - middle), point);
  std::ranges::stable_sort(sorted, [](const auto& a, const auto& b) { return a.first > b.first; });
  double best = 0;
  for (std::size_t i = 0; i < sorted.size() && 2 * sorted[i].first > best; ++i) {
    job.poll();
    for (std::size_t j = i + 1; j < sorted.size() && sorted[i].first + sorted[j].first > best; ++j)
      best = std::max(best, glm::length(sorted[i].second - sorted[j].second));
  }
  return best;
}

}  // namespace

PlyModel ply_of(const pan::Model& model, double unit, const Job& job) {
  const std::vector<Mat4> matrices = model.world_from_nodes();
  std::vector<Vec3> points;
  std::string vertices, faces;
  std::uint32_t count = 0;
  PlyModel out;
  for (const pan::layout::Instance& instance : model.instances()) {
    job.poll();
    const pan::MeshView mesh = model.mesh(instance.mesh);
    const Mat4& matrix = matrices[instance.node];
    const Mat3 normals = cofactor(Mat3(matrix));
    const bool mirrored = glm::determinant(Mat3(matrix)) < 0;
    const auto origin = model.meshes()[instance.mesh].origin;
    const std::uint32_t first = count;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const auto& p = mesh.positions[v];
      const auto& n = mesh.normals[v];
      const Vec3 point = unit * Vec3(matrix * Vec4(origin[0] + double{p.x}, origin[1] + double{p.y},
                                                   origin[2] + double{p.z}, 1));
      const Vec3 turned = (mirrored ? -1.0 : 1.0) * (normals * Vec3(n.x, n.y, n.z));
      const double length = glm::length(turned);
      const Vec3 normal = length > 0 ? turned / length : Vec3(0, 0, 1);
      for (int k = 0; k < 3; ++k) append_bytes(vertices, static_cast<float>(point[k]));
      for (int k = 0; k < 3; ++k) append_bytes(vertices, static_cast<float>(normal[k]));
      out.least = points.empty() ? point : glm::min(out.least, point);
      out.most = points.empty() ? point : glm::max(out.most, point);
      points.push_back(point);
      ++count;
    }
    for (std::size_t t = 0; t + 3 <= mesh.indices.size(); t += 3) {
      append_bytes(faces, std::uint8_t{3});
      for (const std::size_t k : {0, mirrored ? 2 : 1, mirrored ? 1 : 2})
        append_bytes(faces, first + mesh.indices[t + k]);
    }
  }
  constexpr std::size_t kFaceBytes = 13;
  out.bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float "
      "y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face "
      "{}\nproperty list uchar int vertex_indices\nend_header\n",
      count, faces.size() / kFaceBytes);
  out.bytes += vertices;
  out.bytes += faces;
  out.diameter = diameter_of(std::move(points), 0.5 * (out.least + out.most), job);
  return out;
}

}  // namespace panwright::labels
