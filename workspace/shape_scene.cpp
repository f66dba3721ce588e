#include "workspace/shape_scene.h"

#include <memory>
#include <utility>

#include "preview/reference/ground_layer.h"

namespace panwright::workspace {

scene::Scene shape_scene(const terrain::Shape& shape, const std::string& name) {
  auto mesh = std::make_shared<geometry::Mesh>();
  mesh->positions = shape.vertices;
  mesh->normals.assign(shape.vertices.size(), Vec3(0));
  for (const auto& [a, b, c] : shape.plates) {
    // twice the area long
    const Vec3 normal =
        glm::cross(shape.vertices[b] - shape.vertices[a], shape.vertices[c] - shape.vertices[a]);
    if (normal == Vec3(0)) continue;
    mesh->triangles.push_back({a, b, c});
    for (const std::uint32_t corner : {a, b, c}) mesh->normals[corner] += normal;
  }
  for (Vec3& normal : mesh->normals) {
    const double length = glm::length(normal);
    // no plate uses it, or they cancel out
    normal = length > 0 ? normal / length : Vec3(0, 0, 1);
  }
  mesh->closed = terrain::survey_shape(shape).open_edges == 0;
  scene::Scene out;
  out.nodes.emplace_back().name = name;
  out.shapes.emplace_back(geometry::MeshShape(std::move(mesh)));
  out.materials.push_back(preview::lunar_regolith());
  out.materials.back().name = "regolith";
  out.instances.emplace_back();
  return out;
}

}  // namespace panwright::workspace
