#include "preview/model/caster_meshes.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/mesh/simplify.h"
#include "preview/gl/uniforms.h"

namespace panwright::preview {
namespace {

constexpr std::size_t kFewTriangles = 64;
constexpr std::size_t kMostTargets = 64;
constexpr int kNoStep = -2000;

geometry::Mesh shape_of(const pan::MeshView& mesh) {
  geometry::Mesh shape;
  shape.positions.reserve(mesh.positions.size());
  for (const pan::layout::Float3& p : mesh.positions) shape.positions.emplace_back(p.x, p.y, p.z);
  shape.triangles.reserve(mesh.indices.size() / 3);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    shape.triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
  return shape;
}

void add(const geometry::Mesh& shape, const Mat4& placed, geometry::Mesh& to) {
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  for (const Vec3& p : shape.positions) to.positions.emplace_back(placed * Vec4(p, 1));
  for (const geometry::Triangle& t : shape.triangles)
    to.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

// The largest axis of a placement.
double scale_of(const Mat4& placed) {
  const Mat3 turn(placed);
  return std::max({glm::length(turn[0]), glm::length(turn[1]), glm::length(turn[2]), 1e-300});
}

// Of a tolerance: the power of two below it.
int step_of(double tolerance) {
  return tolerance > 0x1p-100 && tolerance < 0x1p100 ? std::ilogb(tolerance) : kNoStep;
}

}  // namespace

CasterMesh::CasterMesh(const GladGLContext& gl, const geometry::Mesh& shape)
    : triangles_(shape.triangles.size()), array_(make_vertex_array(gl)) {
  if (triangles_ == 0) return;  // all of it is smaller than the tolerance
  std::vector<float> positions;
  positions.reserve(3 * shape.positions.size());
  for (const Vec3& p : shape.positions)
    for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(p[k]));
  positions_ = make_buffer(gl, positions.data(), positions.size() * sizeof(float));
  indices_ = make_buffer(gl, shape.triangles.data(), triangles_ * sizeof(geometry::Triangle));
  const GLuint array = array_.id();
  gl.EnableVertexArrayAttrib(array, kPositionAttribute);
  gl.VertexArrayAttribFormat(array, kPositionAttribute, 3, GL_FLOAT, GL_FALSE, 0);
  gl.VertexArrayAttribBinding(array, kPositionAttribute, 0);
  gl.VertexArrayVertexBuffer(array, 0, positions_.id(), 0, 3 * sizeof(float));
  gl.VertexArrayElementBuffer(array, indices_.id());
}

void CasterMesh::bind_vertices(const GladGLContext& gl) const { gl.BindVertexArray(array_.id()); }

void CasterMesh::draw(const GladGLContext& gl, std::size_t instances) const {
  if (triangles_ == 0) return;
  gl.DrawElementsInstanced(GL_TRIANGLES, static_cast<GLsizei>(3 * triangles_), GL_UNSIGNED_INT,
                           nullptr, static_cast<GLsizei>(instances));
}

const geometry::Mesh* CasterMeshes::simplified(const std::shared_ptr<const pan::Model>& model,
                                               std::uint32_t mesh, int step) {
  if (step == kNoStep || model->meshes()[mesh].triangle_count < kFewTriangles) return nullptr;
  Simplified& entry = simplified_[{model.get(), mesh, step}];
  if (entry.owner.expired()) {
    entry.owner = model;
    const geometry::Mesh full = shape_of(model->mesh(mesh));
    geometry::Simplifier simplifier(full, false);
    simplifier.step(0, std::ldexp(1.0, step));
    entry.mesh = simplifier.mesh();
  }
  return &entry.mesh;
}

void CasterMeshes::begin() {
  while (targets_.size() > kMostTargets) targets_.pop_back();
  std::erase_if(simplified_, [](const auto& entry) { return entry.second.owner.expired(); });
}

const CasterMesh& CasterMeshes::find(const GladGLContext& gl,
                                     const std::shared_ptr<const pan::Model>& model,
                                     std::span<const DrawItem> items, Stamp stamp,
                                     std::size_t level, double tolerance) {
  const int step = step_of(tolerance);
  const auto known = std::ranges::find_if(targets_, [&](const Target& one) {
    return one.stamp == stamp && one.level == level && one.step == step;
  });
  if (known != targets_.end()) {
    targets_.splice(targets_.begin(), targets_, known);
    return known->mesh;
  }
  geometry::Mesh all;
  for (const DrawItem& item : items) {
    if (!item.visible || item.variant.cutout) continue;
    const Mat4& placed = item.model_from_mesh;
    const geometry::Mesh* simple =
        simplified(model, item.mesh, step_of(std::ldexp(1.0, step) / scale_of(placed)));
    add(simple ? *simple : shape_of(model->mesh(item.mesh)), placed, all);
  }
  targets_.push_front({stamp, level, step, CasterMesh(gl, all)});
  return targets_.front().mesh;
}

}  // namespace panwright::preview
