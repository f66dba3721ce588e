#include "preview/reference/internal/path.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <vector>

#include "base/random.h"
#include "preview/reference/internal/disc_places.h"

namespace panwright::preview::reference {
namespace {

// paths are not ended at random before this many bounces
constexpr std::uint32_t kSureBounces = 3;
constexpr double kLargestSurvival = 0.95;

double power_weight(double pdf, double other) {
  // a huge density must not overflow in the squares
  const double ratio = other / pdf;
  return 1 / (1 + ratio * ratio);
}

bool is_black(const Vec3& v) { return !(v.x > 0 || v.y > 0 || v.z > 0); }

// Places of the unit disc in a steradian.
double per_steradian(const Sun& sun, const Vec3& direction) {
  return glm::dot(direction, sun.centre()) / (sun.sine() * sun.sine());
}

// A point of a target, in its frame as the Sun is there.
struct Lit {
  const TraceScene& scene;
  std::uint32_t target;
  const Sun& sun;
  const Bodies* bodies;  // null: none
  const Point& point;
  const trace::GroundBeams* beams = nullptr;

  bool open(const Vec3& to_light) const {
    return !scene.any({{point.start, to_light}, target}, beams);
  }
  // share of the Sun's light from a direction
  Vec3 arriving(const Vec3& to_sun) const {
    const Vec3 share = bodies ? bodies->passes(point.start, to_sun) : Vec3(1);
    return !(share == Vec3(0)) && open(to_sun) ? share : Vec3(0);
  }
  bool reaches(const TraceLamp::Sample& light) const {
    constexpr double kShort = 1 - 1e-9;  // of a lamp that lies on a surface
    return !scene.any({{point.start, light.to_light, 0, kShort * light.distance}, target});
  }
};

// The Sun's light that a surface sends to a viewer, its disc sampled. places: where a narrow lobe
// sees it; none elsewhere
Vec3 sunlight(const Lit& lit, const Vec3& to_viewer, const Vec2& u,
              const std::optional<DiscPlaces>& places, RayCounts& counts) {
  const Sun& sun = lit.sun;
  const Point& point = lit.point;
  const Vec2 place = places ? places->sample(u) : Vec2(0);
  const Sun::Sample light = places ? sun.at(place) : sun.sample(u);
  const Scatter& surface = point.surface();
  Vec3 result = reflected(point, light.to_light, to_viewer) * light.irradiance;
  if (is_black(result)) return Vec3(0);
  if (places) {
    const double density = places->pdf(place);
    result *= power_weight(density * per_steradian(sun, light.to_light),
                           surface.scattering.pdf(light.to_light, to_viewer, point.normal,
                                                  point.tangent, point.tint)) /
              (kPi * density);
  }
  ++counts.shadow;
  return lit.arriving(light.to_light) * result;
}

// The Sun's disc as mirrors show it.
Vec3 mirrored_disc(const Lit& lit, const Vec3& to_viewer, RayCounts& counts) {
  const Sun& sun = lit.sun;
  const Point& point = lit.point;
  Vec3 result(0);
  const materials::Mirrors mirrors =
      point.surface().scattering.mirrors(to_viewer, point.normal, point.tangent);
  for (int i = 0; i < mirrors.count; ++i) {
    const materials::Mirrored& one = mirrors.all[static_cast<std::size_t>(i)];
    const Vec3 shown = sun.radiance(one.to_light) * one.reflectance;
    if (is_black(shown) || !(glm::dot(one.to_light, point.normal) > 0)) continue;
    ++counts.shadow;
    result += lit.arriving(one.to_light) * shown;
  }
  return result;
}

// The light of a lamp that a surface sends to a viewer: by a place on it, and in mirrors.
Vec3 lamplight(const Lit& lit, const TraceLamp& lamp, const Vec3& to_viewer, const Vec2& u,
               RayCounts& counts) {
  const Point& point = lit.point;
  const materials::Scattering& scattering = point.surface().scattering;
  Vec3 result(0);
  const TraceLamp::Sample light = lamp.sample(point.start, u);
  if (!is_black(light.irradiance)) {
    const Vec3 sent = reflected(point, light.to_light, to_viewer) * light.irradiance;
    if (!is_black(sent)) {
      ++counts.shadow;
      if (lit.reaches(light)) result += sent;
    }
  }
  if (!point.surface().has_mirror) return result;
  const materials::Mirrors mirrors = scattering.mirrors(to_viewer, point.normal, point.tangent);
  for (int i = 0; i < mirrors.count; ++i) {
    const materials::Mirrored& one = mirrors.all[static_cast<std::size_t>(i)];
    const TraceLamp::Sample seen = lamp.seen(point.start, one.to_light);
    const Vec3 shown = seen.irradiance * one.reflectance;
    if (is_black(shown) || !(glm::dot(one.to_light, point.normal) > 0)) continue;
    ++counts.shadow;
    if (lit.reaches(seen)) result += shown;
  }
  return result;
}

// Of all lamps. Numbers of lamps have uses of their own, beyond those of bounces.
Vec3 all_lamplight(const Lit& lit, const std::vector<TraceLamp>& lamps, const Vec3& to_viewer,
                   const StreamKey& name, std::uint32_t depth, RayCounts& counts) {
  constexpr std::uint32_t kFirstUse = 1u << 20;
  const auto count = static_cast<std::uint32_t>(lamps.size());
  Vec3 result(0);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::array<double, 4> u = numbers(name, kFirstUse + depth * count + k);
    result += lamplight(lit, lamps[k], to_viewer, {u[0], u[1]}, counts);
  }
  return result;
}

// What a direction drawn by a narrow lobe gets of the Sun's disc where nothing stands before it.
Vec3 disc_seen(const Sun& sun, const DiscPlaces& places, const materials::Sampled& sampled) {
  // mirrors have looked for the Sun already
  if (sampled.delta) return Vec3(0);
  const double density = places.pdf(sun.place(sampled.to_light));
  if (!(density > 0)) return Vec3(0);
  return sun.radiance(sampled.to_light) * sampled.weight *
         power_weight(sampled.pdf, density * per_steradian(sun, sampled.to_light));
}

// The light of bodies that a surface sends to a viewer, their discs sampled.
Vec3 planetshine(const Lit& lit, const Vec3& to_viewer, const std::array<double, 4>& u,
                 double u_body, RayCounts& counts) {
  const Point& point = lit.point;
  const auto light = lit.bodies->sample(point.start, {u[0], u[1]}, u_body);
  if (!light) return Vec3(0);
  Vec3 result = reflected(point, light->direction, to_viewer) / light->pdf;
  if (is_black(result)) return Vec3(0);
  result *= lit.bodies->light(point.start, light->direction, {u[2], u[3]});
  // facets are lit by this alone: no lobe is drawn about their normals
  if (!point.facets)
    result *= power_weight(light->pdf,
                           point.surface().scattering.pdf(light->direction, to_viewer, point.normal,
                                                          point.tangent, point.tint));
  if (is_black(result)) return Vec3(0);
  ++counts.shadow;
  return lit.open(light->direction) ? result : Vec3(0);
}

// What a direction drawn by a lobe gets of a body where nothing stands before it.
Vec3 body_seen(const Lit& lit, const materials::Sampled& sampled, const Vec2& u) {
  const Vec3 light = sampled.weight * lit.bodies->light(lit.point.start, sampled.to_light, u);
  if (sampled.delta) return light;
  return light * power_weight(sampled.pdf, lit.bodies->pdf(lit.point.start, sampled.to_light));
}

// Uses of numbers() for bodies, beyond those of paths.
constexpr std::uint32_t kBodyUse = 1u << 20;

}  // namespace

Vec3 reflected(const Point& point, const Vec3& to_light, const Vec3& to_viewer) {
  const auto of = [&](const Vec3& normal) {
    const double cosine = glm::dot(normal, to_light);
    if (!(cosine > 0)) return Vec3(0);
    return cosine *
           point.surface().scattering.brdf(to_light, to_viewer, normal, point.tangent, point.tint);
  };
  if (!point.facets) return of(point.normal);
  Vec3 sum(0);
  for (std::size_t k = 0; k < point.facets->count; ++k)
    sum += point.facets->weights[k] * of(point.facets->normals[k]);
  return sum;
}

std::array<double, 4> numbers(const StreamKey& name, std::uint32_t use) {
  const std::array<std::uint32_t, 4> words =
      philox({name.pixel, name.batch, name.number, use},
             {static_cast<std::uint32_t>(name.seed), static_cast<std::uint32_t>(name.seed >> 32)});
  return {in_unit(words[0]), in_unit(words[1]), in_unit(words[2]), in_unit(words[3])};
}

namespace {

// bodies: the last for rays of the observer
bool is_behind_body(std::span<const Bodies> bodies, const trace::Ray& ray, double distance) {
  if (bodies.empty()) return false;
  const auto before = bodies.back().nearest(ray.origin, ray.direction);
  return before && before->distance < distance;
}

}  // namespace

bool sunlit(const TraceScene& scene, std::span<const Sun> suns, std::span<const SunSample> samples,
            const PathOptions& options, std::span<Vec3> radiances) {
  assert(samples.size() == radiances.size());
  // the light of a sample, and where that of its facets begins
  struct Light {
    Point point;
    Sun::Sample sun;
    std::size_t first;
  };
  static thread_local std::vector<Light> lights;
  static thread_local std::vector<materials::Scattering::Directions> directions;
  static thread_local std::vector<Vec2> factors;  // weight, cosine
  static thread_local std::vector<Vec3> brdfs;
  lights.clear();
  directions.clear();
  factors.clear();
  const Scatter* scatter = nullptr;  // of all
  for (const SunSample& sample : samples) {
    const trace::Hit& hit = *sample.hit;
    Light& light = lights.emplace_back(
        Light{scene.point(hit, options.flat, options.footprint.of(hit.distance)),
              suns[hit.target].sample(sample.sun), directions.size()});
    const Point& point = light.point;
    if (scatter == nullptr) scatter = &point.surface();
    if (&point.surface() != scatter || scatter->is_narrow() || scatter->has_mirror) return false;
    const auto add = [&](const Vec3& normal, double weight) {
      const double cosine = glm::dot(normal, light.sun.to_light);
      if (!(cosine > 0)) return;
      directions.push_back({light.sun.to_light, -hit.direction, normal, point.tint});
      factors.push_back({weight, cosine});
    };
    if (!point.facets) add(point.normal, 1);
    for (std::size_t k = 0; point.facets && k < point.facets->count; ++k)
      add(point.facets->normals[k], point.facets->weights[k]);
  }
  brdfs.resize(directions.size());
  if (scatter != nullptr) scatter->scattering.brdf(directions, brdfs);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Light& light = lights[i];
    const std::size_t end = i + 1 < lights.size() ? lights[i + 1].first : directions.size();
    Vec3 result(0);
    for (std::size_t k = light.first; k < end; ++k)
      result += factors[k].x * (factors[k].y * brdfs[k]);
    result *= light.sun.irradiance;
    const Lit lit{scene,       samples[i].hit->target, suns[samples[i].hit->target], nullptr,
                  light.point, options.beams};
    if (is_black(result) || !lit.open(light.sun.to_light)) result = Vec3(0);
    radiances[i] = light.point.emitted * options.white + result;
  }
  return true;
}

PathResult traced(const TraceScene& scene, std::span<const Sun> suns,
                  std::span<const Bodies> bodies, const trace::Ray& ray, const FirstRandoms& first,
                  const StreamKey& name, const PathOptions& options, RayCounts& counts) {
  ++counts.camera;
  const auto hit = scene.seen(ray);
  if (!hit || is_behind_body(bodies, ray, hit->distance)) return {};
  return traced_from(scene, suns, bodies, *hit, first, name, options, counts);
}

PathResult traced_from(const TraceScene& scene, std::span<const Sun> suns,
                       std::span<const Bodies> bodies, const trace::Hit& first_hit,
                       const FirstRandoms& first, const StreamKey& name, const PathOptions& options,
                       RayCounts& counts) {
  PathResult result;
  std::optional<trace::Hit> hit = first_hit;
  result.covered = true;
  Vec3 direction = hit->direction;
  Vec3 share(1);
  FirstRandoms u = first;
  double u_survival = 0;
  for (std::uint32_t depth = 0;; ++depth) {
    const Sun& sun = suns[hit->target];
    const Point point =
        scene.point(*hit, options.flat, depth == 0 ? options.footprint.of(hit->distance) : 0);
    const Bodies* of_target = bodies.empty() ? nullptr : &bodies[hit->target];
    const Lit lit{scene, hit->target, sun, of_target, point, options.beams};
    result.radiance += share * point.emitted * options.white;
    const Scatter& surface = point.surface();
    if (point.normal == Vec3(0)) break;
    if (depth > 0) {
      const std::array<double, 4> a = numbers(name, 2 * depth);
      const std::array<double, 4> b = numbers(name, 2 * depth + 1);
      u = {{a[0], a[1]}, {b[0], b[1]}, b[2]};
      u_survival = b[3];
    }
    const Vec3 to_viewer = -direction;
    std::optional<DiscPlaces> places;
    if (surface.is_narrow() && sun.has_disc())
      places.emplace(surface.scattering.disc_lobes(sun.centre(), sun.sine(), to_viewer,
                                                   point.normal, point.tangent));
    result.radiance += share * sunlight(lit, to_viewer, u.sun, places, counts);
    if (surface.has_mirror && sun.has_disc())
      result.radiance += share * mirrored_disc(lit, to_viewer, counts);
    if (options.lamps)
      result.radiance +=
          share * all_lamplight(lit, (*options.lamps)[hit->target], to_viewer, name, depth, counts);

    std::array<double, 4> v{}, w{};
    if (lit.bodies != nullptr) {
      v = numbers(name, kBodyUse + 2 * depth);
      w = numbers(name, kBodyUse + 2 * depth + 1);
      result.radiance += share * planetshine(lit, to_viewer, v, w[0], counts);
    }

    const bool last = depth >= options.bounces;
    if (last && !places && lit.bodies == nullptr) break;
    const auto sampled = surface.scattering.sample(to_viewer, point.normal, point.tangent,
                                                   point.tint, u.bounce, u.lobe);
    if (!sampled || is_black(sampled->weight)) break;
    Vec3 disc = places ? disc_seen(sun, *places, *sampled) : Vec3(0);
    if (lit.bodies != nullptr) {
      if (!is_black(disc)) disc *= lit.bodies->passes(point.start, sampled->to_light);
      if (!point.facets) disc += body_seen(lit, *sampled, {w[1], w[2]});
    }
    if (last && is_black(disc)) break;
    const trace::Ray onward{{point.start, sampled->to_light}, hit->target};
    ++counts.bounce;
    if (last) {
      if (!scene.any(onward)) result.radiance += share * disc;
      break;
    }
    hit = scene.closest(onward);
    if (!hit) {
      result.radiance += share * disc;
      break;
    }
    // the inside of a closed mesh is not there for light
    if (scene.is_inside(*hit)) break;
    share *= sampled->weight;
    direction = hit->direction;
    if (depth + 1 > kSureBounces) {
      const double survival = std::min(kLargestSurvival, std::max({share.x, share.y, share.z}));
      if (!(u_survival < survival)) break;
      share /= survival;
    }
  }
  return result;
}

}  // namespace panwright::preview::reference
