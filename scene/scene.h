// The authored scene: exact shapes on a tree of transforms, in double precision. Plain data.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/hash.h"
#include "base/math.h"
#include "geometry/shape.h"
#include "materials/material.h"

namespace panwright::scene {

inline constexpr std::int32_t kNone = -1;

// Where something was written: the file as in Scene::inputs. Survives without the source text.
struct Source {
  std::string file;
  std::uint32_t line = 0;  // 0: unknown
  std::uint32_t column = 0;
};

// p' = T·R·S·p.
struct Transform {
  Vec3 translation{0};        // metres
  Quat rotation{1, 0, 0, 0};  // unit
  Vec3 scale{1};              // ≠ 0; negative mirrors
  Mat4 matrix() const { return matrix_from_trs(translation, rotation, scale); }
  bool operator==(const Transform&) const = default;
};

// One node of the tree. nodes[0] is the root; a parent stands before its children.
struct Node {
  std::string name;
  std::int32_t parent = kNone;  // < own index; kNone for the root alone
  Transform parent_from_node;
  Source source;
};

// A picture that multiplies the diffuse colour.
struct Texture {
  std::string name;                // file name as written
  std::uint32_t width = 0;         // pixels
  std::uint32_t height = 0;        // pixels
  std::vector<std::uint8_t> rgba;  // 4·width·height, row 0 the top row
  bool linear = false;             // false: sRGB encoded
};

// How a texture finds its place on a shape.
enum class Mapping : std::uint8_t {
  texcoords,  // by the mesh's own coordinates
  sphere,     // by longitude and latitude seen from the origin of the texture's frame
};

// A shape at a node, with what covers it.
struct Instance {
  std::int32_t node = 0;
  std::int32_t shape = 0;
  std::int32_t material = 0;
  std::int32_t texture = kNone;
  Mapping mapping = Mapping::texcoords;
  Mat4 texture_from_shape{1};  // for Mapping::sphere
  Source source;
};

// A named frame: a camera, a docking port. x right, y down, z forward (docs/conventions.md 2).
struct Frame {
  std::string name;
  std::int32_t node = 0;
  Vec3 origin{0};             // in the node's frame, metres
  Quat rotation{1, 0, 0, 0};  // node_from_frame, unit
  Source source;
};

// A file that went into the scene.
struct Input {
  std::string path;  // relative to the top file's folder, '/' between parts
  Hash128 hash;
  std::uint64_t bytes = 0;
};

struct Scene {
  std::vector<Node> nodes;
  std::vector<geometry::Shape> shapes;
  std::vector<materials::Material> materials;
  std::vector<Texture> textures;
  std::vector<Instance> instances;
  std::vector<Frame> frames;
  std::vector<Input> inputs;  // in order of first use
};

// World matrices, one for each node, root first.
std::vector<Mat4> world_from_nodes(const Scene& scene);

// Whether every index, number and name of a scene is as documented above; says what is not.
// Returns an empty string for a sound scene. A reader that builds an unsound one has a bug.
std::string check(const Scene& scene);

}  // namespace panwright::scene
