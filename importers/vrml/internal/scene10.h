// VRML 1.0 → scene: nodes change a state, and shapes are made of it.
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

// What the items of Material and Normal are given to.
enum class Binding : std::uint8_t {
  standard,  // none is stated
  overall,
  face,  // parts and faces
  face_indexed,
  vertex,
  vertex_indexed,
};

// What has been read before a shape and holds for it.
struct State10 {
  std::int32_t anchor = 0;  // node of the scene; scene::kNone: what comes is left out
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

// The items of a Material node. Where its lists differ in length the longest counts, and the
// others hold their last.
class Materials10 {
 public:
  explicit Materials10(const Node* material);  // nullptr: the standard's
  std::size_t size() const { return size_; }
  Phong at(std::size_t item) const;  // counts round
  bool only_diffuse_varies() const { return others_ <= 1; }
  bool lit() const { return lit_; }            // false: its colours were emissive alone
  std::vector<double> diffuse_colors() const;  // 3*size
  std::string_view name() const;

 private:
  std::span<const double> list(std::string_view field) const;

  const Node* node_;
  std::span<const double> diffuse_, specular_, emissive_, shininess_, transparency_;
  std::size_t size_ = 1;
  std::size_t others_ = 1;
  bool lit_ = true;
};

// A face set of VRML 1.0, or a shape made of faces as one.
struct Faces10 {
  std::span<const double> points;
  std::span<const std::int32_t> coord_index;
  std::span<const std::int32_t> material_index;  // empty: none
  std::span<const std::int32_t> normal_index;
  std::span<const double> texcoords;
  std::span<const std::int32_t> texcoord_index;
  bool own_texcoords = true;  // asked for by the node, not left by one before it
};

// How a binding finds items: the index, and whether it is one per corner.
struct Bound10 {
  std::vector<std::int32_t> owned;
  std::span<const std::int32_t> index;
  bool per_vertex = false;
};

class Scene10 {
 public:
  Scene10(Builder& builder, std::int32_t parent) : builder_(builder) { state_.anchor = parent; }

  void visit(Node& node);
  // apart: what they change ends with them
  void visit_all(std::span<Node* const> nodes, bool apart);

 private:
  using Visitor = void (Scene10::*)(Node&);
  static const std::map<std::string_view, Visitor>& visitors();

  // A node of the scene that is made when something stands in it, where the transforms before that
  // have led.
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
  // once: the lists of the node and its coordinates are not asked for again
  void add_part(Node& node, const Faces10& faces, const FaceSet& set, Phong phong, bool once,
                std::vector<Part>& parts);
  bool coordinates_are_served() const;
  void report(const Node& node, const ListProblems& problems);

  // What a face set came out as, for its further uses in the same state.
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
  // The lists of nodes around the one that is visited.
  struct Level {
    bool apart;  // what they change ends with them
    bool last;   // nothing after that node can hold faces
  };
  std::vector<Level> levels_;
  std::map<const Node*, std::int32_t> images_;  // textures of Texture2 nodes
  // the last node that was made for a shape without a name
  std::int32_t last_anchor_ = scene::kNone;
  std::int32_t last_place_ = scene::kNone;
  Mat4 last_matrix_{1};
};

}  // namespace panwright::importers::vrml
