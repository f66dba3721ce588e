#include "preview/reference/internal/trace_model.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "materials/cells.h"
#include "preview/reference/ground_layer.h"

namespace panwright::preview::reference {

using trace::Place, trace::unit_or;

namespace {

namespace layout = pan::layout;

Vec3 vec3(const layout::Float3& v) { return Vec3(v.x, v.y, v.z); }

}  // namespace

TraceModel::TraceModel(std::shared_ptr<const trace::Model> traced, const Job& job)
    : traced_(std::move(traced)), model_(traced_->model().get()), textures_(traced_->textures()) {
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
  if (traced_->ground() != nullptr && scatters_.empty()) scatters_.emplace_back(lunar_regolith());
  add_parts();
  add_tangents(job);
  add_decals();
  for (std::vector<Part>* sides : {&parts_, &backs_})
    for (Part& part : *sides)
      if (!part.decals.empty()) lay_decals_over(part);
  for (std::vector<Part>* sides : {&parts_, &backs_})
    for (Part& part : *sides)
      part.plain = part.decals.empty() && part.mesh.colors.empty() && part.cell_parts == 0 &&
                   part.tangents == nullptr && part.texture < 0 && part.albedo < 0 &&
                   part.normal < 0 && part.roughness < 0 && part.reflectance < 0;
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

bool TraceModel::may_mirror(std::uint32_t part) const {
  const auto side = [&](const Part& one) {
    return scatters_[one.scatter].has_mirror ||
           (one.cell_parts > 0 &&
            (scatters_[one.cell_parts].has_mirror || scatters_[one.cell_parts + 1].has_mirror ||
             scatters_[one.cell_parts + 2].has_mirror));
  };
  const Part& front = parts_[part];
  return side(front) || (front.back >= 0 && side(backs_[static_cast<std::size_t>(front.back)]));
}

void TraceModel::add_parts() {
  parts_.reserve(model_->instances().size());
  for (std::uint32_t i = 0; i < model_->instances().size(); ++i) {
    const layout::Instance& instance = model_->instances()[i];
    const layout::Mesh& mesh = model_->meshes()[instance.mesh];
    Part& part = parts_.emplace_back();
    static_cast<trace::Model::Part&>(part) = traced_->parts()[i];
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
  part.texture = back ? -1 : instance.texture;
  part.albedo = record.albedo_map;
  part.normal = record.normal_map;
  part.roughness = record.roughness_map;
  part.reflectance = record.reflectance_map;
}

// of every mesh that is placed and needs them, once
void TraceModel::add_tangents(const Job& job) {
  const std::size_t count = model_->meshes().size();
  std::vector<std::uint8_t> directed(count);
  for (const std::vector<Part>* sides : {&parts_, &backs_})
    for (const Part& part : *sides)
      if (!part.mesh.texcoords.empty() &&
          (part.normal >= 0 || materials::is_anisotropic(materials_[part.material])))
        directed[part.mesh_index] = 1;
  tangents_.resize(count);
  parallel_for(
      count,
      [&](std::size_t i) {
        if (directed[i]) tangents_[i] = std::make_unique<TangentField>(model_->mesh(i));
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

std::uint32_t TraceModel::cell_part_at(const Part& part, const Place& place) const {
  if (part.cell_parts == 0) return 0;
  const materials::CellShares shares = materials::cells_at(
      *materials_[part.material].cells, trace::texcoord_of(part.mesh, place), Vec2(0));
  return shares.cell >= 0.5 ? 0 : shares.finger > shares.gap ? 1 : 2;
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
  const trace::Texture& read = textures_[static_cast<std::size_t>(texture)];
  if (texture != part.cutout) return read.color(at);
  const Vec4 texel = read.premultiplied(at);
  return texel.w > 0 ? Vec3(texel) / texel.w : Vec3(0);
}

// What textures and vertices multiply the diffuse colour by.
Vec3 TraceModel::color(const Part& part, const Place& place) const {
  Vec3 result(1);
  if (part.texture >= 0 || part.albedo >= 0) {
    const Vec2 at = trace::texcoord_of(part.mesh, place);
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

Point TraceModel::ground_point(const trace::Target& target, const trace::Hit& hit, bool flat,
                               double size) const {
  Point result;
  terrain::SmoothGround smooth{hit.normal, 0};
  if (!flat && hit.front) {
    const terrain::SmoothGround ground = target.smooth_ground(hit);
    // at outlines it may face away from the viewer, whom the triangle faces
    if (glm::dot(ground.normal, hit.direction) < 0) smooth = ground;
  }
  if (!flat && hit.front && hit.level > 0)
    if (const terrain::GroundRelief relief = target.ground_relief(hit))
      result.facets = facets_of(relief, -hit.direction);
  result.normal = hit.front ? smooth.normal : -smooth.normal;
  // far past the rounding of a body's radius
  const double offset = 1e-4 + 1e-9 * glm::length(hit.position) + smooth.rise;
  result.start = hit.position + offset * result.normal;
  result.scatter = &scatters_.front();
  if (!target.ground()->tiles().albedo().empty())
    result.tint = target.ground()->albedo(hit.position, size);
  return result;
}

Point TraceModel::point(const trace::Placement& placement, const trace::Hit& hit, bool flat) const {
  const bool seen_outside = parts_[hit.part].closed || hit.front;
  const Part& part = seen(hit.part, seen_outside);
  const Place where = trace::place_of(part.mesh, hit.triangle, hit.barycentric);
  const trace::MeshPoint here = trace::point_of(part.mesh, where, flat);
  const Vec3 outwards = unit_or(here.smooth, here.facet);

  Point result;
  Vec3 shaded = outwards;
  double length = 1;
  Vec2 at(0);
  if (!part.mesh.texcoords.empty()) at = trace::texcoord_of(part.mesh, where) * part.repeat;
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
