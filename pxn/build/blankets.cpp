#include "pxn/build/blankets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "geometry/mesh/check.h"
#include "geometry/mesh/strip.h"
#include "geometry/tessellate/tessellate.h"
#include "mli/preset.h"
#include "pxn/build/metric.h"
#include "pxn/build/shapes.h"

namespace panwright::pxn {

namespace {

// metres; the stand-off that is not given, and its largest part of a shape's diagonal
constexpr double kStandOff = 0.025, kShare = 1.0 / 40;
// what heights are scaled by under a stand-off that nobody asked for, without a word
constexpr double kQuietScale = 0.5;
// of the stand-off: how far facets of a curved shape may lie from it
constexpr double kFacetShare = 0.02;
constexpr double kCell = 0.005;     // metres, without a preset
constexpr double kTriangles = 1e6;  // of a blanket whose cells are not given
// triangles of a blanket are about so many times the area over a cell's
constexpr double kPerCell = 2.4;  // an estimate: 2 and what faces are cut into at their borders

double diagonal_of(const geometry::Mesh& mesh) {
  Vec3 low(HUGE_VAL), high(-HUGE_VAL);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      low = glm::min(low, mesh.positions[v]);
      high = glm::max(high, mesh.positions[v]);
    }
  return mesh.triangles.empty() ? 0 : glm::length(high - low);
}

// A shape as triangles, good to `error` in its own frame; null where it cannot be made.
geometry::MeshShape mesh_of(const geometry::Shape& shape, double error) {
  if (const auto* mesh = std::get_if<geometry::MeshShape>(&shape)) return *mesh;
  DiagnosticLog ignored;
  auto made = geometry::tessellated(shape, {.max_error = error}, {}, ignored);
  return made ? std::make_shared<const geometry::Mesh>(*std::move(made)) : nullptr;
}

geometry::Mesh stretched(const geometry::Mesh& mesh, const Mat3& by) {
  geometry::Mesh out;
  out.triangles = mesh.triangles;
  for (const Vec3& p : mesh.positions) out.positions.push_back(by * p);
  return out;
}

// Faces whose normal lies within 45 degrees of a chosen direction; all where none is chosen.
std::vector<std::uint32_t> chosen_faces(const geometry::Mesh& mesh, std::uint32_t directions,
                                        const Mat4& axes_from_shape) {
  std::vector<std::uint32_t> out;
  const Mat3 turn = glm::transpose(glm::inverse(Mat3(axes_from_shape)));
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    bool chosen = directions == 0;
    if (!chosen) {
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3 normal = turn * glm::cross(mesh.positions[b] - mesh.positions[a],
                                            mesh.positions[c] - mesh.positions[a]);
      const double length = glm::length(normal);
      for (int k = 0; k < 6; ++k)
        chosen =
            chosen || ((directions >> k & 1) != 0 && length > 0 &&
                       (k % 2 == 0 ? 1 : -1) * normal[k / 2] >= (std::sqrt(0.5) - 1e-9) * length);
    }
    if (chosen) out.push_back(t);
  }
  return out;
}

double area_of(const geometry::Mesh& mesh, const std::vector<std::uint32_t>& faces) {
  double twice = 0;
  for (const std::uint32_t t : faces) {
    const auto& [a, b, c] = mesh.triangles[t];
    twice += glm::length(
        glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
  }
  return twice / 2;
}

mli::RecipeFor recipe_for(const Blanket& how, double cell, std::uint32_t seed) {
  return [&how, cell, seed](double width, double height, std::uint32_t seed_offset) {
    mli::Recipe recipe;
    recipe.width = recipe.height = cell;
    recipe.xgrid = 1;
    recipe.seed = seed;
    recipe = mli::fitted(recipe)(width, height, seed_offset);
    if (auto preset = mli::preset_operations(how.preset, recipe.height))
      recipe.operations = *std::move(preset);
    recipe.operations.insert(recipe.operations.end(), how.operations.begin(), how.operations.end());
    return recipe;
  };
}

// The cells of a blanket that says nothing of them: the preset's, smaller on small shapes, larger
// where it would have too many triangles and its operations allow that.
double cell_of(const Blanket& how, double diagonal, double area, double& coarsened) {
  if (how.cell > 0) return how.cell;
  double cell = kCell;
  for (const mli::Preset& preset : mli::presets())
    if (preset.name == how.preset) cell = preset.cell;
  cell = std::min(cell, diagonal / 100);
  const double largest = std::sqrt(kPerCell * area / kTriangles);
  if (largest <= cell) return cell;
  DiagnosticLog ignored;
  if (!mli::check(recipe_for(how, largest, 0)(64 * largest, 64 * largest, 0), ignored)) return cell;
  return coarsened = largest;
}

}  // namespace

bool Blankets::is_blanket(std::int32_t instance) const {
  return std::ranges::binary_search(blankets_, instance);
}

Mat4 Blankets::world_from(std::int32_t node) const {
  Mat4 out(1);
  for (; node != scene::kNone; node = scene_.nodes[static_cast<std::size_t>(node)].parent)
    out = scene_.nodes[static_cast<std::size_t>(node)].parent_from_node.matrix() * out;
  return out;
}

void Blankets::cover(std::int32_t instance, const Blanket& how, const Mat4& axes_from_world,
                     std::string name, scene::Instance blanket, WornFoil& out) {
  job_.poll();
  const auto index = static_cast<std::size_t>(instance);
  const std::int32_t node = scene_.instances[index].node;
  const Mat4 world = world_from(node);
  const bool beside = std::ranges::none_of(
      scene_.joints, [&](const scene::Joint& joint) { return joint.node == node; });
  bool any = false;
  const Made& made = this->made(scene_.instances[index].shape, how, world, axes_from_world * world,
                                any, blanket.source);
  if (!any) return;
  ++out.instances;
  out.tally.add(made.tally);
  if (made.cell > 0) ++out.coarsened, out.largest_cell = std::max(out.largest_cell, made.cell);
  if (out.problem.empty()) out.problem = made.problem;
  if (made.shape == scene::kNone) return;
  if (!std::holds_alternative<geometry::MeshShape>(
          scene_.shapes[static_cast<std::size_t>(scene_.instances[index].shape)])) {
    const double most = kFacetShare * made.stand_off;
    std::optional<double>& tolerance = scene_.instances[index].tolerance;
    if (!tolerance && scene_.budget.tolerance) tolerance = scene_.budget.tolerance;
    tolerance = std::min(tolerance.value_or(most), most);
  }
  scene::Node hanger;
  hanger.name = std::move(name);
  // note: beside a shape of its own node, so that this stays a leaf
  const scene::Node& covered = scene_.nodes[static_cast<std::size_t>(node)];
  if (beside && covered.parent != scene::kNone) {
    hanger.parent = covered.parent;
    hanger.parent_from_node = covered.parent_from_node;
  } else {
    hanger.parent = node;
  }
  hanger.source = blanket.source;
  blanket.node = static_cast<std::int32_t>(scene_.nodes.size());
  blanket.shape = made.shape;
  scene_.nodes.push_back(std::move(hanger));
  blankets_.push_back(static_cast<std::int32_t>(scene_.instances.size()));
  scene_.instances.push_back(std::move(blanket));
}

const Blankets::Made& Blankets::made(std::int32_t shape, const Blanket& how,
                                     const Mat4& world_from_shape, const Mat4& axes_from_shape,
                                     bool& any, const scene::Source& source) {
  const std::array<double, 6> metric = metric_of(world_from_shape);
  const Mat3 in_metres = metres_of(metric);
  const geometry::Shape given = scene_.shapes[static_cast<std::size_t>(shape)];
  Made none;
  // note: facets of a curved shape follow from its size and the stand-off
  geometry::MeshShape mesh = mesh_of(given, 1e300);
  const double stretch = std::sqrt(std::max({metric[0], metric[1], metric[2]}));
  if (mesh && mesh->triangles.empty()) mesh = nullptr;
  double diagonal = mesh ? diagonal_of(stretched(*mesh, in_metres)) : 0;
  const double stand_off =
      how.stand_off > 0 ? how.stand_off : std::min(kStandOff, kShare * diagonal);
  if (mesh && stand_off > 0 && stretch > 0 && !std::holds_alternative<geometry::MeshShape>(given))
    mesh = mesh_of(given, kFacetShare * stand_off / stretch);
  static const Made kNothing;
  any = false;
  if (!mesh || !(diagonal > 0)) return kNothing;
  const std::vector<std::uint32_t> faces = chosen_faces(*mesh, how.faces, axes_from_shape);
  any = !faces.empty();
  if (!any) return kNothing;
  const auto [known, added] = known_.try_emplace(
      Key(shape, metric, key_of(how), how.faces == 0 ? std::vector<std::uint32_t>() : faces));
  if (added) {
    known->second.stand_off = stand_off;
    make(shape, stretched(*mesh, in_metres), in_metres, how, faces, source, known->second);
  }
  return known->second;
}

void Blankets::make(std::int32_t shape, const geometry::Mesh& metres, const Mat3& in_metres,
                    const Blanket& how, const std::vector<std::uint32_t>& faces,
                    const scene::Source& source, Made& out) {
  const double room = kMaxFoilVertices - vertices_;
  if (room < 1) {
    out.problem = fmt::format("all sheets of a model may have {:.0f} vertices, and none is left",
                              kMaxFoilVertices);
    return;
  }
  const double cell = cell_of(how, diagonal_of(metres), area_of(metres, faces), out.cell);
  // other shapes wear other sheets, and the same one after each change of the model
  const auto seed =
      how.seed + static_cast<std::uint32_t>(
                     geometry::hash_of(scene_.shapes[static_cast<std::size_t>(shape)]).low);
  mli::WrapOptions options;
  options.stand_off = out.stand_off;
  options.max_triangles = room;
  options.tell = false;
  DiagnosticLog log;
  auto wrap = mli::wrapped(metres, faces, recipe_for(how, cell, seed), options, log, {}, job_);
  job_.poll();
  if (!wrap) {
    out.problem = log.entries().empty() ? "no blanket" : log.entries()[0].message;
    return;
  }
  out.tally.add(*wrap);
  if (how.stand_off == 0 && out.tally.least >= kQuietScale) out.tally.scaled = 0;
  if (wrap->blanket.triangles.empty()) return;
  const mli::WrapGroup* largest = nullptr;
  for (const mli::WrapGroup& g : wrap->groups)
    if (g.accepted && (largest == nullptr || g.area > largest->area)) largest = &g;
  scene::Foil foil{static_cast<std::int32_t>(scene_.shapes.size()),
                   largest->recipe,
                   mli::Flat{},
                   largest->statistics,
                   true,
                   source,
                   {}};
  auto mesh = std::make_shared<geometry::Mesh>(std::move(wrap->blanket));
  geometry::compute_normals(*mesh, crease_angle_);
  const Mat3 back = glm::inverse(in_metres);
  for (Vec3& p : mesh->positions) p = back * p;
  // normals are covectors
  for (Vec3& n : mesh->normals) n = glm::normalize(glm::transpose(in_metres) * n);
  geometry::set_closed(*mesh);
  vertices_ += static_cast<double>(mesh->positions.size());
  out.shape = foil.shape;
  scene_.shapes.emplace_back(geometry::MeshShape(std::move(mesh)));
  scene_.foils.push_back(std::move(foil));
}

}  // namespace panwright::pxn
