// Blankets of foil over shapes of a scene.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "base/job.h"
#include "mli/wrap.h"
#include "pxn/build/part.h"
#include "scene/scene.h"

namespace panwright::pxn {

// What became of one wish, over all instances that it is about.
struct WornFoil {
  mli::WrapTally tally;
  std::size_t instances = 0;  // with a face that was chosen
  std::size_t coarsened = 0;  // whose cells are larger than the preset asks for
  double largest_cell = 0;    // of those, metres
  std::string problem;        // the first one; empty: none
};

// Makes blankets and hangs them beside what they cover, or below where that has joints, with nodes
// and instances of their own. Wrinkles have their sizes in the world: shapes are wrapped as they
// are stretched there, and the blanket is brought back, so that instances of the same shape and
// stretch share one.
class Blankets {
 public:
  // vertices: of all sheets so far
  Blankets(scene::Scene& scene, double crease_angle, double vertices, const Job& job)
      : scene_(scene), crease_angle_(crease_angle), vertices_(vertices), job_(job) {}

  // Whether an instance is itself a blanket.
  bool is_blanket(std::int32_t instance) const;

  // Covers an instance, which gets a tolerance that keeps its facets below the blanket.
  //
  //   axes_from_world  the frame in which directions of faces are meant
  //   blanket          its name, material and source; node and shape are set here
  //
  // Throws Cancelled.
  void cover(std::int32_t instance, const Blanket& how, const Mat4& axes_from_world,
             std::string name, scene::Instance blanket, WornFoil& out);

 private:
  using Key = std::tuple<std::int32_t, std::array<double, 6>, std::vector<double>,
                         std::vector<std::uint32_t>>;  // shape, metric, blanket, faces
  struct Made {
    std::int32_t shape = scene::kNone;
    double stand_off = 0;  // metres in the world
    double cell = 0;       // above 0: larger than the preset's
    mli::WrapTally tally;
    std::string problem;
  };

  Mat4 world_from(std::int32_t node) const;
  const Made& made(std::int32_t shape, const Blanket& how, const Mat4& world_from_shape,
                   const Mat4& axes_from_shape, bool& any, const scene::Source& source);
  void make(std::int32_t shape, const geometry::Mesh& metres, const Mat3& in_metres,
            const Blanket& how, const std::vector<std::uint32_t>& faces,
            const scene::Source& source, Made& out);

  scene::Scene& scene_;
  double crease_angle_;
  double vertices_;
  const Job job_;
  std::map<Key, Made> known_;
  std::vector<std::int32_t> blankets_;  // instances, ascending
};

}  // namespace panwright::pxn
