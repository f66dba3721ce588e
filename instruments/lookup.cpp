#include "instruments/lookup.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "instruments/internal/nearest.h"
#include "labels/compute.h"

namespace panwright::instruments {

namespace {

constexpr std::size_t kLookupsAtOnce = 256;  // of a thread

template <class Answer>
void for_each_lookup(std::size_t count, const Job& job, const Answer& answer) {
  const auto some = [&](std::size_t chunk) {
    const std::size_t end = std::min(count, (chunk + 1) * kLookupsAtOnce);
    for (std::size_t i = chunk * kLookupsAtOnce; i < end; ++i) answer(i);
  };
  parallel_for((count + kLookupsAtOnce - 1) / kLookupsAtOnce, some, job);
}

}  // namespace

struct Lookups::Impl {
  world::World world;
  trace::Scene scene{{0, true}};  // its observer stays the world's frame
  NearestSearch search;

  // A hit of a ray that began at the world's origin or elsewhere in its axes.
  SurfacePoint point_of(const trace::Hit& hit) const {
    if (!hit) return {};
    const trace::Surface surface = scene.surface(hit);
    const trace::RigidFrame& frame = scene.targets()[hit.target].frame;
    SurfacePoint out;
    out.distance = hit.distance;
    out.in_model = surface.position;
    out.position = frame.world_from * surface.position + frame.position;
    out.facet = frame.world_from * surface.facet;
    out.normal = frame.world_from * surface.normal;
    out.ids = scene.ids(hit);
    return out;
  }

  SurfacePoint cast(const geometry::Ray& ray) const {
    return point_of(scene.nearest({ray, trace::Ray::kObserver}));
  }

  // z above all that is visible; none: nothing is
  std::optional<double> top() const {
    std::optional<double> top;
    for (const std::uint32_t i : scene.visible()) {
      const trace::Scene::Placed& placed = scene.targets()[i];
      const AxisBox& box = placed.target->bounds();
      if (box.empty()) continue;
      for (const double x : {box.low.x, box.high.x})
        for (const double y : {box.low.y, box.high.y})
          for (const double z : {box.low.z, box.high.z}) {
            const double height =
                (placed.frame.world_from * Vec3(x, y, z) + placed.frame.position).z;
            top = std::max(top.value_or(height), height);
          }
    }
    if (top) *top += 1 + 1e-6 * std::fabs(*top);
    return top;
  }

  SurfacePoint surface_near(const Vec3& point) const {
    const auto found = search.nearest(point);
    if (!found) return {};
    const trace::Scene::Placed& placed = scene.targets()[found->target];
    const trace::Target& target = *placed.target;
    const Vec3 local = (point - placed.frame.position) * placed.frame.world_from;
    if (found->part == trace::Hit::kGround) {
      trace::Hit hit;
      hit.distance = std::sqrt(found->squared);
      hit.target = found->target;
      hit.part = trace::Hit::kGround;
      hit.position = found->in_model;
      hit.normal = found->ground.normal;
      hit.triangle = found->triangle;
      hit.chart = found->ground.chart;
      hit.level = found->ground.level;
      hit.column = found->ground.column;
      hit.row = found->ground.row;
      hit.front = glm::dot(hit.normal, local - hit.position) >= 0;
      return point_of(hit);
    }
    // weights of the corners by the areas beside the point, in the model's frame
    const trace::Model::Part& part = target.model().parts()[found->part];
    const trace::Affine& place = target.placement(found->part).model_from_mesh;
    std::array<Vec3, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& p = part.mesh.positions[part.mesh.indices[std::size_t{3} * found->triangle + k]];
      corner[k] = place(Vec3(p.x, p.y, p.z));
    }
    const Vec3 area = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double squared = glm::dot(area, area);
    const auto share = [&](const Vec3& a, const Vec3& b) {
      const Vec3& p = found->in_model;
      return squared > 0 ? std::clamp(glm::dot(glm::cross(a - p, b - p), area) / squared, 0.0, 1.0)
                         : 0.0;
    };
    trace::Hit hit;
    hit.distance = std::sqrt(found->squared);
    hit.target = found->target;
    hit.part = found->part;
    hit.triangle = found->triangle;
    hit.barycentric = {share(corner[2], corner[0]), share(corner[0], corner[1])};
    const double mirrored = glm::determinant(place.linear) < 0 ? -1 : 1;
    hit.front = mirrored * glm::dot(area, local - found->in_model) >= 0;
    SurfacePoint out = point_of(hit);
    // on the triangle to rounding, whatever its weights are worth
    out.in_model = found->in_model;
    out.position = placed.frame.world_from * found->in_model + placed.frame.position;
    if (!hit.front && part.closed) {
      // from the inside of a closed mesh
      out.facet = -out.facet;
      out.normal = -out.normal;
    }
    return out;
  }
};

Lookups::Lookups() : impl_(std::make_unique<Impl>()) {}
Lookups::~Lookups() = default;
Lookups::Lookups(Lookups&&) noexcept = default;
Lookups& Lookups::operator=(Lookups&&) noexcept = default;

void Lookups::update(const world::World& world, const Job& job) {
  impl_->scene.update(world, job);
  impl_->world = world;
}

const world::World& Lookups::world() const { return impl_->world; }

void Lookups::report_damaged(DiagnosticLog& log) const { impl_->scene.report_damaged(log); }

void Lookups::rays(std::span<const geometry::Ray> rays, std::span<SurfacePoint> found,
                   const Job& job) const {
  assert(rays.size() == found.size());
  for_each_lookup(rays.size(), job, [&](std::size_t i) { found[i] = impl_->cast(rays[i]); });
}

void Lookups::pixels(const world::Camera& camera, std::span<const Vec2> places,
                     std::span<SurfacePoint> found, const Job& job) const {
  assert(places.size() == found.size());
  for_each_lookup(places.size(), job, [&](std::size_t i) {
    const auto ray = world::distorted_ray(camera, places[i]);
    found[i] = ray ? impl_->cast(*ray) : SurfacePoint{};
  });
}

void Lookups::sights(std::span<const Sight> sights, double slack, std::span<std::uint8_t> open,
                     const Job& job) const {
  assert(sights.size() == open.size() && slack >= 0);
  for_each_lookup(sights.size(), job, [&](std::size_t i) {
    const Vec3 line = sights[i].to - sights[i].from;
    const double length = glm::length(line);
    open[i] = 1;
    if (!(length > 2 * slack) || !(length > 0)) return;
    const trace::Ray ray{{sights[i].from, line / length, slack, length - slack},
                         trace::Ray::kObserver};
    open[i] = impl_->scene.any(ray, trace::Insides::stop) ? 0 : 1;
  });
}

void Lookups::elevations(std::span<const Vec2> places, std::span<SurfacePoint> found,
                         const Job& job) const {
  assert(places.size() == found.size());
  const auto top = impl_->top();
  for_each_lookup(places.size(), job, [&](std::size_t i) {
    found[i] = top ? impl_->cast({Vec3(places[i], *top), Vec3(0, 0, -1)}) : SurfacePoint{};
    if (found[i]) found[i].distance = found[i].position.z;
  });
}

void Lookups::nearest(std::span<const Vec3> points, std::span<SurfacePoint> found, const Job& job) {
  assert(points.size() == found.size());
  impl_->search.update(impl_->scene, job);
  for_each_lookup(points.size(), job,
                  [&](std::size_t i) { found[i] = impl_->surface_near(points[i]); });
}

std::vector<std::vector<labels::Keypoint>> Lookups::keypoints(const world::Camera& camera,
                                                              double slack) const {
  trace::Scene scene = impl_->scene;
  scene.place_observer({camera.position, camera.world_from_camera});
  return labels::keypoints_in_view(impl_->world, scene, camera, slack);
}

}  // namespace panwright::instruments
