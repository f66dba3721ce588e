// Surfels of a target: pieces of its surfaces, and points spread evenly over each. No OpenGL.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/math.h"
#include "light/surfels.h"
#include "trace/scene.h"

namespace panwright::transport {

// A point of a surface, on one of its sides. Model frame, metres.
struct Point {
  Vec3 start{0};           // of rays: past the mesh's error towards the side
  Vec3 normal{0};          // of the triangle, unit, on the side
  std::uint32_t part = 0;  // of the trace::Model
  std::uint32_t triangle = 0;
  Vec2 barycentric{0};
  bool back = false;  // of an open mesh
  double free = 0;    // metres along the normal to the next surface of the target
};

struct SurfelOptions {
  std::uint32_t surfels = 8192;  // of a target, about
  std::uint32_t points = 32;     // of a surfel, on average
};

// Key of a surfel: a cube of the mesh's frame, in metres, the side and the axis nearest to
// the normal. Cubes close to other surfaces are halved, up to twice.
struct SurfelKey {
  std::uint32_t part = 0;
  std::uint8_t level = 0;
  std::uint8_t side = 0;
  std::uint8_t direction = 0;
  std::array<std::int32_t, 3> cube{};
  auto operator<=>(const SurfelKey&) const = default;
};

// Surfels of a target in one shape. Where a plate passes a cube, the points on its two sides are
// surfels of their own, which have limits. Fixed by its meshes and options: the same bits always.
//
// Points are spread over all sides by their areas, so that each stands for the same area; those of
// a surfel follow one another. What lies on another surface, as a panel
// under foil, or within a closed part has none.
class SurfelSet {
 public:
  // Expects: a target of the scene. Throws Cancelled. Cost: O(T), two rays a point, 16 rays a
  // surfel that find how far other surfaces are, and one each to its neighbours.
  SurfelSet(const trace::Scene& scene, std::uint32_t target, const SurfelOptions& options,
            const Job& job);

  std::span<const light::Surfel> surfels() const { return surfels_; }
  std::span<const Point> points() const { return points_; }
  // Of a surfel: [first(s), first(s + 1)).
  std::uint32_t first(std::size_t surfel) const { return first_[surfel]; }
  double spacing() const { return spacing_; }  // metres, of the widest
  double area() const { return area_; }        // m², of all sides
  double area(std::size_t surfel) const;       // m²
  // Returns the surfel at a hit on this target; none: on a piece without points,
  // or behind a plate from all points of its cube.
  std::optional<std::uint32_t> find(const trace::Hit& hit) const;

 private:
  struct Part;
  SurfelKey key_of(std::uint32_t part, std::uint32_t triangle, const Vec2& barycentric, bool back,
                   std::uint8_t level) const;
  Point point_at(double place, double u, double v) const;
  std::optional<double> free_above(const Point& point) const;
  void measure();
  void spread(std::uint64_t count, std::uint8_t level, std::vector<std::pair<SurfelKey, Point>>& to,
              const Job& job) const;
  void choose_levels(const trace::Scene& scene, std::uint32_t target,
                     std::vector<std::pair<SurfelKey, Point>> all, std::uint64_t most,
                     const Job& job);
  std::uint8_t level_of(const SurfelKey& coarse) const;
  std::optional<std::uint32_t> nearest_part(std::uint32_t begin, std::uint32_t end,
                                            const Vec3& place) const;
  void gather(std::vector<std::pair<SurfelKey, Point>> all, const Job& job);
  void add(const SurfelKey& key, std::span<const Point> points);

  const trace::Target& target_;
  std::vector<std::uint32_t> parts_;       // of the target, by ends_
  std::vector<double> ends_;               // cumulated areas of sides of triangles, m²
  std::vector<std::uint32_t> first_side_;  // of parts, in ends_
  bool by_part_ = true;                    // false: surfels may hold several parts
  double area_ = 0;
  double spacing_ = 0;
  std::vector<SurfelKey> coarse_;     // ascending
  std::vector<std::uint8_t> levels_;  // of them
  std::vector<SurfelKey> keys_;       // of the surfels, ascending; the same for parts of a cube
  std::vector<light::Surfel> surfels_;
  std::vector<double> weights_;  // share of the area of each
  std::vector<std::uint32_t> first_;
  std::vector<Point> points_;
};

// Returns what is left of a number beyond the next lower whole one.
inline double fraction(double x) { return x - std::floor(x); }
// Returns a direction about a normal, of density cosθ/π. u, v: in [0, 1).
Vec3 cosine_direction(const Vec3& normal, double u, double v);

}  // namespace panwright::transport
