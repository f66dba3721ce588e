// Rays over a world: nearest and any hit, what they hit, and the surface there. No OpenGL.
//
//   trace::Scene scene;
//   scene.update(world);
//   scene.place_observer({position, world_from_lidar});
//   std::vector<trace::Hit> hits(rays.size());
//   scene.nearest(rays, hits);
//
// All in double. A ray stays in the frame of its origin; for another target it is transformed into
// that model's frame, forming the difference of the two positions first. So distances between
// targets, to the observer and to the world's origin cost only their own rounding.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/axis_box.h"
#include "base/job.h"
#include "geometry/ray/box_tree.h"
#include "geometry/ray/instances.h"
#include "trace/model.h"
#include "trace/placement.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::trace {

// A ray of unit direction; origin and range in metres. Its frame is that of the observer, or of a
// target's model, for rays that go on from its surface.
struct Ray : geometry::Ray {
  static constexpr std::uint32_t kObserver = ~0u;
  std::uint32_t frame = kObserver;  // else the target's index in the world
};

// The inside of closed meshes without holes: rays pass, as in images; or it stops them, as light.
enum class Insides : std::uint8_t { pass, stop };

// Point at which a ray meets a triangle, of a mesh or of terrain.
struct Hit {
  static constexpr std::uint32_t kGround = ~0u;
  double distance = std::numeric_limits<double>::infinity();  // metres from the origin; inf: none
  std::uint32_t target = 0;                                   // index in the world
  std::uint32_t part = 0;      // of its trace::Model; below the model's instances: the instance;
                               // kGround: its terrain
  std::uint32_t triangle = 0;  // of the part's mesh
  Vec2 barycentric{0};         // weights of the second and third corner, in the triangle
  bool front = true;           // from outside: counter-clockwise in the mesh's frame
  Vec3 direction{0};           // the ray's, unit, in the frame of the target's model
  // of terrain, in that frame: the point, and the normal of its triangle, unit, away from the body
  Vec3 position{0}, normal{0};
  std::uint32_t chart = 0, level = 0, column = 0, row = 0;  // of terrain: the cell

  explicit operator bool() const { return distance < std::numeric_limits<double>::infinity(); }
};

// The numbers of the layers of an image (image/image.h): index + 1, 0: nothing hit.
struct Ids {
  std::uint32_t target = 0;    // in the world
  std::uint32_t node = 0;      // in its model
  std::uint32_t material = 0;  // in its model, of the visible side; at any level the instance's own
  std::uint32_t instance = 0;  // in its model
};

// Surface at a hit, in the frame of the target's model. Its visible side is that of the ray; of
// closed meshes the outside.
struct Surface {
  Vec3 position{0};  // metres, on the triangle to some 1e-15 of the mesh's size
  Vec3 facet{0};     // normal of the triangle, unit, on the visible side
  Vec3 normal{0};    // interpolated, without normal maps, unit, on the visible side; 0: none
  Vec2 texcoord{0};  // 0 0: the mesh has none
};

// State of a target: everything in its model's frame, whatever its pose.
class Target {
 public:
  // footprint: as SceneOptions.
  Target(std::shared_ptr<const Model> model, const world::Instance& instance, double footprint,
         const Job& job);
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  const Model& model() const { return *model_; }
  const std::shared_ptr<const Model>& shared_model() const { return model_; }
  // Visible parts, ascending by instance, and their placements.
  std::span<const std::uint32_t> parts() const { return parts_; }
  std::span<const Placement> placements() const { return placements_; }
  const AxisBox& bounds() const { return bounds_; }  // empty: fully hidden

  // Placement of a visible part.
  const Placement& placement(std::uint32_t part) const {
    return placements_[number_of_[model_->parts()[part].instance]];
  }
  // Returns true for the inside of a closed mesh without holes.
  bool is_inside(const Hit& hit) const {
    return !hit.front && hit.part != Hit::kGround && model_->parts()[hit.part].closed;
  }
  const terrain::Ground* ground() const { return ground_; }  // null: none, or hidden
  // Expects: a hit on its terrain.
  terrain::SmoothGround smooth_ground(const Hit& hit) const;
  terrain::GroundRelief ground_relief(const Hit& hit) const;
  // As Surface::normal; flat: by the triangles' own normals.
  Vec3 normal(const Hit& hit, bool flat) const;
  Surface surface(const Hit& hit) const;

  // Nearest surface to a ray of the model's frame, with the number of the part in parts().
  std::optional<geometry::InstanceHit> closest(const geometry::Ray& ray, Insides insides) const;
  // The same for rays of one origin, as one by one.
  void closest(std::span<const geometry::Ray> rays,
               std::span<std::optional<geometry::InstanceHit>> hits, Insides insides) const;
  bool any(const geometry::Ray& ray, Insides insides) const;

 private:
  geometry::HitFilter filter_of(Insides insides) const;
  static bool hole_filter(const void* target, const geometry::InstanceHit& hit);
  static bool visible_filter(const void* target, const geometry::InstanceHit& hit);

  std::shared_ptr<const Model> model_;
  std::vector<std::uint32_t> parts_;
  std::vector<Placement> placements_;
  std::vector<std::uint32_t> number_of_;  // in parts_, by instance
  geometry::InstanceCaster caster_;
  AxisBox bounds_;
  const terrain::Ground* ground_ = nullptr;
  bool has_holes_ = false;
};

// Tiles of terrain that rays of a beam may meet, by target.
class GroundBeams {
 private:
  friend class Scene;
  std::vector<std::optional<terrain::GroundBeam>> beams_;
};

struct SceneOptions {
  // Metres, of a pixel or a beam on the targets: instances have the level of detail for it, as
  // images do. 0: their own meshes, the finest.
  double footprint = 0;
  // Terrain of pan files is there, in the frame of their models. Else it is left out.
  bool ground = false;
};

// Counts of what was built so far.
struct Work {
  std::uint64_t models = 0;  // search trees of all meshes of a model
  std::uint64_t shapes = 0;  // placements of a target's meshes and the tree over them
  std::uint64_t poses = 0;   // a target's place in the world
};

// The targets of a world, and an observer among them.
//
// Joints, moved and hidden nodes are those of the world. Where a texture cuts holes, rays pass;
// decals are no surfaces. At equal distances the lower target wins, then the lower instance and
// triangle. Rays are answered from any thread while nothing is updated.
//
// Structures are kept by model and stamps: a model's meshes while another owner holds the model, a
// target's placements and pose while they are in the world of the last update. Answers depend on
// the world, the options and the ray alone.
class Scene {
 public:
  // Target of the world, placed.
  struct Placed {
    std::shared_ptr<const Target> target;
    RigidFrame frame;
    Affine from_observer;  // to the model's frame
  };

  explicit Scene(const SceneOptions& options = {}) : options_(options) {}

  // Builds what is missing. The observer stays; at first it is the world's frame.
  //
  // Expects: models kept alive by their pointers. Throws Cancelled: may be called again then.
  // Cost: O(T log T) for new models, about 200 bytes a triangle; O(parts) for targets whose nodes
  // or joints changed.
  void update(const world::World& world, const Job& job = {});
  //
  //   ground_angle  radians: of terrain all rays see the levels for this angle at the observer
  //                 (terrain::Ground::levels()); 0: the finest
  // Expects: finite, a unit rotation. Cost: O(targets); with an angle O(tiles).
  void place_observer(const world::Pose& world_from_observer, double ground_angle = 0);

  // One for each target of the world, hidden ones too.
  std::span<const Placed> targets() const { return targets_; }
  // Indices of the targets with visible parts or terrain, ascending.
  std::span<const std::uint32_t> visible() const { return visible_; }
  const RigidFrame& observer() const { return observer_; }
  // Reports damaged tiles of terrain that rays have met, once each: W9615.
  void report_damaged(DiagnosticLog& log) const;
  const Work& work() const { return work_; }

  // Returns the nearest hit within the ray's range, both ends included; none: an infinite distance.
  // Expects: a finite ray of unit direction; a frame of the world. Cost: O(log T), expected.
  Hit nearest(const Ray& ray, Insides insides = Insides::pass) const;
  // The same of terrain alone.
  Hit nearest_ground(const Ray& ray, const GroundBeams* beams = nullptr) const;
  // The same of rays of one beam and frame, as terrain::Ground::nearest() of several.
  void nearest_ground(std::span<const Ray> rays, std::span<Hit> hits,
                      const GroundBeams& beams) const;
  // Prepares answers to the rays of a beam of a frame as Ray::frame, which are quicker then.
  //
  // Expects: used before the next update.
  GroundBeams ground_beams(const terrain::RayBeam& rays, std::uint32_t frame) const;
  // Returns whether a ray meets the terrain of a target.
  bool meets_ground(std::uint32_t target, const Ray& ray) const;
  // Returns true if nearest() has a hit, faster.
  bool any(const Ray& ray, Insides insides = Insides::pass,
           const GroundBeams* beams = nullptr) const;

  // The same for many rays on the threads of a job, as one by one.
  //
  //   hits, found  R, one for each ray; found: 0 or 1
  // Expects: as many as rays. Throws Cancelled; some are set then.
  void nearest(std::span<const Ray> rays, std::span<Hit> hits, Insides insides = Insides::pass,
               const Job& job = {}) const;
  void any(std::span<const Ray> rays, std::span<std::uint8_t> found,
           Insides insides = Insides::pass, const Job& job = {}) const;

  // The same for a bundle: rays of the observer, of one origin and range, on this thread, as one by
  // one; faster where their directions are similar.
  void nearest_bundle(std::span<const Ray> rays, std::span<Hit> hits,
                      Insides insides = Insides::pass) const;

  // Expects, all of these: a hit of this scene, before the next update.
  //
  // Returns its node in its model: of terrain the root.
  std::uint32_t node_of(const Hit& hit) const {
    if (hit.part == Hit::kGround) return 0;
    return targets_[hit.target].target->model().parts()[hit.part].node;
  }
  bool is_inside(const Hit& hit) const { return targets_[hit.target].target->is_inside(hit); }
  Surface surface(const Hit& hit) const { return targets_[hit.target].target->surface(hit); }
  // Ids of a hit, or 0 of none.
  Ids ids(const Hit& hit) const;
  // Returns the map from a target's model to the observer's frame.
  Affine observer_from(std::uint32_t target) const {
    return between(observer_, targets_[target].frame);
  }

 private:
  std::shared_ptr<const Model> model_of(const world::ModelPtr& model, const Job& job);
  void place_targets();
  void meet_ground(std::uint32_t target, const geometry::Ray& ray, const GroundBeams* beams,
                   Hit& best, double& limit) const;
  static void set_ground(std::uint32_t target, const Vec3& direction,
                         const std::optional<terrain::GroundHit>& hit, Hit& best, double& limit);
  bool is_blocked_by_ground(std::uint32_t target, const geometry::Ray& ray,
                            const GroundBeams* beams) const;
  static const terrain::GroundBeam* beam_of(const GroundBeams* beams, std::uint32_t target);
  Hit closest(const Ray& ray, Insides insides) const;
  void closest_of_bundle(std::span<const Ray> rays, std::span<Hit> hits) const;
  geometry::Ray local(const Ray& ray, std::uint32_t target) const;
  template <class Look>
  void visit(const Ray& ray, const double& limit, const Look& look) const;

  SceneOptions options_;
  std::unordered_map<const pan::Model*, std::shared_ptr<const Model>> models_;
  std::unordered_map<world::Stamp, std::shared_ptr<const Target>> states_;  // by shape stamp
  std::unordered_map<world::Stamp, RigidFrame> frames_;                     // by pose stamp
  std::vector<Placed> targets_;
  std::vector<std::uint32_t> visible_;
  RigidFrame observer_;
  double ground_angle_ = 0;
  std::vector<std::optional<terrain::GroundLevels>> ground_levels_;  // one for each target
  geometry::BoxTree tree_;  // of the visible targets, world axes about the observer
  Work work_;
};

// Half the angle between rays of neighbouring pixels, or less: of terrain the levels for it are
// those of images (Scene::place_observer()). 0: parallel rays.
double half_pixel(const world::Camera& camera);

}  // namespace panwright::trace
