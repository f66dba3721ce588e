#include "importers/vrml/internal/scene10.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "importers/vrml/internal/scene97.h"

namespace panwright::importers::vrml {

namespace {

// Whether it can take coordinates that stand before it.
bool may_hold_faces(const Node& node) {
  return node.spec == nullptr || node.spec->group || node.again ||
         node.spec->name == "IndexedFaceSet";
}

std::string_view word(const Node& node, std::string_view field) {
  const auto words = node.strings(field);
  return words.empty() ? std::string_view() : words[0];
}

bool has_part(const Node& node, std::string_view part) {
  return std::ranges::any_of(node.strings("parts"),
                             [&](std::string_view word) { return word == part || word == "ALL"; });
}

}  // namespace

// ---- groups

const std::map<std::string_view, Scene10::Visitor>& Scene10::visitors() {
  static const std::map<std::string_view, Visitor> table = {
      {"AsciiText", &Scene10::skipped},
      {"Cone", &Scene10::cone},
      {"Coordinate3", &Scene10::coordinates},
      {"Cube", &Scene10::cube},
      {"Cylinder", &Scene10::cylinder},
      {"DirectionalLight", &Scene10::skipped},
      {"FontStyle", &Scene10::nothing},
      {"Group", &Scene10::group},
      {"IndexedFaceSet", &Scene10::face_set},
      {"IndexedLineSet", &Scene10::skipped},
      {"Info", &Scene10::nothing},
      {"LOD", &Scene10::lod},
      {"Material", &Scene10::material},
      {"MaterialBinding", &Scene10::material_binding},
      {"MatrixTransform", &Scene10::move},
      {"Normal", &Scene10::normals},
      {"NormalBinding", &Scene10::normal_binding},
      {"OrthographicCamera", &Scene10::skipped},
      {"PerspectiveCamera", &Scene10::skipped},
      {"PointLight", &Scene10::skipped},
      {"PointSet", &Scene10::skipped},
      {"Rotation", &Scene10::move},
      {"Scale", &Scene10::move},
      {"Separator", &Scene10::separator},
      {"ShapeHints", &Scene10::hints},
      {"Sphere", &Scene10::sphere},
      {"SpotLight", &Scene10::skipped},
      {"Switch", &Scene10::switch_node},
      {"Texture2", &Scene10::texture},
      {"Texture2Transform", &Scene10::texture_transform},
      {"TextureCoordinate2", &Scene10::texcoords},
      {"Transform", &Scene10::transform},
      {"TransformSeparator", &Scene10::transform_separator},
      {"Translation", &Scene10::move},
      {"WWWAnchor", &Scene10::separator},
      {"WWWInline", &Scene10::inlined},
  };
  return table;
}

void Scene10::visit(Node& node) {
  if (!builder_.enter(node)) return;
  const bool once = builder_.once;
  builder_.once = once && !node.again;
  const auto found = node.spec == nullptr ? visitors().end() : visitors().find(node.spec->name);
  if (found != visitors().end())
    (this->*found->second)(node);
  else if (node.type == "LevelOfDetail")  // of Inventor
    lod(node);
  else
    group(node);
  builder_.once = once;
  builder_.leave(node);
}

void Scene10::visit_all(std::span<Node* const> nodes, bool apart) {
  std::size_t last = nodes.size();
  while (last > 0 && !may_hold_faces(*nodes[last - 1])) --last;
  levels_.push_back({apart, false});
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    levels_.back().last = i + 1 >= last;
    visit(*nodes[i]);
  }
  levels_.pop_back();
}

void Scene10::children(Node& node, bool apart) { visit_all(node.children, apart); }

// Whether no face set that is still to come can ask for the coordinates.
bool Scene10::coordinates_are_served() const {
  if (!builder_.once || state_.coordinates == nullptr || state_.coordinates->again) return false;
  for (std::size_t i = levels_.size(); i-- > 0;) {
    if (!levels_[i].last) return false;
    if (i < state_.coordinates_level && levels_[i].apart) return true;
  }
  return true;
}

// Passes its state on to what follows.
void Scene10::group(Node& node) {
  if (node.name.empty() || node.children.empty() || state_.anchor == scene::kNone)
    return children(node);
  settle();
  const std::int32_t anchor = state_.anchor;
  const Mat4 before = state_.anchor_from_here;
  if (anchor != scene::kNone)
    state_.anchor = builder_.add_node(anchor, before, node.name, "Group", node.where);
  state_.anchor_from_here = Mat4(1);
  children(node);
  state_.anchor = anchor;
  state_.anchor_from_here = before * state_.anchor_from_here;
}

void Scene10::separator(Node& node) {
  settle();
  const State10 before = state_;
  const Frame frame = std::exchange(frame_, {node.name, "Separator", node.where, false});
  children(node, true);
  if (!node.name.empty()) settle();
  frame_ = frame;
  state_ = before;
}

void Scene10::transform_separator(Node& node) {
  settle();
  const std::int32_t anchor = state_.anchor;
  const Mat4 before = state_.anchor_from_here;
  const Frame frame = std::exchange(frame_, {node.name, "TransformSeparator", node.where, false});
  children(node);
  frame_ = frame;
  state_.anchor = anchor;
  state_.anchor_from_here = before;
}

void Scene10::switch_node(Node& node) {
  constexpr std::int32_t kAll = -3;
  constexpr std::int32_t kInherited = -2;  // of Inventor: as the switch around it
  const std::int32_t written = node.integer("whichChild");
  const std::int32_t which = written == kInherited ? which_child_ : written;
  const std::int32_t before = std::exchange(which_child_, which);
  if (which == kAll)
    group(node);
  else if (which >= 0 && static_cast<std::size_t>(which) < node.children.size())
    visit(*node.children[static_cast<std::size_t>(which)]);
  which_child_ = before;
}

void Scene10::lod(Node& node) {
  if (!node.children.empty()) visit(*node.children[0]);
}

void Scene10::inlined(Node& node) {
  const Field* name = node.find("name");
  if (name != nullptr) {
    Document* document = builder_.context.inlined(name->value.strings(), name->where);
    settle();
    if (document != nullptr && state_.anchor != scene::kNone &&
        builder_.enter(*document, name->where)) {
      const std::int32_t place = builder_.add_node(state_.anchor, state_.anchor_from_here,
                                                   node.name, "WWWInline", node.where);
      const bool once = std::exchange(builder_.once, false);
      if (place != scene::kNone) build(builder_, *document, place);
      builder_.once = once;
      builder_.leave(*document);
    }
  }
  if (!node.children.empty()) separator(node);
}

// ---- properties

Binding Scene10::binding(Node& node) {
  static const std::map<std::string_view, Binding> words = {
      {"DEFAULT", Binding::standard},  {"OVERALL", Binding::overall},
      {"PER_PART", Binding::face},     {"PER_PART_INDEXED", Binding::face_indexed},
      {"PER_FACE", Binding::face},     {"PER_FACE_INDEXED", Binding::face_indexed},
      {"PER_VERTEX", Binding::vertex}, {"PER_VERTEX_INDEXED", Binding::vertex_indexed},
  };
  const std::string_view text = word(node, "value");
  const auto found = words.find(text);
  if (found != words.end()) return found->second;
  const Field* field = node.find("value");
  builder_.context.log.report(Code("E6107"), field != nullptr ? field->where : node.where,
                              fmt::format("{} is not a binding", in_quotes(text)));
  return Binding::standard;
}

// About the centre: scale, then turn; then move. Transforms add up, the later the nearer to the
// coordinates.
void Scene10::texture_transform(Node& node) {
  const Vec2 centre = node.vec2("center");
  const Vec2 scale = node.vec2("scaleFactor");
  const Vec2 move = node.vec2("translation");
  const det::SinCos turn = det::sincos(node.number("rotation"));
  const Mat3 about(Vec3(scale.x * turn.cos, scale.x * turn.sin, 0),
                   Vec3(-scale.y * turn.sin, scale.y * turn.cos, 0), Vec3(0, 0, 1));
  Mat3 to(1), from(1);
  to[2] = Vec3(-centre, 1);
  from[2] = Vec3(centre + move, 1);
  state_.texture_transform = state_.texture_transform * from * about * to;
}

// note: the file multiplies rows by it, so that its rows are our columns
// Translation, Rotation, Scale and MatrixTransform.
void Scene10::move(Node& node) {
  if (const auto moved = transform10_of(node, builder_.context.log))
    state_.anchor_from_here = state_.anchor_from_here * *moved;
}

void Scene10::transform(Node& node) {
  TransformFields fields;
  fields.translation = node.vec3("translation");
  fields.centre = node.vec3("center");
  fields.rotation = node.numbers("rotation");
  fields.scale = node.vec3("scaleFactor");
  fields.scale_orientation = node.numbers("scaleOrientation");
  state_.anchor_from_here = state_.anchor_from_here * matrix_of(fields);
}

void Scene10::skipped(Node& node) { builder_.skipped(node.spec->name); }

// ---- places

void Scene10::settle() {
  if (frame_.made) return;
  frame_.made = true;
  if (state_.anchor == scene::kNone) return;
  state_.anchor = builder_.add_node(state_.anchor, state_.anchor_from_here, frame_.name,
                                    frame_.kind, frame_.where);
  state_.anchor_from_here = Mat4(1);
}

std::int32_t Scene10::place_of(const Node& node, const Mat4& here_from_shape) {
  settle();
  if (state_.anchor == scene::kNone) return scene::kNone;
  const Mat4 matrix = state_.anchor_from_here * here_from_shape;
  if (!node.name.empty())
    return builder_.add_node(state_.anchor, matrix, node.name, node.type, node.where);
  if (matrix == Mat4(1)) return state_.anchor;
  if (last_anchor_ != state_.anchor || last_matrix_ != matrix) {
    last_anchor_ = state_.anchor;
    last_matrix_ = matrix;
    last_place_ = builder_.add_node(state_.anchor, matrix, {}, node.type, node.where);
  }
  return last_place_;
}

// ---- shapes

void Scene10::cube(Node& node) {
  const Vec3 size(node.number("width"), node.number("height"), node.number("depth"));
  const Materials10 materials(state_.material);
  const bool plain =
      state_.material_binding == Binding::standard || state_.material_binding == Binding::overall;
  if (plain || materials.size() == 1) {
    const auto sheet = sheet_of(size);
    if (sheet)
      builder_.context.log.report(
          Code("W6009"), node.where,
          "the Cube has a side of 0 m; it is a sheet, visible from both sides");
    return add_primitive(node, sheet ? *sheet : box_of(size, texture_index() != scene::kNone), 0);
  }
  std::array<double, 24> points;
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      points[3 * i + k] = size[static_cast<int>(k)] * ((i >> k) % 2 == 1 ? 0.5 : -0.5);
  // front, back, left, right, top, bottom: each from its texture's bottom left
  constexpr std::array<std::int32_t, 30> kFaces = {4, 5, 7, 6, -1, 1, 0, 2, 3, -1, 0, 4, 6, 2, -1,
                                                   5, 1, 3, 7, -1, 6, 7, 3, 2, -1, 0, 1, 5, 4, -1};
  constexpr std::array<double, 8> kSquare = {0, 0, 1, 0, 1, 1, 0, 1};
  constexpr std::array<std::int32_t, 30> kCorners = {0, 1, 2, 3, -1, 0, 1, 2, 3, -1,
                                                     0, 1, 2, 3, -1, 0, 1, 2, 3, -1,
                                                     0, 1, 2, 3, -1, 0, 1, 2, 3, -1};
  Faces10 faces;
  faces.points = points;
  faces.coord_index = kFaces;
  faces.texcoords = kSquare;
  faces.texcoord_index = kCorners;
  add_faces(node, faces);
}

void Scene10::sphere(Node& node) {
  add_primitive(node, sphere_of(node.number("radius"), segments()), 0);
}

bool Scene10::has_parts_of_their_own() const {
  return state_.material_binding == Binding::face ||
         state_.material_binding == Binding::face_indexed;
}

void Scene10::cylinder(Node& node) {
  const double radius = node.number("radius");
  const double height = node.number("height");
  const bool sides = has_part(node, "SIDES");
  const bool top = has_part(node, "TOP");
  const bool bottom = has_part(node, "BOTTOM");
  const bool parted = has_parts_of_their_own();
  using geometry::Caps;
  if (sides) {
    const Caps caps = parted || (!top && !bottom) ? Caps::none
                      : top && bottom             ? Caps::both
                      : top                       ? Caps::top
                                                  : Caps::bottom;
    add_primitive(node, cylinder_of(radius, height, caps, segments()), 0);
  }
  if (sides && !parted) return;
  if (top) add_primitive(node, disc_of(radius, height / 2, true, segments()), 1);
  if (bottom) add_primitive(node, disc_of(radius, -height / 2, false, segments()), 2);
}

void Scene10::cone(Node& node) {
  const double radius = node.number("bottomRadius");
  const double height = node.number("height");
  const bool sides = has_part(node, "SIDES");
  const bool bottom = has_part(node, "BOTTOM");
  const bool parted = has_parts_of_their_own();
  using geometry::Caps;
  if (sides) {
    const Caps caps = bottom && !parted ? Caps::bottom : Caps::none;
    add_primitive(node, cone_of(radius, height, caps, segments()), 0);
  }
  if (bottom && (!sides || parted))
    add_primitive(node, disc_of(radius, -height / 2, false, segments()), 1);
}

// A shape with the material of one of the node's parts.
void Scene10::add_primitive(Node& node, const Primitive& primitive, std::size_t part) {
  if (const auto problem = geometry::problem_of(primitive.shape)) {
    builder_.context.log.report(Code("W6009"), node.where,
                                fmt::format("{}; it is left out", problem->message));
    return;
  }
  const std::int32_t place = place_of(node, primitive.theirs_from_shape);
  if (place == scene::kNone) return;
  const Materials10 materials(state_.material);
  const std::int32_t texture = texture_index();
  if (texture != scene::kNone && state_.texture_transform != Mat3(1))
    builder_.lost("texture transforms on primitives", node.where);
  builder_.add_instance(
      place, builder_.add_shape(primitive.shape, node.where),
      builder_.add_phong(materials.at(has_parts_of_their_own() ? part : 0), materials.name(),
                         texture != scene::kNone, materials.where(node)),
      texture, node.where);
}

void build10(Builder& builder, Document& document, std::int32_t parent) {
  Scene10 scene(builder, parent);
  scene.visit_all(document.nodes, true);
}

}  // namespace panwright::importers::vrml
