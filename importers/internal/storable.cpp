#include "importers/internal/storable.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "geometry/kinematics/joint.h"
#include "geometry/tessellate/tessellate.h"

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
  for (auto& node : scene.nodes) mend(node.marks.label);
  for (auto& material : scene.materials) mend(material.name);
  for (auto& texture : scene.textures) mend(texture.name);
  for (auto& joint : scene.joints) mend(joint.name);
  for (auto& frame : scene.frames) mend(frame.name);
  for (auto& keypoint : scene.keypoints) mend(keypoint.name);
  for (auto& lamp : scene.lamps) mend(lamp.name);
  return count;
}

// ---- joints

constexpr double kLargestValue = 1e15;  // metres, radians, factors that anyone means

bool is_value(double x) { return std::fabs(x) <= kLargestValue; }

// Drops limits that are none, and brings the initial values to the others. Returns true for a
// change.
bool mend_limits(scene::Joint& joint) {
  const std::size_t count = geometry::value_count(joint.kind);
  const auto is_usable = [&] {
    if (joint.lower.size() != count || joint.upper.size() != count) return false;
    for (std::size_t i = 0; i < count; ++i)
      if (!(joint.lower[i] <= joint.upper[i]) || !is_value(joint.lower[i]) ||
          !is_value(joint.upper[i]))
        return false;
    return true;
  };
  bool changed = false;
  if (!(joint.lower.empty() && joint.upper.empty()) && !is_usable()) {
    joint.lower.clear();
    joint.upper.clear();
    changed = true;
  }
  geometry::JointValues rest = geometry::rest_values(joint.kind), begins = rest;
  if (joint.value.size() == count)
    std::ranges::copy(joint.value, begins.begin());
  else
    changed = changed || !joint.value.empty();
  bool moved = false;
  for (std::size_t i = 0; i < count; ++i) {
    double value = is_value(begins[i]) ? begins[i] : rest[i];
    if (!joint.lower.empty() && joint.mimic == scene::kNone)
      value = std::clamp(value, joint.lower[i], joint.upper[i]);
    changed = changed || value != begins[i];
    moved = moved || value != rest[i];
    begins[i] = value;
  }
  joint.value.clear();
  if (moved)
    joint.value.assign(begins.begin(), begins.begin() + static_cast<std::ptrdiff_t>(count));
  return changed;
}

// Followers of values that overflow move independently. Returns their number.
std::size_t cut_followers(std::vector<scene::Joint>& joints) {
  std::vector<geometry::Joint> all;
  std::vector<geometry::JointValues> values;
  for (scene::Joint& joint : joints) {
    if (!std::isfinite(joint.multiplier) || !std::isfinite(joint.offset))
      joint.multiplier = HUGE_VAL;  // beyond any value, and cut below
    all.push_back(scene::kinematic(joint));
    values.push_back(scene::initial_values(joint));
  }
  const auto set = geometry::JointSet::of(std::move(all));
  if (!set) return 0;
  set->resolve(values);
  std::size_t count = 0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    scene::Joint& joint = joints[i];
    if (joint.mimic == scene::kNone) continue;
    const double own =
        joint.multiplier * values[static_cast<std::size_t>(joint.mimic)][0] + joint.offset;
    if (is_value(own) && is_value(joint.multiplier) && is_value(joint.offset)) continue;
    joint.mimic = scene::kNone;
    joint.multiplier = 1;
    joint.offset = 0;
    (void)mend_limits(joint);
    ++count;
  }
  return count;
}

// ---- places

// Whether single precision holds the axes and the place of a node.
bool holds(const Mat4& world) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 3; ++r)
      if (!(std::fabs(world[c][r]) <= geometry::kMaxCoordinate)) return false;
  for (int c = 0; c < 3; ++c)
    if (!(glm::length(Vec3(world[c])) >= geometry::kMinRadius)) return false;
  return true;
}

// Leaves out transforms, and then the motion of joints, that lead beyond. Returns the nodes.
std::vector<std::size_t> mend_places(scene::Scene& scene) {
  std::vector<std::size_t> out;
  std::vector<Mat4> world(scene.nodes.size());
  for (std::size_t i = 0; i < world.size(); ++i) {
    scene::Node& node = scene.nodes[i];
    const Mat4 above =
        node.parent == scene::kNone ? Mat4(1) : world[static_cast<std::size_t>(node.parent)];
    world[i] = above * node.parent_from_node.matrix();
    if (holds(world[i])) continue;
    node.parent_from_node = {};
    world[i] = above;
    out.push_back(i);
  }
  const std::vector<Mat4> moved = scene::world_from_nodes(scene);
  const auto far = std::ranges::find_if_not(moved, holds);
  if (far == moved.end()) return out;
  out.push_back(static_cast<std::size_t>(far - moved.begin()));
  // values of joints depend on one another: all are at rest then
  for (scene::Joint& joint : scene.joints) {
    joint.lower.clear();
    joint.upper.clear();
    joint.value.clear();
    joint.mimic = scene::kNone;
    joint.multiplier = 1;
    joint.offset = 0;
  }
  return out;
}

void report_places(const scene::Scene& scene, const std::vector<std::size_t>& nodes,
                   const std::string& name, DiagnosticLog& log) {
  if (nodes.empty()) return;
  const scene::Node& first = scene.nodes[nodes.front()];
  const std::string line =
      first.source.line == 0 ? "" : fmt::format(", line {}", first.source.line);
  log.report_file(
      Code("E2010"), name,
      fmt::format("the transforms down to {}{} together scale or move by less than "
                  "1e-30 or more than 1e30; its own is left out{}",
                  in_quotes(to_utf8(first.name, Encoding::utf8)), line,
                  nodes.size() == 1 ? "" : fmt::format(", as those of {} more", nodes.size() - 1)));
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
    log.report_file(Code("W6009"), name,
                    fmt::format("{} left out: without triangles, or of fewer than three vertices",
                                counted(count, "part")));
  if (const std::size_t count = mend_numbers(scene); count > 0)
    log.report_file(Code("W6012"), name,
                    fmt::format("{} beyond single precision: texture coordinates become 0, "
                                "colours white, repeats of textures 1",
                                counted(count, "value")));
  std::size_t joints = 0;
  for (scene::Joint& joint : scene.joints) joints += mend_limits(joint);
  joints += cut_followers(scene.joints);
  if (joints > 0)
    log.report_file(Code("W6012"), name,
                    fmt::format("{} with limits or values that contradict each other or are beyond "
                                "{:g}: limits are dropped, initial values brought to the limits, "
                                "followers made independent",
                                counted(joints, "joint"), kLargestValue));
  report_places(scene, mend_places(scene), name, log);
  if (const std::size_t count = mend_names(scene); count > 0)
    log.report_file(Code("W6012"), name,
                    fmt::format("{} with a NUL, which becomes '_'", counted(count, "name")));
}

}  // namespace panwright::importers
