#include "ephemeris/internal/spk.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace panwright::ephemeris {

namespace {

constexpr std::size_t kAxes = 3;
constexpr std::size_t kState = 6;
constexpr std::size_t kMostWindow = 64;
constexpr std::size_t kMostTerms = 40;  // of a difference array; writers have 25
constexpr std::size_t kMostCount = 1u << 31;
constexpr std::size_t kDirectoryStep = 100;

// ---- Chebyshev polynomials: types 2 and 3, and binary PCK

struct ValueAndSlope {
  double value = 0, slope = 0;
};

// Clenshaw's sums of a series and of its derivative by x.
ValueAndSlope chebyshev(const Doubles& data, std::size_t first, std::size_t count, double x) {
  double b1 = 0, b2 = 0, d1 = 0, d2 = 0;
  for (std::size_t k = count - 1; k > 0; --k) {
    const double b = 2 * x * b1 - b2 + data[first + k];
    const double d = 2 * x * d1 - d2 + 2 * b1;
    b2 = b1;
    b1 = b;
    d2 = d1;
    d1 = d;
  }
  return {x * b1 - b2 + data[first], x * d1 - d2 + b1};
}

bool chebyshev_layout(const Doubles& data, std::size_t series, SpkLayout& out) {
  const std::size_t n = data.size();
  if (n < 4) return false;
  out.size = whole_number(data[n - 2], n);
  out.count = whole_number(data[n - 1], n);
  return out.size <= n && out.count <= n && out.count > 0 && out.size >= 2 + series &&
         (out.size - 2) % series == 0 && out.count <= (n - 4) / out.size && data[n - 3] > 0;
}

bool chebyshev_state(const SpkLayout& layout, const Doubles& data, double et, State& out) {
  const std::size_t n = data.size();
  const double index = std::floor((et - data[n - 4]) / data[n - 3]);
  const auto most = static_cast<double>(layout.count - 1);
  if (!(index >= -1e15 && index <= 1e15)) return false;
  const auto record = static_cast<std::size_t>(std::clamp(index, 0.0, most));
  const Doubles part = data.part(record * layout.size, layout.size);
  const bool both = layout.type == 3;
  const std::size_t terms = (layout.size - 2) / (both ? kState : kAxes);
  const double radius = part[1];
  const double x = (et - part[0]) / radius;
  for (std::size_t i = 0; i < kAxes; ++i) {
    const auto axis = static_cast<Vec3::length_type>(i);
    const ValueAndSlope p = chebyshev(part, 2 + i * terms, terms, x);
    out.position[axis] = p.value;
    out.velocity[axis] =
        both ? chebyshev(part, 2 + (kAxes + i) * terms, terms, x).value : p.slope / radius;
  }
  return true;
}

// ---- modified difference arrays: types 1 and 21

constexpr std::size_t kGauss = kMostTerms / 2 + 1;  // points of the longest

// Points and weights on [0, 1]; n of them are exact for polynomials of degree 2n − 1.
struct GaussRule {
  std::array<double, kGauss> x{}, weight{};
};

GaussRule gauss_rule(std::size_t points) {
  GaussRule out;
  const auto n = static_cast<double>(points);
  for (std::size_t i = 0; i < points; ++i) {
    double z = det::cos(kPi * (static_cast<double>(i) + 0.75) / (n + 0.5));
    double slope = 1;
    constexpr int kSteps = 8;  // of Newton's, quadratic
    for (int step = 0; step < kSteps; ++step) {
      double p = 1, before = 0;
      for (std::size_t k = 0; k < points; ++k) {
        const double older = before;
        before = p;
        const auto d = static_cast<double>(k);
        p = ((2 * d + 1) * z * before - d * older) / (d + 1);
      }
      slope = n * (z * p - before) / (z * z - 1);
      z -= p / slope;
    }
    out.x[i] = 0.5 * (1 - z);
    out.weight[i] = 1 / ((1 - z * z) * slope * slope);
  }
  return out;
}

const GaussRule& rule_of(std::size_t points) {
  static const auto rules = [] {
    std::array<GaussRule, kGauss + 1> out;
    for (std::size_t n = 1; n < out.size(); ++n) out[n] = gauss_rule(n);
    return out;
  }();
  return rules[points];
}

bool difference_layout(const Doubles& data, SpkLayout& out) {
  const std::size_t n = data.size();
  constexpr std::size_t kOwnTerms = 15;  // of type 1
  const std::size_t tail = out.type == 1 ? 1 : 2;
  if (n <= tail) return false;
  out.size = out.type == 1 ? kOwnTerms : whole_number(data[n - 2], kMostTerms);
  out.count = whole_number(data[n - 1], n);
  if (out.size > kMostTerms || out.size == 0 || out.count > n || out.count == 0) return false;
  return out.count <= (n - tail) / (4 * out.size + 12);
}

bool difference_state(const SpkLayout& layout, const Doubles& data, double et, State& out) {
  const std::size_t terms = layout.size;
  const std::size_t length = 4 * terms + 11;
  const Doubles epochs = data.part(layout.count * length, layout.count);
  // the first record whose epoch is not before
  std::size_t record = last_at_or_below(epochs, et);
  if (epochs[record] < et && record + 1 < layout.count) ++record;
  const Doubles part = data.part(record * length, length);
  const double x = et - part[0];
  std::array<double, kMostTerms> step{}, inverse{};
  for (std::size_t m = 0; m < terms; ++m) {
    step[m] = part[1 + m];
    inverse[m] = step[m] != 0 ? 1 / step[m] : 0;
  }
  std::array<std::size_t, kAxes> orders{};
  std::size_t most = 0;
  for (std::size_t i = 0; i < kAxes; ++i) {
    orders[i] = whole_number(part[8 + 4 * terms + i], terms);
    if (orders[i] > terms) return false;
    most = std::max(most, orders[i]);
  }
  Vec3 once(0), twice(0);  // integrals of the acceleration
  const std::size_t points = most / 2 + 1;
  const GaussRule& rule = rule_of(points);
  for (std::size_t k = 0; k < points; ++k) {
    const double at = x * rule.x[k];
    Vec3 acceleration(0);
    double product = 1;
    for (std::size_t j = 0; j < most; ++j) {
      if (j > 0) product *= (at + (j > 1 ? step[j - 2] : 0.0)) * inverse[j - 1];
      for (std::size_t i = 0; i < kAxes; ++i)
        if (j < orders[i])
          acceleration[static_cast<Vec3::length_type>(i)] +=
              part[7 + terms + i * terms + j] * product;
    }
    once += rule.weight[k] * acceleration;
    twice += rule.weight[k] * (1 - rule.x[k]) * acceleration;
  }
  const std::size_t reference = 1 + terms;
  const Vec3 position(part[reference], part[reference + 2], part[reference + 4]);
  const Vec3 velocity(part[reference + 1], part[reference + 3], part[reference + 5]);
  out.velocity = velocity + x * once;
  out.position = position + x * (velocity + x * twice);
  return true;
}

// ---- interpolation between states: types 8, 9, 12, 13, 18 and 19

// Nodes of one interpolation, with times relative to the one asked for.
struct Nodes {
  std::size_t count = 0;
  std::array<double, kMostWindow> times{};
  std::array<std::size_t, kMostWindow> packets{};  // their numbers begin there
};

// Value at 0 of the polynomial through the nodes (Neville's scheme).
double lagrange(const Nodes& nodes, const Doubles& data, std::size_t offset) {
  std::array<double, kMostWindow> p{};
  for (std::size_t i = 0; i < nodes.count; ++i) p[i] = data[nodes.packets[i] + offset];
  for (std::size_t m = 1; m < nodes.count; ++m)
    for (std::size_t i = 0; i + m < nodes.count; ++i)
      p[i] = (nodes.times[i] * p[i + 1] - nodes.times[i + m] * p[i]) /
             (nodes.times[i] - nodes.times[i + m]);
  return p[0];
}

// Value and slope at 0 of the polynomial with values and slopes of the nodes (Newton's divided
// differences with each node twice).
ValueAndSlope hermite(const Nodes& nodes, const Doubles& data, std::size_t value_offset,
                      std::size_t slope_offset) {
  std::array<double, 2 * kMostWindow> z{}, p{};
  const std::size_t count = 2 * nodes.count;
  for (std::size_t i = 0; i < count; ++i) {
    z[i] = nodes.times[i / 2];
    p[i] = data[nodes.packets[i / 2] + value_offset];
  }
  for (std::size_t i = count - 1; i > 0; --i)
    p[i] = i % 2 == 1 ? data[nodes.packets[i / 2] + slope_offset]
                      : (p[i] - p[i - 1]) / (z[i] - z[i - 1]);
  for (std::size_t m = 2; m < count; ++m)
    for (std::size_t i = count - 1; i >= m; --i) p[i] = (p[i] - p[i - 1]) / (z[i] - z[i - m]);
  ValueAndSlope out{p[count - 1], 0};
  for (std::size_t i = count - 1; i > 0; --i) {
    out.slope = out.value - z[i - 1] * out.slope;
    out.value = p[i - 1] - z[i - 1] * out.value;
  }
  return out;
}

enum class Scheme { lagrange, hermite, twice_hermite };

void interpolate(Scheme scheme, const Nodes& nodes, const Doubles& data, State& out) {
  for (std::size_t i = 0; i < kAxes; ++i) {
    const auto axis = static_cast<Vec3::length_type>(i);
    switch (scheme) {
      case Scheme::lagrange:
        out.position[axis] = lagrange(nodes, data, i);
        out.velocity[axis] = lagrange(nodes, data, i + kAxes);
        break;
      case Scheme::hermite: {
        const ValueAndSlope both = hermite(nodes, data, i, i + kAxes);
        out.position[axis] = both.value;
        out.velocity[axis] = both.slope;
        break;
      }
      case Scheme::twice_hermite:
        out.position[axis] = hermite(nodes, data, i, i + kAxes).value;
        out.velocity[axis] = hermite(nodes, data, i + kState, i + kState + kAxes).value;
        break;
    }
  }
}

// Index of the first node: an even number of nodes lies around the time, an odd one around the
// nearest node; at both ends they begin or end there.
//
//   low   the last node at or before the time
//   near  whether the next node is nearer
std::size_t first_node(std::size_t low, bool near, std::size_t window, std::size_t count) {
  const std::size_t middle = window % 2 == 1 && near ? low + 1 : low;
  const std::size_t before = (window - 1) / 2;
  const std::size_t first = middle > before ? middle - before : 0;
  return std::min(first, count - window);
}

void interpolate_even_steps(const SpkLayout& layout, const Doubles& data, double et, State& out) {
  const std::size_t n = data.size();
  const double begin = data[n - 4], step = data[n - 3];
  const double place = (et - begin) / step;
  const auto most = static_cast<double>(layout.count - 1);
  const double low = place > 0 ? std::min(std::floor(place), most) : 0.0;
  Nodes nodes;
  nodes.count = std::min(layout.window, layout.count);
  const std::size_t first = first_node(static_cast<std::size_t>(low),
                                       place - low > 0.5 && low < most, nodes.count, layout.count);
  for (std::size_t i = 0; i < nodes.count; ++i) {
    nodes.times[i] = begin + static_cast<double>(first + i) * step - et;
    nodes.packets[i] = (first + i) * kState;
  }
  interpolate(layout.type == 8 ? Scheme::lagrange : Scheme::hermite, nodes, data, out);
}

// Packets, then as many epochs.
void interpolate_at_epochs(const Doubles& data, std::size_t count, std::size_t packet,
                           std::size_t window, Scheme scheme, double et, State& out) {
  const Doubles epochs = data.part(count * packet, count);
  const std::size_t low = last_at_or_below(epochs, et);
  Nodes nodes;
  nodes.count = std::min(window, count);
  const bool near = low + 1 < count && epochs[low + 1] - et < et - epochs[low];
  const std::size_t first = first_node(low, near, nodes.count, count);
  for (std::size_t i = 0; i < nodes.count; ++i) {
    nodes.times[i] = epochs[first + i] - et;
    nodes.packets[i] = (first + i) * packet;
  }
  interpolate(scheme, nodes, data, out);
}

std::size_t directory(std::size_t count) { return (count - 1) / kDirectoryStep; }

bool states_layout(const Doubles& data, SpkLayout& out) {
  const std::size_t n = data.size();
  const bool even = out.type == 8 || out.type == 12;
  const std::size_t tail = even ? 4 : 2;
  if (n < tail) return false;
  out.window = whole_number(data[n - 2], kMostWindow - 1) + 1;
  out.count = whole_number(data[n - 1], n);
  out.size = kState;
  if (out.window > kMostWindow || out.window == 0 || out.count == 0 || out.count > n) return false;
  if (even) return out.count <= (n - tail) / kState && data[n - 3] > 0;
  return out.count * (kState + 1) + directory(out.count) + tail <= n;
}

// Of type 18, and of the parts of type 19: packets, epochs, subtype, window and count.
bool packets_layout(const Doubles& data, bool of_19, SpkLayout& out) {
  const std::size_t n = data.size();
  if (n < 3) return false;
  const std::size_t subtype = whole_number(data[n - 3], of_19 ? 2 : 1);
  out.window = whole_number(data[n - 2], kMostWindow);
  out.count = whole_number(data[n - 1], n);
  if (subtype > 2 || out.window > kMostWindow || out.window == 0 || out.count == 0 || out.count > n)
    return false;
  out.subtype = static_cast<int>(subtype);
  out.size = subtype == 0 ? 2 * kState : kState;
  return out.count * (out.size + 1) + directory(out.count) + 3 <= n;
}

Scheme scheme_of(int subtype) {
  if (subtype == 0) return Scheme::twice_hermite;
  return subtype == 1 ? Scheme::lagrange : Scheme::hermite;
}

// Part of type 19 by its interval; empty: its pointers lie outside.
Doubles interval_part(const SpkLayout& layout, const Doubles& data, std::size_t interval) {
  const std::size_t n = data.size();
  const std::size_t pointers = n - 2 - (layout.count + 1);
  const std::size_t from = whole_number(data[pointers + interval], n),
                    to = whole_number(data[pointers + interval + 1], n);
  if (from > n || to > n || from < 1 || to <= from) return {};
  return data.part(from - 1, to - from);
}

bool intervals_layout(const Doubles& data, SpkLayout& out, std::string& problem) {
  const std::size_t n = data.size();
  if (n < 2) return false;
  out.count = whole_number(data[n - 1], n);
  out.subtype = static_cast<int>(std::min<std::size_t>(whole_number(data[n - 2], 1), 2));
  if (out.count == 0 || out.count > n || out.subtype > 1) return false;
  if (2 * (out.count + 1) + out.count / kDirectoryStep + 2 > n) return false;
  for (std::size_t i = 0; i < out.count; ++i) {
    SpkLayout part;
    if (packets_layout(interval_part(out, data, i), true, part)) continue;
    problem = fmt::format("interval {} of {} is damaged", i, out.count);
    return false;
  }
  return true;
}

bool intervals_state(const SpkLayout& layout, const Doubles& data, double et, State& out) {
  const std::size_t bounds = layout.count + 1;
  const std::size_t first = data.size() - 2 - bounds - layout.count / kDirectoryStep - bounds;
  const Doubles times = data.part(first, bounds);
  std::size_t interval = last_at_or_below(times, et);
  // at a bound the flag of the segment decides, 1: the later one
  if (interval > 0 && times[interval] == et && layout.subtype == 0) --interval;
  interval = std::min(interval, layout.count - 1);
  const Doubles part = interval_part(layout, data, interval);
  SpkLayout own;
  if (!packets_layout(part, true, own)) return false;
  interpolate_at_epochs(part, own.count, own.size, own.window, scheme_of(own.subtype), et, out);
  return true;
}

}  // namespace

bool is_spk_type_read(int type) {
  constexpr std::array<int, 10> kTypes = {1, 2, 3, 8, 9, 12, 13, 18, 19, 21};
  return std::ranges::find(kTypes, type) != kTypes.end();
}

bool spk_layout(int type, const Doubles& data, SpkLayout& out, std::string& problem) {
  out = {};
  out.type = type;
  problem.clear();
  bool sound = data.size() <= kMostCount;
  switch (sound ? type : 0) {
    case 1:
    case 21:
      sound = difference_layout(data, out);
      break;
    case 2:
    case 3:
      sound = chebyshev_layout(data, type == 2 ? kAxes : kState, out);
      break;
    case 8:
    case 9:
    case 12:
    case 13:
      sound = states_layout(data, out);
      break;
    case 18:
      sound = packets_layout(data, false, out);
      break;
    case 19:
      sound = intervals_layout(data, out, problem);
      break;
    default:
      sound = false;
  }
  if (!sound && problem.empty())
    problem = fmt::format("its counts do not fit its {} numbers", data.size());
  return sound;
}

bool spk_state(const SpkLayout& layout, const Doubles& data, double et, State& out) {
  bool good = true;
  switch (layout.type) {
    case 1:
    case 21:
      good = difference_state(layout, data, et, out);
      break;
    case 2:
    case 3:
      good = chebyshev_state(layout, data, et, out);
      break;
    case 8:
    case 12:
      interpolate_even_steps(layout, data, et, out);
      break;
    case 9:
    case 13:
      interpolate_at_epochs(data, layout.count, kState, layout.window,
                            layout.type == 9 ? Scheme::lagrange : Scheme::hermite, et, out);
      break;
    case 18:
      interpolate_at_epochs(data, layout.count, layout.size, layout.window,
                            scheme_of(layout.subtype), et, out);
      break;
    case 19:
      good = intervals_state(layout, data, et, out);
      break;
    default:
      return false;
  }
  return good && is_finite(out.position) && is_finite(out.velocity);
}

}  // namespace panwright::ephemeris
