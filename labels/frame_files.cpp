#include "labels/frame_files.h"

#include <fmt/core.h>

#include <array>
#include <cassert>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "image/arrays.h"
#include "labels/internal/flo.h"
#include "sensor/camera_file.h"

namespace panwright::labels {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const Vec2& v) { return {v.x, v.y}; }
Json numbers(const Vec3& v) { return {v.x, v.y, v.z}; }
Json numbers(const Quat& q) { return {q.w, q.x, q.y, q.z}; }

Json json_of(const std::optional<Box>& box) {
  if (!box) return nullptr;
  return {box->left, box->top, box->right, box->bottom};
}

Json json_of(const Mask& mask) {
  return {{"left", mask.left}, {"top", mask.top}, {"width", mask.width}, {"height", mask.height}};
}

Json json_of(const world::Camera& camera) {
  Json json{{"width", camera.width},
            {"height", camera.height},
            {"projection",
             camera.projection == world::Projection::perspective ? "perspective" : "orthographic"},
            {"focal", numbers(camera.focal)},
            {"principal", numbers(camera.principal)}};
  const std::string distortion =
      camera.distortion ? sensor::distortion_text(camera.distortion->distortion()) : "";
  json["distortion"] = distortion.empty() ? Json() : Json(distortion);
  json["position"] = numbers(camera.position);
  json["world_from_camera"] = numbers(camera.world_from_camera);
  return json;
}

Json json_of(const Keypoint& keypoint) {
  return {{"name", keypoint.name},
          {"position", numbers(keypoint.position)},
          {"in_camera", numbers(keypoint.in_camera)},
          {"pixel", keypoint.pixel ? numbers(*keypoint.pixel) : Json()},
          {"truncated", keypoint.truncated},
          {"occluded", keypoint.occluded},
          {"lit", keypoint.lit}};
}

Json json_of(const Thing& thing) {
  Json json{{"id", thing.id}, {"target", thing.target}, {"label", thing.label}};
  json["camera_from_thing"] = {{"translation", numbers(thing.camera_from_thing.translation)},
                               {"rotation", numbers(thing.camera_from_thing.rotation)}};
  json["amodal"] = json_of(thing.amodal);
  json["visible"] = json_of(thing.visible);
  json["amodal_box"] = json_of(thing.amodal_box);
  json["visible_box"] = json_of(thing.visible_box);
  json["amodal_pixels"] = thing.amodal_pixels;
  json["visible_pixels"] = thing.visible_pixels;
  json["visible_fraction"] =
      thing.amodal_pixels > 0 ? thing.visible_pixels / thing.amodal_pixels : 0.0;
  Json& keypoints = json["keypoints"] = Json::array();
  for (const Keypoint& keypoint : thing.keypoints) keypoints.push_back(json_of(keypoint));
  return json;
}

std::string text_of(const FrameLabels& frame, bool any_mask) {
  Json json{{"schema_id", "panwright/frame_labels/1"},
            {"name", frame.name},
            {"image", frame.image},
            {"number", frame.number},
            {"time", frame.time},
            {"camera", json_of(frame.camera)},
            {"sun_in_camera", numbers(frame.sun_in_camera)}};
  if (frame.pixel_um) json["camera"]["pixel_um"] = numbers(*frame.pixel_um);
  const auto file = [&](bool there, std::string_view extension) {
    return there ? Json(frame.name + std::string(extension)) : Json();
  };
  json["masks"] = file(any_mask, kMasksExtension);
  json["forward"] = file(frame.forward.has_value(), kForwardExtension);
  json["backward"] = file(frame.backward.has_value(), kBackwardExtension);
  Json& things = json["things"] = Json::array();
  for (const Thing& thing : frame.things) things.push_back(json_of(thing));
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

bool write_frame(const std::filesystem::path& folder, const FrameLabels& frame, DiagnosticLog& log,
                 double* sync_seconds) {
  const auto path = [&](std::string_view extension) {
    return folder / (frame.name + std::string(extension));
  };
  const auto json = path(kLabelsExtension);
  std::error_code error;
  std::filesystem::remove(json, error);
  if (error) {
    log.report_file(Code("E0103"), json.string(), "the old file cannot be removed");
    return false;
  }
  std::vector<image::Array> arrays;
  for (const Thing& thing : frame.things)
    for (const auto& [mask, name] :
         {std::pair(&thing.amodal, "amodal"), std::pair(&thing.visible, "visible")}) {
      assert(mask->coverage.size() == std::size_t{mask->width} * mask->height);
      if (mask->coverage.empty()) continue;
      const auto bytes = std::as_bytes(std::span(mask->coverage));
      arrays.push_back({fmt::format("{}.{}", thing.id, name),
                        "|u1",
                        {mask->height, mask->width},
                        {bytes.begin(), bytes.end()}});
    }
  if (!arrays.empty() && !image::write_arrays(path(kMasksExtension), arrays, log, sync_seconds))
    return false;
  for (const auto& [flow, extension] : {std::pair(&frame.forward, kForwardExtension),
                                        std::pair(&frame.backward, kBackwardExtension)})
    if (*flow && !write_flo(path(extension), **flow, log, sync_seconds)) return false;
  return write_file(json, as_bytes(text_of(frame, !arrays.empty())), log, sync_seconds);
}

}  // namespace panwright::labels
