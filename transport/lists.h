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
  };
  std::vector<std::uint32_t> first;  // of each surfel's entries; one more at the end
  std::vector<Entry> entries;
  std::vector<std::uint8_t> open;  // of each ray of each point, kRaysAPoint bits: leads to the sky
};

// The ray of a point of a surfel; in its target's frame.
//
//   ray  from 0 to kRaysAPoint - 1
Vec3 ray_direction(const SurfelSet& set, std::size_t surfel, std::uint32_t point,
                   std::uint32_t ray);

// Traces the rays of a target's surfels.
//
//   slots  by target of the world: its slot in sets, or ~0u
//   sets   by slot
// Throws Cancelled. Cost: kRaysAPoint rays a point.
TransportLists transport_lists(const trace::Scene& scene, std::uint32_t target,
                               std::span<const std::uint32_t> slots,
                               std::span<const SurfelSet* const> sets, const Job& job);

// Reflectance and emission of a target's surfels.
struct Sources {
  std::vector<Vec3> albedo;  // of light from everywhere
  std::vector<Vec3> sent;    // radiosity without interreflections, in the unit of irradiance
};

// Returns the irradiance of all surfels by interreflections, of all slots.
//
//   lists, sources  by slot
//   bounces         1 or more: 1 is light that sources send directly
std::vector<std::vector<Vec3>> interreflections(std::span<const TransportLists* const> lists,
                                                std::span<const Sources* const> sources,
                                                unsigned bounces, const Job& job);

}  // namespace panwright::transport
