#include "preview/reference/surfaces.h"

#include <algorithm>

#include "preview/reference/internal/trace_scene.h"

namespace panwright::preview {

struct SurfaceScene::Impl {
  reference::TraceScene scene;
};

SurfaceScene::SurfaceScene() : impl_(std::make_unique<Impl>()) {}
SurfaceScene::~SurfaceScene() = default;
SurfaceScene::SurfaceScene(const SurfaceScene& other)
    : impl_(std::make_unique<Impl>(*other.impl_)) {}
SurfaceScene& SurfaceScene::operator=(const SurfaceScene& other) {
  *impl_ = *other.impl_;
  return *this;
}

void SurfaceScene::update(const world::World& world, const Job& job) {
  impl_->scene.update(world, job);
}

void SurfaceScene::place_observer(const world::Pose& world_from_observer) {
  impl_->scene.place_observer(world_from_observer);
}

const trace::Scene& SurfaceScene::rays() const { return impl_->scene.rays(); }

ViewedSurface SurfaceScene::viewed(const trace::Hit& hit) const {
  const reference::Point point = impl_->scene.point(hit, false);
  const reference::Scatter& surface = point.surface();
  const Vec3 to_viewer = -hit.direction;
  ViewedSurface out;
  out.start = point.start;
  out.normal = point.normal;
  if (point.normal == Vec3(0)) return out;
  out.cosine = std::clamp(glm::dot(point.normal, to_viewer), 0.0, 1.0);
  if (out.cosine > 0)
    out.returned = out.cosine * surface.scattering.brdf(to_viewer, to_viewer, point.normal,
                                                        point.tangent, point.tint);
  if (surface.has_mirror) {
    const materials::Mirrors mirrors =
        surface.scattering.mirrors(to_viewer, point.normal, point.tangent);
    out.mirror_count = mirrors.count;
    for (std::size_t i = 0; i < static_cast<std::size_t>(mirrors.count); ++i)
      out.mirrors[i] = {mirrors.all[i].to_light, mirrors.all[i].reflectance};
  }
  return out;
}

Vec3 SurfaceScene::lit(const trace::Hit& hit, const Vec3& to_light) const {
  const reference::Point point = impl_->scene.point(hit, false);
  const double cosine = glm::dot(point.normal, to_light);
  if (!(cosine > 0)) return Vec3(0);
  return cosine * point.surface().scattering.brdf(to_light, -hit.direction, point.normal,
                                                  point.tangent, point.tint);
}

}  // namespace panwright::preview
