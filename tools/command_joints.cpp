#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "base/text.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/joint_list.h"
#include "tools/posed_model.h"
#include "tools/print.h"
#include "workspace/joints.h"
#include "world/evaluation.h"
#include "world/sweep.h"

namespace panwright::tools {

namespace command_joints {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  CommonOptions common;
  ReadOptions read;
  std::string input;
  PoseOptions pose;
  bool sweep = false;
  std::vector<std::string> swept;  // joints; none: all
  std::uint32_t steps = 25;
};

void declare_all(Arguments& arguments, Options& options) {
  arguments.add("input", options.input, "Model: a .pan, .pxn or CAD file").required().type("FILE");
  declare(arguments, options.pose);
  arguments.flag("--sweep", options.sweep,
                 "Sweep each joint through its range; print the swept bounds and the collisions "
                 "that the given values do not have");
  arguments.add("--sweep-joint", options.swept, "Sweep only this joint; may be repeated")
      .type("JOINT")
      .one_value();
  arguments
      .add("--steps", options.steps, "Number of positions of each joint in a sweep (default 25)")
      .range(2u, 100000u)
      .type("N");
  declare(arguments, options.read);
  declare(arguments, options.read.cache);
  declare(arguments, options.read.open.cad);
  declare(arguments, options.common);
}

// Row-major: what stands in a row of the matrix stands in a row here.
Json matrix_json(const Mat4& m) {
  Json out = Json::array();
  for (int row = 0; row < 4; ++row) out.push_back({m[0][row], m[1][row], m[2][row], m[3][row]});
  return out;
}

void show_sweep(const std::vector<world::SweptJoint>& sweep, const pan::Model& model, bool text,
                Json& out) {
  out["sweep"] = Json::array();
  for (const world::SweptJoint& swept : sweep) {
    Json one;
    one["joint"] = model.joint_name(swept.joint);
    one["from"] = swept.from;
    one["to"] = swept.to;
    one["positions"] = swept.positions;
    one["min"] = {swept.bounds.low.x, swept.bounds.low.y, swept.bounds.low.z};
    one["max"] = {swept.bounds.high.x, swept.bounds.high.y, swept.bounds.high.z};
    one["collisions"] = Json::array();
    const auto kind = static_cast<geometry::JointKind>(model.joints()[swept.joint].kind);
    const auto shown = [&](double value) {
      geometry::JointValues values{};
      values[0] = value;
      return workspace::shown_value(kind, values);
    };
    if (text)
      print(
          "sweep {}: {} to {} in {} positions, bounds {:.4g} {:.4g} {:.4g} .. {:.4g} {:.4g} "
          "{:.4g} m\n",
          model.joint_name(swept.joint), shown(swept.from), shown(swept.to), swept.positions,
          swept.bounds.low.x, swept.bounds.low.y, swept.bounds.low.z, swept.bounds.high.x,
          swept.bounds.high.y, swept.bounds.high.z);
    for (const world::Collision& each : swept.collisions) {
      one["collisions"].push_back({{"a", model.node_path(each.node_a)},
                                   {"b", model.node_path(each.node_b)},
                                   {"first", each.first},
                                   {"last", each.last},
                                   {"positions", each.positions}});
      if (text)
        print("  {} meets {} at {} of {} positions, {} to {}\n", model.node_path(each.node_a),
              model.node_path(each.node_b), each.positions, swept.positions, shown(each.first),
              shown(each.last));
    }
    out["sweep"].push_back(std::move(one));
  }
}

int run(const Options& options, const Host& host) {
  CommandContext context("joints", options.common, host);
  DiagnosticLog& log = context.log();
  const auto read = options.read.opening(log);
  if (!read) return context.finish();
  if (workspace::extension_of(options.input) == ".pxn") context.summarise_imports();
  workspace::OpenReport report;
  const auto model = workspace::open(options.input, *read, log, context.job(), &report);
  context.add_timings(report.steps);
  if (!model) return context.finish();
  const auto world = posed(options.input, *model, options.pose, log);
  if (!world) return context.finish();
  const pan::Model& shown = **model;
  const auto values = (*world)[0].joint_values();
  const bool text = !options.common.json;
  Json& out = context.result();
  out["file"] = options.input;
  out["joints"] = joints_json(shown, values);
  if (text)
    for (const std::string& line : joint_lines(shown, values)) print("{}\n", line);
  if (text && values.empty()) print("{} has no joints\n", options.input);
  const auto state = world::evaluated((*world)[0]);
  out["nodes"] = Json::array();
  for (std::size_t i = 0; i < state.model_from_nodes.size(); ++i)
    out["nodes"].push_back(
        {{"name", shown.node_path(i)}, {"world_pose", matrix_json(state.model_from_nodes[i])}});
  if (options.sweep || !options.swept.empty()) {
    std::vector<std::uint32_t> joints;
    for (const std::string& name : options.swept) {
      const auto place = workspace::find_joint(name, *world, log);
      if (!place) return context.finish();
      joints.push_back(place->joint);
    }
    const auto sweep = world::swept(*world, 0, joints, options.steps, log, context.job());
    if (!sweep) return context.finish();
    show_sweep(*sweep, shown, text, out);
  }
  return context.finish();
}

}  // namespace
}  // namespace command_joints

Command joints_command() {
  return command("joints", "List the joints of a model; sweep them for collisions",
                 command_joints::declare_all, command_joints::run);
}

}  // namespace panwright::tools
