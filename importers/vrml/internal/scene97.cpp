#include "importers/vrml/internal/scene97.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "importers/vrml/internal/node_types.h"

namespace panwright::importers::vrml {

namespace {

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

Quat rotation_of(std::span<const double> axis_angle) {
  if (axis_angle.size() < 4) return {1, 0, 0, 0};
  // scaled first: squares of tiny or huge numbers are not
  Vec3 axis(axis_angle[0], axis_angle[1], axis_angle[2]);
  const double largest = std::max({std::fabs(axis.x), std::fabs(axis.y), std::fabs(axis.z)});
  if (!(largest > 0)) return {1, 0, 0, 0};
  axis /= largest;
  axis /= glm::length(axis);
  const det::SinCos half = det::sincos(axis_angle[3] / 2);
  return {half.cos, half.sin * axis.x, half.sin * axis.y, half.sin * axis.z};
}

// To the centre and turned: what a joint turns and slides stands in these axes, its scale below.
Mat4 pivot_of(const TransformFields& f) {
  return matrix_from_trs(f.translation + f.centre, rotation_of(f.rotation), Vec3(1));
}

Mat4 below_pivot(const TransformFields& f) {
  const Quat along = rotation_of(f.scale_orientation);
  const bool turned = f.scale.x != f.scale.y || f.scale.y != f.scale.z;
  Mat4 stretch = matrix_from_trs(Vec3(0), {1, 0, 0, 0}, f.scale);
  if (turned && along != Quat(1, 0, 0, 0))
    stretch = matrix_from_trs(Vec3(0), along, f.scale) *
              matrix_from_trs(Vec3(0), glm::conjugate(along), Vec3(1));
  if (f.centre == Vec3(0)) return stretch;
  return stretch * matrix_from_trs(-f.centre, {1, 0, 0, 0}, Vec3(1));
}

Mat4 matrix_of(const TransformFields& f) { return pivot_of(f) * below_pivot(f); }

std::optional<Mat4> transform10_of(const Node& node, DiagnosticLog& log) {
  if (node.spec == nullptr || !is_transform10(node.spec->name)) return std::nullopt;
  const std::string_view type = node.spec->name;
  constexpr Quat kNoTurn(1, 0, 0, 0);
  if (type == "Translation") return matrix_from_trs(node.vec3("translation"), kNoTurn, Vec3(1));
  if (type == "Rotation")
    return matrix_from_trs(Vec3(0), rotation_of(node.numbers("rotation")), Vec3(1));
  if (type == "Scale") return matrix_from_trs(Vec3(0), kNoTurn, node.vec3("scaleFactor"));
  const auto numbers = node.numbers("matrix");
  Mat4 m;
  for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = numbers[static_cast<std::size_t>(i)];
  if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1) {
    log.report(Code("W6118"), node.find("matrix")->where,
               "the last column of a matrix is 0 0 0 1; it is taken for that");
    for (int i = 0; i < 4; ++i) m[i][3] = i == 3 ? 1 : 0;
  }
  return m;
}

std::int32_t Scene97::add(Node* node, std::int32_t parent) {
  if (node == nullptr || parent == scene::kNone) return scene::kNone;
  if (!builder_.enter(*node)) return scene::kNone;
  const bool once = builder_.once;
  builder_.once = once && !node->again && node->prototype == nullptr;
  std::int32_t made = scene::kNone;
  if (node->prototype == nullptr) {
    made = add_actual(*node, node->name, parent, false);
  } else if (Node* const body = context_.actual(node)) {
    const bool joint = is_joint(*node);
    const std::string_view name = node->name.empty() ? body->name : node->name;
    if (builder_.enter(*body)) {
      made = add_actual(*body, name, parent, joint);
      builder_.leave(*body);
    }
    if (joint && made != scene::kNone) add_joint(*node, made);
  }
  builder_.once = once;
  builder_.leave(*node);
  return made;
}

void Scene97::add_all(std::span<Node* const> nodes, std::int32_t parent) {
  for (Node* node : nodes) {
    const auto moved = node == nullptr ? std::nullopt : transform10_of(*node, context_.log);
    if (!moved)
      add(node, parent);
    else if (parent != scene::kNone)
      parent = builder_.add_node(parent, *moved, node->name, node->spec->name, node->where);
  }
}

std::int32_t Scene97::add_actual(const Node& node, std::string_view name, std::int32_t parent,
                                 bool pivots) {
  if (node.spec == nullptr) return scene::kNone;
  const std::string_view type = node.spec->name;
  if (type == "Shape") return add_shape(node, name, parent);
  if (type == "Transform") return add_transform(node, name, parent, pivots);
  if (is_one_of(type, {"Group", "Anchor", "Billboard", "Collision"}))
    return add_group(node, name, parent);
  if (type == "Switch") return add_switch(node, name, parent);
  if (type == "LOD") return add_lod(node, name, parent);
  if (type == "Inline") return add_inline(node, name, parent);
  if (is_one_of(type, {"Box",
                       "Cone",
                       "Cylinder",
                       "Sphere",
                       "IndexedFaceSet",
                       "ElevationGrid",
                       "Extrusion",
                       "IndexedLineSet",
                       "PointSet",
                       "Text",
                       "Appearance",
                       "Material",
                       "ImageTexture",
                       "PixelTexture",
                       "MovieTexture",
                       "TextureTransform",
                       "Coordinate",
                       "Color",
                       "Normal",
                       "TextureCoordinate",
                       "FontStyle"})) {
    context_.log.report(Code("W6115"), node.where,
                        fmt::format("{} is outside of a Shape", in_quotes(node.type)));
    return scene::kNone;
  }
  if (is_transform10(type)) {
    context_.log.report(
        Code("W6115"), node.where,
        fmt::format("{} is not in a group: it moves nothing", in_quotes(node.type)));
    return scene::kNone;
  }
  builder_.skipped(type);
  return scene::kNone;
}

std::int32_t Scene97::add_group(const Node& node, std::string_view name, std::int32_t parent) {
  if (node.spec->name == "Billboard") builder_.lost("rotation of billboards", node.where);
  const std::int32_t made = builder_.add_node(parent, Mat4(1), name, node.spec->name, node.where);
  add_all(node.nodes("children"), made);
  add_all(node.children, made);
  return made;
}

std::int32_t Scene97::add_transform(const Node& node, std::string_view name, std::int32_t parent,
                                    bool pivots) {
  TransformFields fields;
  fields.translation = node.vec3("translation");
  fields.centre = node.vec3("center");
  fields.rotation = node.numbers("rotation");
  fields.scale = node.vec3("scale");
  fields.scale_orientation = node.numbers("scaleOrientation");
  const bool apart = pivots && (fields.centre != Vec3(0) || fields.scale != Vec3(1));
  const std::int32_t made = builder_.add_node(parent, apart ? pivot_of(fields) : matrix_of(fields),
                                              name, node.spec->name, node.where);
  if (made == scene::kNone) return made;
  // what turns about a centre has a node there; what it scales does not scale its slides
  const std::int32_t inside =
      apart ? builder_.add_node(made, below_pivot(fields), {}, "Centre", node.where) : made;
  add_all(node.nodes("children"), inside);
  add_all(node.children, inside);
  return made;
}

std::int32_t Scene97::add_switch(const Node& node, std::string_view name, std::int32_t parent) {
  const std::int32_t choice = node.integer("whichChoice");
  const auto choices = node.nodes("choice");
  const std::int32_t made = builder_.add_node(parent, Mat4(1), name, node.spec->name, node.where);
  if (choice >= 0 && static_cast<std::size_t>(choice) < choices.size())
    add(choices[static_cast<std::size_t>(choice)], made);
  return made;
}

std::int32_t Scene97::add_lod(const Node& node, std::string_view name, std::int32_t parent) {
  const auto levels = node.nodes("level");
  const std::int32_t made = builder_.add_node(parent, Mat4(1), name, node.spec->name, node.where);
  if (!levels.empty()) add(levels[0], made);
  return made;
}

std::int32_t Scene97::add_inline(const Node& node, std::string_view name, std::int32_t parent) {
  const std::int32_t made = builder_.add_node(parent, Mat4(1), name, node.spec->name, node.where);
  const Field* urls = node.find("url");
  if (urls == nullptr || urls->value.strings().empty()) return made;
  Document* document = context_.inlined(urls->value.strings(), urls->where);
  if (document == nullptr || !builder_.enter(*document, urls->where)) return made;
  const bool once = std::exchange(builder_.once, false);
  build(builder_, *document, made);
  builder_.once = once;
  builder_.leave(*document);
  return made;
}

void build97(Builder& builder, Document& document, std::int32_t parent) {
  if (!builder.cache97) builder.cache97 = std::make_shared<Cache97>();
  Scene97 scene(builder, *builder.cache97);
  scene.add_all(document.nodes, parent);
}

}  // namespace panwright::importers::vrml
