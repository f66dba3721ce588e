// The authored scene: exact shapes on a tree of transforms, in double precision. Plain data.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/hash.h"
#include "base/math.h"
#include "geometry/kinematics/joint.h"
#include "geometry/tessellate/shape.h"
#include "materials/material.h"
#include "mli/form.h"

namespace panwright::scene {

inline constexpr std::int32_t kNone = -1;

// Place in an input file; the file as in Scene::inputs. Survives without the source text.
struct Source {
  std::string file;
  std::uint32_t line = 0;  // 0: unknown
  std::uint32_t column = 0;
};

// Affine transform: p' = T·R·S·p.
struct Transform {
  Vec3 translation{0};        // metres
  Quat rotation{1, 0, 0, 0};  // unit
  Vec3 scale{1};              // ≠ 0; negative mirrors
  Mat4 matrix() const { return matrix_from_trs(translation, rotation, scale); }
  bool operator==(const Transform&) const = default;
};

// Names that an author gives a part for its users.
struct Marks {
  std::string label;  // in labels of images, with all below it; empty: none
  bool operator==(const Marks&) const = default;
};

// One node of the tree. nodes[0] is the root; a parent stands before its children.
struct Node {
  std::string name;
  std::int32_t parent = kNone;  // < own index; kNone for the root alone
  Transform parent_from_node;
  Source source;
  Marks marks{};
};

// A texture that multiplies the diffuse colour.
struct Texture {
  std::string name;                // file name as written
  std::uint32_t width = 0;         // pixels
  std::uint32_t height = 0;        // pixels
  std::vector<std::uint8_t> rgba;  // 4·width·height, row 0 the top row
  bool linear = false;             // false: sRGB encoded
};

// Mapping of a texture onto a shape.
enum class Mapping : std::uint8_t {
  texcoords,  // by the mesh's own coordinates
  sphere,     // by longitude and latitude seen from the origin of the texture's frame
};

// The accuracy budget of the model. Absent terms set no limit.
struct Budget {
  static constexpr double kDefaultCorridor = 30 * kDegree;
  static constexpr double kDefaultPixels = 0.25;  // if a camera is given without pixels
  std::optional<double> tolerance;                // metres
  std::optional<double> nearest;   // metres from the camera to the nearest surface, > 0
  std::optional<double> ifov;      // radians, the angle of a pixel, > 0
  std::optional<double> pixels;    // largest silhouette error, > 0
  std::optional<double> flux;      // relative error of a part's flux, > 0
  std::optional<double> centroid;  // largest error of a part's photocentre, pixels, > 0
  // Frame along whose z axis, within `corridor` radians, the camera approaches; `nearest` is then
  // measured from the frame's origin. Empty: from anywhere.
  std::string approach;
  double corridor = kDefaultCorridor;  // radians, > 0
  Source source;
  bool any() const { return tolerance || nearest || ifov || pixels || flux || centroid; }
};

// A shape at a node, with its materials.
struct Instance {
  std::int32_t node = 0;
  std::int32_t shape = 0;
  std::int32_t material = 0;
  std::int32_t texture = kNone;
  // Material of the back, without texture and vertex colours, which are the front's. It has the
  // holes of the front's. kNone: both sides are alike.
  std::int32_t back = kNone;
  Mapping mapping = Mapping::texcoords;
  Mat4 texture_from_shape{1};       // for Mapping::sphere
  std::optional<double> tolerance;  // metres in the world: overrides the budget
  bool prunable = false;            // a mesh whose hidden faces may be removed
  bool see_through = false;  // partly transparent where it was authored: it hides nothing behind it
  Source source;
};

// A coarser mesh of a sheet of foil.
struct FoilLevel {
  geometry::MeshShape mesh;
  double detail = 0;  // metres: smallest pixel footprint that uses it
  double error = 0;   // metres
};

// Recipe of a shape that is a sheet of foil: a mesh at the recipe's own detail.
struct Foil {
  std::int32_t shape = 0;
  mli::Recipe recipe;
  mli::Form form;
  mli::Statistics statistics;  // of the flat sheet
  // A blanket of several sheets over faces: recipe and statistics are of the largest one, and the
  // form is unused.
  bool wrapped = false;
  Source source;
  std::vector<FoilLevel> levels;  // from the finest, less detail each
};

// Texture laid on a shape: over the diffuse colour where its alpha is 1, nothing where it is 0.
// Upright along `up` as seen from outside. It reaches half its larger side deep on both sides of
// the point, not on faces turned away from the normal.
struct Decal {
  std::string name;
  std::int32_t instance = 0;
  std::int32_t texture = 0;
  Vec3 at{0};  // centre of the texture, in the shape's frame, metres; moved to the nearest point of
               // the surface
  std::optional<Vec3> normal;  // outwards, any length; none: the surface's there
  std::optional<Vec3> up;      // any length; none: +z, or +y where the normal is along z
  double width = 1;            // metres in the shape's frame, > 0
  double height = 1;
  Source source;
};

// A point whose image position is ground truth.
struct Keypoint {
  std::string name;
  std::int32_t node = 0;
  Vec3 position{0};  // in the node's frame, metres
  Source source;
};

// A lamp on a node: as light::Spot, light::Point and light::Disc. Intensities are W/sr per band, or
// in parts of the Sun's irradiance at 1 m.
struct Lamp {
  enum class Kind : std::uint8_t { spot, point, disc };
  std::string name;
  std::int32_t node = 0;
  Kind kind = Kind::spot;
  Vec3 position{0};       // in the node's frame, metres
  Vec3 axis{0, 0, 1};     // unit
  Vec3 intensity{1};      // on the axis, >= 0
  double half_angle = 0;  // of a spot, radians, above 0 to π; others: 0
  double exponent = 0;    // of a spot, >= 0; others: 0
  double radius = 0;      // metres; of a disc above 0
  bool on = true;
  std::optional<Vec2> pulse;  // begin and end, seconds after the time of the frame; none: always
  Source source;
};

// Returns the power of a lamp over its intensity on the axis, sr.
double steradians(const Lamp& lamp);

// A setting of views that say nothing of it, as an option of `panwright render` takes it: Sun,
// planets, stars. Files are relative to the top file's folder.
struct Setting {
  std::string name;
  std::string value;
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

using geometry::JointKind;

// Target that a joint's pointing direction follows.
enum class PointAt : std::uint8_t { nothing, sun };

// Motion of a part about or along an axis through its node's origin, inside the node's own
// transform: world_from_node = world_from_parent·(node's transform)·motion. Several joints of one
// node apply in their order, the first outermost. At rest (values of 0, factors of 1) nothing
// moves; world_from_nodes() has them at `value`.
struct Joint {
  std::string name;
  std::int32_t node = 0;
  JointKind kind = JointKind::revolute;
  Vec3 axis{0, 0, 1};         // unit, in the node's frame
  std::vector<double> lower;  // radians, metres or factors; none: unlimited; else of each value
  std::vector<double> upper;  // as many as lower
  std::vector<double> value;  // the initial ones, within the limits; none: at rest
  // Index of the joint to follow: value = multiplier·(value of that one) + offset.
  std::int32_t mimic = kNone;
  double multiplier = 1;
  double offset = 0;
  std::optional<Vec3> pointing;  // direction to be aimed, in the node's frame, unit
  std::int32_t gimbal = kNone;   // a joint further out that aims together with this one
  PointAt point_at = PointAt::nothing;
  // Inertia of the moving part, if known: kilograms, metres in the node's frame, kg·m².
  std::optional<double> mass;
  std::optional<Vec3> centre_of_mass;
  std::optional<Mat3> inertia;
  Source source;
};

// An input file of the scene.
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
  std::vector<Foil> foils;  // in order of shapes, each at most once
  std::vector<Instance> instances;
  std::vector<Frame> frames;        // names are unique
  std::vector<Keypoint> keypoints;  // names are unique
  std::vector<Lamp> lamps;          // names are unique
  std::vector<Setting> settings;    // of `<scene>`
  std::vector<Decal> decals;        // later ones lie over earlier ones
  std::vector<Joint> joints;        // names need not be unique
  Budget budget;
  std::vector<Input> inputs;  // in order of first use
};

// Decomposition of a regular affine matrix: p' = outer·inner·p. A shear needs both; else inner is
// the identity. Mirrors become a negative scale. Nothing for a matrix that flattens space (smallest
// stretch below 1e-12 of the largest) or is not finite or not affine. Good to a few ulps of the
// largest stretch.
struct Decomposed {
  Transform outer;
  Transform inner;  // a pure rotation
  bool sheared = false;
};
std::optional<Decomposed> decomposed(const Mat4& matrix);

// Returns true if the cut-outs of two materials make the same holes.
bool same_holes(const materials::Material& a, const materials::Material& b);

// Returns true if a joint can take more than one value.
bool can_move(const Joint& joint);

// Converts a joint to the form of geometry/kinematics, with its initial values.
geometry::Joint kinematic(const Joint& joint);
geometry::JointValues initial_values(const Joint& joint);

// Returns unique names of joints: their own, else that of the node, with "#2"… for repeated ones.
std::vector<std::string> joint_names(const Scene& scene);

// World matrices with all joints at their initial values, one per node, root first.
std::vector<Mat4> world_from_nodes(const Scene& scene);

// Checks that every index, number and name of a scene is as documented above. Returns the first
// problem, or an empty string for a valid scene. A reader that builds an invalid one has a bug.
std::string check(const Scene& scene);

}  // namespace panwright::scene
