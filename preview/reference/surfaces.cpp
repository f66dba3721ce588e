#include "preview/reference/surfaces.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>
#include <vector>

#include "preview/reference/internal/trace_scene.h"

namespace panwright::preview {

namespace {

// f of a scatter at zero phase over sqrt(1 - cos θ), in which lobes and limbs are even.
struct ZeroPhase {
  static constexpr int kSteps = 2048;
  std::vector<Vec3> f;  // empty: a mirror, or a lobe too narrow for the steps

  explicit ZeroPhase(const reference::Scatter& scatter) {
    constexpr double kNarrow = 0.05;  // RMS slope
    if (scatter.has_mirror || scatter.slope < kNarrow) return;
    const Vec3 normal(0, 0, 1);
    for (int k = 0; k <= kSteps; ++k) {
      const double root = std::min(static_cast<double>(k) / kSteps, 1 - 1e-9);
      const double cosine = 1 - root * root;
      const Vec3 to_viewer(std::sqrt(1 - cosine * cosine), 0, cosine);
      f.push_back(scatter.scattering.brdf(to_viewer, to_viewer, normal, Vec3(0), Vec3(1)));
    }
  }
  Vec3 operator()(double cosine) const {
    double share = 0;
    const std::size_t k = step(cosine, share);
    return f[k] + share * (f[k + 1] - f[k]);
  }
  double of_band(double cosine, int band) const {
    double share = 0;
    const std::size_t k = step(cosine, share);
    return f[k][band] + share * (f[k + 1][band] - f[k][band]);
  }

 private:
  static std::size_t step(double cosine, double& share) {
    const double place = std::sqrt(std::max(1 - cosine, 0.0)) * kSteps;
    const auto k = std::min(static_cast<std::size_t>(place), std::size_t{kSteps - 1});
    share = place - static_cast<double>(k);
    return k;
  }
};

struct ModelTables {
  std::shared_ptr<const reference::TraceModel> model;
  std::vector<ZeroPhase> scatters;
};

}  // namespace

struct SurfaceScene::Impl {
  reference::TraceScene scene{true};
  std::unordered_map<const reference::TraceModel*, std::shared_ptr<const ModelTables>> known;
  std::vector<std::shared_ptr<const ModelTables>> tables;  // one for each target

  void add_tables() {
    std::unordered_map<const reference::TraceModel*, std::shared_ptr<const ModelTables>> now;
    tables.clear();
    for (std::uint32_t i = 0; i < scene.rays().targets().size(); ++i) {
      const auto& model = scene.model(i);
      auto& each = now[model.get()];
      if (const auto same = known.find(model.get()); same != known.end()) each = same->second;
      if (each == nullptr) {
        auto made = std::make_shared<ModelTables>();
        made->model = model;
        for (const reference::Scatter& scatter : model->scatters())
          made->scatters.emplace_back(scatter);
        each = std::move(made);
      }
      tables.push_back(each);
    }
    known = std::move(now);
  }

  // Returns the table of a surface and the cosine of its viewer; null: it has none.
  const ZeroPhase* table_of(const trace::Hit& hit, double& cosine) const {
    const ModelTables& of = *tables[hit.target];
    const std::int32_t number = of.model->plain_scatter(hit);
    if (number < 0) return nullptr;
    const ZeroPhase& table = of.scatters[static_cast<std::size_t>(number)];
    if (table.f.empty()) return nullptr;
    const trace::Target& target = *scene.rays().targets()[hit.target].target;
    const trace::Model::Part& part = target.model().parts()[hit.part];
    const std::size_t first = std::size_t{3} * hit.triangle;
    const Vec2& b = hit.barycentric;
    const auto& n0 = part.mesh.normals[part.mesh.indices[first]];
    const auto& n1 = part.mesh.normals[part.mesh.indices[first + 1]];
    const auto& n2 = part.mesh.normals[part.mesh.indices[first + 2]];
    const double a = 1 - b.x - b.y;
    const Vec3 smooth(a * n0.x + b.x * n1.x + b.y * n2.x, a * n0.y + b.x * n1.y + b.y * n2.y,
                      a * n0.z + b.x * n1.z + b.y * n2.z);
    const Vec3 normal = target.placement(hit.part).normals * smooth;
    const double square = glm::dot(normal, normal);
    if (!(square > 1e-200)) return nullptr;  // viewed() takes the triangle's
    const double side = part.closed || hit.front ? -1 : 1;
    cosine = std::clamp(side * glm::dot(normal, hit.direction) / std::sqrt(square), 0.0, 1.0);
    return &table;
  }
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
  impl_->add_tables();
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

ViewedSurface SurfaceScene::returned(const trace::Hit& hit) const {
  ViewedSurface out;
  const ZeroPhase* const table = impl_->table_of(hit, out.cosine);
  if (table == nullptr) return viewed(hit);
  out.returned = out.cosine * (*table)(out.cosine);
  return out;
}

bool SurfaceScene::returned_from_table(const trace::Hit& hit, int band, BandLight& out) const {
  const ZeroPhase* const table = impl_->table_of(hit, out.cosine);
  if (table == nullptr) return false;
  out.returned = out.cosine * table->of_band(out.cosine, band);
  return true;
}

Vec3 SurfaceScene::lit(const trace::Hit& hit, const Vec3& to_light, Vec3& start) const {
  const reference::Point point = impl_->scene.point(hit, false);
  start = point.start;
  const double cosine = glm::dot(point.normal, to_light);
  if (!(cosine > 0)) return Vec3(0);
  return cosine * point.surface().scattering.brdf(to_light, -hit.direction, point.normal,
                                                  point.tangent, point.tint);
}

}  // namespace panwright::preview
