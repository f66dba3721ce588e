// Contents of a robot description, and its tree.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "geometry/tessellate/shape.h"
#include "importers/internal/robot_parts.h"
#include "scene/scene.h"

namespace panwright::importers::urdf {

inline constexpr std::int32_t kNone = scene::kNone;

struct Origin {
  Vec3 xyz{0};
  Quat rotation{1, 0, 0, 0};
};

struct Visual {
  std::string name;
  Origin origin;
  std::variant<geometry::Shape, MeshFile> geometry;
  std::int32_t paint = kNone;  // index into Robot::paints
  SourceSpan where;
};

struct Link {
  std::string name;
  std::vector<Visual> visuals;
  std::optional<double> mass;
  Origin inertial;
  std::optional<Mat3> inertia;  // in the axes of `inertial`
  SourceSpan where;
};

enum class JointType { fixed, revolute, continuous, prismatic, floating, planar };

struct Mimic {
  std::string joint;
  double multiplier = 1;
  double offset = 0;
  SourceSpan where;
};

struct RobotJoint {
  std::string name;
  JointType type = JointType::fixed;
  Origin origin;
  std::int32_t parent = kNone;  // index into Robot::links
  std::int32_t child = kNone;
  Vec3 axis{1, 0, 0};
  std::optional<Vec2> limits;  // lower, upper
  std::optional<Mimic> mimic;
  SourceSpan where;
};

struct Robot {
  std::string name;
  std::vector<Link> links;
  std::vector<RobotJoint> joints;  // those with existing links
  std::vector<Paint> paints;
};

// Reads a robot. Reports E6220, W6221; counts skipped elements. Elements outside the format, as
// those of simulators, are skipped.
Robot read_robot(const XmlText& text, meshes::ReaderContext& context);

// Returns the parent joint of each link; kNone: none. No link is below itself. Joints that do not
// fit are reported (E6220) and left out.
std::vector<std::int32_t> tree_of(const Robot& robot, meshes::ReaderContext& context);

}  // namespace panwright::importers::urdf
