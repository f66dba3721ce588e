// Frames between the nodes of a trajectory: time of one, and errors by the step of the nodes,
// against a circular orbit and an even spin in closed form.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "scenario/csv.h"

namespace panwright::bench::case_trajectories {

namespace {

constexpr double kRadius = 6.778e6;     // metres
constexpr double kRate = 1.1313659e-3;  // rad/s
constexpr double kSpin = 0.01;          // rad/s, about the axis below
const Vec3 kAxis = glm::normalize(Vec3(1, -2, 0.5));

Vec3 place_at(double time) {
  return kRadius * Vec3(std::cos(kRate * time), std::sin(kRate * time), 0);
}
Vec3 speed_at(double time) {
  return kRadius * kRate * Vec3(-std::sin(kRate * time), std::cos(kRate * time), 0);
}
Quat turn_at(double time) { return glm::angleAxis(kSpin * time, kAxis); }

struct Kind {
  const char* name;
  scenario::Method method;
  std::size_t degree;
};
constexpr Kind kKinds[] = {{"linear", scenario::Method::linear, 1},
                           {"cubic", scenario::Method::cubic, 3},
                           {"Lagrange 7", scenario::Method::lagrange, 7},
                           {"Hermite 7", scenario::Method::hermite, 7}};

std::string table(double step, std::size_t nodes) {
  std::string text =
      "time[s],camera.x[m],camera.y[m],camera.z[m],camera.vx[m/s],camera.vy[m/s],camera.vz[m/s],"
      "camera.qw[world_from_camera],camera.qx[world_from_camera],camera.qy[world_from_camera],"
      "camera.qz[world_from_camera]\n";
  for (std::size_t k = 0; k < nodes; ++k) {
    const double time = step * static_cast<double>(k);
    const Vec3 p = place_at(time), v = speed_at(time);
    const Quat q = turn_at(time);
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", time, p.x, p.y, p.z, v.x, v.y, v.z,
                        q.w, q.x, q.y, q.z);
  }
  return text;
}

void run_trajectories(Context& context) {
  const std::size_t nodes = 1000, frames = context.quick() ? 1000 : 100'000;
  DiagnosticLog log;
  for (const double step : {10.0, 60.0, 180.0})
    for (const Kind& kind : kKinds) {
      const auto source = scenario::read_csv(scenario::memory_text("nodes.csv", table(step, nodes)),
                                             {kind.method, kind.degree}, log);
      if (!source) return context.note("the table cannot be read");
      // away from the ends, where windows of nodes are not in the middle
      const double begin = 10 * step, length = step * static_cast<double>(nodes - 20);
      const auto time_of = [&](std::size_t k) {
        return begin + length * (static_cast<double>(k) + 0.37) / static_cast<double>(frames);
      };
      double place = 0, turn = 0;
      scenario::Frame frame;
      const auto work = [&] {
        for (std::size_t k = 0; k < frames; ++k)
          static_cast<void>((*source)->at(time_of(k), frame, log));
      };
      for (std::size_t k = 0; k < frames; ++k) {
        if (!(*source)->at(time_of(k), frame, log)) return context.note("a frame has no value");
        place = std::max(place, glm::length(*frame.camera.position - place_at(time_of(k))));
        const Quat off = glm::conjugate(turn_at(time_of(k))) * *frame.camera.rotation;
        turn = std::max(turn, 2 * glm::length(Vec3(off.x, off.y, off.z)));
      }
      Row row;
      row.case_name = "trajectories";
      row.setting = fmt::format("{}, nodes every {} s", kind.name, step);
      row.speed_unit = "us/frame";
      set_time(row, timed(work, context.runs()), 1e6 / static_cast<double>(frames));
      row.error = place;
      row.error_unit = "m";
      row.reference = "circular orbit of 6778 km";
      row.reference_error = kRadius * 1e-15;
      context.add(row);
      context.note(fmt::format("{}: an even spin of {} rad/s is off by {:.2g} rad at most",
                               row.setting, kSpin, turn));
    }
}

const bool kAdded =
    add_case({"trajectories", "frames between the nodes of trajectories", run_trajectories});

}  // namespace
}  // namespace panwright::bench::case_trajectories
