// Contents of a MuJoCo model, with defaults applied.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "geometry/tessellate/shape.h"
#include "importers/internal/robot_parts.h"

namespace panwright::importers::mjcf {

inline constexpr std::int32_t kNone = scene::kNone;

struct Pose {
  Vec3 position{0};
  Quat rotation{1, 0, 0, 0};
  Vec3 operator()(const Vec3& p) const { return position + rotation * p; }
  Pose operator*(const Pose& inner) const {
    return {(*this)(inner.position), rotation * inner.rotation};
  }
};

struct MeshAsset {
  MeshFile file;
  std::shared_ptr<const geometry::Mesh> mesh;  // of vertices in the model, in place of a file
  Pose reference;                              // its vertices are moved by the inverse, then scaled
};

struct Geom {
  std::string name;
  Pose pose;
  std::vector<geometry::Shape> shapes;  // together; empty: a mesh
  std::vector<double> heights;          // of each shape along the geom's z, metres
  std::int32_t mesh = kNone;            // index into Model::meshes
  std::int32_t paint = kNone;           // index into Model::paints
  SourceSpan where;
};

enum class JointType { hinge, slide, ball, free };

struct ModelJoint {
  std::string name;
  JointType type = JointType::hinge;
  Vec3 anchor{0};  // in the body's frame, metres
  Vec3 axis{0, 0, 1};
  std::optional<Vec2> range;  // radians or metres
  double reference = 0;       // value in the pose of the file
  SourceSpan where;
};

// Site, or a camera rotated to look along +z with +y down.
struct Mark {
  std::string name;
  Pose pose;
  SourceSpan where;
};

struct Body {
  std::string name;
  std::int32_t parent = kNone;  // index into Model::bodies; of the world: none
  Pose pose;
  std::vector<ModelJoint> joints;
  std::vector<Geom> geoms;
  std::vector<Mark> marks;
  SourceSpan where;
};

// Coupling y − y0 = c0 + c1·(x − x0) + … of two joints' values.
struct Coupling {
  std::string follower;  // y
  std::string leader;    // x; empty: y stays at y0 + c0
  std::array<double, 5> factors{0, 1, 0, 0, 0};
  SourceSpan where;
};

struct Model {
  std::string name;
  std::vector<Body> bodies;  // the world first; parents before children
  std::vector<MeshAsset> meshes;
  std::vector<Paint> paints;
  std::vector<Coupling> couplings;
};

// Reads a model. Reports E6220, W6221; counts skipped elements.
Model read_model(const XmlText& text, meshes::ReaderContext& context);

}  // namespace panwright::importers::mjcf
