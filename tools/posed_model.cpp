#include "tools/posed_model.h"

#include <fmt/core.h>

#include "base/text.h"
#include "workspace/joints.h"
#include "workspace/quantities.h"
#include "workspace/targets.h"

namespace panwright::tools {

void declare(Arguments& arguments, PoseOptions& options) {
  declare(arguments, options.joints);
  arguments.add("--sun", options.sun, "Direction to the Sun for joints that aim at it, world axes")
      .type("\"X Y Z\"")
      .group("Joints");
}

Result<world::World> posed(const std::string& file, const world::ModelPtr& model,
                           const PoseOptions& options, DiagnosticLog& log) {
  const auto texts = options.joints.texts(log);
  if (!texts) return failed;
  world::World world;
  const std::string name = workspace::target_file(file).name;
  if (!world.add(name.empty() ? "model" : name, model, log)) return failed;
  bool aims = false;
  workspace::JointSetter setter(world);
  bool good = true;
  for (const workspace::JointText& text : *texts) {
    good = setter.set(text, log) && good;
    aims = aims || (!text.value.empty() && text.value[0] == '@');
  }
  if (options.sun) {
    const auto direction = workspace::parse_numbers(*options.sun, 3);
    if (!direction || ((*direction)[0] == 0 && (*direction)[1] == 0 && (*direction)[2] == 0)) {
      log.report(
          Code("E0201"), {},
          fmt::format("--sun is {}, expected a direction, as \"0 0 1\"", in_quotes(*options.sun)));
      return failed;
    }
    world::Sun sun;
    sun.direction = Vec3((*direction)[0], (*direction)[1], (*direction)[2]);
    world.set_sun(sun);
  }
  for (const workspace::JointText& text : *texts)
    if (text.value == "@sun" && !options.sun) {
      log.report(Code("E0201"), {},
                 fmt::format("--joint {}=@sun needs the direction: --sun \"X Y Z\"", text.joint));
      good = false;
    }
  if (!good) return failed;
  if ((aims || options.sun) && !setter.set_aims(std::nullopt, log)) return failed;
  return world;
}

}  // namespace panwright::tools
