// Blankets of foil over shapes of a scene.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/job.h"
#include "base/work_cache.h"
#include "mli/corners.h"
#include "mli/wrap.h"
#include "pxn/reader/kept_foil.h"
#include "pxn/reader/obstacles.h"
#include "pxn/reader/part.h"
#include "pxn/text/reporter.h"
#include "scene/scene.h"

namespace panwright::pxn {

// Request for blankets over some instances.
struct FoilWish {
  std::vector<std::pair<std::int32_t, std::string>> on;  // and their blankets' names
  Blanket how;
  Mat4 axes_from_world{1};  // frame of the directions of faces
  std::string faces;        // these directions as written
  scene::Instance blanket;  // material and source
  // materials of tape and of cut edges
  std::int32_t tape = scene::kNone, edge = scene::kNone;
  SourceSpan where;
  const xml::Document* document = nullptr;
  std::uint32_t element = 0;  // requests of one element are reported together
};

// Returns the message about an element's blankets of this many triangles, with cells of at least
// `cell` metres; empty: nothing.
std::string many_triangles(double triangles, double cell);

// Maker of blankets: adds them beside the covered instances, or below joints, with nodes and
// instances of their own. Wrinkles have their sizes in the world: shapes are wrapped at world
// scale, and the blanket is transformed back. Instances of the same shape and stretch share one,
// unless other parts are in the way.
class Blankets {
 public:
  // vertices: of all sheets so far; cache: null: none
  Blankets(scene::Scene& scene, double crease_angle, double vertices, const WorkCache* cache,
           const Job& job)
      : scene_(scene), crease_angle_(crease_angle), vertices_(vertices), cache_(cache), job_(job) {}

  void wish(FoilWish wish) { wishes_.push_back(std::move(wish)); }

  // Fulfils all requests in a complete scene. Covered instances get a tolerance that keeps their
  // facets below the blanket. Reports E7001, W7002, W1501. Throws Cancelled.
  void make(std::uint64_t most_nodes, Reporter& reporter);

 private:
  using Key = std::tuple<std::int32_t, std::array<double, 6>, std::vector<double>,
                         std::vector<std::uint32_t>>;  // shape, metric, blanket, faces
  struct Made {
    std::int32_t shape = scene::kNone;
    // shapes of tape and of cut edges
    std::int32_t tape = scene::kNone, edge = scene::kNone;
    double stand_off = 0;  // metres in the world
    double across = 0;     // diagonal of the shape, metres
    double cell = 0;       // above 0: larger than the preset's
    double used_cell = 0;  // metres
    std::size_t triangles = 0;
    bool cornered = false;  // lower at places beside another shape's blanket
    mli::WrapTally tally;
    std::string problem;
    // if others may share it: its vertices and the places below them, in metres_of(metric)
    struct Reach {
      std::vector<Vec3> tops, roots;
      Asked asked;
    };
    std::shared_ptr<const Reach> reach;
  };
  // Results of one element's requests.
  struct Worn {
    const FoilWish* wish = nullptr;
    mli::WrapTally tally;
    std::size_t asked = 0;      // instances
    std::size_t instances = 0;  // with a chosen face
    std::size_t coarsened = 0;  // with larger cells than the preset's
    double largest_cell = 0;    // of those, metres
    double triangles = 0;       // of new blankets
    double finest_cell = 0;     // of all, metres
    double enough = 0;          // metres of stand-off that keep all heights
    double stand_off = 0;       // the given one where it exceeds the size of a shape, metres
    double across = 0;          // diagonal of the shape, metres
    std::string problem;        // the first one; empty: none
  };
  // Instance being covered.
  struct Place {
    std::int32_t instance;
    Mat4 world_from_shape, axes_from_shape;
  };

  Mat4 world_from(std::int32_t node) const;
  void share_triangles();
  void cover(std::int32_t instance, const std::string& name, const FoilWish& wish, Worn& worn);
  std::optional<Made> made(const Place& place, const FoilWish& wish, bool& any);
  Made woven(const Place& place, const Surroundings& around, const Mat3& in_metres,
             const FoilWish& wish, double stand_off);
  std::optional<WovenFoil> wrapped(const Place& place, const Surroundings& around,
                                   const Mat3& in_metres, const mli::RecipeFor& recipe,
                                   mli::WrapOptions options, DiagnosticLog& log);
  mli::FreeRoom room_of(const Place& place, const Mat3& in_metres, double stand_off) const;
  mli::OtherCorners corners_of(const Place& place, const Mat3& in_metres) const;
  void find_corners();
  bool is_clear(const Made& made, const Surroundings& around, const mli::FreeRoom& room,
                const mli::OtherCorners& others);
  void hang(std::int32_t node, std::string name, scene::Instance what);
  std::int32_t add_shape(FoilMeshes::Part& part, scene::Foil foil);
  static void tell(const std::vector<Worn>& worn, Reporter& reporter);
  static void tell_cells(const std::vector<Worn>& worn, Reporter& reporter);

  scene::Scene& scene_;
  double crease_angle_;
  double vertices_;
  const WorkCache* cache_;
  const Job job_;
  std::vector<FoilWish> wishes_;
  std::map<Key, Made> known_;      // with nothing in the way
  std::vector<std::size_t> uses_;  // of shapes, by instances
  std::optional<Obstacles> obstacles_;
  mli::Corners corners_;   // faces with blankets, in the world, by instance
  double least_cell_ = 0;  // metres, of blankets without an own one
};

}  // namespace panwright::pxn
