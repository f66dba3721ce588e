// State that changes from frame to frame: poses of shared models, transforms of their nodes, and
// the Sun. No OpenGL. The camera is separate: several may look at one world.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "base/result.h"
#include "base/stamp.h"
#include "geometry/kinematics/joint.h"
#include "light/body.h"
#include "light/light.h"
#include "light/stars.h"
#include "pan/model.h"
#include "world/camera.h"

namespace panwright::world {

// Model shared by worlds, renderers and threads. It never changes and lives as long as one of them
// holds it.
using ModelPtr = std::shared_ptr<const pan::Model>;

using light::kSunSineAtOneAu;
using light::Sun;  // its direction in world axes
using panwright::Stamp;

// The transform of a node in its parent: p' = T·R·S·p.
struct NodeTransform {
  Vec3 translation{0};        // metres
  Quat rotation{1, 0, 0, 0};  // unit
  Vec3 scale{1};              // not 0; negative mirrors
  Mat4 matrix() const { return matrix_from_trs(translation, rotation, scale); }
  bool operator==(const NodeTransform&) const = default;
};

// State of a node of one instance that differs from its model.
struct NodeState {
  std::uint32_t node = 0;                  // index in the model
  std::optional<NodeTransform> transform;  // parent_from_node; none: the model's
  bool visible = true;                     // false: hides the node and its descendants
  bool operator==(const NodeState&) const = default;
};

// Values of a joint of one instance that differ from its model.
struct JointState {
  std::uint32_t joint = 0;         // index in the model
  geometry::JointValues values{};  // radians, metres, factors; limits apply when evaluated
  bool aimed = false;              // by aim_at_sun(), which may set it anew
  bool operator==(const JointState&) const = default;
};

// A target: a model, placed.
class Instance {
 public:
  const std::string& name() const { return name_; }
  const ModelPtr& model() const { return model_; }
  const Pose& pose() const { return pose_; }  // world_from_model
  bool visible() const { return visible_; }
  // States that differ from the model, ascending by node.
  std::span<const NodeState> node_states() const { return node_states_; }
  const NodeState* node_state(std::uint32_t node) const;  // null: as in the model

  // States of joints that differ from the model, ascending by joint.
  std::span<const JointState> joint_states() const { return joint_states_; }
  const JointState* joint_state(std::uint32_t joint) const;  // null: as in the model
  // Returns the values of all joints: within limits, followers resolved.
  std::vector<geometry::JointValues> joint_values() const;

  // Changes with the model, the node and joint states and visible(), but not with the pose.
  Stamp shape_stamp() const { return shape_stamp_; }
  Stamp pose_stamp() const { return pose_stamp_; }

 private:
  friend class World;
  std::string name_;
  ModelPtr model_;
  Pose pose_;
  bool visible_ = true;
  std::vector<NodeState> node_states_;
  std::vector<JointState> joint_states_;
  Stamp shape_stamp_ = 0;
  Stamp pose_stamp_ = 0;
};

// Time in which a lamp is on, seconds after that of the frame: begin <= t < end.
struct Pulse {
  double begin = 0;
  double end = 0;  // above begin
  bool operator==(const Pulse&) const = default;
};

// A light beside the Sun, in the frame of what carries it. Irradiance, radiance·sr and intensity/m²
// have the unit of the Sun's irradiance.
struct Lamp {
  enum class Carrier : std::uint8_t {
    world,   // world axes
    camera,  // x right, y down, z along the boresight
    node,    // of a target: moves with its pose, nodes and joints
  };
  light::Source source;  // a light::Sun: a disc at infinity
  Carrier carrier = Carrier::world;
  std::string target;      // of a node
  std::uint32_t node = 0;  // index in its model; its scale moves the lamp, and leaves its radius
  bool on = true;
  std::string name;  // of a lamp of the target's model; empty: none
  // none: all the time. Images of a world ignore it: lamps_during() takes it into account.
  std::optional<Pulse> pulse;
  bool operator==(const Lamp&) const = default;
};

// Any number of targets under one Sun. Copies are cheap (models are shared) and independent; equal
// stamps in copies mean equal states. Setting an equal value changes no stamp. Distinct worlds may
// be used on distinct threads; one world allows many readers or one writer.
class World {
 public:
  // Adds a target at the origin, or at `pose`, with the lamps of its model.
  //
  //   name     not empty; identifies it in options, diagnostics and ids
  //   returns  its index: targets keep theirs until one before them is removed
  // Expects: model is not null and checked(); a finite pose of unit rotation.
  // Fails: E5009 when a target has this name, E5010 beyond kMaxInstances.
  Result<std::size_t> add(std::string name, ModelPtr model, DiagnosticLog& log);
  Result<std::size_t> add(std::string name, ModelPtr model, const Pose& pose, DiagnosticLog& log);
  // Removes a target, and the lamps on it.
  void remove(std::size_t index);

  static constexpr std::size_t kMaxInstances = 4096;

  std::size_t size() const { return instances_.size(); }
  bool empty() const { return instances_.empty(); }
  const Instance& operator[](std::size_t index) const { return instances_[index]; }
  std::span<const Instance> instances() const { return instances_; }
  std::optional<std::size_t> find(std::string_view name) const;
  // find(), with a diagnostic that lists near names. Fails: E5011.
  Result<std::size_t> require(std::string_view name, DiagnosticLog& log) const;

  // Expects, all of these: an index below size(), a node of the model; finite numbers, unit
  // rotations, scales that are not 0.
  void set_pose(std::size_t index, const Pose& world_from_model);
  void set_visible(std::size_t index, bool visible);
  // nullopt: as in the model.
  void set_node_transform(std::size_t index, std::uint32_t node,
                          const std::optional<NodeTransform>& parent_from_node);
  void set_node_visible(std::size_t index, std::uint32_t node, bool visible);
  // nullopt: as in the model. Followers ignore their own values.
  // Expects: also a joint of the model, factors that are not 0.
  void set_joint(std::size_t index, std::uint32_t joint,
                 const std::optional<geometry::JointValues>& values, bool aimed = false);

  // Expects: light::is_sound().
  void set_sun(const Sun& sun);
  const Sun& sun() const { return std::get<Sun>(sun_.source()); }

  static constexpr std::size_t kMaxLamps = 64;
  // Replaces all lamps, those of models too. Lamps whose target or node does not exist, or is
  // hidden, are off.
  // Expects: at most kMaxLamps that are on, all light::is_sound().
  void set_lamps(std::vector<Lamp> lamps);
  std::span<const Lamp> lamps() const { return lamps_; }
  // Expects: an index of lamps().
  void set_lamp_on(std::size_t index, bool on);

  // White: what emission is measured in, the irradiance E0 of L = emissive·E0/π. The Sun does not
  // change it.
  //
  //   white    in the unit of the Sun's irradiance; nullopt: 1, or light::kSolarIrradiance where
  //            that has a unit
  // Expects: numbers that are finite and >= 0.
  void set_white(const std::optional<Vec3>& white);
  const std::optional<Vec3>& given_white() const { return white_; }
  Vec3 white() const;

  // Sets the bodies of the sky, which light targets, eclipse the Sun and stand in the background.
  //
  //   sun_visible  the Sun's own disc is drawn
  // Expects: light::is_sound() bodies.
  void set_sky(std::vector<light::Body> bodies, bool sun_visible);
  std::span<const light::Body> bodies() const { return bodies_; }
  bool sun_visible() const { return sun_visible_; }
  bool has_sky() const { return sun_visible_ || !bodies_.empty(); }
  // Stars stand in the background; they light nothing. Expects: a unit rotation, a velocity below
  // that of light.
  void set_stars(const light::Stars& stars);
  const light::Stars& stars() const { return stars_; }

  Stamp stamp() const { return stamp_; }            // changes with anything
  Stamp sun_stamp() const { return sun_.stamp(); }  // changes with the Sun
  Stamp sky_stamp() const { return sky_stamp_; }    // changes with the bodies

 private:
  NodeState& state_of(Instance& instance, std::uint32_t node);
  void shape_changed(Instance& instance);

  std::vector<Instance> instances_;
  light::Light sun_;
  std::vector<Lamp> lamps_;
  std::optional<Vec3> white_;
  std::vector<light::Body> bodies_;
  bool sun_visible_ = false;
  Stamp stamp_ = kFirstStamp;
  Stamp sky_stamp_ = kFirstStamp;
  light::Stars stars_;
};

}  // namespace panwright::world
