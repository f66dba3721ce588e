// Conversion of VRML 97 to a scene. Private to scene97*.cpp.
#pragma once

#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "importers/vrml/internal/builder.h"
#include "importers/vrml/internal/faces.h"
#include "importers/vrml/internal/primitives.h"

namespace panwright::importers::vrml {

// Matrix of a Transform: p' = T·C·R·SR·S·−SR·−C·p (ISO/IEC 14772-1, 6.52). Of either version:
// rotation and orientation as axis and angle, as written.
struct TransformFields {
  Vec3 translation{0};
  Vec3 centre{0};
  std::span<const double> rotation;
  Vec3 scale{1};
  std::span<const double> scale_orientation;
};
// Its first part, T·C·R, and the rest.
Mat4 pivot_of(const TransformFields& fields);
Mat4 below_pivot(const TransformFields& fields);
Mat4 matrix_of(const TransformFields& fields);

// Returns the matrix of Translation, Rotation, Scale and MatrixTransform of VRML 1.0; nothing for
// other nodes. Reports W6118.
std::optional<Mat4> transform10_of(const Node& node, DiagnosticLog& log);

// An axis and an angle; the identity for an axis without direction.
Quat rotation_of(std::span<const double> axis_angle);

// Results for nodes, which may occur repeatedly.
struct Cache97 {
  struct Key {
    const Node* node = nullptr;
    const Node* other = nullptr;
    int flags = 0;
    bool operator==(const Key&) const = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& key) const {
      const auto a = reinterpret_cast<std::uintptr_t>(key.node);
      const auto b = reinterpret_cast<std::uintptr_t>(key.other);
      return (a >> 4) + (b >> 4) * 31 + static_cast<std::size_t>(key.flags);
    }
  };
  struct Meshed {
    std::int32_t shape = scene::kNone;
    bool colored = false;
  };
  // by geometry, texture transform, presence of a texture, and of one in colour
  std::unordered_map<Key, Meshed, KeyHash> meshes;
  std::unordered_set<const Node*> textured;  // geometries made for a texture
  std::uint64_t made_again = 0;              // triangles of the meshes after the first for each
  std::unordered_map<const Node*, std::int32_t> pixels;  // by PixelTexture
  // by appearance, presence of a texture, and replacement of its diffuse colour
  std::unordered_map<Key, std::int32_t, KeyHash> materials;
};

class Scene97 {
 public:
  Scene97(Builder& builder, Cache97& cache)
      : builder_(builder), context_(builder.context), cache_(cache) {}

  // Returns the corresponding node of the scene, or scene::kNone.
  std::int32_t add(Node* node, std::int32_t parent);

  // Adds the nodes of a group or a file. Transforms of VRML 1.0 apply to the nodes after them.
  void add_all(std::span<Node* const> nodes, std::int32_t parent);

 private:
  // Appearance of a shape.
  struct Look {
    const Node* appearance = nullptr;
    const Node* material = nullptr;
    const Node* transform = nullptr;  // of texture coordinates
    std::string_view name;
    std::int32_t texture = scene::kNone;
    bool grey = false;
    bool repeat_s = true;
    bool repeat_t = true;
    bool once = false;  // no other Shape has the same geometry
    bool own = false;   // nor the same appearance
  };

  std::int32_t add_actual(const Node& node, std::string_view name, std::int32_t parent,
                          bool pivots);
  std::int32_t add_group(const Node& node, std::string_view name, std::int32_t parent);
  std::int32_t add_transform(const Node& node, std::string_view name, std::int32_t parent,
                             bool pivots);
  std::int32_t add_switch(const Node& node, std::string_view name, std::int32_t parent);
  std::int32_t add_lod(const Node& node, std::string_view name, std::int32_t parent);
  std::int32_t add_inline(const Node& node, std::string_view name, std::int32_t parent);

  // scene97_shapes.cpp
  std::int32_t add_shape(const Node& node, std::string_view name, std::int32_t parent);
  bool add_primitive(const Node& geometry, const Look& look, std::int32_t parent,
                     std::string_view name, std::int32_t* made);
  bool add_round(const Node& geometry, const Look& look, std::int32_t parent, std::string_view name,
                 std::int32_t* made);
  std::int32_t place(const Primitive& primitive, const Look& look, std::int32_t parent,
                     std::string_view name, const Node& geometry);
  bool sound(const geometry::Shape& shape, const Node& geometry);
  std::int32_t mesh_shape(Node& geometry, const Look& look, bool* colored);
  Cache97::Meshed make_mesh(Node& geometry, const Look& look);
  FaceOptions face_options(const Look& look) const;
  geometry::Mesh face_set(Node& node, const Look& look, ListProblems& problems);
  void release(Node& geometry, List list);
  geometry::Mesh elevation_grid(const Node& node, const Look& look, ListProblems& problems);
  geometry::Mesh extrusion(const Node& node, const Look& look, ListProblems& problems);
  void count_made(const Node& geometry, std::uint64_t triangles);
  void report(const ListProblems& problems, const Node& node);
  std::span<const double> list_of(const Node& node, std::string_view member,
                                  std::string_view field);
  Look look_of(const Node& shape);
  std::int32_t material_of(const Look& look, bool colored);
  std::int32_t make_material(const Look& look, bool textured, bool replaced);

  // scene97_joints.cpp
  static bool is_joint(const Node& instance);
  void add_joint(const Node& instance, std::int32_t node);
  void add_masses(const Node& instance, scene::Joint& joint);

  Builder& builder_;
  ReaderContext& context_;
  Cache97& cache_;
};

}  // namespace panwright::importers::vrml
