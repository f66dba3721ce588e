#include "trace/model.h"

#include <algorithm>

#include "base/parallel.h"

namespace panwright::trace {
namespace {

namespace layout = pan::layout;

Vec3 vec3(const float* v) { return Vec3(v[0], v[1], v[2]); }
Vec3 vec3(const double* v) { return Vec3(v[0], v[1], v[2]); }

}  // namespace

Model::Model(world::ModelPtr model, bool levels, bool ground, const Job& job)
    : model_(std::move(model)) {
  if (ground) {
    DiagnosticLog log;  // whoever opened the file has said what is wrong
    if (auto tiles = terrain::Tiles::of(model_, log); tiles && *tiles)
      ground_ = std::make_unique<const terrain::Ground>(
          std::make_shared<const terrain::Tiles>(**std::move(tiles)));
  }
  for (std::size_t i = 0; i < model_->textures().size(); ++i) {
    const layout::Texture& record = model_->textures()[i];
    textures_.emplace_back(model_->texels(i), record.width, record.height,
                           (record.flags & layout::kTextureLinear) != 0);
  }
  const auto instances = model_->instances();
  parts_.reserve(instances.size() + (levels ? model_->levels().size() : 0));
  for (std::uint32_t i = 0; i < instances.size(); ++i)
    add_part(i, instances[i].mesh, instances[i].material, 0);
  if (levels)
    for (const layout::Level& level : model_->levels())
      add_part(level.instance, level.mesh, level.material, level.detail);
  add_meshes(job);
}

void Model::add_part(std::uint32_t instance, std::uint32_t mesh_index, std::uint32_t material,
                     double detail) {
  const layout::Mesh& mesh = model_->meshes()[mesh_index];
  const layout::Material& record = model_->materials()[material];
  Part& part = parts_.emplace_back();
  part.mesh = model_->mesh(mesh_index);
  part.mesh_index = mesh_index;
  part.instance = instance;
  part.node = model_->instances()[instance].node;
  part.origin = vec3(mesh.origin);
  part.low = vec3(mesh.bounds_min);
  part.high = vec3(mesh.bounds_max);
  part.has_holes = record.cutout_map >= 0;
  part.closed = (mesh.flags & layout::kMeshClosed) != 0 && !part.has_holes;
  part.detail = detail;
  if (part.mesh.texcoords.empty()) return;
  part.cutout = record.cutout_map;
  part.threshold = record.cutout_threshold;
  part.repeat = Vec2(record.map_repeat[0], record.map_repeat[1]);
}

// every mesh that is placed, once
void Model::add_meshes(const Job& job) {
  const std::size_t count = model_->meshes().size();
  std::vector<std::uint8_t> placed(count);
  for (const Part& part : parts_) placed[part.mesh_index] = 1;
  meshes_.resize(count);
  parallel_for(
      count,
      [&](std::size_t i) {
        if (!placed[i]) return;
        const pan::MeshView mesh = model_->mesh(i);
        std::vector<Vec3> positions;
        positions.reserve(mesh.positions.size());
        for (const layout::Float3& p : mesh.positions) positions.emplace_back(p.x, p.y, p.z);
        std::vector<geometry::Triangle> triangles(mesh.indices.size() / 3);
        for (std::size_t k = 0; k < mesh.indices.size(); ++k)
          triangles[k / 3][k % 3] = mesh.indices[k];
        meshes_[i] = geometry::search_mesh(std::move(positions), std::move(triangles), job);
      },
      job);
}

std::span<const Model::Part> Model::levels(std::uint32_t instance) const {
  const auto all = std::span(parts_).subspan(model_->instances().size());
  return {std::ranges::lower_bound(all, instance, {}, &Part::instance),
          std::ranges::upper_bound(all, instance, {}, &Part::instance)};
}

Placement Model::placement(std::uint32_t part, const PlacedNodes& nodes) const {
  Placement result;
  result.model_from_mesh = nodes.model_from_node[parts_[part].node];
  result.normals = normal_matrix(result.model_from_mesh.linear);
  result.model_from_mesh.offset = result.model_from_mesh(parts_[part].origin);
  return result;
}

bool Model::is_there(std::uint32_t index, std::uint32_t triangle, const Vec2& barycentric) const {
  const Part& part = parts_[index];
  if (part.cutout < 0) return true;
  const Vec2 at = texcoord_of(part.mesh, place_of(part.mesh, triangle, barycentric)) * part.repeat;
  return textures_[static_cast<std::size_t>(part.cutout)].alpha(at) >= part.threshold;
}

}  // namespace panwright::trace
