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

// Entries of a surfel, those of one other merged.
void add_row(std::vector<TransportLists::Entry>& row, double rays,
             std::vector<TransportLists::Entry>& to) {
  std::ranges::sort(row, [](const auto& a, const auto& b) {
    return std::tie(a.slot, a.surfel) < std::tie(b.slot, b.surfel);
  });
  for (std::size_t i = 0; i < row.size();) {
    std::size_t end = i;
    while (end < row.size() && row[end].slot == row[i].slot && row[end].surfel == row[i].surfel)
      ++end;
    row[i].share = static_cast<float>(static_cast<double>(end - i) / rays);
    to.push_back(row[i]);
    i = end;
  }
}

}  // namespace

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
                               std::span<const SurfelSet* const> sets, const Job& job) {
  const SurfelSet& set = *sets[slots[target]];
  const std::size_t count = set.surfels().size();
  TransportLists lists;
  lists.first.assign(count + 1, 0);
  lists.open.assign(set.points().size(), 0);
  const std::size_t chunks = (count + kRowsAtOnce - 1) / kRowsAtOnce;
  std::vector<std::vector<TransportLists::Entry>> found(chunks);
  const auto trace_some = [&](std::size_t chunk) {
    std::vector<TransportLists::Entry> row;
    const std::size_t end = std::min(count, (chunk + 1) * kRowsAtOnce);
    for (std::size_t s = chunk * kRowsAtOnce; s < end; ++s) {
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
          if (there)
            row.push_back({slot, *there, 0});
          else
            ++lost;  // too small a piece for a point: as the others
        }
      const std::uint32_t rays = kRaysAPoint * (set.first(s + 1) - set.first(s));
      const std::size_t before = found[chunk].size();
      add_row(row, std::max(rays - lost, 1u), found[chunk]);
      lists.first[s + 1] = static_cast<std::uint32_t>(found[chunk].size() - before);
    }
  };
  parallel_for(chunks, trace_some, job);
  for (std::size_t s = 0; s < count; ++s) lists.first[s + 1] += lists.first[s];
  lists.entries.reserve(lists.first.back());
  for (const auto& some : found)
    lists.entries.insert(lists.entries.end(), some.begin(), some.end());
  return lists;
}

std::vector<std::vector<Vec3>> interreflections(std::span<const TransportLists* const> lists,
                                                std::span<const Sources* const> sources,
                                                unsigned bounces, const Job& job) {
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
  std::vector<std::vector<Vec3>> result;
  for (std::size_t slot = 0; slot < sources.size(); ++slot) {
    std::vector<Vec3>& own = result.emplace_back();
    for (std::size_t i = 0; i < sources[slot]->sent.size(); ++i)
      own.emplace_back(arriving[base[slot] + i]);
  }
  return result;
}

}  // namespace panwright::transport
