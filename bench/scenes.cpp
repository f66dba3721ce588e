#include "bench/scenes.h"

#include <fmt/core.h>

#include <fstream>
#include <memory>
#include <utility>

#include "compiler/compile.h"
#include "pan/model.h"

namespace panwright::bench {

scene::Scene sphere_scene(const geometry::SphereCounts& counts,
                          const materials::Material& material) {
  scene::Scene scene;
  scene.nodes.push_back({});
  scene.shapes.push_back(geometry::Sphere{1, counts});
  scene.materials.push_back(material);
  scene.instances.push_back({});
  return scene;
}

materials::Material figure8_material() {
  materials::Material material;
  material.specular_brdf = materials::CookTorrance{.alpha = 0.15};
  material.diffuse = {0.7038, 0.27048, 0.0828};
  material.specular = Vec3(1);
  material.weights = {0.9, 0.1, 0};
  material.refract = Vec3(1.5);
  return material;
}

materials::Material lambert_material(double albedo) {
  materials::Material material;
  material.diffuse = Vec3(albedo);
  return material;
}

world::ModelPtr compiled_model(const scene::Scene& scene, DiagnosticLog& log) {
  const auto bytes = compiler::compiled(scene, {}, log);
  if (!bytes) return nullptr;
  auto model = pan::Model::from_bytes(*bytes, "bench", log);
  if (!model || !model->check(log)) return nullptr;
  return std::make_shared<const pan::Model>(*std::move(model));
}

AxisBox box_of(const pan::Model& model) {
  AxisBox box;
  const auto nodes = model.world_from_nodes();
  for (const pan::layout::Instance& instance : model.instances()) {
    const pan::layout::Mesh& mesh = model.meshes()[instance.mesh];
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 p;
      for (int k = 0; k < 3; ++k)
        p[k] = mesh.origin[k] +
               static_cast<double>(corner & (1 << k) ? mesh.bounds_max[k] : mesh.bounds_min[k]);
      box.add(Vec3(nodes[instance.node] * Vec4(p, 1)));
    }
  }
  return box;
}

std::string sphere_pxn(const geometry::SphereCounts& counts) {
  return fmt::format("<pangu_model ver=\"0\"><sphere rings=\"{}\" quads=\"{}\"/></pangu_model>\n",
                     counts.rings, counts.quads);
}

std::string many_spheres_pxn(int spheres) {
  std::string text = "<pangu_model ver=\"0\">\n<group>\n";
  for (int i = 0; i < spheres; ++i)
    text += fmt::format(
        "<transform>\n  <scaling> 0.5 0.5 0.5 </scaling>\n  <rotation> 0 0 {} </rotation>\n"
        "  <translation> {} {} 0.25 </translation>\n"
        "  <child> <sphere rings=\"8\" quads=\"12\"/> </child>\n</transform>\n",
        i % 360, i % 40, i / 40);
  return text + "</group>\n</pangu_model>\n";
}

std::filesystem::path write_scratch(const Context& context, const std::string& name,
                                    const std::string& text) {
  const std::filesystem::path path = context.scratch() / name;
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  return file ? path : std::filesystem::path();
}

}  // namespace panwright::bench
