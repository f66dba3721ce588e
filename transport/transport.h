// Light that the surfaces of a world send one another, by surfels. No OpenGL.
//
//   transport::Transport transport;
//   transport.update(world, lamps);
//   transport.light();  // for preview::RenderOptions::indirect
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/job.h"
#include "base/stamp.h"
#include "base/work_cache.h"
#include "light/ground_shine.h"
#include "light/light.h"
#include "light/surfels.h"
#include "trace/scene.h"
#include "transport/lists.h"
#include "transport/reflectance.h"
#include "transport/surfels.h"
#include "world/camera.h"
#include "world/world.h"

namespace panwright::transport {

struct TransportOptions {
  SurfelOptions surfels;
  unsigned bounces = 8;
};

// Interreflections among the targets of a world. The Sun's light leaves lobes along their mirrored
// directions (Reflectance::lobe); all surfaces are diffuse after that, and to other light.
//
// Visibility among surfels depends on shapes and on targets close by alone, and is kept until these
// change. Light of the Sun, of bodies, terrain and lamps reaches surfels by shadow rays when it
// changes. Nothing depends on a camera, on threads or on former worlds: the same bits.
class Transport {
 public:
  // cache: of transport lists of targets that stand alone; null: none. It outlives this.
  explicit Transport(const TransportOptions& options = {}, const WorkCache* cache = nullptr)
      : options_(options), cache_(cache) {}

  // Finds the light of a world.
  //
  //   lamps   in world axes (world/lamps.h)
  //   ground  light of terrain on each target (preview::GroundLayer::shine()); empty: none
  // Throws Cancelled: may be called again then. Cost: for a new shape some million rays; for other
  // light some ten thousand.
  void update(const world::World& world, std::span<const light::Source> lamps,
              std::span<const light::GroundShine> ground = {}, const Job& job = {});

  // Of each target of the world, in its model's frame.
  std::span<const light::SurfelLight> light() const { return light_; }
  // Light that interreflections add to an image, and all that it shows: sums over solid angles
  // (areas, of parallel rays) of radiance and of its square.
  struct Change {
    double added = 0, added_square = 0;
    double flux = 0, square = 0;
    // shares of the image
    double of_flux() const { return flux > 0 ? added / flux : added > 0 ? 1 : 0; }
    double rms() const {
      return square > 0 ? std::sqrt(added_square / square) : added_square > 0 ? 1 : 0;
    }
  };
  // Estimates it from surfels that face a camera, as if nothing stood before them and all sent
  // evenly; means of the channels. 0: none faces it. Expects: update() of the same world.
  Change change_seen(const world::World& world, const world::Camera& camera) const;
  // Surfels of a target. Expects: visible.
  const SurfelSet& surfels(std::uint32_t target) const {
    return *slots_[slot_of_[target]].shape->set;
  }
  const TransportLists& lists(std::uint32_t target) const {
    return *slots_[slot_of_[target]].lists;
  }

  // Counts of work so far.
  struct Counts {
    std::uint64_t shapes = 0;  // surfels placed
    std::uint64_t lists = 0;   // traced
    std::uint64_t kept = 0;    // lists from the cache
    std::uint64_t lights = 0;  // of all targets
  };
  const Counts& counts() const { return counts_; }

 private:
  // A target's surfels in one shape.
  struct Shape {
    std::shared_ptr<const trace::Target> target;
    std::unique_ptr<const SurfelSet> set;
    std::vector<ModelReflectance::At> surfaces;  // of the surfels, tints averaged
    std::shared_ptr<const ModelReflectance> reflectance;
    std::vector<std::uint8_t> glossy;  // of the surfels: Reflectance::is_glossy
    std::shared_ptr<const light::SurfelGrid> grid;
  };
  using ShapePtr = std::shared_ptr<const Shape>;
  struct Slot {
    std::uint32_t target = 0;
    Stamp shape_stamp = 0;
    ShapePtr shape;
    std::vector<std::uint64_t>
        near;  // shape and pose stamps of it and of targets close by; lists depend on them
    std::shared_ptr<const TransportLists> lists;
    std::vector<std::array<float, 2>>
        sent;  // of its surfels: radiosity, and what of it is indirect
  };

  void place(const world::World& world, const Job& job);
  ShapePtr make_shape(std::uint32_t target, const Job& job);
  void find_light(const world::World& world, std::span<const light::Source> lamps,
                  std::span<const light::GroundShine> ground, const Job& job);
  bool trace_lists(const world::World& world, const Job& job);
  TransportLists kept_lists(const Slot& slot, std::span<const SurfelSet* const> sets, bool alone,
                            const Job& job);

  TransportOptions options_;
  const WorkCache* cache_;
  std::optional<trace::Scene> scene_;
  std::unordered_map<const trace::Model*, std::shared_ptr<const ModelReflectance>> reflectances_;
  std::vector<std::uint32_t> slot_of_;  // by target; ~0u: hidden
  std::vector<Slot> slots_;
  std::vector<light::SurfelLight> light_;
  Stamp stamp_ = 0;                    // of the world of the last update
  std::vector<std::uint64_t> stamps_;  // of what lights depend on
  Vec3 white_{0};
  std::vector<light::Source> lamps_;
  std::vector<Stamp> ground_;  // of its light
  Counts counts_;
};

}  // namespace panwright::transport
