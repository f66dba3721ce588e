#include "importers/internal/storable.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"

namespace panwright::importers {

namespace {

using geometry::Mesh;
using geometry::MeshShape;

bool fits(double value) { return std::fabs(value) <= std::numeric_limits<float>::max(); }

template <class V>
bool fits_all(const V& v) {
  for (glm::length_t k = 0; k < v.length(); ++k)
    if (!fits(v[k])) return false;
  return true;
}

// Puts `instead` where a vector does not fit. Returns how many.
template <class V>
std::size_t mended(std::vector<V>& list, const V& instead) {
  std::size_t count = 0;
  for (V& v : list)
    if (!fits_all(v)) {
      v = instead;
      ++count;
    }
  return count;
}

bool is_surface(const geometry::Shape& shape) {
  const auto* mesh = std::get_if<MeshShape>(&shape);
  return mesh == nullptr || ((*mesh)->positions.size() >= 3 && !(*mesh)->triangles.empty());
}

std::size_t mend_numbers(scene::Scene& scene) {
  std::size_t count = 0;
  for (geometry::Shape& shape : scene.shapes) {
    auto* held = std::get_if<MeshShape>(&shape);
    if (held == nullptr) continue;
    const auto& all_fit = [](const auto& list) {
      return std::all_of(list.begin(), list.end(), [](const auto& v) { return fits_all(v); });
    };
    const Mesh& mesh = **held;
    if (all_fit(mesh.texcoords) && all_fit(mesh.colors)) continue;
    Mesh copy = mesh;
    count += mended(copy.texcoords, Vec2(0)) + mended(copy.colors, Vec3(1));
    *held = std::make_shared<const Mesh>(std::move(copy));
  }
  for (materials::Material& material : scene.materials)
    if (!fits_all(material.maps.repeat)) {
      material.maps.repeat = Vec2(1);
      ++count;
    }
  return count;
}

std::size_t mend_names(scene::Scene& scene) {
  std::size_t count = 0;
  const auto mend = [&](std::string& name) {
    if (name.find('\0') == name.npos) return;
    std::replace(name.begin(), name.end(), '\0', '_');
    ++count;
  };
  for (auto& node : scene.nodes) mend(node.name);
  for (auto& material : scene.materials) mend(material.name);
  for (auto& texture : scene.textures) mend(texture.name);
  for (auto& joint : scene.joints) mend(joint.name);
  for (auto& frame : scene.frames) mend(frame.name);
  for (auto& keypoint : scene.keypoints) mend(keypoint.name);
  return count;
}

}  // namespace

std::vector<std::int32_t> remove_instances(
    scene::Scene& scene, const std::function<bool(const scene::Instance&)>& unwanted) {
  std::vector<std::int32_t> moved(scene.instances.size(), scene::kNone);
  std::vector<scene::Instance> kept;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (unwanted(scene.instances[i])) continue;
    moved[i] = static_cast<std::int32_t>(kept.size());
    kept.push_back(std::move(scene.instances[i]));
  }
  scene.instances = std::move(kept);
  std::erase_if(scene.decals, [&](scene::Decal& decal) {
    decal.instance = moved[static_cast<std::size_t>(decal.instance)];
    return decal.instance == scene::kNone;
  });
  return moved;
}

void make_storable(scene::Scene& scene, const std::string& name, DiagnosticLog& log) {
  const std::size_t before = scene.instances.size();
  const auto is_empty = [&](const scene::Instance& instance) {
    return !is_surface(scene.shapes[static_cast<std::size_t>(instance.shape)]);
  };
  if (std::any_of(scene.instances.begin(), scene.instances.end(), is_empty))
    remove_instances(scene, is_empty);
  if (const std::size_t count = before - scene.instances.size(); count > 0)
    log.report_file(Code::W6009, name,
                    fmt::format("{} left out: without triangles, or of fewer than three vertices",
                                counted(count, "part")));
  if (const std::size_t count = mend_numbers(scene); count > 0)
    log.report_file(Code::W6012, name,
                    fmt::format("{} beyond single precision: texture coordinates become 0, "
                                "colours white, repeats of textures 1",
                                counted(count, "value")));
  if (const std::size_t count = mend_names(scene); count > 0)
    log.report_file(Code::W6012, name,
                    fmt::format("{} with a NUL, which becomes '_'", counted(count, "name")));
}

}  // namespace panwright::importers
