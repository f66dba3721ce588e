#include "compiler/internal/size_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/axis_box.h"
#include "compiler/size.h"

namespace panwright::compiler::internal {

namespace {

constexpr double kLargest = 200;  // metres: the largest spacecraft, a space station, is 109 m
constexpr double kSmallest = 0.05;
constexpr double kMostRatio = 1e5;  // of the sizes of two parts

AxisBox box_of(const pan::PackedMesh& mesh, const Mat4& world) {
  AxisBox box;
  for (std::size_t i = 0; i < mesh.positions.size(); i += 3) {
    const Vec3 p(mesh.positions[i], mesh.positions[i + 1], mesh.positions[i + 2]);
    box.add(Vec3(world * Vec4(mesh.origin + p, 1.0)));
  }
  return box;
}

bool may_be_celestial(const scene::Scene& scene) {
  if (scene.instances.size() != 1) return false;
  const geometry::Shape& shape = scene.shapes[static_cast<std::size_t>(scene.instances[0].shape)];
  return std::holds_alternative<geometry::Sphere>(shape) ||
         std::holds_alternative<geometry::Ellipsoid>(shape) ||
         std::holds_alternative<geometry::MeshShape>(shape);
}

// "wing/panel2", below the root.
std::string path_of(const scene::Scene& scene, std::int32_t node) {
  std::string path = scene.nodes[static_cast<std::size_t>(node)].name;
  for (std::int32_t at = scene.nodes[static_cast<std::size_t>(node)].parent; at > 0;
       at = scene.nodes[static_cast<std::size_t>(at)].parent)
    path = scene.nodes[static_cast<std::size_t>(at)].name + "/" + path;
  return path;
}

void report_whole(const std::string& file, double size, DiagnosticLog& log) {
  const std::string words = length_in_words(size);
  if (size > kLargest)
    log.report_file(
        Code("W2022"), file,
        fmt::format("the model is {} large, more than any spacecraft; read as millimetres it is "
                    "{}, as inches {}",
                    words, length_in_words(size * 1e-3), length_in_words(size * 0.0254)),
        "set units=\"mm\" at the root, or write a unit after each number, as 6mm; for CAD files "
        "--units mm");
  else
    log.report_file(Code("W2022"), file,
                    fmt::format("the model is {} large, less than any spacecraft; read as metres "
                                "it is {}, as inches {}",
                                words, length_in_words(size * 1e3), length_in_words(size * 25.4)),
                    "set units=\"m\" at the root, or write a unit after each number, as 6m; for "
                    "CAD files --units m");
}

}  // namespace

void check_size(const scene::Scene& scene, const pan::Contents& contents, DiagnosticLog& log) {
  const std::vector<Mat4> world = scene::world_from_nodes(scene);
  std::vector<PartBox> parts;
  for (const pan::InstanceContent& instance : contents.instances)
    parts.push_back({static_cast<std::int32_t>(instance.node),
                     box_of(contents.meshes[instance.mesh], world[instance.node])});
  check_sizes(scene, parts, log);
}

}  // namespace panwright::compiler::internal

namespace panwright::compiler {

void check_sizes(const scene::Scene& scene, std::span<const PartBox> parts, DiagnosticLog& log) {
  if (parts.empty() || internal::may_be_celestial(scene)) return;
  const std::string file = scene.inputs.empty() ? "" : scene.inputs.front().path;
  AxisBox whole;
  double least = HUGE_VAL, most = 0;
  std::int32_t smallest = 0, largest = 0;  // their nodes
  for (const auto& [node, box] : parts) {
    whole.add(box);
    const double size = box.longest();
    // what has no extent is reported elsewhere
    if (!(size > 0) || !std::isfinite(size)) continue;
    if (size < least) {
      least = size;
      smallest = node;
    }
    if (size > most) {
      most = size;
      largest = node;
    }
  }
  if (!(most > 0)) return;
  if (most > internal::kMostRatio * least) {
    log.report_file(
        Code("W2023"), file,
        fmt::format("the part '{}' is {} large, and '{}' is {}: {:.2g} times as much",
                    internal::path_of(scene, smallest), length_in_words(least),
                    internal::path_of(scene, largest), length_in_words(most), most / least),
        "check their units; a unit after a number sets it, as 6mm");
    return;
  }
  const double size = whole.longest();
  if (size > internal::kLargest || size < internal::kSmallest)
    internal::report_whole(file, size, log);
}

}  // namespace panwright::compiler
