// Conversion of VRML 1.0 to a scene: nodes change a state, from which shapes are made.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "importers/vrml/internal/builder.h"
#include "importers/vrml/internal/faces.h"
#include "importers/vrml/internal/primitives.h"

namespace panwright::importers::vrml {

// Assignment of the items of Material and Normal.
enum class Binding : std::uint8_t {
  standard,  // none given
  overall,
  face,  // parts and faces
  face_indexed,
  vertex,
  vertex_indexed,
};

// State of the preceding nodes at a shape.
struct State10 {
  std::int32_t anchor = 0;  // node of the scene; scene::kNone: following nodes are left out
  Mat4 anchor_from_here{1};
  Node* coordinates = nullptr;
  std::size_t coordinates_level = 0;  // of levels_: those around it
  const Node* normals = nullptr;
  const Node* texcoords = nullptr;
  const Node* material = nullptr;
  const Node* texture = nullptr;
  const Node* hints = nullptr;
  Binding material_binding = Binding::standard;
  Binding normal_binding = Binding::standard;
  Mat3 texture_transform{1};  // of (s, t, 1)
};

// Items of a Material node: as many as its longest list; the others repeat their last.
class Materials10 {
 public:
  explicit Materials10(const Node* material);  // nullptr: the standard's
  std::size_t size() const { return size_; }
  Phong at(std::size_t item) const;  // wraps around
  bool only_diffuse_varies() const { return others_ <= 1; }
  bool lit() const { return lit_; }            // false: its colours were only emissive
  std::vector<double> diffuse_colors() const;  // 3*size
  std::string_view name() const;
  // The place of the node; else that of the shape.
  SourceSpan where(const Node& shape) const { return (node_ != nullptr ? *node_ : shape).where; }

 private:
  std::span<const double> list(std::string_view field) const;

  const Node* node_;
  std::span<const double> diffuse_, specular_, emissive_, shininess_, transparency_;
  std::size_t size_ = 1;
  std::size_t others_ = 1;
  bool lit_ = true;
};

// Face set of VRML 1.0, or a shape of faces treated as one.
struct Faces10 {
  std::span<const double> points;
  std::span<const std::int32_t> coord_index;
  std::span<const std::int32_t> material_index;  // empty: none
  std::span<const std::int32_t> normal_index;
  std::span<const double> texcoords;
  std::span<const std::int32_t> texcoord_index;
  bool own_texcoords = true;  // from the node, not inherited from an earlier one
};

// Index lookup of a binding, and true for one item per corner.
struct Bound10 {
  std::vector<std::int32_t> owned;
  std::span<const std::int32_t> index;
  bool per_vertex = false;
};

class Scene10 {
 public:
  Scene10(Builder& builder, std::int32_t parent) : builder_(builder) { state_.anchor = parent; }

  void visit(Node& node);
  // apart: their changes end with them
  void visit_all(std::span<Node* const> nodes, bool apart);

 private:
  using Visitor = void (Scene10::*)(Node&);
  static const std::map<std::string_view, Visitor>& visitors();

  // Node of the scene, made on first use, at the transforms so far.
  struct Frame {
    std::string_view name;
    std::string_view kind;
    SourceSpan where;
    bool made = true;
  };
  struct Part {
    std::int32_t shape;
    std::int32_t material;
    bool colored;  // the mesh has colours of its own
  };

  // groups
  void children(Node& node, bool apart = false);
  void group(Node& node);
  void separator(Node& node);
  void transform_separator(Node& node);
  void switch_node(Node& node);
  void lod(Node& node);
  void inlined(Node& node);

  // properties
  void coordinates(Node& node) {
    state_.coordinates = &node;
    state_.coordinates_level = levels_.size();
  }
  void normals(Node& node) { state_.normals = &node; }
  void texcoords(Node& node) { state_.texcoords = &node; }
  void material(Node& node) { state_.material = &node; }
  void texture(Node& node) { state_.texture = &node; }
  void hints(Node& node) { state_.hints = &node; }
  void material_binding(Node& node) { state_.material_binding = binding(node); }
  void normal_binding(Node& node) { state_.normal_binding = binding(node); }
  void texture_transform(Node& node);
  void move(Node& node);
  void transform(Node& node);
  void nothing(Node&) {}
  void skipped(Node& node);

  // shapes
  void cube(Node& node);
  void sphere(Node& node);
  void cylinder(Node& node);
  void cone(Node& node);
  void face_set(Node& node);

  Binding binding(Node& node);
  void settle();  // makes the node of the frame
  std::int32_t place_of(const Node& node, const Mat4& here_from_shape);
  std::uint32_t segments() const { return builder_.context.options.primitives; }
  bool has_parts_of_their_own() const;  // side, top and bottom may differ in material
  void add_primitive(Node& node, const Primitive& primitive, std::size_t part);
  std::int32_t texture_index();
  void add_faces(Node& node, const Faces10& faces);
  std::vector<Part> parts_of(Node& node, const Faces10& faces);
  FaceSet set_of(Node& node, const Faces10& faces, const Bound10& normals);
  // once: the lists of the node and its coordinates are not needed again
  void add_part(Node& node, const Faces10& faces, const FaceSet& set, Phong phong, bool once,
                std::vector<Part>& parts);
  bool coordinates_are_served() const;
  void report(const Node& node, const ListProblems& problems);

  // Result of a face set, for further uses in the same state.
  struct Use {
    std::array<const void*, 7> nodes;
    std::array<Binding, 2> bindings;
    std::array<double, 6> texture_transform;
    auto operator<=>(const Use&) const = default;
  };

  Builder& builder_;
  State10 state_;
  Frame frame_;
  std::int32_t which_child_ = -1;  // of the innermost Switch
  std::map<Use, std::vector<Part>> parts_;
  // Lists of nodes around the current one.
  struct Level {
    bool apart;  // their changes end with them
    bool last;   // no later node can hold faces
  };
  std::vector<Level> levels_;
  std::map<const Node*, std::int32_t> images_;  // textures of Texture2 nodes
  // last node made for an unnamed shape
  std::int32_t last_anchor_ = scene::kNone;
  std::int32_t last_place_ = scene::kNone;
  Mat4 last_matrix_{1};
};

}  // namespace panwright::importers::vrml
