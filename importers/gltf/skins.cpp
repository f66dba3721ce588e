#include "importers/gltf/skins.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "geometry/mesh/strip.h"
#include "importers/gltf/read.h"

namespace panwright::importers::gltf {

namespace {

Mat4 local_of(const tinygltf::Node& node) {
  Mat4 matrix(1);
  if (node.matrix.size() == 16) {
    for (int k = 0; k < 16; ++k) matrix[k / 4][k % 4] = node.matrix[static_cast<std::size_t>(k)];
    return matrix;
  }
  const auto& t = node.translation;
  const auto& r = node.rotation;
  const auto& s = node.scale;
  return matrix_from_trs(
      t.size() == 3 ? Vec3(t[0], t[1], t[2]) : Vec3(0),
      r.size() == 4 ? glm::normalize(Quat(r[3], r[0], r[1], r[2])) : Quat(1, 0, 0, 0),
      s.size() == 3 ? Vec3(s[0], s[1], s[2]) : Vec3(1));
}

}  // namespace

SkinPoser::SkinPoser(Document& document, const tinygltf::Model& model)
    : document_(document), model_(model), world_(model.nodes.size(), Mat4(1)) {
  std::vector<int> parent(model.nodes.size(), -1);
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    for (const int child : model.nodes[i].children)
      parent[static_cast<std::size_t>(child)] = static_cast<int>(i);
  std::vector<int> todo;
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    if (parent[i] < 0) todo.push_back(static_cast<int>(i));
  while (!todo.empty()) {
    const auto i = static_cast<std::size_t>(todo.back());
    todo.pop_back();
    world_[i] = local_of(model.nodes[i]);
    if (parent[i] >= 0) world_[i] = world_[static_cast<std::size_t>(parent[i])] * world_[i];
    todo.insert(todo.end(), model.nodes[i].children.begin(), model.nodes[i].children.end());
  }
}

const std::vector<Mat4>& SkinPoser::joints_of(int skin) {
  const auto [place, is_new] = joints_.try_emplace(skin);
  if (!is_new) return place->second;
  const tinygltf::Skin& from = model_.skins[static_cast<std::size_t>(skin)];
  std::vector<Mat4> inverse;
  if (from.inverseBindMatrices >= 0)
    inverse = read_vectors<Mat4>(
        document_, static_cast<std::size_t>(from.inverseBindMatrices),
        pointer("skins", static_cast<std::size_t>(skin)) + "/inverseBindMatrices");
  std::size_t projective = 0;
  const auto matrices = static_cast<std::size_t>(std::max(from.inverseBindMatrices, 0));
  const bool given = !inverse.empty() && document_.accessors[matrices].view >= 0;
  for (const Mat4& m : inverse)
    if (given && (m[0].w != 0 || m[1].w != 0 || m[2].w != 0 || m[3].w != 1)) ++projective;
  if (projective > 0)
    document_.report(Code("E6207"), nullptr,
                     pointer("skins", static_cast<std::size_t>(skin)) + "/inverseBindMatrices",
                     fmt::format("{} of {} matrices have a last row other than 0 0 0 1", projective,
                                 inverse.size()));
  for (std::size_t i = 0; i < from.joints.size(); ++i) {
    const Mat4& world = world_[static_cast<std::size_t>(from.joints[i])];
    place->second.push_back(i < inverse.size() ? world * inverse[i] : world);
  }
  return place->second;
}

geometry::MeshShape SkinPoser::posed(int skin, const geometry::Mesh& mesh,
                                     const SkinWeights& weights) {
  const std::vector<Mat4>& joints = joints_of(skin);
  auto out = std::make_shared<geometry::Mesh>(mesh);
  const std::size_t vertices = mesh.positions.size();
  std::size_t beyond = 0, negative = 0, twice = 0;
  std::vector<double> used;  // joints of one vertex
  for (std::size_t v = 0; v < vertices; ++v) {
    Mat4 moved(0);
    used.clear();
    double sum = 0;
    for (std::size_t set = 0; set < weights.sets; ++set)
      for (int k = 0; k < 4; ++k) {
        const double weight = weights.weights[set * vertices + v][k];
        const double joint = weights.joints[set * vertices + v][k];
        const bool is_there = joint < static_cast<double>(joints.size());
        if (!is_there) ++beyond;
        if (weight == 0 || !is_there) continue;
        if (weight < 0) ++negative;
        if (std::find(used.begin(), used.end(), joint) != used.end()) ++twice;
        used.push_back(joint);
        moved += weight * joints[static_cast<std::size_t>(joint)];
        sum += weight;
      }
    if (!(sum > 0)) continue;
    const Vec3 position = Vec3(moved * Vec4(mesh.positions[v], 1)) / sum;
    if (!is_finite(position)) continue;
    out->positions[v] = position;
    if (mesh.normals.empty()) continue;
    const Vec3 normal = cofactor(Mat3(moved)) * mesh.normals[v];
    const double length = glm::length(normal);
    if (length > 1e-300 && std::isfinite(length)) out->normals[v] = normal / length;
  }
  const std::string object = pointer("skins", static_cast<std::size_t>(skin));
  if (beyond > 0 && !joints.empty())
    document_.report(Code("E6207"), nullptr, object,
                     fmt::format("{} of its mesh are for joints past the last of {}; left out",
                                 counted(beyond, "weight"), joints.size()));
  if (negative > 0)
    document_.report(Code("E6207"), nullptr, object,
                     fmt::format("{} of its mesh are negative", counted(negative, "weight")));
  if (twice > 0)
    document_.report(Code("W6212"), nullptr, object,
                     fmt::format("{} of its mesh are for a joint that the vertex has already",
                                 counted(twice, "weight")));
  if (out->normals.empty()) geometry::compute_normals(*out, document_.options.crease_angle);
  return out;
}

}  // namespace panwright::importers::gltf
