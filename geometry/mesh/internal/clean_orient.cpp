#include "geometry/mesh/internal/clean_orient.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/axis_box.h"
#include "base/parallel.h"
#include "base/random.h"
#include "geometry/internal/limits.h"
#include "geometry/internal/triangle.h"
#include "geometry/ray/instances.h"

namespace panwright::geometry {

namespace {

// of area · radius: cones about the centroid that suggest inside out. A hemisphere has 0.5.
constexpr double kInsideOut = 0.05;
// of all open components together, and of one
constexpr std::uint64_t kRays = 400'000;
constexpr std::uint64_t kMostRays = 512;
constexpr std::uint64_t kFewestRays = 32;
// how many times more rays must see the back than the front
constexpr double kMajority = 1.5;

// Sums over one component, with the windings that the flood gave.
struct Sums {
  Vec3 moment{0};  // area · centroid, about the mesh's centre
  double area = 0;
  double flipped_area = 0;
  double volume = 0;  // · 6, of cones from the mesh's centre
  Vec3 cross{0};      // 2 · area vector
  AxisBox box;
};

class Orienter {
 public:
  Orienter(const Mesh& mesh, std::span<const std::uint32_t> unique_position, const Edges& edges)
      : mesh_(mesh), unique_position_(unique_position), edges_(edges) {}

  Orientation run() {
    const std::size_t count = mesh_.triangles.size();
    out_.component_of.assign(count, kNone);
    out_.flip.assign(count, 0);
    for (std::uint32_t i = 0; i < count; ++i)
      if (out_.component_of[i] == kNone) flood(i);
    for (std::uint32_t i = 0; i < count; ++i)
      if (out_.components[out_.component_of[i]].one_sided) out_.flip[i] = 0;
    measure_pieces();
    std::vector<char> turn(out_.components.size(), 0);
    std::vector<std::uint32_t> ambiguous;
    for (std::uint32_t p = 0; p < out_.components.size(); ++p) decide(p, turn, ambiguous);
    ask_rays(ambiguous, turn);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t p = out_.component_of[i];
      out_.flip[i] = out_.flip[i] != turn[p];
      out_.components[p].flipped += out_.flip[i] ? 1 : 0;
    }
    return std::move(out_);
  }

 private:
  std::uint32_t from(std::uint32_t half_edge) const {
    return unique_position_[mesh_.triangles[half_edge / 3][half_edge % 3]];
  }

  void flood(std::uint32_t seed) {
    const auto p = static_cast<std::uint32_t>(out_.components.size());
    Component component;
    component.first = seed;
    out_.component_of[seed] = p;
    waiting_.assign(1, seed);
    while (!waiting_.empty()) {
      const std::uint32_t t = waiting_.back();
      waiting_.pop_back();
      ++component.triangles;
      for (std::uint32_t half_edge = 3 * t; half_edge < 3 * t + 3; ++half_edge) {
        const std::uint32_t twin = edges_.twin[half_edge];
        if (twin >= Edges::kNonManifold) {
          component.closed = false;
          continue;
        }
        const bool alike = edges_.misoriented > 0 && from(half_edge) == from(twin);
        const char flip = out_.flip[t] != (alike ? 1 : 0);
        const std::uint32_t other = twin / 3;
        if (out_.component_of[other] == kNone) {
          out_.component_of[other] = p;
          out_.flip[other] = flip;
          waiting_.push_back(other);
        } else if (out_.flip[other] != flip) {
          component.one_sided = true;
        }
      }
    }
    out_.components.push_back(component);
  }

  std::array<Vec3, 3> corners(std::uint32_t triangle) const {
    const Triangle& t = mesh_.triangles[triangle];
    return {mesh_.positions[t[0]] - centre_, mesh_.positions[t[1]] - centre_,
            mesh_.positions[t[2]] - centre_};
  }

  void measure_pieces() {
    AxisBox box;
    for (const Vec3& p : mesh_.positions) box.add(p);
    if (!mesh_.positions.empty()) centre_ = box.centre();
    sums_.resize(out_.components.size());
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      Sums& sum = sums_[out_.component_of[i]];
      const auto [a, b, c] = corners(i);
      const Vec3 cross = glm::cross(b - a, c - a);
      const double area = 0.5 * glm::length(cross);
      const double sign = out_.flip[i] ? -1 : 1;
      sum.area += area;
      sum.flipped_area += out_.flip[i] ? area : 0;
      sum.moment += (area / 3) * (a + b + c);
      sum.cross += sign * cross;
      sum.volume += sign * glm::dot(a, cross);
      for (const Vec3& p : {a, b, c}) sum.box.add(p);
    }
  }

  // Closed components by their volume; open ones as most of their area was written, unless rays
  // decide otherwise.
  void decide(std::uint32_t p, std::vector<char>& turn, std::vector<std::uint32_t>& ambiguous) {
    Component& component = out_.components[p];
    const Sums& sum = sums_[p];
    component.area = sum.area;
    if (component.one_sided || !(sum.area > 0)) return;
    const double radius = 0.5 * sum.box.diagonal();
    // cones from the component's own centroid: what the mesh's centre adds to an open one is not
    // its own
    const double cones = (sum.volume - glm::dot(sum.moment / sum.area, sum.cross)) / 6;
    const double scale = sum.area * radius;
    if (component.closed) {
      turn[p] = cones < -1e-12 * scale;
      // a sheet folded onto itself has no inside
      if (std::fabs(cones) <= 1e-12 * scale) turn[p] = 2 * sum.flipped_area > sum.area;
      return;
    }
    turn[p] = 2 * sum.flipped_area > sum.area;
    if ((turn[p] ? -cones : cones) < -kInsideOut * scale) ambiguous.push_back(p);
  }

  void ask_rays(const std::vector<std::uint32_t>& ambiguous, std::vector<char>& turn) {
    if (ambiguous.empty()) return;
    std::vector<std::vector<std::uint32_t>> triangles(ambiguous.size());
    std::vector<std::uint32_t> place_of(out_.components.size(), kNone);
    for (std::uint32_t i = 0; i < ambiguous.size(); ++i) place_of[ambiguous[i]] = i;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (const std::uint32_t i = place_of[out_.component_of[t]]; i != kNone)
        triangles[i].push_back(t);
    InstanceCaster caster;
    caster.add(caster.add_mesh(mesh_.positions, mesh_.triangles), Mat4(1), false);
    caster.build();
    const std::uint64_t rays = std::clamp<std::uint64_t>(
        kRays / static_cast<std::uint64_t>(ambiguous.size()), kFewestRays, kMostRays);
    std::vector<char> inside_out(ambiguous.size(), 0);
    parallel_for(ambiguous.size(), [&](std::size_t i) {
      inside_out[i] = shows_its_back(triangles[i], ambiguous[i], rays, turn, caster);
    });
    for (std::size_t i = 0; i < ambiguous.size(); ++i)
      if (inside_out[i]) turn[ambiguous[i]] ^= 1;
  }

  // Which side faces outwards, by rays from points on the component, evenly by area.
  bool shows_its_back(const std::vector<std::uint32_t>& triangles, std::uint32_t component,
                      std::uint64_t rays, const std::vector<char>& turn,
                      const InstanceCaster& caster) const {
    std::vector<double> areas;
    double total = 0;
    for (const std::uint32_t t : triangles) {
      const auto [a, b, c] = corners(t);
      areas.push_back(total += glm::length(glm::cross(b - a, c - a)));
    }
    const double size = sums_[component].box.diagonal();
    double front = 0;
    double back = 0;
    for (std::uint32_t r = 0; r < rays; ++r) {
      const auto first = philox({r, 0, 0, 0}, {component, 0x0f1e});
      const auto second = philox({r, 1, 0, 0}, {component, 0x0f1e});
      const auto at = std::lower_bound(areas.begin(), areas.end(), total * in_unit(first[0]));
      const std::uint32_t t = triangles[static_cast<std::size_t>(
          std::min<std::ptrdiff_t>(at - areas.begin(), std::ssize(areas) - 1))];
      const auto [a, b, c] = corners(t);
      const double root = std::sqrt(in_unit(first[1]));
      const double v = root * in_unit(first[2]);
      const Vec3 point = centre_ + a + (root - v) * (b - a) + v * (c - a);
      const double z = 2 * in_unit(second[0]) - 1;
      const auto turnabout = det::sincos(2 * kPi * in_unit(second[1]));
      const double across = std::sqrt(std::max(0.0, 1 - z * z));
      const Vec3 direction(across * turnabout.cos, across * turnabout.sin, z);
      const Vec3 normal = glm::cross(b - a, c - a);
      const double length = glm::length(normal);
      if (!(length > 0)) continue;
      const double cosine =
          glm::dot(normal, direction) / length * (out_.flip[t] != turn[component] ? -1 : 1);
      // a start of 1e-5 of the component keeps clear of the surface itself
      if (caster.any({point, direction, 1e-5 * size})) continue;
      (cosine > 0 ? front : back) += std::fabs(cosine);
    }
    return back > kMajority * front;
  }

  const Mesh& mesh_;
  std::span<const std::uint32_t> unique_position_;
  const Edges& edges_;
  Orientation out_;
  std::vector<Sums> sums_;
  std::vector<std::uint32_t> waiting_;
  Vec3 centre_{0};
};

}  // namespace

Orientation orientation_of(const Mesh& mesh, std::span<const std::uint32_t> unique_position,
                           const Edges& edges) {
  return Orienter(mesh, unique_position, edges).run();
}

}  // namespace panwright::geometry
