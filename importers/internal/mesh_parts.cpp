#include "importers/internal/mesh_parts.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text.h"
#include "importers/internal/import_part.h"

namespace panwright::importers {

namespace {

using scene::kNone;

const geometry::Mesh* mesh_in(const geometry::Shape& shape) {
  const auto* held = std::get_if<geometry::MeshShape>(&shape);
  return held ? held->get() : nullptr;
}

}  // namespace

const MeshParts::Part* MeshParts::part(const MeshFile& mesh) {
  std::string name = mesh.name;
  for (const std::string& including : mesh.including) name += '\n' + including;
  const auto [place, is_new] = by_name_.try_emplace(name);
  if (!is_new) return place->second ? &*place->second : nullptr;
  if (by_name_.size() > c_.options.limits.files) {
    c_.limit("the model names too many files", mesh.where);
    return nullptr;
  }
  FileName wanted{.text = mesh.name, .including = mesh.including, .part = true};
  if (wanted.including.empty()) wanted.including.push_back(c_.file.path);
  NamedFile found = find_file(c_.files, wanted);
  if (found.outcome != Files::Outcome::found) {
    c_.report_missing(found, true, mesh.where);
    return nullptr;
  }
  if (!found.deviation.empty()) c_.log.report(c_.tolerated, mesh.where, found.deviation);
  const auto [first, unread] = first_name_.try_emplace(found.path, name);
  if (!unread) {
    place->second = by_name_.at(first->second);
    return place->second ? &*place->second : nullptr;
  }
  Options options = c_.options;
  options.assume.reset();
  options.limits.triangles -= std::min(options.limits.triangles, triangles_);
  options.limits.texture_bytes -= std::min(options.limits.texture_bytes, texture_bytes_);
  auto imported = import_part(c_.files, found.path, std::move(found.bytes), options, c_.log,
                              mesh.where, c_.file.job);
  if (!imported) return nullptr;
  if (imported->lacks_unit)
    c_.log.report(Code("W6006"), mesh.where,
                  fmt::format("{} states no unit: millimetres are assumed", in_quotes(mesh.name)));
  place->second = taken(*imported);
  return &*place->second;
}

// Moves shapes, materials and textures of a file into the scene.
MeshParts::Part MeshParts::taken(Imported& imported) {
  scene::Scene& from = imported.scene;
  scene::Scene& to = assembly_.out().scene;
  const auto shapes = static_cast<std::int32_t>(to.shapes.size());
  const auto materials = static_cast<std::int32_t>(to.materials.size());
  const auto textures = static_cast<std::int32_t>(to.textures.size());
  Part out;
  for (scene::Instance& one : from.instances) {
    const CadMaterial& cad = imported.materials[static_cast<std::size_t>(one.material)];
    const auto* mesh = mesh_in(from.shapes[static_cast<std::size_t>(one.shape)]);
    out.bare.push_back(cad.name.empty() && !cad.textured && (!mesh || mesh->colors.empty()));
    out.texcoords.push_back(!mesh || !mesh->texcoords.empty());
    one.shape += shapes;
    one.material += materials;
    if (one.back != kNone) one.back += materials;
    if (one.texture != kNone) one.texture += textures;
  }
  for (geometry::Shape& shape : from.shapes) {
    if (const auto* mesh = mesh_in(shape)) triangles_ += mesh->triangles.size();
    to.shapes.push_back(std::move(shape));
  }
  for (materials::Material& material : from.materials) {
    materials::Maps& maps = material.maps;
    for (std::int32_t* map :
         {&maps.albedo, &maps.normal, &maps.roughness, &maps.reflectance, &maps.cutout})
      if (*map >= 0) *map += textures;
    to.materials.push_back(std::move(material));
  }
  for (CadMaterial& cad : imported.materials) assembly_.out().materials.push_back(std::move(cad));
  for (scene::Texture& texture : from.textures) {
    texture_bytes_ += texture.rgba.size();
    to.textures.push_back(std::move(texture));
  }
  for (scene::Input& input : from.inputs)
    if (known_inputs_.insert(input.path).second) inputs_.push_back(std::move(input));
  out.nodes = std::move(from.nodes);
  out.instances = std::move(from.instances);
  out.joints = std::move(from.joints);
  return out;
}

void MeshParts::attach(const MeshFile& mesh, std::int32_t node, const Cover& cover) {
  const Part* from = part(mesh);
  if (!from) return;
  scene::Scene& scene = assembly_.out().scene;
  const std::uint64_t most = c_.options.limits.nodes;
  if (scene.nodes.size() + from->nodes.size() > most ||
      scene.instances.size() + from->instances.size() > most)
    return c_.limit(fmt::format("more than {} nodes", most), mesh.where);
  // the root of a file is the node itself
  const auto first = static_cast<std::int32_t>(scene.nodes.size()) - 1;
  const auto node_of = [&](std::int32_t index) { return index == 0 ? node : first + index; };
  for (std::size_t i = 1; i < from->nodes.size(); ++i) {
    scene.nodes.push_back(from->nodes[i]);
    scene.nodes.back().parent = node_of(from->nodes[i].parent);
  }
  bool own = false, flat = false;
  for (std::size_t i = 0; i < from->instances.size(); ++i) {
    scene::Instance one = from->instances[i];
    one.node = node_of(one.node);
    if (cover.material != kNone && from->bare[i]) {
      one.material = cover.material;
      if (from->texcoords[i]) one.texture = cover.texture;
      flat = flat || (cover.texture != kNone && !from->texcoords[i]);
    }
    own = own || (cover.material != kNone && !from->bare[i]);
    scene.instances.push_back(std::move(one));
  }
  const auto joints = static_cast<std::int32_t>(scene.joints.size());
  for (scene::Joint joint : from->joints) {
    joint.node = node_of(joint.node);
    for (std::int32_t* other : {&joint.mimic, &joint.gimbal})
      if (*other != kNone) *other += joints;
    scene.joints.push_back(std::move(joint));
  }
  if (own)
    c_.trouble(Code("W6221"), "own", mesh.where, [&] {
      return fmt::format(
          "{} has materials of its own, which are kept: the material of the visual "
          "is not used",
          in_quotes(mesh.name));
    });
  if (flat)
    c_.trouble(Code("W6221"), "flat", mesh.where, [&] {
      return fmt::format("{} has no texture coordinates: the texture of the visual is not used",
                         in_quotes(mesh.name));
    });
}

}  // namespace panwright::importers
