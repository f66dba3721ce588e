#include "transport/lists.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/parallel.h"
#include "base/random.h"

namespace panwright::transport {
namespace {

constexpr double kGolden = 0.6180339887498949;
constexpr std::size_t kRowsAtOnce = 64;

// A ray of a surfel that meets another one.
struct Met {
  std::uint32_t slot, surfel;
  Vec3 direction;
};

// Adds the entries of a surfel, its rays to one other merged.
void add_row(std::vector<Met>& row, double rays, std::vector<TransportLists::Entry>& to) {
  std::ranges::stable_sort(row, [](const Met& a, const Met& b) {
    return std::tie(a.slot, a.surfel) < std::tie(b.slot, b.surfel);
  });
  for (std::size_t i = 0; i < row.size();) {
    Vec3 sum(0);
    std::size_t end = i;
    for (; end < row.size() && row[end].slot == row[i].slot && row[end].surfel == row[i].surfel;
         ++end)
      sum += row[end].direction;
    const auto count = static_cast<double>(end - i);
    to.push_back(
        {row[i].slot, row[i].surfel, static_cast<float>(count / rays), packed(sum / count)});
    i = end;
  }
}

// What the rays of a few surfels found.
struct Rows {
  std::vector<TransportLists::Entry> entries;
  std::vector<TransportLists::Glossy> glossy;
};

// Rays of one surfel.
struct Tracer {
  const trace::Scene& scene;
  std::uint32_t target;
  std::span<const std::uint32_t> slots;
  std::span<const SurfelSet* const> sets;
  std::span<const std::vector<std::uint8_t>> glossy;

  void trace(std::size_t s, std::vector<Met>& row, TransportLists& lists, Rows& to) const {
    const SurfelSet& set = *sets[slots[target]];
    row.clear();
    std::uint32_t lost = 0;
    for (std::uint32_t p = set.first(s); p < set.first(s + 1); ++p)
      for (std::uint32_t k = 0; k < kRaysAPoint; ++k) {
        const trace::Ray ray{{set.points()[p].start, ray_direction(set, s, p, k)}, target};
        const trace::Hit hit = scene.nearest(ray, trace::Insides::stop);
        if (!hit) {
          lists.open[p] = static_cast<std::uint8_t>(lists.open[p] | 1u << k);
          continue;
        }
        if (scene.is_inside(hit)) continue;
        const std::uint32_t slot = slots[hit.target];
        const auto there = slot == ~0u ? std::nullopt : sets[slot]->find(hit);
        if (!there) {
          ++lost;  // too small a piece for a point: as the others
          continue;
        }
        row.push_back({slot, *there, ray.direction});
        if (!glossy.empty() && glossy[slot][*there] != 0)
          to.glossy.push_back(
              {slot, *there, packed(scene.surface(hit).normal), packed(-hit.direction)});
      }
    const std::uint32_t rays = kRaysAPoint * (set.first(s + 1) - set.first(s));
    const double counted = std::max(rays - lost, 1u);
    lists.ray_share[s] = static_cast<float>(1 / counted);
    add_row(row, counted, to.entries);
  }
};

// Counts of rows, one behind its place, to their beginnings.
void add_up(std::vector<std::uint32_t>& counts) {
  for (std::size_t s = 1; s < counts.size(); ++s) counts[s] += counts[s - 1];
}

}  // namespace

std::uint32_t packed(const Vec3& v) {
  const auto code = [](double x) {
    return static_cast<std::uint32_t>(std::floor(std::clamp(511 * x + 511.5, 0.0, 1022.0)));
  };
  return code(v.x) | code(v.y) << 10 | code(v.z) << 20;
}

Vec3 ray_direction(const SurfelSet& set, std::size_t surfel, std::uint32_t point,
                   std::uint32_t ray) {
  const std::uint32_t first = set.first(surfel);
  const std::uint32_t points = set.first(surfel + 1) - first;
  const std::uint32_t number = ray * points + (point - first);
  const Point& from = set.points()[point];
  const auto words = philox({static_cast<std::uint32_t>(surfel), from.part, 0, 0}, {0x7a45u, 0});
  return cosine_direction(from.normal,
                          (number + in_unit(words[0])) / (double{kRaysAPoint} * points),
                          fraction(kGolden * number + in_unit(words[1])));
}

TransportLists transport_lists(const trace::Scene& scene, std::uint32_t target,
                               std::span<const std::uint32_t> slots,
                               std::span<const SurfelSet* const> sets,
                               std::span<const std::vector<std::uint8_t>> glossy, const Job& job) {
  const SurfelSet& set = *sets[slots[target]];
  const std::size_t count = set.surfels().size();
  TransportLists lists;
  lists.first.assign(count + 1, 0);
  lists.first_glossy.assign(count + 1, 0);
  lists.ray_share.assign(count, 0);
  lists.open.assign(set.points().size(), 0);
  const std::size_t chunks = (count + kRowsAtOnce - 1) / kRowsAtOnce;
  std::vector<Rows> found(chunks);
  const Tracer tracer{scene, target, slots, sets, glossy};
  const auto trace_some = [&](std::size_t chunk) {
    std::vector<Met> row;
    Rows& rows = found[chunk];
    const std::size_t end = std::min(count, (chunk + 1) * kRowsAtOnce);
    for (std::size_t s = chunk * kRowsAtOnce; s < end; ++s) {
      const std::size_t entries = rows.entries.size(), narrow = rows.glossy.size();
      tracer.trace(s, row, lists, rows);
      lists.first[s + 1] = static_cast<std::uint32_t>(rows.entries.size() - entries);
      lists.first_glossy[s + 1] = static_cast<std::uint32_t>(rows.glossy.size() - narrow);
    }
  };
  parallel_for(chunks, trace_some, job);
  add_up(lists.first);
  add_up(lists.first_glossy);
  lists.entries.reserve(lists.first.back());
  lists.glossy.reserve(lists.first_glossy.back());
  for (const Rows& some : found) {
    lists.entries.insert(lists.entries.end(), some.entries.begin(), some.entries.end());
    lists.glossy.insert(lists.glossy.end(), some.glossy.begin(), some.glossy.end());
  }
  return lists;
}

namespace {

float mean(const glm::vec3& rgb) { return (rgb.x + rgb.y + rgb.z) / 3; }

light::SurfelSides fitted(float whole, const Directions& sums) {
  light::SurfelSides sides;
  if (!(whole > 0)) return sides;
  sides.across = sums.from / whole;
  sides.low = sums.low / whole;
  sides.middle = sums.middle / whole;
  sides.high = sums.high / whole;
  return sides;
}

}  // namespace

void Directions::add(float irradiance, const glm::vec3& direction, const glm::vec3& normal) {
  const float cosine = std::max(glm::dot(direction, normal), 0.0f);
  const glm::vec3 along = direction - glm::dot(direction, normal) * normal;
  from += irradiance / std::sqrt(std::max(glm::dot(along, along), 1e-6f)) * along;
  if (cosine * cosine < 1 / 16.0f)
    low += irradiance;
  else if (cosine * cosine < 1 / 4.0f)
    middle += irradiance;
  else if (cosine * cosine < 1 / 2.0f)
    high += irradiance;
}

std::vector<Arriving> interreflections(std::span<const TransportLists* const> lists,
                                       std::span<const Sources* const> sources,
                                       std::span<const SurfelSet* const> sets, unsigned bounces,
                                       const Job& job) {
  constexpr std::size_t kAtOnce = 256;
  // radiosities of all slots, one after the other, in single precision
  std::vector<std::size_t> base;
  std::size_t total = 0;
  for (const Sources* one : sources) {
    base.push_back(total);
    total += one->sent.size();
  }
  struct Chunk {
    std::size_t slot, begin, end;
  };
  std::vector<Chunk> chunks;
  std::vector<glm::vec3> sent(total), next(total), arriving(total);
  for (std::size_t slot = 0; slot < sources.size(); ++slot) {
    const std::vector<Vec3>& own = sources[slot]->sent;
    for (std::size_t i = 0; i < own.size(); ++i) sent[base[slot] + i] = glm::vec3(own[i]);
    for (std::size_t i = 0; i < own.size(); i += kAtOnce)
      chunks.push_back({slot, i, std::min(own.size(), i + kAtOnce)});
  }
  for (unsigned bounce = 0; bounce < bounces; ++bounce) {
    parallel_for(
        chunks.size(),
        [&](std::size_t c) {
          const auto [slot, begin, end] = chunks[c];
          const TransportLists& own = *lists[slot];
          for (std::size_t s = begin; s < end; ++s) {
            glm::vec3 sum(0);
            if (!sources[slot]->thrown.empty()) sum = sources[slot]->thrown[s];
            for (std::uint32_t e = own.first[s]; e < own.first[s + 1]; ++e) {
              const TransportLists::Entry& entry = own.entries[e];
              sum += entry.share * sent[base[entry.slot] + entry.surfel];
            }
            arriving[base[slot] + s] = sum;
            next[base[slot] + s] =
                glm::vec3(sources[slot]->sent[s] + sources[slot]->albedo[s] * Vec3(sum));
          }
        },
        job);
    std::swap(sent, next);
  }
  // next: what was sent last
  std::vector<Arriving> result(sources.size());
  for (std::size_t slot = 0; slot < sources.size(); ++slot) {
    const std::size_t count = sources[slot]->sent.size();
    result[slot].sides.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      result[slot].irradiance.emplace_back(arriving[base[slot] + i]);
  }
  parallel_for(
      chunks.size(),
      [&](std::size_t c) {
        const auto [slot, begin, end] = chunks[c];
        const TransportLists& own = *lists[slot];
        for (std::size_t s = begin; s < end; ++s) {
          const glm::vec3 normal(sets[slot]->surfels()[s].normal);
          Directions from;
          if (!sources[slot]->thrown.empty()) from = sources[slot]->thrown_from[s];
          for (std::uint32_t e = own.first[s]; e < own.first[s + 1]; ++e) {
            const TransportLists::Entry& entry = own.entries[e];
            from.add(entry.share * mean(next[base[entry.slot] + entry.surfel]),
                     unpacked(entry.direction), normal);
          }
          result[slot].sides[s] = fitted(mean(arriving[base[slot] + s]), from);
        }
      },
      job);
  return result;
}

}  // namespace panwright::transport
