#include "compiler/internal/kept_meshes.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "geometry/mesh/bytes.h"

namespace panwright::compiler::internal {

namespace {

// About 0.1 ms; a file costs as much.
constexpr double kLeastKeptTriangles = 1000;

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

}  // namespace

bool worth_keeping(const MeshJob& job, const geometry::TessellationOptions& tessellation) {
  return !std::holds_alternative<geometry::MeshShape>(*job.shape) &&
         geometry::planned_triangles(*job.shape, tessellation) >= kLeastKeptTriangles;
}

Hash128 mesh_key(const MeshJob& job, const geometry::TessellationOptions& tessellation, Kept kept) {
  KeyHasher key;
  key.hash(job.hash);
  key.number(static_cast<std::uint64_t>(kept));
  key.real(tessellation.max_error);
  key.number(tessellation.max_triangles);
  key.number(tessellation.texcoords);
  key.number(tessellation.edge_segments);
  key.number(job.boxed);
  key.number(job.projected());
  for (int i = 0; job.projected() && i < 16; ++i) key.real(job.texture_from_shape[i / 4][i % 4]);
  return key.key();
}

void write_packed(const pan::PackedMesh& mesh, ByteWriter& to) {
  for (int k = 0; k < 3; ++k) to.real(mesh.origin[k]);
  to.real(mesh.error);
  to.number(mesh.closed);
  for (const auto* values : {&mesh.positions, &mesh.normals, &mesh.texcoords, &mesh.colors})
    to.list(*values);
  to.list(mesh.indices);
}

pan::PackedMesh read_packed(ByteReader& from) {
  pan::PackedMesh mesh;
  for (int k = 0; k < 3; ++k) mesh.origin[k] = from.real();
  mesh.error = from.real();
  mesh.closed = from.number() != 0;
  for (auto* values : {&mesh.positions, &mesh.normals, &mesh.texcoords, &mesh.colors})
    from.list(*values);
  from.list(mesh.indices);
  const std::size_t count = mesh.positions.size() / 3;
  const auto fits = [&](const std::vector<float>& values, std::size_t width) {
    return values.empty() || values.size() == width * count;
  };
  const bool sound =
      std::isfinite(glm::length(mesh.origin)) && std::isfinite(mesh.error) && count > 0 &&
      mesh.positions.size() == 3 * count && mesh.normals.size() == 3 * count &&
      fits(mesh.texcoords, 2) && fits(mesh.colors, 3) && all_finite(mesh.positions) &&
      all_finite(mesh.normals) && all_finite(mesh.texcoords) && all_finite(mesh.colors) &&
      !mesh.indices.empty() && mesh.indices.size() % 3 == 0 &&
      *std::max_element(mesh.indices.begin(), mesh.indices.end()) < count;
  if (!sound) from.fail();
  return mesh;
}

}  // namespace panwright::compiler::internal
