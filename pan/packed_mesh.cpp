// Meshes rounded to float about their centres.
#include <cassert>

#include "base/axis_box.h"
#include "pan/writer.h"

namespace panwright::pan {

namespace {

void store_rounded(float* to, const Vec3& v) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v[k]);
}

std::vector<float> rounded(const std::vector<Vec3>& values) {
  std::vector<float> out(3 * values.size());
  for (std::size_t i = 0; i < values.size(); ++i) store_rounded(&out[3 * i], values[i]);
  return out;
}

// owned: the same mesh, of which each array is freed once it is rounded; null: it stays whole
PackedMesh packed_from(const geometry::Mesh& mesh, geometry::Mesh* owned, std::string name) {
  assert(!mesh.triangles.empty() && mesh.normals.size() == mesh.positions.size());
  const auto done = [&](auto member) {
    if (owned != nullptr) std::remove_cvref_t<decltype(owned->*member)>().swap(owned->*member);
  };
  PackedMesh out;
  out.name = std::move(name);
  out.closed = mesh.closed;
  AxisBox box;
  for (const Vec3& p : mesh.positions) box.add(p);
  out.origin = box.centre();
  double worst = 0;
  out.positions.resize(3 * mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    float* to = &out.positions[3 * i];
    store_rounded(to, mesh.positions[i] - out.origin);
    const Vec3 stored = out.origin + Vec3(to[0], to[1], to[2]);
    const double moved = glm::length(stored - mesh.positions[i]);
    worst = moved > worst ? moved : worst;
  }
  done(&geometry::Mesh::positions);
  out.error = mesh.error + worst;
  out.normals = rounded(mesh.normals);
  done(&geometry::Mesh::normals);
  out.colors = rounded(mesh.colors);
  out.texcoords.reserve(2 * mesh.texcoords.size());
  for (const Vec2& t : mesh.texcoords) {
    out.texcoords.push_back(static_cast<float>(t.x));
    out.texcoords.push_back(static_cast<float>(t.y));
  }
  out.indices.reserve(3 * mesh.triangles.size());
  for (const geometry::Triangle& triangle : mesh.triangles)
    out.indices.insert(out.indices.end(), triangle.begin(), triangle.end());
  return out;
}

}  // namespace

PackedMesh packed(const geometry::Mesh& mesh, std::string name) {
  return packed_from(mesh, nullptr, std::move(name));
}

PackedMesh packed(geometry::Mesh&& mesh, std::string name) {
  return packed_from(mesh, &mesh, std::move(name));
}

}  // namespace panwright::pan
