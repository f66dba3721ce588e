// Light that reaches surfels straight from the Sun, bodies and lamps. Private to transport.
#pragma once

#include <optional>
#include <span>

#include "base/job.h"
#include "light/ground_shine.h"
#include "light/light.h"
#include "sky/shine_table.h"
#include "trace/scene.h"
#include "transport/lists.h"
#include "transport/reflectance.h"
#include "transport/surfels.h"
#include "world/world.h"

namespace panwright::transport {

// Lights of a target.
struct DirectLights {
  Vec3 to_sun{0, 0, 1};    // world axes, unit
  Vec3 sun_irradiance{0};  // less eclipses
  double sun_sine = 0;
  std::optional<sky::ShineTable> bodies;  // and terrain
  std::span<const light::Source> lamps;
  Vec3 white{1};
};
//   point   of the world, metres
//   ground  null: none
DirectLights direct_lights(const world::World& world, const Vec3& point,
                           std::span<const light::Source> lamps, const light::GroundShine* ground);

// Returns the light that surfels reflect of it, and their emission.
//
//   surfaces  of the surfels
// Throws Cancelled. Cost: one to four rays a surfel and light, by its area.
Sources direct_sources(const trace::Scene& scene, std::uint32_t target, const SurfelSet& set,
                       const TransportLists& lists, std::span<const ModelReflectance::At> surfaces,
                       const DirectLights& lights, const Job& job);

// Lobes of a target's surfels, as the Sun lights them.
struct Glossy {
  std::uint32_t target = 0;
  std::span<const ModelReflectance::At> surfaces;
  const DirectLights* lights = nullptr;
  const Sources* sources = nullptr;
};
// Sets Sources::thrown and thrown_from: the same rays whatever the Sun, so that it may turn.
//
//   others  by slot
// Throws Cancelled. Cost: one lobe a ray that meets a glossy surfel.
void throw_sunlight(const trace::Scene& scene, std::uint32_t target, const SurfelSet& set,
                    const TransportLists& lists, std::span<const Glossy> others, Sources& to,
                    const Job& job);

}  // namespace panwright::transport
