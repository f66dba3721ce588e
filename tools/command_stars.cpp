#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "sky/stars.h"
#include "tools/command_context.h"
#include "tools/commands.h"
#include "tools/print.h"
#include "workspace/frame.h"

namespace panwright::tools {

namespace command_stars {
namespace {

using workspace::SettingId;

struct Options {
  CommonOptions common;
  ViewOptions view;
};

void declare_all(Arguments& arguments, Options& options) {
  for (const SettingId id :
       {SettingId::camera, SettingId::look_at, SettingId::up, SettingId::quat, SettingId::fov,
        SettingId::ifov, SettingId::intrinsics, SettingId::distortion, SettingId::camera_file,
        SettingId::size, SettingId::planet, SettingId::sky, SettingId::stars,
        SettingId::star_catalogue, SettingId::date, SettingId::orbit})
    declare(arguments, options.view, id);
  declare(arguments, options.common);
}

nlohmann::ordered_json star_json(const sky::Star& star, const sky::StarInView& seen) {
  nlohmann::ordered_json out;
  if (star.hip > 0) out["hip"] = star.hip;
  if (!star.name.empty()) out["name"] = star.name;
  out["v"] = star.v;
  if (!std::isnan(star.b_v)) out["b_v"] = star.b_v;
  out["pixel"] = {seen.pixel.x, seen.pixel.y};
  out["direction"] = {seen.direction.x, seen.direction.y, seen.direction.z};
  out["irradiance"] = {seen.irradiance.x, seen.irradiance.y, seen.irradiance.z};
  return out;
}

int run(const Options& options, const Host& host) {
  CommandContext context("stars", options.common, host);
  DiagnosticLog& log = context.log();
  auto settings = options.view.settings(log);
  if (!settings) return context.finish();
  if (!settings->stars)
    settings->stars = workspace::NumberOr<workspace::Settings::Stars, double>(8.0);
  const world::World empty;
  const auto frame = workspace::FrameMaker(empty).frame(workspace::View(*settings), log);
  if (!frame) return context.finish();
  world::World shown = empty;
  workspace::show(*frame, empty, shown);
  auto seen = sky::stars_in_view(shown.stars(), frame->camera(), 0);
  sky::remove_hidden(sky::Sky(shown), frame->camera().position, seen);
  auto& list = context.result()["stars"] = nlohmann::ordered_json::array();
  if (!options.common.json) print("  V     B-V   column     row        HIP     name\n");
  for (const sky::StarInView& each : seen) {
    const sky::Star& star = shown.stars().catalogue->stars[each.index];
    if (options.common.json)
      list.push_back(star_json(star, each));
    else
      print("{:5.2f} {:>6}  {:9.3f}  {:9.3f}  {:>6}  {}\n", star.v,
            std::isnan(star.b_v) ? "" : fmt::format("{:.2f}", star.b_v), each.pixel.x, each.pixel.y,
            star.hip > 0 ? fmt::format("{}", star.hip) : "", star.name);
  }
  if (!options.common.json) print(stderr, "{}\n", counted(seen.size(), "star"));
  return context.finish();
}

}  // namespace
}  // namespace command_stars

Command stars_command() {
  return command("stars", "List the stars in a camera's view, with pixels and magnitudes",
                 command_stars::declare_all, command_stars::run);
}

}  // namespace panwright::tools
