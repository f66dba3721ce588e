#include "compiler/internal/sound.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/text.h"

namespace panwright::compiler::internal {

namespace {

// metres: with coordinates of 1e30 in a node's frame, sums of products stay finite
constexpr double kFurthest = 1e200;

bool lie_between(std::span<const float> values, double low, double high) {
  return std::all_of(values.begin(), values.end(), [&](float x) { return x >= low && x <= high; });
}

bool have_unit_length(const std::vector<float>& normals) {
  constexpr double kTolerance = 9.9e-6;  // of the squared length; pan::check() takes 1e-5
  for (std::size_t i = 0; i + 2 < normals.size(); i += 3) {
    const Vec3 n(normals[i], normals[i + 1], normals[i + 2]);
    if (!(std::fabs(glm::dot(n, n) - 1) <= kTolerance)) return false;
  }
  return true;
}

bool is_path_end(std::string_view path, std::string_view end) {
  return path.ends_with(end) &&
         (path.size() == end.size() || path[path.size() - end.size() - 1] == '/');
}

// Returns the span of an element's name, at its place in a text; no file: not in this log, or
// files of several folders have the name.
SourceSpan span_of(const scene::Source& source, const SourceMap& sources) {
  FileId file = kNoFile;
  for (FileId id = 0; source.line > 0 && !source.file.empty() && id < sources.size(); ++id) {
    const SourceFile& each = sources.file(id);
    if (!each.bytes || !is_path_end(each.name, source.file)) continue;
    if (file == kNoFile)
      file = id;
    else if (sources.file(file).name != each.name)
      return {};
  }
  if (file == kNoFile) return {};
  const std::string_view text = *sources.file(file).bytes;
  std::uint32_t low = 0, high = static_cast<std::uint32_t>(text.size());
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    const Position at = sources.position(file, middle);
    if (std::pair(at.line, at.column) < std::pair(source.line, source.column))
      low = middle + 1;
    else
      high = middle;
  }
  if (low == text.size()) return {};
  const std::size_t begin = low + (text[low] == '<' ? 1 : 0);
  const std::size_t end = std::min(text.find_first_of(" \t\r\n/><", begin), text.size());
  return {file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

bool is_near(const Vec3& v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}) <= kFurthest;
}

}  // namespace

std::string place_of(const scene::Source& source) {
  return source.line == 0 ? source.file
                          : fmt::format("{}:{}:{}", source.file, source.line, source.column);
}

void report_at(const scene::Source& source, Code code, const std::string& message, std::string hint,
               DiagnosticLog& log) {
  const SourceSpan where = span_of(source, log.sources());
  log.report(code, where,
             where.file == kNoFile ? fmt::format("{}: {}", place_of(source), message) : message,
             std::move(hint));
}

bool is_sound(const pan::PackedMesh& mesh, DiagnosticLog& log) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  constexpr double kMost = pan::layout::kMaxNumber, kMostColor = pan::layout::kMaxColor;
  const auto refuse = [&](std::string message) {
    log.report(Code("E2010"), {}, std::move(message));
    return false;
  };
  if (!lie_between(mesh.positions, -kLargest, kLargest) || !is_finite(mesh.origin) ||
      !std::isfinite(mesh.error))
    return refuse("single precision cannot hold the positions of this shape");
  if (!have_unit_length(mesh.normals)) {
    log.report(Code("E2011"), {},
               "parts of this shape are so small beside others that they have no normal",
               "give sizes that differ less");
    return false;
  }
  if (!lie_between(mesh.texcoords, -kMost, kMost))
    return refuse(fmt::format("texture coordinates above {}, expected at most that", kMost));
  if (!lie_between(mesh.colors, 0, kMostColor))
    return refuse(fmt::format("vertex colours outside 0 to {}", kMostColor));
  return true;
}

bool is_sound(const scene::Scene& scene, DiagnosticLog& log) {
  const std::vector<Mat4> world = scene::world_from_nodes(scene);
  const auto report = [&](const scene::Source& source, const std::string& what) {
    report_at(source, Code("E2010"),
              fmt::format("{} lies out of range: the transforms and the initial values of "
                          "joints down to here together exceed {} m",
                          what, kFurthest),
              {}, log);
    return false;
  };
  for (std::size_t i = 0; i < world.size(); ++i) {
    bool near = true;
    for (int c = 0; c < 4; ++c) near = near && is_near(Vec3(world[i][c]));
    if (!near) return report(scene.nodes[i].source, "node " + in_quotes(scene.nodes[i].name));
  }
  for (const scene::Keypoint& point : scene.keypoints) {
    const Mat4& matrix = world[static_cast<std::size_t>(point.node)];
    if (!is_near(Vec3(matrix * Vec4(point.position, 1))))
      return report(point.source, "keypoint " + in_quotes(point.name));
  }
  for (const scene::Lamp& lamp : scene.lamps)
    if (!is_near(Vec3(world[static_cast<std::size_t>(lamp.node)] * Vec4(lamp.position, 1))))
      return report(lamp.source, "lamp " + in_quotes(lamp.name));
  return true;
}

}  // namespace panwright::compiler::internal
