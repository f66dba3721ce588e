#include "ephemeris/internal/ck.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace panwright::ephemeris {

namespace {

constexpr std::size_t kQuaternion = 4;
constexpr std::size_t kWithRates = 7;
constexpr std::size_t kPacket2 = 8;  // and two times
constexpr std::size_t kStep = 100;   // of directories

std::size_t directory_of(std::size_t count) { return count == 0 ? 0 : (count - 1) / kStep; }

// Unit quaternion; nothing: it is no rotation.
std::optional<Quat> quaternion(const Doubles& data, std::size_t at) {
  const Quat q(data[at], data[at + 1], data[at + 2], data[at + 3]);
  const double length = std::sqrt(dot(q, q));
  if (!(length > 0.5 && length < 2)) return std::nullopt;
  return Quat(q.w / length, q.x / length, q.y / length, q.z / length);
}

Vec3 vector_at(const Doubles& data, std::size_t at) {
  return {data[at], data[at + 1], data[at + 2]};
}

Quat turned_about(const Vec3& axis, double angle) {
  const double length = std::sqrt(dot(axis, axis));
  if (!(length > 0)) return {1, 0, 0, 0};
  const det::SinCos half = det::sincos(angle / 2);
  const Vec3 v = axis * (half.sin / length);
  return {half.cos, v.x, v.y, v.z};
}

std::optional<Pointing> pointing(const Quat& q, std::optional<Vec3> rate) {
  if (rate && !is_finite(*rate)) return std::nullopt;
  return Pointing{glm::mat3_cast(q), rate};
}

// Of type 2: each pointing holds from a time to another, and turns evenly.
std::optional<Pointing> even_turn(const CkLayout& layout, const Doubles& data, double ticks) {
  const Doubles starts = data.part(kPacket2 * layout.count, layout.count),
                stops = data.part((kPacket2 + 1) * layout.count, layout.count);
  const std::size_t i = last_at_or_below(starts, ticks);
  if (!(starts[i] <= ticks && ticks <= stops[i])) return std::nullopt;
  const std::size_t at = kPacket2 * i;
  const auto q = quaternion(data, at);
  if (!q) return std::nullopt;
  const Vec3 rate = vector_at(data, at + kQuaternion);
  const double angle = std::sqrt(dot(rate, rate)) * (ticks - starts[i]) * data[at + 7];
  if (!std::isfinite(angle)) return std::nullopt;
  return pointing(*q * turned_about(rate, -angle), rate);
}

// Times of type 3: of pointings, and starts of intervals without gaps.
struct Times3 {
  Doubles times, starts;
};

Times3 times_of(const CkLayout& layout, const Doubles& data) {
  const std::size_t packet = layout.with_rates ? kWithRates : kQuaternion;
  const std::size_t first = packet * layout.count;
  return {data.part(first, layout.count),
          data.part(first + layout.count + directory_of(layout.count), layout.intervals)};
}

std::optional<Pointing> between(const CkLayout& layout, const Doubles& data, double ticks) {
  const std::size_t packet = layout.with_rates ? kWithRates : kQuaternion;
  const auto [times, starts] = times_of(layout, data);
  const std::size_t i = last_at_or_below(times, ticks);
  if (!(times[i] <= ticks)) return std::nullopt;
  const auto q = quaternion(data, packet * i);
  if (!q) return std::nullopt;
  const auto rate_at = [&](std::size_t k) -> std::optional<Vec3> {
    if (!layout.with_rates) return std::nullopt;
    return vector_at(data, packet * k + kQuaternion);
  };
  if (times[i] == ticks) return pointing(*q, rate_at(i));
  if (i + 1 >= layout.count) return std::nullopt;
  // a gap, where an interval starts at the next one
  const std::size_t run = last_at_or_below(starts, times[i + 1]);
  if (starts[run] > times[i]) return std::nullopt;
  const auto next = quaternion(data, packet * (i + 1));
  const double share = (ticks - times[i]) / (times[i + 1] - times[i]);
  if (!next || !(share >= 0 && share <= 1)) return std::nullopt;
  // the turn between them, in its shorter sense
  Quat turn = conjugate(*q) * *next;
  if (turn.w < 0) turn = -turn;
  const Vec3 axis(turn.x, turn.y, turn.z);
  const double angle = 2 * det::atan2(std::sqrt(dot(axis, axis)), turn.w);
  auto rate = rate_at(i);
  if (rate) *rate = (1 - share) * *rate + share * *rate_at(i + 1);
  return pointing(*q * turned_about(axis, share * angle), rate);
}

}  // namespace

bool is_ck_type_read(int type) { return type == 2 || type == 3; }

bool ck_layout(int type, bool with_rates, const Doubles& data, CkLayout& out,
               std::string& problem) {
  const std::size_t n = data.size();
  out = {type, with_rates, 0, 0};
  bool sound = false;
  if (type == 2) {
    out.with_rates = true;
    // no count is written: 10 numbers each, and a directory entry for each 100
    constexpr std::size_t kEach = kPacket2 + 2;
    out.count = (n * kStep + kStep) / (kEach * kStep + 1);
    while (out.count > 0 && kEach * out.count + directory_of(out.count) > n) --out.count;
    sound = out.count > 0 && kEach * out.count + directory_of(out.count) == n;
  } else if (type == 3 && n >= 2) {
    const std::size_t packet = with_rates ? kWithRates : kQuaternion;
    out.intervals = whole_number(data[n - 2], n);
    out.count = whole_number(data[n - 1], n);
    sound = out.count > 0 && out.count <= n && out.intervals > 0 && out.intervals <= out.count &&
            (packet + 1) * out.count + directory_of(out.count) + out.intervals +
                    directory_of(out.intervals) + 2 <=
                n;
  }
  if (!sound) problem = fmt::format("its counts do not fit its {} numbers", n);
  return sound;
}

std::optional<Pointing> ck_pointing(const CkLayout& layout, const Doubles& data, double ticks) {
  return layout.type == 2 ? even_turn(layout, data, ticks) : between(layout, data, ticks);
}

std::vector<Interval> ck_spans(const CkLayout& layout, const Doubles& data) {
  std::vector<Interval> out;
  const auto add = [&](double begin, double end) {
    if (!(begin <= end) || (!out.empty() && !(out.back().end <= begin))) return;
    if (!out.empty() && out.back().end == begin)
      out.back().end = end;
    else
      out.push_back({begin, end});
  };
  if (layout.type == 2) {
    for (std::size_t i = 0; i < layout.count; ++i)
      add(data[kPacket2 * layout.count + i], data[(kPacket2 + 1) * layout.count + i]);
    return out;
  }
  const auto [times, starts] = times_of(layout, data);
  for (std::size_t i = 0; i < layout.intervals; ++i) {
    std::size_t last = layout.count - 1;
    if (i + 1 < layout.intervals) {
      last = last_at_or_below(times, starts[i + 1]);
      if (last > 0 && times[last] >= starts[i + 1]) --last;
    }
    add(starts[i], times[last]);
  }
  return out;
}

}  // namespace panwright::ephemeris
