#include "preview/reference/internal/trace_model.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "materials/cells.h"

namespace panwright::preview::reference {
namespace {

namespace layout = pan::layout;

Vec3 vec3(const layout::Float3& v) { return Vec3(v.x, v.y, v.z); }
Vec2 vec2(const layout::Float2& v) { return Vec2(v.x, v.y); }
Vec3 vec3(const float* v) { return Vec3(v[0], v[1], v[2]); }
Vec3 vec3(const double* v) { return Vec3(v[0], v[1], v[2]); }

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double square = glm::dot(v, v);
  // neither under- nor overflow
  if (square > 1e-200 && square < 1e200) return v * (1 / std::sqrt(square));
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  if (!(largest > 0) || !std::isfinite(largest)) return otherwise;
  const Vec3 scaled = v / largest;
  return scaled / glm::length(scaled);
}

}  // namespace

TraceModel::TraceModel(world::ModelPtr model, const Job& job) : model_(std::move(model)) {
  for (std::size_t i = 0; i < model_->textures().size(); ++i) {
    const layout::Texture& record = model_->textures()[i];
    textures_.emplace_back(model_->texels(i), record.width, record.height,
                           (record.flags & layout::kTextureLinear) != 0);
  }
  for (std::uint32_t i = 0; i < model_->materials().size(); ++i) {
    job.poll();
    materials_.push_back(pan::material_from(model_->materials()[i], {}));
    // in double, whatever the file's own fits were rounded to
    materials::fit(materials_.back());
    scatters_.emplace_back(materials_.back());
  }
  for (const materials::Material& material : materials_) {
    parts_of_.push_back(material.cells ? static_cast<std::uint32_t>(scatters_.size()) : 0);
    if (!material.cells) continue;
    for (const materials::Material& part : materials::cell_parts(material))
      scatters_.emplace_back(part);
  }
  add_parts();
  add_meshes(job);
  add_decals();
  for (std::vector<Part>* sides : {&parts_, &backs_})
    for (Part& part : *sides)
      if (!part.decals.empty()) lay_decals_over(part);
}

void TraceModel::lay_decals_over(Part& part) {
  part.diffuse_in_tint = true;
  materials::Material white = materials_[part.material];
  const auto first = static_cast<std::uint32_t>(scatters_.size());
  if (part.cell_parts == 0) {
    white.diffuse = Vec3(1);
    part.scatter = first;
    scatters_.emplace_back(white);
    return;
  }
  // a decal has the weight of a grid line, on cells too
  const std::array parts = materials::cell_parts(white);
  part.cell_parts = first;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    white = parts[i];
    if (i < 2) {
      part.part_diffuse[i] = white.weights.x * white.diffuse;
      white.weights.x = 1;
      white.diffuse = Vec3(1);
      materials::fit(white);
    }
    scatters_.emplace_back(white);
  }
}

void TraceModel::add_parts() {
  parts_.reserve(model_->instances().size());
  for (const layout::Instance& instance : model_->instances()) {
    const layout::Mesh& mesh = model_->meshes()[instance.mesh];
    const layout::Material& record = model_->materials()[instance.material];
    Part& part = parts_.emplace_back();
    part.mesh = model_->mesh(instance.mesh);
    part.mesh_index = instance.mesh;
    part.node = instance.node;
    part.origin = vec3(mesh.origin);
    part.low = vec3(mesh.bounds_min);
    part.high = vec3(mesh.bounds_max);
    part.has_holes = record.cutout_map >= 0;
    part.closed = (mesh.flags & layout::kMeshClosed) != 0 && !part.has_holes;
    const Vec3 far = glm::max(glm::abs(part.low), glm::abs(part.high));
    // four roundings of the largest coordinate to float
    part.flat_offset = 0x1p-22 * std::max({far.x, far.y, far.z});
    // a chord is as deep below the smooth surface as others stand out of it
    part.offset = 2 * mesh.error + part.flat_offset;
    wear(part, instance, instance.material, false);
  }
  for (const layout::Back& record : model_->backs()) {
    Part& front = parts_[record.instance];
    front.back = static_cast<std::int32_t>(backs_.size());
    Part& back = backs_.emplace_back(front);
    wear(back, model_->instances()[record.instance], record.material, true);
  }
}

void TraceModel::wear(Part& part, const layout::Instance& instance, std::uint32_t index,
                      bool back) {
  const layout::Material& record = model_->materials()[index];
  const materials::Material& material = materials_[index];
  part.material = index;
  part.diffuse = material.diffuse;
  part.emitted = material.emissive * (material.weights.z / kPi);
  part.scatter = index;
  part.is_back = back;
  if (back) part.mesh.colors = {};
  if (part.mesh.texcoords.empty()) return;
  part.cell_parts = parts_of_[index];
  part.repeat = Vec2(record.map_repeat[0], record.map_repeat[1]);
  part.texture = back ? -1 : instance.texture;
  part.albedo = record.albedo_map;
  part.normal = record.normal_map;
  part.roughness = record.roughness_map;
  part.reflectance = record.reflectance_map;
  part.cutout = record.cutout_map;
  part.threshold = record.cutout_threshold;
}

// every mesh that is placed, once
void TraceModel::add_meshes(const Job& job) {
  const std::size_t count = model_->meshes().size();
  std::vector<std::uint8_t> placed(count), directed(count);
  for (const std::vector<Part>* sides : {&parts_, &backs_})
    for (const Part& part : *sides) {
      placed[part.mesh_index] = 1;
      if (!part.mesh.texcoords.empty() &&
          (part.normal >= 0 || materials::is_anisotropic(materials_[part.material])))
        directed[part.mesh_index] = 1;
    }
  meshes_.resize(count);
  tangents_.resize(count);
  parallel_for(
      count,
      [&](std::size_t i) {
        if (!placed[i]) return;
        const pan::MeshView mesh = model_->mesh(i);
        std::vector<Vec3> positions;
        positions.reserve(mesh.positions.size());
        for (const layout::Float3& p : mesh.positions) positions.push_back(vec3(p));
        std::vector<geometry::Triangle> triangles(mesh.indices.size() / 3);
        for (std::size_t k = 0; k < mesh.indices.size(); ++k)
          triangles[k / 3][k % 3] = mesh.indices[k];
        meshes_[i] = geometry::search_mesh(std::move(positions), std::move(triangles), job);
        if (directed[i]) tangents_[i] = std::make_unique<TangentField>(mesh);
      },
      job);
  for (std::vector<Part>* sides : {&parts_, &backs_})
    for (Part& part : *sides) part.tangents = tangents_[part.mesh_index].get();
}

void TraceModel::add_decals() {
  for (std::uint32_t i = 0; i < model_->decals().size(); ++i) {
    const layout::Decal& record = model_->decals()[i];
    decals_.push_back({glm::inverse(pan::mesh_from_decal(record)),
                       {record.width, record.height, record.depth},
                       record.texture});
    Part& part = parts_[record.instance];
    part.decals.push_back(i);
    if (part.back >= 0) backs_[static_cast<std::size_t>(part.back)].decals.push_back(i);
  }
}

Placement TraceModel::placement(std::uint32_t part, const PlacedNodes& nodes) const {
  Placement result;
  result.model_from_mesh = nodes.model_from_node[parts_[part].node];
  result.normals = normal_matrix(result.model_from_mesh.linear);
  result.model_from_mesh.offset = result.model_from_mesh(parts_[part].origin);
  return result;
}

TraceModel::Place TraceModel::place(const Part& part, const geometry::InstanceHit& hit) const {
  Place result;
  for (std::size_t k = 0; k < 3; ++k)
    result.corner[k] = part.mesh.indices[std::size_t{3} * hit.triangle + k];
  result.weight = Vec3(1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric);
  return result;
}

TraceModel::Surface TraceModel::surface(const Part& part, const Place& place, bool flat) const {
  std::array<Vec3, 3> corner;
  Vec3 smooth(0);
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k] = vec3(part.mesh.positions[place.corner[k]]);
    smooth += place.weight[static_cast<int>(k)] * vec3(part.mesh.normals[place.corner[k]]);
  }
  const Vec3 ab = corner[1] - corner[0];
  const Vec3 ac = corner[2] - corner[0];
  Surface result;
  result.position = corner[0] + place.weight.y * ab + place.weight.z * ac;
  result.facet = unit_or(glm::cross(ab, ac), Vec3(0, 0, 1));
  result.smooth = flat ? result.facet : smooth;
  return result;
}

Vec2 TraceModel::texcoord(const Part& part, const Place& place) const {
  Vec2 at(0);
  for (int k = 0; k < 3; ++k)
    at += place.weight[k] * vec2(part.mesh.texcoords[place.corner[static_cast<std::size_t>(k)]]);
  return at;
}

std::uint32_t TraceModel::cell_part_at(const Part& part, const Place& place) const {
  if (part.cell_parts == 0) return 0;
  const materials::CellShares shares =
      materials::cells_at(*materials_[part.material].cells, texcoord(part, place), Vec2(0));
  return shares.cell >= 0.5 ? 0 : shares.finger > shares.gap ? 1 : 2;
}

bool TraceModel::is_there(std::uint32_t index, const geometry::InstanceHit& hit) const {
  const Part& part = parts_[index];
  if (part.cutout < 0) return true;
  const Vec2 at = texcoord(part, place(part, hit)) * part.repeat;
  return textures_[static_cast<std::size_t>(part.cutout)].alpha(at) >= part.threshold;
}

// The bumps are the mesh's: an instance mirrors and stretches them with it.
Vec3 TraceModel::bumped(const Part& part, const TangentField::At& tangent, const Vec3& normal,
                        const Vec2& at, double& length) const {
  Vec3 bump = textures_[static_cast<std::size_t>(part.normal)].normal(at);
  // those of a back that is a material by itself stand out of it
  if ((part.repeat.x < 0) != part.is_back) bump.x = -bump.x;
  if ((part.repeat.y < 0) != part.is_back) bump.y = -bump.y;
  length = std::min(glm::length(bump), 1.0);
  const Vec3 along = unit_or(tangent.tangent - normal * glm::dot(normal, tangent.tangent), Vec3(0));
  const Vec3 across = glm::cross(normal, along) * tangent.handed;
  return unit_or(bump.x * along + bump.y * across + bump.z * normal, normal);
}

// What colour a hole has in the texture that cuts it counts nowhere.
Vec3 TraceModel::texel_color(const Part& part, std::int32_t texture, const Vec2& at) const {
  const Texture& read = textures_[static_cast<std::size_t>(texture)];
  if (texture != part.cutout) return read.color(at);
  const Vec4 texel = read.premultiplied(at);
  return texel.w > 0 ? Vec3(texel) / texel.w : Vec3(0);
}

// What textures and vertices multiply the diffuse colour by.
Vec3 TraceModel::color(const Part& part, const Place& place) const {
  Vec3 result(1);
  if (part.texture >= 0 || part.albedo >= 0) {
    const Vec2 at = texcoord(part, place);
    if (part.texture >= 0) result *= texel_color(part, part.texture, at);
    if (part.albedo >= 0) result *= texel_color(part, part.albedo, at * part.repeat);
  }
  if (!part.mesh.colors.empty()) {
    Vec3 sum(0);
    for (int k = 0; k < 3; ++k)
      sum += place.weight[k] * vec3(part.mesh.colors[place.corner[static_cast<std::size_t>(k)]]);
    result *= sum;
  }
  return glm::max(result, Vec3(0));
}

// The diffuse colour with the decals that lie over a place of a mesh.
Vec3 TraceModel::decorated(const Part& part, const Vec3& position, const Vec3& normal, bool front,
                           Vec3 color) const {
  for (const std::uint32_t index : part.decals) {
    const Decal& decal = decals_[index];
    const Vec3 q(decal.decal_from_mesh * Vec4(part.origin + position, 1));
    const double facing = (Mat3(decal.decal_from_mesh) * normal).z;
    const bool covers = 2 * std::fabs(q.x) <= decal.size.x && 2 * std::fabs(q.y) <= decal.size.y &&
                        std::fabs(q.z) <= decal.size.z && (front ? facing : -facing) > 0;
    if (!covers) continue;
    const Vec2 at = Vec2(q) / Vec2(decal.size) + 0.5;
    const Vec4 texel = textures_[decal.texture].clamped_premultiplied(at);
    color = color * (1 - texel.w) + Vec3(texel);
  }
  return color;
}

Vec3 TraceModel::normal(std::uint32_t index, const Placement& placement,
                        const geometry::InstanceHit& hit, bool flat) const {
  const Part& part = parts_[index];
  const Surface at = surface(part, place(part, hit), flat);
  const Vec3 unit = unit_or(placement.normals * at.smooth, Vec3(0));
  return part.closed || hit.front ? unit : -unit;
}

Point TraceModel::point(std::uint32_t index, const Placement& placement,
                        const geometry::InstanceHit& hit, bool flat) const {
  const bool seen_outside = parts_[index].closed || hit.front;
  const Part& part = seen(index, seen_outside);
  const Place where = place(part, hit);
  const Surface here = surface(part, where, flat);
  const Vec3 outwards = unit_or(here.smooth, here.facet);

  Point result;
  Vec3 shaded = outwards;
  double length = 1;
  Vec2 at(0);
  if (!part.mesh.texcoords.empty()) at = texcoord(part, where) * part.repeat;
  TangentField::At along;
  if (part.tangents) along = (*part.tangents)(hit.triangle, where.weight);
  if (part.normal >= 0) shaded = bumped(part, along, outwards, at, length);
  const double side = seen_outside ? 1.0 : -1.0;
  const Vec3 start = here.position + outwards * (side * (flat ? part.flat_offset : part.offset));
  result.start = placement.model_from_mesh(start);
  result.normal = unit_or(placement.normals * shaded, Vec3(0)) * side;
  if (part.tangents) {
    const Vec3 t = placement.model_from_mesh.linear * along.tangent;
    result.tangent = unit_or(t - result.normal * glm::dot(result.normal, t), Vec3(0));
  }

  const std::uint32_t cell_part = cell_part_at(part, where);
  // grid lines and gaps have their own colours, and decals lie over the cells
  Vec3 tint = cell_part == 0 ? color(part, where) : Vec3(1);
  if (part.diffuse_in_tint && cell_part < 2) {
    if (part.cell_parts > 0)
      tint *= part.part_diffuse[cell_part];
    else
      tint *= part.diffuse;
    tint = decorated(part, here.position, here.smooth, seen_outside, tint);
  }
  result.tint = tint * length;
  result.scatter = &scatters_[part.cell_parts > 0 ? part.cell_parts + cell_part : part.scatter];
  if (part.roughness >= 0) {
    const double factor = textures_[static_cast<std::size_t>(part.roughness)].red(at);
    result.own.emplace(result.scatter->roughened(factor));
  }
  // grid lines and gaps have no microfacets
  if (part.reflectance >= 0 && cell_part == 0)
    result.own.emplace(result.surface().reflecting(texel_color(part, part.reflectance, at)));
  if (cell_part < 2) result.emitted = part.emitted;
  return result;
}

}  // namespace panwright::preview::reference
