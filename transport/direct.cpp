#include "transport/internal/direct.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "base/parallel.h"
#include "sky/sky.h"

namespace panwright::transport {
namespace {

constexpr std::uint32_t kPoints = 4;  // of a surfel that are asked, at most
constexpr std::size_t kSurfelsAtOnce = 128;

// Points of a surfel that are asked: by its area beside the mean one, so that noise of what small
// ones send does not cost more rays than that of large ones.
std::uint32_t asked_of(const SurfelSet& set, std::size_t surfel) {
  const double mean = set.area() / static_cast<double>(set.surfels().size());
  const double wanted = std::ceil(kPoints * set.area(surfel) / mean);
  return static_cast<std::uint32_t>(std::clamp(wanted, 1.0, double{kPoints}));
}

// The k-th of those.
std::uint32_t point_of(const SurfelSet& set, std::size_t surfel, std::uint32_t k,
                       std::uint32_t asked) {
  const std::uint32_t begin = set.first(surfel), points = set.first(surfel + 1) - begin;
  return begin + (2 * k + 1) * points / (2 * asked);
}

// Position and radius of a lamp; infinitely far: none.
struct LampPlace {
  std::optional<Vec3> position;
  double radius = 0;
};
LampPlace place_of(const light::Source& source) {
  return std::visit(
      [](const auto& lamp) -> LampPlace {
        if constexpr (requires { lamp.position; })
          return {lamp.position, lamp.radius};
        else
          return {};
      },
      source);
}

// The sharpest layer of a table in a direction of the world.
Vec3 shine(const sky::ShineTable& table, const Vec3& direction) {
  const Vec2 at = light::octahedron_place(direction);
  const auto texel = [](double v) {
    constexpr int kSide = sky::ShineTable::kSide;
    return static_cast<std::size_t>(
        1 + std::clamp(static_cast<int>(std::floor((v + 1) * 0.5 * kSide)), 0, kSide - 1));
  };
  const float* rgba = table.rgba.data() + 4 * (texel(at.y) * sky::ShineTable::kRow + texel(at.x));
  return {rgba[0], rgba[1], rgba[2]};
}

// Light on one surfel.
struct OnSurfel {
  const trace::Scene& scene;
  std::uint32_t target;
  const trace::RigidFrame& frame;
  const SurfelSet& set;
  const DirectLights& lights;
  const ModelReflectance::At& surface;

  // The Sun on a point.
  struct Sunlit {
    double cosine = 0;  // above 0: towards it
    bool lit = false;
  };
  // Of points that are asked. Those between the first and the last have rays only where these
  // differ.
  std::array<Sunlit, kPoints> sunlight(std::size_t surfel, std::uint32_t asked) const {
    std::array<Sunlit, kPoints> suns;
    suns[0] = sunlight(point_of(set, surfel, 0, asked), 0, asked, {});
    if (asked == 1) return suns;
    Sunlit& last = suns[asked - 1];
    last = sunlight(point_of(set, surfel, asked - 1, asked), asked - 1, asked, {});
    std::optional<bool> all;
    if (suns[0].cosine > 0 && last.cosine > 0 && suns[0].lit == last.lit) all = last.lit;
    for (std::uint32_t k = 1; k + 1 < asked; ++k)
      suns[k] = sunlight(point_of(set, surfel, k, asked), k, asked, all);
    return suns;
  }
  //   k, of  its number among those that are asked
  //   known  without a ray
  Sunlit sunlight(std::uint32_t point, std::uint32_t k, std::uint32_t of,
                  std::optional<bool> known) const {
    const Point& at = set.points()[point];
    // places of the disc, the same share of its area each
    const auto turn = det::sincos(2 * kPi * k / of + 2.399963 * point);
    const Vec3 aside = std::fabs(lights.to_sun.z) < 0.7 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
    const Vec3 across = glm::normalize(glm::cross(lights.to_sun, aside));
    const Vec3 place = turn.cos * across + turn.sin * glm::cross(lights.to_sun, across);
    const Vec3 to_light = glm::normalize(
        (lights.to_sun + lights.sun_sine * std::sqrt((k + 0.5) / of) * place) * frame.world_from);
    const double cosine = glm::dot(at.normal, to_light);
    if (!(cosine > 0)) return {};
    if (known) return {cosine, *known};
    const trace::Ray ray{{at.start, to_light}, target};
    return {cosine, !scene.any(ray, trace::Insides::stop)};
  }

  Vec3 lamplight(std::uint32_t point, const light::Source& lamp) const {
    const Point& at = set.points()[point];
    const Vec3 here = frame.world_from * at.start + frame.position;
    const light::Incidence from = light::incidence(lamp, here);
    const Vec3 to_light = glm::normalize(from.to_light * frame.world_from);
    const double cosine = glm::dot(at.normal, to_light);
    if (!(cosine > 0) || !(max_component(from.irradiance) > 0)) return Vec3(0);
    trace::Ray ray{{at.start, to_light}, target};
    const LampPlace place = place_of(lamp);
    if (place.position)
      ray.max_distance =
          std::max(0.999 * (glm::length(*place.position - here) - place.radius), 0.0);
    if (scene.any(ray, trace::Insides::stop)) return Vec3(0);
    return cosine * from.irradiance * surface.reflectance->directional(cosine, surface.tint);
  }

  // of bodies and terrain, by the rays that lead to the sky
  Vec3 planetshine(std::size_t surfel, const TransportLists& lists) const {
    Vec3 sum(0);
    const std::uint32_t begin = set.first(surfel), end = set.first(surfel + 1);
    for (std::uint32_t p = begin; p < end; ++p)
      for (std::uint32_t k = 0; k < kRaysAPoint; ++k)
        if ((lists.open[p] >> k & 1) != 0)
          sum += shine(*lights.bodies, frame.world_from * ray_direction(set, surfel, p, k));
    return sum * (kPi / (double{kRaysAPoint} * (end - begin))) *
           surface.reflectance->mean(surface.tint);
  }
};

}  // namespace

DirectLights direct_lights(const world::World& world, const Vec3& point,
                           std::span<const light::Source> lamps, const light::GroundShine* ground) {
  DirectLights lights;
  const light::Incidence sun = light::incidence(world.sun(), point);
  lights.to_sun = sun.to_light;
  lights.sun_sine = std::min(light::kSunSineAtOneAu / world.sun().distance, 0.999);
  lights.sun_irradiance = sun.irradiance;
  lights.lamps = lamps;
  lights.white = world.white();
  if (world.bodies().empty() && ground == nullptr) return lights;
  const sky::Sky sky(world);
  if (!world.bodies().empty()) lights.sun_irradiance *= sky.sunlight(point);
  lights.bodies = sky::shine_table(sky, point, ground);
  return lights;
}

Sources direct_sources(const trace::Scene& scene, std::uint32_t target, const SurfelSet& set,
                       const TransportLists& lists, std::span<const ModelReflectance::At> surfaces,
                       const DirectLights& lights, const Job& job) {
  const std::size_t count = set.surfels().size();
  Sources sources;
  sources.albedo.resize(count);
  sources.sent.resize(count);
  sources.lit.resize(count);
  sources.glossy.resize(count);
  const bool sunny = max_component(lights.sun_irradiance) > 0;
  const auto light_some = [&](std::size_t chunk) {
    const std::size_t end = std::min(count, (chunk + 1) * kSurfelsAtOnce);
    for (std::size_t s = chunk * kSurfelsAtOnce; s < end; ++s) {
      const OnSurfel here{scene, target, scene.targets()[target].frame, set, lights, surfaces[s]};
      const Reflectance& reflectance = *surfaces[s].reflectance;
      Vec3 sum(0);
      std::uint32_t towards = 0, lit = 0;
      const std::uint32_t asked = asked_of(set, s);
      std::array<OnSurfel::Sunlit, kPoints> suns;
      if (sunny) suns = here.sunlight(s, asked);
      for (std::uint32_t k = 0; k < asked; ++k) {
        if (sunny) {
          const OnSurfel::Sunlit& sun = suns[k];
          towards += sun.cosine > 0;
          lit += sun.lit;
          if (sun.lit) {
            const Vec3 arriving = sun.cosine * lights.sun_irradiance;
            const Vec3 lobes = reflectance.is_glossy() ? reflectance.glossy(sun.cosine) : Vec3(0);
            sum += arriving * (reflectance.directional(sun.cosine, surfaces[s].tint) - lobes);
            sources.glossy[s] += arriving * lobes / static_cast<double>(asked);
          }
        }
        for (const light::Source& lamp : lights.lamps)
          sum += here.lamplight(point_of(set, s, k, asked), lamp);
      }
      sources.lit[s] = towards > 0 ? static_cast<float>(lit) / static_cast<float>(towards) : 0;
      sources.albedo[s] = surfaces[s].reflectance->mean(surfaces[s].tint);
      sources.sent[s] =
          sum / static_cast<double>(asked) + surfaces[s].reflectance->emitted() * lights.white;
      if (lights.bodies) sources.sent[s] += here.planetshine(s, lists);
    }
  };
  parallel_for((count + kSurfelsAtOnce - 1) / kSurfelsAtOnce, light_some, job);
  return sources;
}

void throw_sunlight(const trace::Scene& scene, std::uint32_t target, const SurfelSet& set,
                    const TransportLists& lists, std::span<const Glossy> others, Sources& to,
                    const Job& job) {
  const std::size_t count = to.sent.size();
  to.thrown.assign(count, glm::vec3(0));
  to.thrown_from.assign(count, {});
  const Mat3 own_from_world = glm::transpose(scene.targets()[target].frame.world_from);
  struct Other {
    glm::vec3 to_sun, irradiance;
    glm::mat3 own_from;
  };
  std::vector<Other> each;
  for (const Glossy& other : others) {
    const Mat3& world_from = scene.targets()[other.target].frame.world_from;
    each.push_back({glm::vec3(other.lights->to_sun * world_from),
                    glm::vec3(other.lights->sun_irradiance),
                    glm::mat3(own_from_world * world_from)});
  }
  const auto gather_some = [&](std::size_t chunk) {
    const std::size_t end = std::min(count, (chunk + 1) * kSurfelsAtOnce);
    for (std::size_t s = chunk * kSurfelsAtOnce; s < end; ++s) {
      glm::vec3 sum(0);
      Directions from;
      const float share = static_cast<float>(kPi) * lists.ray_share[s];
      const glm::vec3 own_normal(set.surfels()[s].normal);
      for (std::uint32_t i = lists.first_glossy[s]; i < lists.first_glossy[s + 1]; ++i) {
        const TransportLists::Glossy& ray = lists.glossy[i];
        const Glossy& other = others[ray.slot];
        const float lit = other.sources->lit[ray.surfel];
        if (!(lit > 0)) continue;
        const glm::vec3& to_sun = each[ray.slot].to_sun;
        const glm::vec3 normal = unpacked(ray.normal);
        if (!(glm::dot(normal, to_sun) > 0)) continue;
        const glm::vec3 back = unpacked(ray.back);
        const glm::vec3 radiance =
            lit * each[ray.slot].irradiance *
            other.surfaces[ray.surfel].reflectance->lobe(to_sun, back, normal);
        sum += radiance;
        from.add(share * (radiance.x + radiance.y + radiance.z) / 3,
                 -(each[ray.slot].own_from * back), own_normal);
      }
      to.thrown[s] = share * sum;
      to.thrown_from[s] = from;
    }
  };
  parallel_for((count + kSurfelsAtOnce - 1) / kSurfelsAtOnce, gather_some, job);
}

}  // namespace panwright::transport
