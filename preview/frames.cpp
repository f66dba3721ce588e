#include <fmt/format.h>

#include <string>
#include <vector>

#include "base/text.h"
#include "preview/renderer.h"

namespace panwright::preview {

bool place_in_frame(View& view, const pan::Model& model, std::string_view name,
                    DiagnosticLog& log) {
  if (const auto index = model.find_frame(name)) {
    const pan::layout::Frame& frame = model.frames()[*index];
    const Mat4 world_from_node =
        view.world_from_model.matrix() * model.world_from_nodes()[frame.node];
    place_in_frame(
        view.camera, world_from_node, Vec3(frame.origin[0], frame.origin[1], frame.origin[2]),
        Quat(frame.rotation[0], frame.rotation[1], frame.rotation[2], frame.rotation[3]));
    return true;
  }
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < model.frames().size(); ++i) names.push_back(model.frame_name(i));
  std::string hint;
  if (const auto near = nearest_name(name, names)) hint = fmt::format("did you mean '{}'?", *near);
  std::string message = fmt::format("the model has no frame {}", in_quotes(name));
  if (names.empty()) {
    message += "; it has none at all";
  } else if (hint.empty() && names.size() <= 10) {
    message += "; it has ";
    for (std::size_t i = 0; i < names.size(); ++i) message += (i ? ", " : "") + in_quotes(names[i]);
  }
  log.report_file(Code::E5005, model.name(), message, hint);
  return false;
}

}  // namespace panwright::preview
