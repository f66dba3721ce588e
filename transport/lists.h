// Transport between surfels: what share of the light that each gets comes from which other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/job.h"
#include "base/math.h"
#include "trace/scene.h"
#include "transport/surfels.h"

namespace panwright::transport {

inline constexpr std::uint32_t kRaysAPoint = 4;

// Rays of a target's surfels, in compressed rows: those of a surfel that meet another one's piece
// are its share of the irradiance of surfels around. Shares of a row, the sky's and what is lost on
// insides add up to 1, so energy is kept.
struct TransportLists {
  struct Entry {
    std::uint32_t slot = 0;
    std::uint32_t surfel = 0;
    float share = 0;
    std::uint32_t direction = 0;  // packed(): the mean of its rays', in the own frame
  };
  // A ray that meets a glossy surfel: in the frame of that surfel's target.
  struct Glossy {
    std::uint32_t slot = 0;
    std::uint32_t surfel = 0;
    std::uint32_t normal = 0;  // packed(): where it meets
    std::uint32_t back = 0;    // packed(): towards its origin
  };
  std::vector<std::uint32_t> first;  // of each surfel's entries; one more at the end
  std::vector<Entry> entries;
  std::vector<std::uint32_t> first_glossy;  // as first
  std::vector<Glossy> glossy;
  std::vector<float> ray_share;    // of each surfel: of one of its rays
  std::vector<std::uint8_t> open;  // of each ray of each point, kRaysAPoint bits: leads to the sky
};

// A vector of components from -1 to 1 in thirty bits, to 0.001.
std::uint32_t packed(const Vec3& v);
inline glm::vec3 unpacked(std::uint32_t word) {
  constexpr float kStep = 1 / 511.0f;
  return kStep * (glm::vec3(word & 1023u, word >> 10 & 1023u, word >> 20 & 1023u) - 511.0f);
}

// The ray of a point of a surfel; in its target's frame.
//
//   ray  from 0 to kRaysAPoint - 1
Vec3 ray_direction(const SurfelSet& set, std::size_t surfel, std::uint32_t point,
                   std::uint32_t ray);

// Traces the rays of a target's surfels.
//
//   slots   by target of the world: its slot in sets, or ~0u
//   sets    by slot
//   glossy  by slot: of its surfels, 1 or 0; empty: none is
// Throws Cancelled. Cost: kRaysAPoint rays a point.
TransportLists transport_lists(const trace::Scene& scene, std::uint32_t target,
                               std::span<const std::uint32_t> slots,
                               std::span<const SurfelSet* const> sets,
                               std::span<const std::vector<std::uint8_t>> glossy, const Job& job);

// Light of a target's surfels by interreflections.
struct Arriving {
  std::vector<Vec3> irradiance;
  std::vector<light::SurfelSides> sides;
};

// Sums of a surfel's light by where it comes from, mean of the channels.
struct Directions {
  glm::vec3 from{0};                    // irradiances times directions along the surface
  float low = 0, middle = 0, high = 0;  // irradiances of bands of light::SurfelSides

  void add(float irradiance, const glm::vec3& direction, const glm::vec3& normal);
};

// Reflectance and emission of a target's surfels.
struct Sources {
  std::vector<Vec3> albedo;  // of light from everywhere
  std::vector<Vec3> sent;    // radiosity without interreflections, in the unit of irradiance
  std::vector<float> lit;    // share of the surface towards the Sun that it reaches
  // Of the Sun's light that lobes reflect, which is not in sent: radiosity, and what arrives of it
  // at each surfel; empty: none.
  std::vector<Vec3> glossy;
  std::vector<glm::vec3> thrown;
  std::vector<Directions> thrown_from;
};

// Returns what arrives at all surfels by interreflections, of all slots.
//
//   lists, sources, sets  by slot
//   bounces               1 or more: 1 is light that sources send directly
std::vector<Arriving> interreflections(std::span<const TransportLists* const> lists,
                                       std::span<const Sources* const> sources,
                                       std::span<const SurfelSet* const> sets, unsigned bounces,
                                       const Job& job);

}  // namespace panwright::transport
