#include "preview/reference/internal/stage.h"

#include <algorithm>
#include <cmath>

#include "materials/cells.h"
#include "preview/reference/internal/texels.h"

namespace panwright::preview::reference {
namespace {

namespace layout = pan::layout;

Vec3 vec3(const layout::Float3& v) { return Vec3(v.x, v.y, v.z); }
Vec2 vec2(const layout::Float2& v) { return Vec2(v.x, v.y); }

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double square = glm::dot(v, v);
  // neither under- nor overflow
  if (square > 1e-200 && square < 1e200) return v * (1 / std::sqrt(square));
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  if (!(largest > 0) || !std::isfinite(largest)) return otherwise;
  const Vec3 scaled = v / largest;
  return scaled / glm::length(scaled);
}

// Whether its laws look different along u and along v.
bool has_direction(const materials::Material& material) {
  return materials::is_anisotropic(material);
}

}  // namespace

Stage::Stage(const pan::Model& model) : model_(model), items_(draw_list(model)) {
  decals_ = placed_decals(model, items_);
  for (std::uint32_t i = 0; i < model.materials().size(); ++i) {
    materials_.push_back(pan::material_from(model.materials()[i], {}));
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
  add_meshes();
  for (const DrawItem& item : items_) placed_.push_back(make_item(item));
  for (std::uint32_t i = 0; i < decals_.size(); ++i) {
    Item& item = placed_[decals_[i].item];
    item.decals.push_back(i);
    item.decal_pictures.push_back(static_cast<std::uint32_t>(
        picture(static_cast<std::int32_t>(decals_[i].texture), TextureRole::premultiplied, 0)));
  }
  for (Item& item : placed_) {
    if (item.decals.empty()) continue;
    item.diffuse_in_tint = true;
    materials::Material white = materials_[items_[&item - placed_.data()].material];
    const auto part = static_cast<std::uint32_t>(scatters_.size());
    if (item.cell_parts == 0) {
      white.diffuse = Vec3(1);
      item.scatter = part;
      scatters_.emplace_back(white);
      continue;
    }
    // a decal has the weight of a grid line, on cells too
    const std::array parts = materials::cell_parts(white);
    item.cell_parts = part;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      white = parts[i];
      if (i < 2) {
        item.part_diffuse[i] = white.weights.x * white.diffuse;
        white.weights.x = 1;
        white.diffuse = Vec3(1);
        materials::fit(white);
      }
      scatters_.emplace_back(white);
    }
  }
}

// every mesh that is placed, once; then every instance, in the order of the items
void Stage::add_meshes() {
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> number(model_.meshes().size(), kNone);
  tangents_.resize(model_.meshes().size());
  for (const DrawItem& item : items_) {
    if (number[item.mesh] == kNone) {
      const pan::MeshView mesh = model_.mesh(item.mesh);
      std::vector<Vec3> positions;
      positions.reserve(mesh.positions.size());
      for (const layout::Float3& p : mesh.positions) positions.push_back(vec3(p));
      std::vector<geometry::Triangle> triangles(mesh.indices.size() / 3);
      for (std::size_t i = 0; i < mesh.indices.size(); ++i)
        triangles[i / 3][i % 3] = mesh.indices[i];
      number[item.mesh] = caster_.add_mesh(positions, triangles);
    }
    if ((item.variant.normal_map || has_direction(materials_[item.material])) &&
        !tangents_[item.mesh] && !model_.mesh(item.mesh).texcoords.empty())
      tangents_[item.mesh] = tangents(model_.mesh(item.mesh));
    // filters are asked where something may not count: holes, and insides for the camera
    caster_.add(number[item.mesh], item.model_from_mesh, item.variant.cutout || item.closed);
    has_holes_ = has_holes_ || item.variant.cutout;
  }
  caster_.build();
}

Stage::Item Stage::make_item(const DrawItem& draw) {
  Item item;
  const layout::Material& record = model_.materials()[draw.material];
  const layout::Mesh& mesh = model_.meshes()[draw.mesh];
  item.mesh = model_.mesh(draw.mesh);
  if (tangents_[draw.mesh]) item.tangents = &*tangents_[draw.mesh];
  const Vec3 far = glm::max(glm::abs(draw.low), glm::abs(draw.high));
  // four roundings of the largest coordinate to float
  item.flat_offset = 0x1p-22 * std::max({far.x, far.y, far.z});
  // a chord is as deep below the smooth surface as others stand out of it
  item.offset = 2 * mesh.error + item.flat_offset;
  item.diffuse = materials_[draw.material].diffuse;
  item.emitted = materials_[draw.material].emissive * (materials_[draw.material].weights.z / kPi);
  item.scatter = draw.material;
  // what colour a hole has in the picture that cuts it counts nowhere
  const auto colour = [&](std::int32_t texture) {
    const bool cut = texture == record.cutout_map;
    return picture(texture, cut ? TextureRole::premultiplied : TextureRole::colour, 0);
  };
  item.texture = colour(draw.texture);
  if (item.mesh.texcoords.empty()) return item;
  item.cell_parts = parts_of_[draw.material];
  item.albedo = colour(record.albedo_map);
  item.normal = picture(record.normal_map, TextureRole::normal, 0);
  item.roughness = picture(record.roughness_map, TextureRole::roughness, 0);
  if (draw.variant.reflectance_map) item.reflectance = colour(record.reflectance_map);
  item.cutout = picture(record.cutout_map, TextureRole::cutout, record.cutout_threshold);
  return item;
}

std::int32_t Stage::picture(std::int32_t texture, TextureRole role, float threshold) {
  if (texture < 0) return -1;
  const auto [found, is_new] = picture_of_.try_emplace(PictureKey(texture, role, threshold),
                                                       static_cast<std::int32_t>(pictures_.size()));
  if (is_new) {
    const auto index = static_cast<std::size_t>(texture);
    const layout::Texture& record = model_.textures()[index];
    pictures_.push_back(
        std::move(map_levels(model_.texels(index), record.width, record.height,
                             (record.flags & layout::kTextureLinear) != 0, role, threshold)
                      .front()));
  }
  return found->second;
}

Stage::Place Stage::place(const Item& item, const geometry::InstanceHit& hit) const {
  Place result;
  for (std::size_t k = 0; k < 3; ++k)
    result.corner[k] = item.mesh.indices[std::size_t{3} * hit.triangle + k];
  result.weight = Vec3(1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric);
  return result;
}

Vec2 Stage::plain_texcoord(const Item& item, const Place& place) const {
  Vec2 at(0);
  for (int k = 0; k < 3; ++k)
    at += place.weight[k] * vec2(item.mesh.texcoords[place.corner[static_cast<std::size_t>(k)]]);
  return at;
}

Vec2 Stage::map_texcoord(const DrawItem& draw, const Item& item, const Place& place) const {
  return plain_texcoord(item, place) * draw.repeat;
}

std::uint32_t Stage::part_at(const DrawItem& draw, const Item& item, const Place& place) const {
  if (item.cell_parts == 0) return 0;
  const materials::CellShares shares =
      materials::cells_at(*materials_[draw.material].cells, plain_texcoord(item, place), Vec2(0));
  return shares.cell >= 0.5 ? 0 : shares.finger > shares.gap ? 1 : 2;
}

bool Stage::is_there(const geometry::InstanceHit& hit) const {
  const Item& item = placed_[hit.instance];
  if (item.cutout < 0) return true;
  const Vec2 at = map_texcoord(items_[hit.instance], item, place(item, hit));
  return repeated_texel(pictures_[static_cast<std::size_t>(item.cutout)], at).x >= 0;
}

bool Stage::hole_filter(const void* stage, const geometry::InstanceHit& hit) {
  return static_cast<const Stage*>(stage)->is_there(hit);
}

bool Stage::seen_filter(const void* data, const geometry::InstanceHit& hit) {
  const Stage& stage = *static_cast<const Stage*>(data);
  return !stage.is_inside(hit) && stage.is_there(hit);
}

std::optional<geometry::InstanceHit> Stage::seen(const geometry::Ray& ray) const {
  const auto hit = closest(ray);
  if (!hit || !is_inside(*hit)) return hit;
  return caster_.closest(ray, {seen_filter, this});
}

std::optional<geometry::InstanceHit> Stage::closest(const geometry::Ray& ray) const {
  return has_holes_ ? caster_.closest(ray, {hole_filter, this}) : caster_.closest(ray);
}

bool Stage::any(const geometry::Ray& ray) const {
  return has_holes_ ? caster_.any(ray, {hole_filter, this}) : caster_.any(ray);
}

Vec4 Stage::tangent(const Item& item, const geometry::InstanceHit& hit, const Place& place) const {
  const Tangents& all = *item.tangents;
  Vec4 result(0);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t index =
        all.indices.empty() ? place.corner[k] : all.indices[std::size_t{3} * hit.triangle + k];
    const float* t = &all.tangents[4 * index];
    result += place.weight[static_cast<int>(k)] * Vec4(t[0], t[1], t[2], t[3]);
  }
  return result;
}

// The bumps are the mesh's: an instance mirrors and stretches them with it.
Vec3 Stage::bumped(const DrawItem& draw, const Item& item, const Vec4& tangent, const Vec3& normal,
                   const Vec2& at, double& length) const {
  Vec3 bump = Vec3(repeated_texel(pictures_[static_cast<std::size_t>(item.normal)], at));
  if (draw.repeat.x < 0) bump.x = -bump.x;
  if (draw.repeat.y < 0) bump.y = -bump.y;
  length = std::min(glm::length(bump), 1.0);
  const Vec3 t(tangent);
  const Vec3 along = unit_or(t - normal * glm::dot(normal, t), Vec3(0));
  const Vec3 across = glm::cross(normal, along) * (tangent.w < 0 ? -1.0 : 1.0);
  return unit_or(bump.x * along + bump.y * across + bump.z * normal, normal);
}

// The colour of a picture on a surface that may have holes.
Vec3 Stage::texel_colour(const DrawItem& draw, std::int32_t picture, const Vec2& at) const {
  const Vec4 texel = repeated_texel(pictures_[static_cast<std::size_t>(picture)], at);
  return draw.variant.cutout && texel.w > 0 ? Vec3(texel) / texel.w : Vec3(texel);
}

// What pictures and vertices multiply the diffuse colour by.
Vec3 Stage::colour(const DrawItem& draw, const Item& item, const Place& place,
                   const Vec2& at) const {
  Vec3 result(1);
  if (item.texture >= 0 && !item.mesh.texcoords.empty()) {
    result *= texel_colour(draw, item.texture, plain_texcoord(item, place));
  }
  if (item.albedo >= 0) result *= texel_colour(draw, item.albedo, at);
  if (!item.mesh.colours.empty()) {
    Vec3 sum(0);
    for (int k = 0; k < 3; ++k)
      sum += place.weight[k] * vec3(item.mesh.colours[place.corner[static_cast<std::size_t>(k)]]);
    result *= sum;
  }
  return glm::max(result, Vec3(0));
}

// The diffuse colour with the decals that lie over a place of a mesh.
Vec3 Stage::decorated(const Item& item, const Vec3& position, const Vec3& normal, bool front,
                      Vec3 colour) const {
  const Vec4 at(position, 1);
  for (std::size_t i = 0; i < item.decals.size(); ++i) {
    const PlacedDecal& decal = decals_[item.decals[i]];
    const double facing = glm::dot(decal.outwards, normal);
    const Vec2 where(glm::dot(decal.place[0], at), glm::dot(decal.place[1], at));
    const bool inside = where.x >= 0 && where.x <= 1 && where.y >= 0 && where.y <= 1 &&
                        std::fabs(glm::dot(decal.place[2], at)) <= 1 &&
                        (front ? facing : -facing) > 0;
    if (!inside) continue;
    const Vec4 texel = clamped_texel(pictures_[item.decal_pictures[i]], where);
    colour = colour * (1 - texel.w) + Vec3(texel);
  }
  return colour;
}

Point Stage::point(const geometry::InstanceHit& hit, bool flat) const {
  const DrawItem& draw = items_[hit.instance];
  const Item& item = placed_[hit.instance];
  const Place where = place(item, hit);
  std::array<Vec3, 3> corner;
  Vec3 smooth(0);
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k] = vec3(item.mesh.positions[where.corner[k]]);
    smooth += where.weight[static_cast<int>(k)] * vec3(item.mesh.normals[where.corner[k]]);
  }
  const Vec3 ab = corner[1] - corner[0];
  const Vec3 ac = corner[2] - corner[0];
  const Vec3 position = corner[0] + hit.barycentric.x * ab + hit.barycentric.y * ac;
  const Vec3 facet = unit_or(glm::cross(ab, ac), Vec3(0, 0, 1));
  if (flat) smooth = facet;
  const Vec3 outwards = unit_or(smooth, facet);

  Point result;
  Vec3 shaded = outwards;
  double length = 1;
  Vec2 at(0);
  if (!item.mesh.texcoords.empty()) at = map_texcoord(draw, item, where);
  Vec4 along(0);
  if (item.tangents) along = tangent(item, hit, where);
  if (item.normal >= 0) shaded = bumped(draw, item, along, outwards, at, length);
  const double side = draw.closed || hit.front ? 1.0 : -1.0;
  const Vec3 start = position + outwards * (side * (flat ? item.flat_offset : item.offset));
  result.start = Vec3(draw.model_from_mesh * Vec4(start, 1));
  result.normal = unit_or(draw.model_normal_from_mesh * shaded, Vec3(0)) * side;
  if (item.tangents) {
    const Vec3 t = Mat3(draw.model_from_mesh) * Vec3(along);
    result.tangent = unit_or(t - result.normal * glm::dot(result.normal, t), Vec3(0));
  }

  const std::uint32_t part = part_at(draw, item, where);
  // grid lines and gaps have their own colours, and decals lie over the cells
  Vec3 tint = part == 0 ? colour(draw, item, where, at) : Vec3(1);
  if (item.diffuse_in_tint && part < 2) {
    if (item.cell_parts > 0)
      tint *= item.part_diffuse[part];
    else
      tint *= item.diffuse;
    tint = decorated(item, position, smooth, draw.closed || hit.front, tint);
  }
  result.tint = tint * length;
  result.scatter = &scatters_[item.cell_parts > 0 ? item.cell_parts + part : item.scatter];
  if (item.roughness >= 0) {
    const double factor = repeated_texel(pictures_[static_cast<std::size_t>(item.roughness)], at).x;
    result.own.emplace(result.scatter->roughened(factor));
  }
  // grid lines and gaps have no facets
  if (item.reflectance >= 0 && part == 0)
    result.own.emplace(result.surface().reflecting(texel_colour(draw, item.reflectance, at)));
  if (part < 2) result.emitted = item.emitted;
  return result;
}

}  // namespace panwright::preview::reference
