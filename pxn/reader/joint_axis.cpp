// Axes of joints on nodes of CAD files, where a text leaves them to the file's faces.
#include "pxn/reader/joint_axis.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "base/text.h"
#include "geometry/tessellate/tessellate.h"
#include "pxn/reader/loader.h"
#include "pxn/reader/pattern.h"

namespace panwright::pxn {

namespace attribute = schemas::attribute;

namespace {

constexpr double kAlong = 0.08715574274765817;            // sin 5°: of a written axis
constexpr double kSameDirection = 0.0087265354983739345;  // sin 0.5°: one direction
constexpr double kRival = 0.5;                            // of the first one's area: as good
constexpr std::size_t kMostNamed = 3;                     // of lines in a message
constexpr std::uint32_t kSegments = 64;                   // of exact shapes
constexpr double kFine = 2e-3;                            // of their size: error of exact shapes

// A mesh whose round edges stand on an exact shape; nothing where it cannot be made.
std::optional<geometry::Mesh> mesh_of(const geometry::Shape& shape, const DiagnosticLog& log) {
  if (const auto* held = std::get_if<geometry::MeshShape>(&shape)) return **held;
  DiagnosticLog said = log.apart();
  geometry::TessellationOptions options;
  options.max_error = 1e9;  // the coarsest, for its size
  const auto coarse = geometry::tessellated(shape, options, {}, said);
  if (!coarse) return std::nullopt;
  double size = 0;
  for (const Vec3& p : coarse->positions) size = std::max(size, glm::length(p));
  options.max_error = std::max(kFine * size, geometry::kMinRadius);
  options.edge_segments = kSegments;
  auto out = geometry::tessellated(shape, options, {}, said);
  if (!out) return std::nullopt;
  return *std::move(out);
}

double area_of(const geometry::Mesh& mesh) {
  double twice = 0;
  for (const geometry::Triangle& t : mesh.triangles)
    twice += glm::length(glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                                    mesh.positions[t[2]] - mesh.positions[t[0]]));
  return twice / 2;
}

// "arm/pin": the path below a node, as patterns have it.
std::string path_below(const scene::Scene& scene, std::uint32_t top, std::size_t node) {
  std::string out = scene.nodes[node].name;
  for (auto at = scene.nodes[node].parent; at > static_cast<std::int32_t>(top);
       at = scene.nodes[static_cast<std::size_t>(at)].parent)
    out = scene.nodes[static_cast<std::size_t>(at)].name + "/" + out;
  return out;
}

double distance(const AxisLine& line, const Vec3& point) {
  return glm::length(glm::cross(line.faces.axis, point - line.faces.origin));
}

std::string described(const AxisLine& line) {
  return fmt::format("a {} of radius {:.4g} m in node {}", geometry::name_of(line.faces.kind),
                     line.faces.radius, in_quotes(line.node));
}

// What to say where a joint gets no line: of none that it may mean, or of several.
Reporter::Text no_line(const std::string& joint, const std::string& pattern,
                       const std::vector<AxisLine>& lines, bool some_elsewhere) {
  if (lines.empty())
    return {
        fmt::format("joint {} has no axis: {} in the nodes that {} matches; its nodes stay at rest",
                    in_quotes(joint),
                    some_elsewhere ? "none is along the axis that is written"
                                   : "there is no cylinder, cone, torus or circular hole",
                    in_quotes(pattern)),
        "write axis=\"x y z\" and origin=\"x y z\", or name a node with a round part by "
        "axis_from"};
  std::string list;
  for (std::size_t i = 0; i < std::min(lines.size(), kMostNamed); ++i)
    list +=
        fmt::format("{}{} ({})", i == 0 ? "" : ", ", described(lines[i]), as_attributes(lines[i]));
  return {fmt::format("joint {} has several axes of like size to choose from: {}{}; its nodes stay "
                      "at rest",
                      in_quotes(joint), list, lines.size() > kMostNamed ? ", …" : ""),
          "write the one that is meant, or name its node by axis_from"};
}

}  // namespace

std::vector<AxisLine> lines_meant(std::vector<AxisLine> lines, const WrittenLine& written) {
  using geometry::RevolvedKind;
  const auto keep = [&](const auto& fits) { std::erase_if(lines, std::not_fn(fits)); };
  const auto is_face = [](const AxisLine& l) { return l.faces.kind != RevolvedKind::circle; };
  if (std::ranges::any_of(lines, is_face)) keep(is_face);
  if (written.axis)
    keep([&](const AxisLine& l) {
      return glm::length(glm::cross(l.faces.axis, *written.axis)) <= kAlong;
    });
  if (written.origin) {
    const auto passes = [&](const AxisLine& l) {
      return distance(l, *written.origin) <= l.faces.radius;
    };
    if (std::ranges::any_of(lines, passes)) keep(passes);
  }
  return lines;
}

bool ambiguous(const std::vector<AxisLine>& lines, const WrittenLine& written) {
  return std::ranges::any_of(lines, [&](const AxisLine& l) {
    if (&l == &lines.front() || l.faces.area < kRival * lines.front().faces.area) return false;
    const bool parallel =
        glm::length(glm::cross(l.faces.axis, lines.front().faces.axis)) <= kSameDirection;
    return !(parallel && written.origin);
  });
}

std::string as_attributes(const AxisLine& line) {
  const auto in_words = [](const Vec3& v, const char* unit, double size) {
    std::string out;
    for (int k = 0; k < 3; ++k)
      out += fmt::format("{}{:.9g}{}", k == 0 ? "" : " ",
                         std::fabs(v[k]) < 1e-12 * size ? 0.0 : v[k], unit);
    return out;
  };
  const double size = std::max(glm::length(line.faces.origin), line.faces.radius);
  return fmt::format("origin=\"{}\" axis=\"{}\"", in_words(line.faces.origin, "m", size),
                     in_words(line.faces.axis, "", 1));
}

std::vector<AxisLine> Loader::lines_in(const PartImport& import, const std::vector<char>& nodes) {
  const ImportedModel& model = models_[import.model];
  const scene::Scene& scene = model.imported.scene;
  std::vector<Mat4> import_from(scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Mat4 local = scene.nodes[i].parent_from_node.matrix();
    import_from[i] =
        i == 0 ? local : import_from[static_cast<std::size_t>(scene.nodes[i].parent)] * local;
  }
  std::vector<AxisLine> lines;
  double area = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const auto node = static_cast<std::size_t>(scene.instances[i].node);
    if (!nodes[node] || import.removed[i]) continue;
    job_.poll();
    auto mesh = mesh_of(scene_.shapes[static_cast<std::size_t>(
                            model.shapes[static_cast<std::size_t>(scene.instances[i].shape)])],
                        reporter_.log());
    if (!mesh) continue;
    for (Vec3& p : mesh->positions) p = Vec3(import_from[node] * Vec4(p, 1));
    area += area_of(*mesh);
    for (geometry::RevolvedFaces& found : geometry::revolved_faces(*mesh)) {
      const auto known = std::ranges::find_if(lines, [&](const AxisLine& line) {
        return line.faces.kind != geometry::RevolvedKind::circle &&
               found.kind != geometry::RevolvedKind::circle && share_axis(line.faces, found);
      });
      if (known == lines.end()) {
        lines.push_back({found, path_below(scene, model.top, node), found.area});
        continue;
      }
      // the line of the largest, with the area of all; `share` holds its own area till the end
      const double all = known->faces.area + found.area;
      if (found.area > known->share)
        *known = {found, path_below(scene, model.top, node), found.area};
      known->faces.area = all;
    }
  }
  for (AxisLine& line : lines) line.share = area > 0 ? line.faces.area / area : 0;
  std::ranges::stable_sort(
      lines, [](const AxisLine& a, const AxisLine& b) { return a.faces.area > b.faces.area; });
  return lines;
}

bool Loader::axis_from_faces(Work& work, std::uint32_t rule, const PartImport& import,
                             PartImport::Moved& moved, PartJoint& joint) {
  const xml::Document& document = work.file.document;
  Values& values = *work.file.values;
  const bool named = values.has(rule, attribute::import_joint_axis_from);
  const bool seeks_axis = values.is_word(rule, attribute::import_joint_axis) ||
                          (named && !values.has(rule, attribute::import_joint_axis));
  const bool seeks_origin =
      values.is_word(rule, attribute::import_joint_origin) ||
      ((named || seeks_axis) && !values.has(rule, attribute::import_joint_origin));
  if (!seeks_axis && !seeks_origin) {
    if (named)
      reporter_.report(
          Code("N1405"), values.value_place(rule, attribute::import_joint_axis_from), document,
          rule, [&] {
            return Reporter::Text("'axis_from' has no effect where axis and origin are written");
          });
    return true;
  }
  const SourceSpan where = values.value_place(
      rule, values.is_word(rule, attribute::import_joint_axis) ? attribute::import_joint_axis
            : values.is_word(rule, attribute::import_joint_origin)
                ? attribute::import_joint_origin
                : attribute::import_joint_axis_from);
  const ImportedModel& model = models_[import.model];
  const scene::Scene& scene = model.imported.scene;
  const auto pattern =
      values.text(rule, named ? attribute::import_joint_axis_from : attribute::import_joint_nodes);
  if (!pattern) return false;
  const std::vector<char> nodes = matching_nodes(scene, model.top, Pattern(*pattern));
  if (std::ranges::find(nodes, 1) == nodes.end()) {
    reporter_.report(
        Code("W1501"), values.value_place(rule, attribute::import_joint_axis_from), document, rule,
        [&] {
          std::set<std::string> names;
          for (std::size_t i = 1; i < scene.nodes.size(); ++i) names.insert(scene.nodes[i].name);
          return Reporter::Text(
              fmt::format("no node of the import fits {}; joint {} has no axis and moves nothing",
                          in_quotes(*pattern), in_quotes(joint.joint.name)),
              near_names(*pattern, names));
        });
    return false;
  }
  WrittenLine written;
  if (!seeks_axis) written.axis = joint.joint.axis;
  if (!seeks_origin) written.origin = moved.origin;
  const std::vector<AxisLine> all = lines_in(import, nodes);
  const std::vector<AxisLine> lines = lines_meant(all, written);
  if (lines.empty() || ambiguous(lines, written)) {
    reporter_.report(Code("E1233"), where, document, rule,
                     [&] { return no_line(joint.joint.name, *pattern, lines, !all.empty()); });
    return false;
  }
  const AxisLine& line = lines.front();
  if (seeks_axis) joint.joint.axis = line.faces.axis;
  if (seeks_origin) moved.origin = line.faces.origin;
  reporter_.report(Code("N1234"), where, document, rule, [&] {
    std::string text = fmt::format(
        "joint {} has the axis of {}: {:.3g} % of the area there, {:.2g} m from the vertices (root "
        "mean square); {}",
        in_quotes(joint.joint.name), described(line), 100 * line.share, line.faces.residual,
        as_attributes(line));
    if (written.origin)
      text += fmt::format(", {:.3g} m from the origin that is written",
                          distance(line, *written.origin));
    return Reporter::Text(text);
  });
  return true;
}

}  // namespace panwright::pxn
