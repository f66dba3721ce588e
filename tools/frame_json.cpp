#include "tools/frame_json.h"

#include <nlohmann/json.hpp>

namespace panwright::tools {

using Json = nlohmann::ordered_json;

Json frame_json(const scenario::Frame& frame, std::uint64_t number) {
  const auto vector = [](const Vec3& v) { return Json{v.x, v.y, v.z}; };
  const auto quaternion = [](const Quat& q) { return Json{q.w, q.x, q.y, q.z}; };
  Json out{{"number", number}};
  if (frame.time) {
    out["time"] = *frame.time;
    if (frame.epoch)
      out["epoch"] = scenario::epoch_text(later(*frame.epoch, *frame.time), frame.system) + " " +
                     std::string(time_system_name(frame.system));
  }
  if (!frame.name.empty()) out["name"] = frame.name;
  if (frame.seed) out["seed"] = *frame.seed;
  if (frame.camera.position) out["camera"] = vector(*frame.camera.position);
  if (frame.camera.rotation) out["quat"] = quaternion(*frame.camera.rotation);
  if (frame.lens.fov) out["fov"] = *frame.lens.fov;
  if (frame.lens.focal) {
    out["intrinsics"] = {frame.lens.focal->x, frame.lens.focal->y};
    if (frame.lens.principal) {
      out["intrinsics"].push_back(frame.lens.principal->x);
      out["intrinsics"].push_back(frame.lens.principal->y);
    }
  }
  for (const scenario::TargetState& target : frame.targets) {
    if (target.placement.position || target.placement.rotation) {
      const world::Pose pose = target.placement.pose();
      const Vec3& p = pose.translation;
      const Quat& q = pose.rotation;
      out["poses"][target.name] = {p.x, p.y, p.z, q.w, q.x, q.y, q.z};
    }
    for (const scenario::JointValue& joint : target.joints) {
      Json values = Json::array();
      for (std::size_t k = 0; k < joint.count; ++k) values.push_back(joint.values[k]);
      out["joints"][target.name + "/" + joint.joint] = std::move(values);
    }
  }
  if (frame.sun_direction) out["sun"] = vector(*frame.sun_direction);
  if (frame.sun_distance) out["sun_distance"] = *frame.sun_distance;
  return out;
}

}  // namespace panwright::tools
