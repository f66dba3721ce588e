#include "ephemeris/internal/timeline.h"

#include <algorithm>
#include <set>
#include <utility>

namespace panwright::ephemeris {

Timeline Timeline::of(const std::vector<Piece>& spans) {
  Timeline out;
  // begins and ends in order of time; at one time begins first, so that points are pieces too
  struct Event {
    double time;
    bool ends;
    std::size_t item;
  };
  std::vector<Event> events;
  events.reserve(2 * spans.size());
  for (const Piece& each : spans) {
    events.push_back({each.begin, false, each.item});
    events.push_back({each.end, true, each.item});
  }
  std::ranges::sort(events, [](const Event& a, const Event& b) {
    return std::pair(a.time, a.ends) < std::pair(b.time, b.ends);
  });
  std::multiset<std::size_t> active;
  double since = 0;
  for (const Event& event : events) {
    const bool had = !active.empty();
    const std::size_t before = had ? *active.rbegin() : 0;
    if (event.ends)
      active.erase(active.find(event.item));
    else
      active.insert(event.item);
    const bool has = !active.empty();
    if (had && has && *active.rbegin() == before) continue;
    if (had) out.pieces_.push_back({since, event.time, before});
    since = event.time;
  }
  return out;
}

std::optional<std::size_t> Timeline::at(double time) const {
  auto next = std::ranges::upper_bound(pieces_, time, {}, &Piece::begin);
  std::optional<std::size_t> out;
  // pieces that share the time as a bound: the greatest item
  while (next != pieces_.begin()) {
    --next;
    if (next->end < time) break;
    out = std::max(out.value_or(next->item), next->item);
  }
  return out;
}

std::vector<Interval> joined(const std::vector<Interval>& spans) {
  std::vector<Interval> out;
  for (const Interval& each : spans) {
    if (!out.empty() && each.begin <= out.back().end)
      out.back().end = std::max(out.back().end, each.end);
    else
      out.push_back(each);
  }
  return out;
}

}  // namespace panwright::ephemeris
