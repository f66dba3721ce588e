#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <variant>

#include "preview/model/draw_list.h"

namespace panwright::preview {
namespace {

Mat3 outward_normals(const Mat3& linear) {
  Mat3 normals = cofactor(linear);
  double largest = 0;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) largest = std::max(largest, std::fabs(normals[column][row]));
  if (largest > 0) normals /= largest;
  return glm::determinant(linear) < 0 ? -normals : normals;
}

bool is_brushed(const pan::layout::Material& material) {
  return materials::is_anisotropic(pan::material_from(material, {}));
}

// The squared slope of a material's narrowest lobe; none: it has none that is narrower than normals
// may turn from sample to sample (geometry.frag).
std::optional<double> narrow_lobe(const materials::Material& material) {
  constexpr double kWidest = 0.25;
  const double alpha =
      materials::narrowest_slope(material, materials::Lobes::about_normal).value_or(HUGE_VAL);
  // a map makes lobes narrower
  if (!(alpha < (material.maps.roughness >= 0 ? HUGE_VAL : kWidest))) return std::nullopt;
  return alpha * alpha;
}

// Whether normals differ within a triangle.
bool is_smooth(const pan::MeshView& mesh) {
  if (mesh.normals.empty()) return false;
  const auto normal = [&](std::size_t i) {
    const auto& n = mesh.normals[mesh.indices[i]];
    return glm::vec3(n.x, n.y, n.z);
  };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::vec3 n = normal(i);
    for (const std::size_t k : {i + 1, i + 2})
      if (const glm::vec3 apart = normal(k) - n; glm::dot(apart, apart) > 1e-8f) return true;
  }
  return false;
}

void place(DrawItem& item, const pan::Model& model, const Mat4& model_from_node) {
  const pan::layout::Mesh& mesh = model.meshes()[item.mesh];
  const Vec3 origin(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
  item.model_from_mesh = model_from_node;
  item.model_from_mesh[3] = model_from_node * Vec4(origin, 1);
  item.mirrored = glm::determinant(Mat3(model_from_node)) < 0;
  item.model_normal_from_mesh = outward_normals(Mat3(model_from_node));
  if (item.detail > 0 || item.next_detail < HUGE_VAL) {
    const double stretch = stretch_of(model_from_node).largest;
    item.from = item.detail * stretch;
    item.to = item.next_detail * stretch;
  }
  item.set_pixel(0);
}

// What is asked of meshes and materials once, however many instances they have.
class Shapes {
 public:
  explicit Shapes(const pan::Model& model)
      : model_(model),
        smooth_(model.meshes().size()),
        roundings_(model.meshes().size()),
        lobes_(model.materials().size()) {}

  // The squared slope of the narrowest lobe on a mesh whose normals turn; none: none is narrow.
  std::optional<double> curved_lobe(std::uint32_t mesh, std::uint32_t material) {
    auto& lobe = lobes_[material];
    if (!lobe) lobe = narrow_lobe(pan::material_from(model_.materials()[material], {}));
    if (!*lobe) return std::nullopt;
    auto& smooth = smooth_[mesh];
    if (!smooth) smooth = is_smooth(model_.mesh(mesh));
    return *smooth ? *lobe : std::nullopt;
  }

  double rounding(std::uint32_t mesh) {
    auto& rounding = roundings_[mesh];
    if (!rounding) rounding = interpolation_error(model_.mesh(mesh));
    return *rounding;
  }

 private:
  const pan::Model& model_;
  std::vector<std::optional<bool>> smooth_;
  std::vector<std::optional<double>> roundings_;
  std::vector<std::optional<std::optional<double>>> lobes_;
};

// What is drawn of an instance: its own mesh and material, or those of a level; of its back alone.
DrawItem item_of(const pan::Model& model, Shapes& shapes, std::uint32_t index,
                 std::uint32_t mesh_index, std::uint32_t material_index, bool back) {
  namespace layout = pan::layout;
  const layout::Instance& instance = model.instances()[index];
  const layout::Mesh& mesh = model.meshes()[mesh_index];
  const layout::Material& material = model.materials()[material_index];
  DrawItem item;
  item.variant.shading = material.variant;
  item.variant.textured = instance.texture >= 0 && !back;
  item.variant.colored = (mesh.flags & layout::kMeshColors) != 0 && !back;
  item.variant.albedo_map = material.albedo_map >= 0;
  item.variant.normal_map = material.normal_map >= 0;
  item.variant.roughness_map = material.roughness_map >= 0;
  item.variant.reflectance_map = material.reflectance_map >= 0 &&
                                 materials::brdf_model_of(pan::material_from(material, {})).mapped;
  item.variant.cutout = material.cutout_map >= 0;
  item.variant.cells = material.cell_count[0] > 0;
  item.variant.brushed = is_brushed(material);
  item.variant.tangents = item.variant.normal_map ||
                          (item.variant.brushed && !model.mesh(mesh_index).texcoords.empty());
  if (const auto lobe = shapes.curved_lobe(mesh_index, material_index)) {
    item.variant.curved = true;
    item.lobe = *lobe;
  }
  const bool closed = (mesh.flags & layout::kMeshClosed) != 0 && !item.variant.cutout;
  item.sides = back                                  ? Sides::back
               : closed || model.back_of(index) >= 0 ? Sides::front
                                                     : Sides::both;
  item.texture = back ? -1 : instance.texture;
  item.material = material_index;
  item.mesh = mesh_index;
  item.instance = index;
  item.repeat = Vec2(material.map_repeat[0], material.map_repeat[1]);
  item.diffuse = Vec3(material.diffuse[0], material.diffuse[1], material.diffuse[2]);
  if (item.variant.cells) {
    // gaps and fingers have colours of their own, whatever the weight of the cells'
    item.diffuse *= static_cast<double>(material.weight_d);
    item.cells = *pan::material_from(material, {}).cells;
  }
  item.low = Vec3(mesh.bounds_min[0], mesh.bounds_min[1], mesh.bounds_min[2]);
  item.high = Vec3(mesh.bounds_max[0], mesh.bounds_max[1], mesh.bounds_max[2]);
  item.rounding = shapes.rounding(mesh_index);
  return item;
}

auto order(const DrawItem& item) {
  return std::tie(item.variant, item.sides, item.mirrored, item.texture, item.material, item.mesh,
                  item.instance);
}

}  // namespace

Families families_of(const pan::Model& model) {
  std::vector<materials::BrdfModel> of_material;
  for (const pan::layout::Material& record : model.materials())
    of_material.push_back(materials::brdf_model_of(pan::material_from(record, {})));
  Families brdf_models;
  brdf_models.all = of_material;
  std::sort(brdf_models.all.begin(), brdf_models.all.end());
  brdf_models.all.erase(std::unique(brdf_models.all.begin(), brdf_models.all.end()),
                        brdf_models.all.end());
  for (const materials::BrdfModel& brdf_model : of_material)
    brdf_models.of_material.push_back(static_cast<std::uint32_t>(
        std::lower_bound(brdf_models.all.begin(), brdf_models.all.end(), brdf_model) -
        brdf_models.all.begin()));
  brdf_models.materials.resize(brdf_models.all.size());
  for (const std::uint32_t index : brdf_models.of_material) ++brdf_models.materials[index];
  return brdf_models;
}

bool is_drawn_alike(const DrawItem& a, const DrawItem& b) {
  return a.variant == b.variant && a.sides == b.sides && a.mirrored == b.mirrored &&
         a.texture == b.texture && a.material == b.material && a.mesh == b.mesh;
}

std::vector<DrawItem> draw_list(const pan::Model& model) {
  const std::vector<Mat4> world_from_nodes = model.world_from_nodes();
  Shapes shapes(model);
  std::vector<DrawItem> list;
  list.reserve(model.instances().size() + model.levels().size());
  for (std::uint32_t i = 0; i < model.instances().size(); ++i) {
    const pan::layout::Instance& instance = model.instances()[i];
    const std::size_t first = list.size();
    const auto add = [&](std::int32_t back) {
      const auto material = [&](std::uint32_t front) {
        return back < 0 ? front : static_cast<std::uint32_t>(back);
      };
      list.push_back(
          item_of(model, shapes, i, instance.mesh, material(instance.material), back >= 0));
      for (const pan::layout::Level& level : model.levels(i)) {
        list.back().next_detail = level.detail;
        list.push_back(item_of(model, shapes, i, level.mesh, material(level.material), back >= 0));
        list.back().detail = level.detail;
      }
    };
    add(-1);
    if (const std::int32_t back = model.back_of(i); back >= 0) add(back);
    for (std::size_t k = first; k < list.size(); ++k)
      place(list[k], model, world_from_nodes[instance.node]);
  }
  std::sort(list.begin(), list.end(),
            [](const DrawItem& a, const DrawItem& b) { return order(a) < order(b); });
  return list;
}

std::vector<DrawItem> placed(std::span<const DrawItem> list, const pan::Model& model,
                             const world::EvaluatedInstance& at) {
  std::vector<DrawItem> items(list.begin(), list.end());
  for (DrawItem& item : items) {
    const std::uint32_t node = model.instances()[item.instance].node;
    item.shown = at.node_visible[node] != 0;
    place(item, model, at.model_from_nodes[node]);
  }
  return items;
}

double interpolation_error(const pan::MeshView& mesh) {
  constexpr double kRounding = 0x1p-24;
  constexpr double kRest = 0.01;
  constexpr int kLeast = -64;  // exponents
  std::array<double, 128> areas{};
  double total = 0;
  const auto position = [&](std::size_t index) {
    const pan::layout::Float3& p = mesh.positions[mesh.indices[index]];
    return Vec3(p.x, p.y, p.z);
  };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Vec3 sides[] = {position(i + 1) - position(i), position(i + 2) - position(i + 1),
                          position(i) - position(i + 2)};
    const double area = glm::length(glm::cross(sides[0], sides[1]));
    if (!(area > 0)) continue;
    const double square = std::max(
        {glm::dot(sides[0], sides[0]), glm::dot(sides[1], sides[1]), glm::dot(sides[2], sides[2])});
    // length squared over the height, area over the length
    const int exponent = std::ilogb(kRounding * square / area * std::sqrt(square)) + 1;
    areas[static_cast<std::size_t>(std::clamp(exponent - kLeast, 0, 127))] += area;
    total += area;
  }
  std::size_t k = areas.size();
  for (double rest = 0; k > 0 && rest <= kRest * total; --k) rest += areas[k - 1];
  return total > 0 ? std::ldexp(1.0, static_cast<int>(k) + kLeast) : 0;
}

std::vector<float> triangle_normals(const pan::MeshView& mesh) {
  const auto position = [&](std::size_t index) {
    const pan::layout::Float3& p = mesh.positions[mesh.indices[index]];
    return Vec3(p.x, p.y, p.z);
  };
  std::vector<float> normals(mesh.indices.size());
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    const Vec3 corner = position(i);
    Vec3 a = position(i + 1) - corner;
    Vec3 b = position(i + 2) - corner;
    // tiny and huge triangles would under- or overflow in the squared length of the product
    const double scale = std::max(std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}),
                                  std::max({std::fabs(b.x), std::fabs(b.y), std::fabs(b.z)}));
    if (!(scale > 0)) continue;
    const Vec3 normal = glm::cross(a / scale, b / scale);
    const double length = glm::length(normal);
    if (!(length > 0)) continue;
    for (int k = 0; k < 3; ++k)
      normals[i + static_cast<std::size_t>(k)] = static_cast<float>(normal[k] / length);
  }
  return normals;
}

}  // namespace panwright::preview
