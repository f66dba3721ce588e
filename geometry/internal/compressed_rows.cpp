#include "geometry/internal/compressed_rows.h"

#include <algorithm>

#include "base/parallel.h"

namespace panwright::geometry {

CompressedRows compressed_rows_by(std::span<const std::uint32_t> keys, std::size_t count) {
  CompressedRows rows;
  std::vector<std::uint32_t>& start = rows.start;
  start.assign(count + 2, 0);
  // each task scans all keys for those of its range, whose counters stay in its cache
  const std::size_t tasks = keys.size() < 50'000 ? 1 : 8;
  const auto each = [&](std::size_t task, const auto& body) {
    const auto begin = static_cast<std::uint32_t>(count * task / tasks);
    const auto length = static_cast<std::uint32_t>(count * (task + 1) / tasks) - begin;
    for (std::uint32_t i = 0; i < keys.size(); ++i)
      if (keys[i] - begin < length) body(keys[i], i);
  };
  parallel_for(tasks, [&](std::size_t task) {
    each(task, [&](std::uint32_t key, std::uint32_t) { ++start[key + 2]; });
  });
  for (std::size_t i = 2; i < start.size(); ++i) start[i] += start[i - 1];
  rows.items.resize(start.back());
  parallel_for(tasks, [&](std::size_t task) {
    // start[key + 1] of a key's own range alone is touched: it runs up to what start[key + 2] was
    each(task, [&](std::uint32_t key, std::uint32_t i) { rows.items[start[key + 1]++] = i; });
  });
  start.pop_back();
  return rows;
}

}  // namespace panwright::geometry
