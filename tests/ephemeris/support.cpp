#include "tests/ephemeris/support.h"

#include <set>

namespace panwright::ephemeris::testing_support {

namespace {

constexpr double kEnd = 600;
// uneven nodes that hold 0 and the end
std::vector<double> nodes() {
  std::vector<double> out;
  for (int i = 0; i <= 12; ++i) out.push_back(50.0 * i + (i % 12 == 0 ? 0.0 : 7.0 * (i % 3) - 5));
  return out;
}

void append_chebyshev(std::vector<double>& out, double mid, double radius, bool rates) {
  for (int axis = 0; axis < (rates ? 6 : 3); ++axis) {
    std::vector<double> values;
    for (int i = 0; i < 4; ++i) {
      const State at = path(mid + radius * std::cos(kPi * (i + 0.5) / 4));
      values.push_back(axis < 3 ? at.position[axis] : at.velocity[axis - 3]);
    }
    for (const double c : chebyshev_of(values)) out.push_back(c);
  }
}

std::vector<double> differences(int type) {
  const std::size_t terms = type == 1 ? 15 : 7;
  std::vector<double> out, epochs{100, 250, kEnd};
  for (const double epoch : epochs) {
    std::vector<double> record(4 * terms + 11, 0.0);
    const double reference = epoch - 60;  // the path leads on from there, before and behind it
    record[0] = reference;
    for (std::size_t m = 0; m < terms; ++m) record[1 + m] = 20.0 * static_cast<double>(m + 1);
    const State at = path(reference);
    const Vec3 first = acceleration(reference);
    const Vec3 slope = acceleration(1) - acceleration(0);
    for (int i = 0; i < 3; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      record[1 + terms + 2 * axis] = at.position[i];
      record[2 + terms + 2 * axis] = at.velocity[i];
      record[7 + terms + axis * terms] = first[i];
      record[8 + terms + axis * terms] = 20.0 * slope[i];
      record[8 + 4 * terms + axis] = 3;
    }
    record[7 + 4 * terms] = 4;
    out.insert(out.end(), record.begin(), record.end());
  }
  out.insert(out.end(), epochs.begin(), epochs.end());
  if (type == 21) out.push_back(static_cast<double>(terms));
  out.push_back(3);
  return out;
}

void append_packets(std::vector<double>& out, const std::vector<double>& times, int subtype,
                    int window) {
  for (const double t : times) {
    append(out, path(t));
    if (subtype == 0) append(out, {path(t).velocity, acceleration(t)});
  }
  out.insert(out.end(), times.begin(), times.end());
  out.insert(out.end(), {static_cast<double>(subtype), static_cast<double>(window),
                         static_cast<double>(times.size())});
}

}  // namespace

std::vector<double> segment_numbers(int type) {
  std::vector<double> out;
  switch (type) {
    case 1:
    case 21:
      return differences(type);
    case 2:
    case 3:
      for (const double mid : {100.0, 300.0, 500.0}) {
        out.insert(out.end(), {mid, 100.0});
        append_chebyshev(out, mid, 100, type == 3);
      }
      out.insert(out.end(), {0.0, 200.0, type == 3 ? 26.0 : 14.0, 3.0});
      return out;
    case 8:
    case 12:
      for (int i = 0; i <= 12; ++i) append(out, path(50.0 * i));
      out.insert(out.end(), {0.0, 50.0, type == 8 ? 4.0 : 3.0, 13.0});
      return out;
    case 9:
    case 13:
      for (const double t : nodes()) append(out, path(t));
      for (const double t : nodes()) out.push_back(t);
      out.insert(out.end(), {type == 9 ? 5.0 : 2.0, 13.0});
      return out;
    case 18:
      append_packets(out, nodes(), 0, 4);
      return out;
    case 19: {
      const auto times = nodes();
      const std::vector<double> first(times.begin(), times.begin() + 7),
          second(times.begin() + 6, times.end());
      std::vector<double> ends{1};
      append_packets(out, first, 1, 5);
      ends.push_back(static_cast<double>(out.size()) + 1);
      append_packets(out, second, 2, 4);
      ends.push_back(static_cast<double>(out.size()) + 1);
      out.insert(out.end(), {0, times[6], kEnd});
      out.insert(out.end(), ends.begin(), ends.end());
      out.insert(out.end(), {1, 2});
      return out;
    }
    default:
      return {1, 2, 3, 4};
  }
}

bool ask_all(const std::string& bytes, std::string& broken) {
  DiagnosticLog log;
  const KernelBytes one{"fuzz", as_bytes(bytes)};
  const auto kernels = Kernels::of({&one, 1}, log);
  if (kernels.ok() == log.has_errors()) broken = "an answer or an error: " + to_text(log);
  (void)to_text(log);
  if (!kernels) return false;
  const auto infos = kernels->segments();
  std::string problem;
  std::set<int> bodies;
  constexpr std::size_t kMost = 60;
  for (std::size_t i = 0; i < std::min(infos.size(), kMost); ++i) {
    const SegmentInfo& info = infos[i];
    bodies.insert(info.id);
    for (const double part : {-0.1, 0.0, 0.31, 0.77, 1.0, 1.1}) {
      const double at = info.begin + part * (info.end - info.begin);
      const auto state = kernels->segment_state(i, at);
      if (state && (!is_finite(state->position) || !is_finite(state->velocity)))
        broken = "a state that is not finite";
      const auto axes = kernels->segment_pointing(i, at);
      if (axes && !(std::abs(determinant(axes->from_j2000) - 1) < 1e-9)) broken = "no rotation";
      for (const Aberration aberration : {Aberration::none, Aberration::lt_s, Aberration::cn}) {
        const auto found = kernels->state(info.id, info.relative, kJ2000, at, aberration, problem);
        if (found ? !is_finite(found->state.position) : problem.empty())
          broken = "a state or a problem";
      }
      (void)kernels->attitude(info.id, at, problem);
      (void)kernels->attitude(13000, at, problem);
    }
    (void)kernels->coverage(info.id, info.relative, info.frame);
    (void)kernels->attitude_coverage(info.id);
  }
  for (const char* name : {"IAU_EARTH", "IAU_MARS", "TEST_FRAME", "TEST_CRAFT"}) {
    const auto frame = kernels->frame(name);
    if (!frame) continue;
    for (const double et : {0.0, 8e8}) (void)kernels->attitude(*frame, et, problem);
    (void)kernels->attitude_coverage(*frame);
  }
  for (const int clock : {-82, -99}) {
    (void)kernels->et_of_ticks(clock, 1e9, problem);
    (void)kernels->ticks_of_et(clock, 1e8, problem);
  }
  if (const auto et = kernels->et_of_utc("2020-01-01T00:00:00", problem))
    (void)kernels->utc_of_et(*et, problem);
  return true;
}

}  // namespace panwright::ephemeris::testing_support
