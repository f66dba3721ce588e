// World, ready for rays. Private to preview/reference.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/axis_box.h"
#include "base/job.h"
#include "geometry/ray/box_tree.h"
#include "geometry/ray/instances.h"
#include "preview/reference/internal/placement.h"
#include "preview/reference/internal/trace_model.h"
#include "preview/reference/reference.h"
#include "world/world.h"

namespace panwright::preview::reference {

// State of a target: everything in its model's frame, whatever its pose.
class TraceTarget {
 public:
  TraceTarget(std::shared_ptr<const TraceModel> model, const world::Instance& instance,
              const Job& job);
  TraceTarget(const TraceTarget&) = delete;
  TraceTarget& operator=(const TraceTarget&) = delete;

  const TraceModel& model() const { return *model_; }
  // Visible parts, ascending, and their placements; numbered as hits are.
  std::span<const std::uint32_t> parts() const { return parts_; }
  std::span<const Placement> placements() const { return placements_; }
  const AxisBox& bounds() const { return bounds_; }  // empty: fully hidden

  // Returns the nearest surface, except holes; the inside of closed meshes counts, unless by a
  // camera.
  std::optional<geometry::InstanceHit> closest(const geometry::Ray& ray, bool by_camera) const;
  bool any(const geometry::Ray& ray) const;

  bool is_inside(const geometry::InstanceHit& hit) const {
    return !hit.front && model_->parts()[parts_[hit.instance]].closed;
  }
  Point point(const geometry::InstanceHit& hit, bool flat) const {
    return model_->point(parts_[hit.instance], placements_[hit.instance], hit, flat);
  }
  Vec3 normal(const geometry::InstanceHit& hit, bool flat) const {
    return model_->normal(parts_[hit.instance], placements_[hit.instance], hit, flat);
  }

 private:
  static bool hole_filter(const void* target, const geometry::InstanceHit& hit);
  static bool camera_filter(const void* target, const geometry::InstanceHit& hit);

  std::shared_ptr<const TraceModel> model_;
  std::vector<std::uint32_t> parts_;
  std::vector<Placement> placements_;
  geometry::InstanceCaster caster_;
  AxisBox bounds_;
  bool has_holes_ = false;
};

// Ray in the frame of a target's model, or of the camera.
struct TraceRay {
  static constexpr std::uint32_t kCamera = ~0u;
  std::uint32_t frame = kCamera;  // into the scene's targets
  geometry::Ray ray;              // unit direction
};

struct TraceHit {
  std::uint32_t target = 0;  // into the scene's targets
  geometry::InstanceHit hit;
  Vec3 direction{0};  // the ray's, in the frame of the target's model
};

// Visible targets, and a camera among them.
//
// Rays stay in the frame of their origin. For another target they are transformed into its model's
// frame, forming the difference of the two positions first. So distances between targets, to the
// camera and to the world's origin cost only their own rounding. Points of a target are exact in
// its own frame.
class TraceScene {
 public:
  // Placed target: its state and its pose.
  struct Placed {
    std::shared_ptr<const TraceTarget> target;
    RigidFrame frame;
    std::uint32_t index = 0;  // in the world
    Affine from_camera;       // to the model's frame
  };

  // Updates to a world: parts with unchanged stamps stay.
  void update(const world::World& world, const Job& job);
  // Sets the camera; after update().
  void place_camera(const world::Camera& camera);

  std::span<const Placed> targets() const { return targets_; }
  const RigidFrame& camera() const { return camera_; }
  const ReferenceWork& work() const { return work_; }

  // Returns the hit visible to the camera: not the insides of closed meshes, and through holes.
  std::optional<TraceHit> seen(const TraceRay& ray) const;
  // Returns the nearest surface, except holes; insides of closed meshes count.
  std::optional<TraceHit> closest(const TraceRay& ray) const;
  bool any(const TraceRay& ray) const;

  bool is_inside(const TraceHit& hit) const {
    return targets_[hit.target].target->is_inside(hit.hit);
  }
  Point point(const TraceHit& hit, bool flat) const {
    return targets_[hit.target].target->point(hit.hit, flat);
  }

 private:
  std::shared_ptr<const TraceModel> model_of(const world::ModelPtr& model, const Job& job);
  std::optional<TraceHit> nearest(const TraceRay& ray, bool by_camera) const;
  geometry::Ray local(const TraceRay& ray, std::uint32_t target) const;
  template <class Look>
  void visit(const TraceRay& ray, const double& limit, const Look& look) const;

  std::unordered_map<const pan::Model*, std::shared_ptr<const TraceModel>> models_;
  std::unordered_map<world::Stamp, std::shared_ptr<const TraceTarget>> states_;  // by shape stamp
  std::unordered_map<world::Stamp, RigidFrame> frames_;                          // by pose stamp
  std::vector<Placed> targets_;
  RigidFrame camera_;
  geometry::BoxTree tree_;  // of the targets, world axes about the camera
  ReferenceWork work_;
};

}  // namespace panwright::preview::reference
