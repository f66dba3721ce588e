#include "scenario/internal/track.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace panwright::scenario {

namespace {

std::size_t interval_before(const std::vector<double>& times, double time) {
  const auto next = std::ranges::upper_bound(times, time);
  const auto at = static_cast<std::size_t>(next - times.begin());
  return std::clamp<std::size_t>(at, 1, times.size() - 1) - 1;
}

struct Nodes {
  std::size_t first = 0;
  std::size_t count = 1;
};

// Nodes of a polynomial of a degree; fewer where there are fewer samples.
template <class Value>
Nodes nodes_of(const Samples<Value>& samples, double time, bool with_velocities) {
  const std::size_t wanted = with_velocities ? (samples.degree + 2) / 2 : samples.degree + 1;
  const std::size_t most = with_velocities ? kMaxNodes / 2 : kMaxNodes;
  const std::size_t count =
      std::clamp<std::size_t>(wanted, 1, std::min(most, samples.times.size()));
  return {first_node(samples.times, time, count), count};
}

template <class Value>
std::span<const Value> part(const std::vector<Value>& all, const Nodes& nodes) {
  return std::span(all).subspan(nodes.first, nodes.count);
}

double share_of(const std::vector<double>& times, std::size_t i, double time) {
  return (time - times[i]) / (times[i + 1] - times[i]);
}

}  // namespace

double value_at(const Samples<double>& samples, double time) {
  if (samples.times.size() == 1) return samples.values[0];
  if (samples.method == Method::cubic) return cubic(samples.times, samples.values, time);
  const std::size_t i = interval_before(samples.times, time);
  const double s = share_of(samples.times, i, time);
  return samples.values[i] * (1 - s) + samples.values[i + 1] * s;
}

Vec3 value_at(const Samples<Vec3>& samples, double time) {
  if (samples.times.size() == 1) return samples.values[0];
  if (samples.method == Method::cubic) return cubic(samples.times, samples.values, time);
  if (samples.method == Method::linear) {
    const std::size_t i = interval_before(samples.times, time);
    const double s = share_of(samples.times, i, time);
    return samples.values[i] * (1 - s) + samples.values[i + 1] * s;
  }
  const bool with_velocities = samples.method == Method::hermite && !samples.velocities.empty();
  const Nodes nodes = nodes_of(samples, time, with_velocities);
  if (with_velocities)
    return hermite(part(samples.times, nodes), part(samples.values, nodes),
                   part(samples.velocities, nodes), time);
  return lagrange(part(samples.times, nodes), part(samples.values, nodes), time);
}

Quat value_at(const Samples<Quat>& samples, double time) {
  if (samples.times.size() == 1) return samples.values[0];
  if (samples.method == Method::cubic) return cubic(samples.times, samples.values, time);
  if (samples.method == Method::linear || samples.degree < 2) {
    const std::size_t i = interval_before(samples.times, time);
    return slerp(samples.values[i], samples.values[i + 1], share_of(samples.times, i, time));
  }
  const Nodes nodes = nodes_of(samples, time, false);
  std::vector<Vec4> components;
  Quat before = samples.values[nodes.first];
  for (const Quat& each : part(samples.values, nodes)) {
    const Quat aligned = dot(before, each) < 0 ? -each : each;
    components.emplace_back(aligned.x, aligned.y, aligned.z, aligned.w);
    before = aligned;
  }
  const Vec4 q = lagrange(part(samples.times, nodes), components, time);
  return normalize(Quat(q.w, q.x, q.y, q.z));
}

std::vector<Piece> pieces_of(const std::vector<TimeSpan>& spans, std::size_t& overlaps) {
  overlaps = spans.size();
  std::vector<Piece> out;
  std::vector<Piece> rest;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    // what the pieces so far leave of this one
    rest.assign(1, {spans[i], i});
    auto at = std::ranges::lower_bound(out, spans[i].begin, {},
                                       [](const Piece& p) { return p.span.end; });
    for (; at != out.end() && at->span.begin <= spans[i].end; ++at) {
      Piece& last = rest.back();
      if (at->span.end > last.span.begin && at->span.begin < last.span.end) {
        overlaps = std::min(overlaps, i);
        const TimeSpan after{at->span.end, last.span.end};
        last.span.end = at->span.begin;
        if (!(last.span.begin < last.span.end)) rest.pop_back();
        if (!(after.begin < after.end)) break;
        rest.push_back({after, i});
      } else if (at->span.contains(last.span.begin) && at->span.contains(last.span.end)) {
        overlaps = std::min(overlaps, i);  // one instant within
        rest.pop_back();
        break;
      }
    }
    for (const Piece& piece : rest)
      out.insert(std::ranges::upper_bound(out, piece.span.begin, {},
                                          [](const Piece& p) { return p.span.begin; }),
                 piece);
  }
  return out;
}

std::vector<TimeSpan> spans_of(const std::vector<Piece>& pieces) {
  std::vector<TimeSpan> out;
  for (const Piece& piece : pieces) out.push_back(piece.span);
  return out;
}

std::size_t segment_at(const std::vector<Piece>& pieces, double time) {
  const auto next =
      std::ranges::upper_bound(pieces, time, {}, [](const Piece& p) { return p.span.begin; });
  return std::prev(next)->segment;
}

void report_gap(const std::vector<double>& times, Input& input, std::string_view at) {
  constexpr double kLong = 10;
  if (times.size() < 4) return;
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < times.size(); ++i) steps.push_back(times[i + 1] - times[i]);
  const auto longest = std::ranges::max_element(steps);
  const double most = *longest;
  const double from = times[static_cast<std::size_t>(longest - steps.begin())];
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  if (most <= kLong * *middle) return;
  input.report(Code("W8011"), at,
               fmt::format("a step of {} s begins at {} s; the median step is {} s, and values in "
                           "between are interpolated over the gap",
                           most, from, *middle),
               "divide the samples into segments where nothing is known in between");
}

}  // namespace panwright::scenario
