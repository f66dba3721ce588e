// Joints: node updates a second, and where chains end against their closed forms.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "bench/bench.h"
#include "pan/model.h"
#include "pan/writer.h"
#include "world/aim.h"
#include "world/evaluation.h"
#include "world/world.h"

namespace panwright::bench::case_joints {

namespace {

// Links of 1 m along x, each turning about z, one or several side by side.
world::World arms(std::uint32_t count, std::uint32_t links) {
  pan::Contents contents;
  contents.version = "bench";
  contents.nodes = {{"root"}};
  for (std::uint32_t a = 0; a < count; ++a)
    for (std::uint32_t i = 0; i < links; ++i) {
      const auto node = static_cast<std::uint32_t>(contents.nodes.size());
      contents.nodes.push_back({fmt::format("link{}_{}", a, i),
                                i == 0 ? 0 : static_cast<std::int32_t>(node - 1),
                                Vec3(i == 0 ? 0.0 : 1.0, 0, 0)});
      pan::JointContent joint;
      joint.name = fmt::format("q{}_{}", a, i);
      joint.node = node;
      joint.joint.kind = geometry::JointKind::continuous;
      if (a + 1 == count && i + 1 == links) joint.pointing = Vec3(1, 0, 0);
      contents.joints.push_back(std::move(joint));
    }
  contents.materials = {materials::Material{}};
  DiagnosticLog log;
  auto model = pan::Model::from_bytes(pan::write_to_memory(contents), "arms", log);
  world::World world;
  if (!model || !model->check(log) ||
      !world.add("arms", std::make_shared<const pan::Model>(std::move(*model)), log))
    throw std::runtime_error(to_text(log));
  return world;
}

double angle(std::mt19937_64& random) {
  return kPi * (static_cast<double>(random() >> 11) * 0x1p-52 - 1);
}

void set(world::World& world, std::uint32_t joint, double value) {
  geometry::JointValues values{};
  values[0] = value;
  world.set_joint(0, joint, values);
}

// How far the tip of the last arm is from the sum of its links.
double tip_error(const world::World& world, const world::EvaluatedInstance& at,
                 std::uint32_t links) {
  const auto values = world[0].joint_values();
  long double sum = 0, x = 0, y = 0;
  for (std::size_t i = values.size() - links; i < values.size(); ++i) {
    sum += values[i][0];
    x += std::cos(sum);
    y += std::sin(sum);
  }
  const Vec4 tip = at.model_from_nodes.back() * Vec4(1, 0, 0, 1);
  return std::max(std::fabs(tip.x - static_cast<double>(x)),
                  std::fabs(tip.y - static_cast<double>(y)));
}

// All joints get new values, again and again.
void chain(Context& context, std::uint32_t count, std::uint32_t links) {
  world::World world = arms(count, links);
  world::InstanceEvaluation evaluation;
  std::mt19937_64 random(links);
  const std::uint32_t joints = count * links;
  const std::uint32_t rounds = std::max(1u, (context.quick() ? 20'000u : 1'000'000u) / joints);
  double error = 0;
  const auto work = [&] {
    for (std::uint32_t r = 0; r < rounds; ++r) {
      for (std::uint32_t j = 0; j < joints; ++j) set(world, j, angle(random));
      evaluation.update(world[0]);
    }
    error = std::max(error, tip_error(world, evaluation.result(), links));
  };
  const Timing timing = timed(work, context.runs());
  Row row;
  row.case_name = "joints";
  row.setting = fmt::format("all joints of {} x {} links", count, links);
  set_rate(row, timing, 1e-6 * joints * rounds);
  row.speed_unit = "M joint-node updates/s";
  if (!context.quick()) row.must = 5;
  row.error = error;
  row.error_unit = "m";
  row.must_error = 1e-12;
  row.reference = "sums of cosines and sines of the angles, long double";
  context.add(row);
}

// The last joint of a long chain alone: what is above it is not worked out again.
void last_joint(Context& context) {
  constexpr std::uint32_t kLinks = 1000;
  world::World world = arms(1, kLinks);
  world::InstanceEvaluation evaluation;
  std::mt19937_64 random(7);
  for (std::uint32_t j = 0; j < kLinks; ++j) set(world, j, angle(random));
  const std::uint32_t rounds = context.quick() ? 100 : 10'000;
  double error = 0;
  const auto work = [&] {
    for (std::uint32_t r = 0; r < rounds; ++r) {
      set(world, kLinks - 1, angle(random));
      evaluation.update(world[0]);
    }
    error = std::max(error, tip_error(world, evaluation.result(), kLinks));
  };
  const Timing timing = timed(work, context.runs());
  Row row;
  row.case_name = "joints";
  row.setting = fmt::format("the last of {} joints", kLinks);
  set_time(row, timing, 1e6 / rounds);
  row.speed_unit = "us/update";
  row.error = error;
  row.error_unit = "m";
  row.reference = "sums of cosines and sines of the angles, long double";
  context.add(row);
}

void aims(Context& context) {
  world::World world = arms(1, 3);
  std::mt19937_64 random(9);
  const std::uint32_t rounds = context.quick() ? 100 : 20'000;
  double error = 0;
  const auto work = [&] {
    for (std::uint32_t r = 0; r < rounds; ++r) {
      const Vec3 direction(angle(random), angle(random), angle(random));
      const world::Aimed found = world::aim(world, 0, 2, direction);
      // what no turn about z takes away
      const double least = std::asin(std::fabs(direction.z) / glm::length(direction));
      error = std::max(error, std::fabs(found.error - least));
    }
  };
  const Timing timing = timed(work, context.runs());
  Row row;
  row.case_name = "joints";
  row.setting = "aims about one axis, third joint of a chain";
  set_rate(row, timing, 1e-3 * rounds);
  row.speed_unit = "k aims/s";
  row.error = error;
  row.error_unit = "rad";
  row.must_error = 1e-12;
  row.reference = "the elevation of the direction over the plane of the turn";
  context.add(row);
}

void run(Context& context) {
  chain(context, 1, 2);
  chain(context, 1, 7);
  chain(context, 100, 7);
  chain(context, 1, 100);
  last_joint(context);
  aims(context);
}

const bool kAdded = add_case({"joints", "joint values to node matrices, and aims", run});

}  // namespace

}  // namespace panwright::bench::case_joints
