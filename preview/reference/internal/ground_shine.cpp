#include "preview/reference/internal/ground_shine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/axis_box.h"
#include "base/parallel.h"
#include "preview/reference/internal/path.h"

namespace panwright::preview::reference {
namespace {

constexpr int kTexels = light::GroundShine::kSide;
constexpr std::size_t kRays = std::size_t{kTexels} * kTexels;
constexpr std::size_t kMostShadows = 32;

// Steps of a plane-filling sequence.
Vec2 place_in_square(std::size_t i) {
  const double x = 0.5 + static_cast<double>(i) * 0.7548776662466927;
  const double y = 0.5 + static_cast<double>(i) * 0.5698402909980532;
  return {x - std::floor(x), y - std::floor(y)};
}

// A sphere about terrain.
struct GroundSphere {
  Vec3 centre{0};  // metres, of the world
  double radius = 0;
};
GroundSphere sphere_of(const trace::Scene::Placed& ground) {
  GroundSphere sphere;
  AxisBox box;
  for (const terrain::ChartRecord& chart : ground.target->ground()->tiles().charts()) {
    if (chart.radius > 0)
      sphere.radius =
          std::max(sphere.radius, std::max(chart.radius, chart.polar_radius) + chart.high);
    else
      box.add(ground.target->bounds().low);
  }
  if (!box.empty()) {
    const AxisBox& whole = ground.target->bounds();
    sphere.centre = whole.centre();
    sphere.radius = std::max(sphere.radius, 0.5 * whole.diagonal());
  }
  sphere.centre = ground.frame.world_from * sphere.centre + ground.frame.position;
  return sphere;
}

// Ground along a ray, and the Sun's light that it sends back.
struct SentLight {
  bool met = false;
  bool in_own_shadow = false;  // of the target that is lit
  Vec3 radiance{0};            // as if it were not
  trace::Hit hit;
  Vec3 to_light{0};  // as hit.direction
};

struct GroundShineRays {
  const TraceScene& scene;
  std::span<const Sun> suns;
  std::span<const Bodies> bodies;
  std::uint32_t target;
  double step;  // radians between rays

  bool blocks(std::uint32_t other, const trace::Ray& ray) const {
    const auto targets = scene.rays().targets();
    if (targets[other].target->ground() != nullptr) return scene.rays().meets_ground(other, ray);
    const trace::Affine there = trace::between(targets[other].frame, targets[ray.frame].frame);
    return targets[other].target->any({there(ray.origin), there.linear * ray.direction},
                                      trace::Insides::stop);
  }

  // number: of the ray, for its place on the Sun's disc
  SentLight sent(const trace::Hit& hit, std::size_t number) const {
    SentLight out;
    out.met = true;
    out.hit = hit;
    const Point point = scene.point(hit, false, step * hit.distance);
    const Sun::Sample light = suns[hit.target].sample(place_in_square(number));
    out.to_light = light.to_light;
    out.radiance = reflected(point, light.to_light, -hit.direction) * light.irradiance;
    if (!bodies.empty()) out.radiance *= bodies[hit.target].passes(point.start, light.to_light);
    if (out.radiance == Vec3(0)) return out;
    const trace::Ray to_sun{{point.start, light.to_light}, hit.target};
    for (const std::uint32_t other : scene.rays().visible())
      if (other != target && blocks(other, to_sun)) {
        out.radiance = Vec3(0);
        return out;
      }
    out.in_own_shadow = blocks(target, to_sun);
    return out;
  }
};

// A ray of the observer, for a share of all directions.
struct ShineRay {
  Vec3 direction{0};  // unit
  double solid = 0;   // steradians
};

ShineRay ray_in_texel(std::size_t texel) {
  // the same within each texel but for even steps, so that horizons along rows have no steps
  const Vec2 within = place_in_square(texel);
  const Vec2 place((2 * (static_cast<double>(texel % kTexels) + within.x)) / kTexels - 1,
                   (2 * (static_cast<double>(texel / kTexels) + within.y)) / kTexels - 1);
  const Vec3 at = light::octahedron_direction(place);
  const double length = glm::length(at);
  return {at / length, 4.0 / kRays / (length * length * length)};
}

// Rays over a cap, along a spiral.
ShineRay ray_in_cap(const light::GroundShine::Cap& cap, std::size_t i) {
  constexpr double kGolden = 2.399963229728653;  // radians
  const double height = (1 - cap.cosine) * (static_cast<double>(i) + 0.5) / kRays;
  const double across = std::sqrt(height * (2 - height));
  const Vec3 other = std::fabs(cap.axis.z) < 0.6 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  const Vec3 x = glm::normalize(glm::cross(cap.axis, other)), y = glm::cross(cap.axis, x);
  const det::SinCos turn = det::sincos(kGolden * static_cast<double>(i));
  return {glm::normalize((1 - height) * cap.axis + across * (turn.cos * x + turn.sin * y)),
          2 * kPi * (1 - cap.cosine) / kRays};
}

// A ray that has met the target's own shadow.
struct ShadowPoint {
  const SentLight* sent;
  Vec3 place;  // of the world
  double area;
  double weight;  // flux at the target
};

// Points [begin, end) that one shadow stands for.
struct ShadowCell {
  std::size_t begin, end;
  double weight = 0;
};

// Halves a cell across the axis along which it is widest.
ShadowCell halve(ShadowCell& cell, std::vector<ShadowPoint>& points) {
  AxisBox box;
  for (std::size_t i = cell.begin; i < cell.end; ++i) box.add(points[i].place);
  const Vec3 size = box.high - box.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto first = points.begin() + static_cast<std::ptrdiff_t>(cell.begin);
  const auto last = points.begin() + static_cast<std::ptrdiff_t>(cell.end);
  std::stable_sort(first, last, [&](const ShadowPoint& a, const ShadowPoint& b) {
    return a.place[axis] < b.place[axis];
  });
  ShadowCell other{cell.begin, cell.end};
  double sum = 0;
  while (other.begin + 1 < cell.end && sum + 0.5 * points[other.begin].weight < 0.5 * cell.weight)
    sum += points[other.begin++].weight;
  other.begin = std::max(other.begin, cell.begin + 1);
  cell.end = other.begin;
  const auto weigh = [&](ShadowCell& each) {
    each.weight = 0;
    for (std::size_t i = each.begin; i < each.end; ++i) each.weight += points[i].weight;
  };
  weigh(cell);
  weigh(other);
  return other;
}

std::vector<ShadowCell> shadow_cells(std::vector<ShadowPoint>& points) {
  std::vector<ShadowCell> cells;
  if (!points.empty()) cells.push_back({0, points.size()});
  for (ShadowCell& cell : cells)
    for (const ShadowPoint& point : points) cell.weight += point.weight;
  while (!cells.empty() && cells.size() < kMostShadows) {
    ShadowCell* widest = nullptr;
    for (ShadowCell& cell : cells)
      if (cell.end - cell.begin > 1 && (widest == nullptr || cell.weight > widest->weight))
        widest = &cell;
    if (widest == nullptr) break;
    cells.push_back(halve(*widest, points));
  }
  return cells;
}

// Radiance of ground towards the surface of the target over that towards its middle: the mean over
// places of its box, by the light that they get.
Vec3 towards_box(const TraceScene& scene, const SentLight& sent, std::uint32_t target) {
  const auto targets = scene.rays().targets();
  const trace::Affine ground_from =
      trace::between(targets[sent.hit.target].frame, targets[target].frame);
  const AxisBox& box = targets[target].target->bounds();
  const Point point = scene.point(sent.hit, false);
  Vec3 sum(0);
  double all = 0;
  for (int k = 0; k < 27; ++k) {
    const Vec3 share(0.5 * (k % 3), 0.5 * (k / 3 % 3), 0.5 * (k / 9));
    const Vec3 way = ground_from(box.low + share * (box.high - box.low)) - sent.hit.position;
    const double square = glm::dot(way, way);
    const Vec3 to_viewer = way / std::sqrt(square);
    const double cosine = glm::dot(point.normal, to_viewer);
    if (!(cosine > 0.01)) continue;
    const double weight = cosine / square;
    sum += weight * reflected(point, sent.to_light, to_viewer);
    all += weight;
  }
  const Vec3 middle = reflected(point, sent.to_light, -sent.hit.direction);
  return all > 0 ? sum / (all * glm::max(middle, Vec3(1e-300))) : Vec3(1);
}

std::vector<light::ShineShadow> shadows_of(std::vector<ShadowPoint> points, const TraceScene& scene,
                                           std::uint32_t target) {
  std::vector<light::ShineShadow> shadows;
  for (const ShadowCell& cell : shadow_cells(points)) {
    light::ShineShadow shadow;
    Vec3 normal(0);
    for (std::size_t i = cell.begin; i < cell.end; ++i) {
      const ShadowPoint& point = points[i];
      shadow.area += point.area;
      shadow.place += point.area * point.place;
      normal += point.area * (scene.rays().targets()[point.sent->hit.target].frame.world_from *
                              point.sent->hit.normal);
      shadow.light += kPi * point.area * point.sent->radiance;
    }
    shadow.place /= shadow.area;
    shadow.light /= shadow.area;
    const auto nearest = std::min_element(points.begin() + static_cast<std::ptrdiff_t>(cell.begin),
                                          points.begin() + static_cast<std::ptrdiff_t>(cell.end),
                                          [&](const ShadowPoint& a, const ShadowPoint& b) {
                                            return glm::length(a.place - shadow.place) <
                                                   glm::length(b.place - shadow.place);
                                          });
    shadow.light *= towards_box(scene, *nearest->sent, target);
    if (!(glm::length(normal) > 0)) continue;
    shadow.normal = glm::normalize(normal);
    shadows.push_back(shadow);
  }
  return shadows;
}

// Adds what rays have found.
void add_light(std::span<const ShineRay> rays, std::span<const SentLight> sent,
               light::GroundShine& shine, std::vector<ShadowPoint>& shadows) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const SentLight& one = sent[i];
    const Vec3 irradiance = one.radiance * rays[i].solid;
    const double flux = irradiance.x + irradiance.y + irradiance.z;
    if (!(flux > 0)) continue;
    shine.parts.push_back({rays[i].direction, irradiance, flux});
    if (!one.in_own_shadow) continue;
    // seen at a grazing angle a step of the rays is a wide place
    const double facing = std::max(-glm::dot(one.hit.normal, one.hit.direction), 0.01);
    const double distance = one.hit.distance;
    shadows.push_back({&one, shine.middle + distance * rays[i].direction,
                       rays[i].solid * distance * distance / facing, flux});
  }
}

// Directions over all of the sphere, by texel.
void look_around(const GroundShineRays& rays, light::GroundShine& shine, const Job& job) {
  constexpr std::size_t kBlock = 8;  // texels along a side that rays look through together
  constexpr std::size_t kBlocks = kTexels / kBlock;
  std::vector<ShineRay> all(kRays);
  std::vector<SentLight> sent(kRays);
  const trace::Scene& scene = rays.scene.rays();
  const auto look = [&](std::size_t block) {
    const std::size_t first = block / kBlocks * kBlock * kTexels + block % kBlocks * kBlock;
    AxisBox directions;
    for (std::size_t k = 0; k < kBlock * kBlock; ++k) {
      const std::size_t texel = first + k / kBlock * kTexels + k % kBlock;
      all[texel] = ray_in_texel(texel);
      directions.add(all[texel].direction);
    }
    // see GroundView::beam_about()
    const trace::GroundBeams beams = scene.ground_beams(
        {Vec3(0), 0, glm::normalize(directions.centre()), 0.65 * directions.diagonal()},
        trace::Ray::kObserver);
    for (std::size_t k = 0; k < kBlock * kBlock; ++k) {
      const std::size_t texel = first + k / kBlock * kTexels + k % kBlock;
      const trace::Ray ray{{Vec3(0), all[texel].direction}, trace::Ray::kObserver};
      if (const trace::Hit hit = scene.nearest_ground(ray, &beams))
        sent[texel] = rays.sent(hit, texel);
    }
  };
  parallel_for(kBlocks * kBlocks, look, job);
  double nearest = INFINITY;
  for (const SentLight& one : sent)
    if (one.met) nearest = std::min(nearest, one.hit.distance);
  const Vec3 size = scene.targets()[rays.target].target->bounds().extent();
  shine.closeness = 0.5 * std::max({size.x, size.y, size.z}) / nearest;
  std::vector<ShadowPoint> shadows;
  add_light(all, sent, shine, shadows);
  shine.shadows = shadows_of(std::move(shadows), rays.scene, rays.target);
  for (const SentLight& one : sent) {
    shine.radiance.push_back(one.in_own_shadow ? Vec3(0) : one.radiance);
    shine.is_ground.push_back(one.met);
  }
}

// Directions over the cap of terrain that is far away. Returns whether it fills half of it.
bool look_at_cap(const GroundShineRays& rays, std::uint32_t ground,
                 const light::GroundShine::Cap& cap, light::GroundShine& shine, const Job& job) {
  constexpr std::size_t kChunk = 64;
  std::vector<ShineRay> all(kRays);
  std::vector<SentLight> sent(kRays);
  const auto look = [&](std::size_t chunk) {
    for (std::size_t i = chunk * kChunk; i < (chunk + 1) * kChunk; ++i) {
      all[i] = ray_in_cap(cap, i);
      const trace::Ray ray{{Vec3(0), all[i].direction}, trace::Ray::kObserver};
      const trace::Hit hit = rays.scene.rays().nearest_ground(ray);
      if (hit && hit.target == ground) sent[i] = rays.sent(hit, i);
    }
  };
  parallel_for(kRays / kChunk, look, job);
  std::vector<ShadowPoint> shadows;  // no target's is wide from there
  add_light(all, sent, shine, shadows);
  return 2 * std::ranges::count(sent, true, &SentLight::met) > static_cast<std::ptrdiff_t>(kRays);
}

}  // namespace

light::GroundShine ground_shine(TraceScene& scene, std::span<const Sun> suns,
                                std::span<const Bodies> bodies, std::uint32_t target,
                                const Job& job) {
  constexpr double kFar = 0.5;              // sine of caps' radii, at most
  constexpr double kAngle = 1.0 / kTexels;  // radians: half a step of the rays
  const trace::Scene::Placed& placed = scene.rays().targets()[target];
  light::GroundShine shine;
  shine.stamp = next_stamp();
  shine.middle = placed.frame.world_from * placed.target->bounds().centre() + placed.frame.position;
  bool far = true;
  std::vector<std::uint32_t> grounds;
  std::vector<light::GroundShine::Cap> caps;
  double widest = 0;  // of the caps
  for (const std::uint32_t other : scene.rays().visible()) {
    const trace::Scene::Placed& ground = scene.rays().targets()[other];
    if (ground.target->ground() == nullptr) continue;
    const GroundSphere sphere = sphere_of(ground);
    const Vec3 toward = sphere.centre - shine.middle;
    const double sine = sphere.radius / std::max(glm::length(toward), 1e-300);
    far = far && sine < kFar;
    if (!far) break;
    widest = std::max(widest, sine);
    grounds.push_back(other);
    // a little wider than the sphere
    caps.push_back({glm::normalize(toward), std::sqrt(1 - sine * sine) - 1e-9});
  }
  scene.place_observer({shine.middle, Quat(1, 0, 0, 0)}, far ? kAngle * widest : kAngle);
  const GroundShineRays rays{scene, suns, bodies, target, 2 * (far ? kAngle * widest : kAngle)};
  if (far) {
    for (std::size_t k = 0; k < grounds.size(); ++k)
      if (look_at_cap(rays, grounds[k], caps[k], shine, job)) shine.caps.push_back(caps[k]);
  } else {
    look_around(rays, shine, job);
  }
  return shine;
}

}  // namespace panwright::preview::reference
