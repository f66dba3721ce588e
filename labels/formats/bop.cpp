// BOP, scenewise, as of thodan/bop_toolkit: one scene of all frames; millimetres.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "image/png.h"
#include "labels/internal/format.h"
#include "labels/internal/pixels.h"
#include "labels/internal/ply.h"

namespace panwright::labels {
namespace {

constexpr double kMillimetres = 1000;
const std::filesystem::path kScene = "train/000000";

class BopWriter final : public LabelWriter {
 public:
  explicit BopWriter(Output& output) : output_(output) {}

  bool add(const FrameLabels& frame) override {
    if (frame.camera.projection != world::Projection::perspective)
      return output_.impossible(frame, "its camera is orthographic; the format's are perspective");
    if (frame.camera.distortion)
      output_.lost(frame, "the lens has distortion, which cam_K does not hold");
    const auto depth = output_.depth_of(frame);
    if (!depth) return false;
    if (depth->empty()) output_.lost(frame, "it has no depth (.npz, .exr), which is left out");
    const std::string number = fmt::format("{:06}", frame.number);
    if (!output_.place_png(frame, kScene / (is_grey(frame) ? "gray" : "rgb") / (number + ".png")))
      return false;
    const double scale = depth_scale(frame, *depth);
    if (!depth->empty() && !write_depth(frame, *depth, scale)) return false;
    Json poses = Json::array(), infos = Json::array();
    for (const Thing& thing : frame.things) {
      if (!thing.label.empty()) {
        output_.lost(frame, "parts have no models of their own; targets alone are written");
        continue;
      }
      check_rigid(frame, thing);
      poses.push_back(pose_of(thing));
      const auto info = info_of(frame, thing, *depth, number, infos.size());
      if (!info) return false;
      infos.push_back(*info);
    }
    const std::string key = std::to_string(frame.number);
    poses_.emplace_back(key, poses.dump());
    infos_.emplace_back(key, infos.dump());
    cameras_.emplace_back(key, camera_of(frame.camera, scale).dump());
    return true;
  }

  bool finish() override {
    return output_.write_table(kScene / "scene_gt.json", text_of(poses_)) &&
           output_.write_table(kScene / "scene_gt_info.json", text_of(infos_)) &&
           output_.write_table(kScene / "scene_camera.json", text_of(cameras_)) && write_models();
  }

 private:
  using Json = nlohmann::ordered_json;
  using Rows = std::vector<std::pair<std::string, std::string>>;  // image, JSON

  static std::string text_of(const Rows& rows) {
    std::string text = "{";
    for (const auto& [key, value] : rows)
      text += fmt::format("{}\n  \"{}\": {}", text.size() == 1 ? "" : ",", key, value);
    return text + "\n}\n";
  }

  // PNG of one channel, or one and alpha, by its header.
  bool is_grey(const FrameLabels& frame) const {
    constexpr std::uint64_t kColourType = 25;
    const auto name = output_.png_of(frame);
    std::ifstream file(output_.path_of(name.value_or("")), std::ios::binary);
    file.seekg(kColourType);
    const int type = file.get();
    return type == 0 || type == 4;
  }

  // Millimetres for each unit of depth of a frame.
  double depth_scale(const FrameLabels& frame, const std::vector<float>& depth) {
    constexpr double kMostCode = 65535;
    double farthest = 0;
    for (const float z : depth)
      if (std::isfinite(z)) farthest = std::max(farthest, double{z});
    double scale = 1;
    while (farthest * kMillimetres / scale > kMostCode) scale *= 10;
    if (scale > 1)
      output_.lost(frame, fmt::format("depth reaches beyond {:.6g} m: depth_scale is {}, depth is "
                                      "rounded to {} mm",
                                      kMostCode / kMillimetres * scale / 10, scale, scale));
    return scale;
  }

  static Json matrix(const Quat& q) {
    const Mat3 m = glm::mat3_cast(q);
    Json out = Json::array();
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) out.push_back(m[column][row]);
    return out;
  }
  static Json millimetres(const Vec3& v) {
    return {v.x * kMillimetres, v.y * kMillimetres, v.z * kMillimetres};
  }

  static Json camera_of(const world::Camera& camera, double depth_scale) {
    const Quat q = glm::conjugate(camera.world_from_camera);
    // pixel centres are whole numbers
    return {{"cam_K",
             {camera.focal.x, 0, camera.principal.x - 0.5, 0, camera.focal.y,
              camera.principal.y - 0.5, 0, 0, 1}},
            {"depth_scale", depth_scale},
            {"cam_R_w2c", matrix(q)},
            {"cam_t_w2c", millimetres(-(q * camera.position))}};
  }

  static Json pose_of(const Thing& thing) {
    return {{"cam_R_m2c", matrix(thing.camera_from_thing.rotation)},
            {"cam_t_m2c", millimetres(thing.camera_from_thing.translation)},
            {"obj_id", thing.id}};
  }

  // A model of BOP does not move in itself; keypoints tell.
  void check_rigid(const FrameLabels& frame, const Thing& thing) {
    std::vector<Vec3> positions;
    for (const Keypoint& each : thing.keypoints) positions.push_back(each.position);
    const auto [at, is_new] = keypoints_.try_emplace(thing.id, positions);
    bool moved = false;
    for (std::size_t k = 0; !is_new && k < std::min(positions.size(), at->second.size()); ++k)
      moved = moved || glm::length(positions[k] - at->second[k]) > 1e-6;
    if (moved)
      output_.lost(frame, fmt::format("joints of '{}' move; its model is rigid", thing.target));
  }

  static std::int64_t pixel_of(double edge) {
    constexpr double kMost = 1e9;  // within 32 bits
    return std::llround(std::clamp(edge, -kMost, kMost));
  }

  static bool reaches_outside(const Box& box, const world::Camera& camera) {
    return box.left < 0 || box.top < 0 || box.right > camera.width || box.bottom > camera.height;
  }

  // Extent of the whole, beyond the image's edges too; of the pixels where all of it is inside.
  static Json whole_box(const Thing& thing, const PixelMask& mask, const world::Camera& camera) {
    const auto& box = thing.amodal_box;
    std::int64_t left = mask.left, top = mask.top, right = left + mask.width,
                 bottom = top + mask.height;
    if (box && (mask.empty() || reaches_outside(*box, camera))) {
      left = pixel_of(box->left);
      top = pixel_of(box->top);
      right = pixel_of(box->right);
      bottom = pixel_of(box->bottom);
    } else if (mask.empty()) {
      return {-1, -1, -1, -1};
    }
    // the toolkit's width is the difference of the outermost pixels
    return {left, top, std::max<std::int64_t>(right - left - 1, 0),
            std::max<std::int64_t>(bottom - top - 1, 0)};
  }

  // Area of the whole beyond the image's edges.
  static std::uint64_t pixels_outside(const Thing& thing, const world::Camera& camera) {
    if (!thing.amodal_box || !reaches_outside(*thing.amodal_box, camera)) return 0;
    double inside = 0;
    for (const std::uint8_t value : thing.amodal.coverage) inside += value / 255.0;
    return static_cast<std::uint64_t>(
        std::clamp(std::floor(thing.amodal_pixels - inside + 0.5), 0.0, 1e12));
  }

  std::optional<Json> info_of(const FrameLabels& frame, const Thing& thing,
                              const std::vector<float>& depth, const std::string& number,
                              std::size_t index) {
    const auto [width, height] = std::pair(frame.camera.width, frame.camera.height);
    const PixelMask whole = pixels_of(thing.amodal), seen = pixels_of(thing.visible);
    image::PngOptions grey;
    grey.channels = 1;
    for (const auto& [mask, folder] : {std::pair(&whole, "mask"), std::pair(&seen, "mask_visib")})
      if (!output_.write(kScene / folder / fmt::format("{}_{:06}.png", number, index),
                         image::png_file(width, height, mask_image(*mask, width, height), grey)))
        return std::nullopt;
    std::uint64_t valid = 0;
    for (std::uint32_t j = 0; !depth.empty() && j < whole.height; ++j)
      for (std::uint32_t i = 0; i < whole.width; ++i)
        valid += whole.set[std::size_t{j} * whole.width + i] != 0 &&
                 std::isfinite(depth[(std::size_t{whole.top} + j) * width + whole.left + i]);
    const auto all = std::max(whole.count + pixels_outside(thing, frame.camera), seen.count);
    const double share = all == 0 ? 0 : static_cast<double>(seen.count) / static_cast<double>(all);
    Json json{{"bbox_obj", whole_box(thing, whole, frame.camera)}};
    json["bbox_visib"] = seen.empty() ? Json{-1, -1, -1, -1}
                                      : Json{seen.left, seen.top, seen.width - 1, seen.height - 1};
    json["px_count_all"] = all;
    json["px_count_valid"] = valid;
    json["px_count_visib"] = seen.count;
    json["visib_fract"] = share;
    return json;
  }

  bool write_depth(const FrameLabels& frame, const std::vector<float>& depth, double scale) {
    std::vector<std::uint8_t> pixels;
    pixels.reserve(2 * depth.size());
    for (const float z : depth) {
      // 0 is no depth
      const double code =
          std::isfinite(z) && z > 0
              ? std::clamp(std::floor(double{z} * kMillimetres / scale + 0.5), 1.0, 65535.0)
              : 0.0;
      const auto value = static_cast<std::uint32_t>(code);
      pixels.push_back(static_cast<std::uint8_t>(value >> 8));
      pixels.push_back(static_cast<std::uint8_t>(value & 0xff));
    }
    image::PngOptions options;
    options.channels = 1;
    options.bytes = 2;
    return output_.write(kScene / "depth" / fmt::format("{:06}.png", frame.number),
                         image::png_file(frame.camera.width, frame.camera.height, pixels, options));
  }

  bool write_models() {
    Json infos = Json::object();
    for (const auto& [id, each] : output_.classes()) {
      if (!each.is_target()) continue;
      const pan::Model* model = output_.model(each.target);
      if (model == nullptr) {
        output_.lost({}, fmt::format("'{}' has no model; models/obj_{:06}.ply is left out "
                                     "(--target {}=FILE)",
                                     each.target, id, each.target));
        continue;
      }
      const PlyModel ply = ply_of(*model, kMillimetres, output_.job());
      if (!output_.write(std::filesystem::path("models") / fmt::format("obj_{:06}.ply", id),
                         ply.bytes))
        return false;
      Json& info = infos[std::to_string(id)];
      info["diameter"] = ply.diameter;
      const char* const kAxes = "xyz";
      for (int k = 0; k < 3; ++k) info[fmt::format("min_{}", kAxes[k])] = ply.least[k];
      for (int k = 0; k < 3; ++k)
        info[fmt::format("size_{}", kAxes[k])] = ply.most[k] - ply.least[k];
    }
    return infos.empty() || output_.write_table("models/models_info.json", infos.dump(2) + "\n");
  }

  Output& output_;
  Rows poses_, infos_, cameras_;
  std::map<std::uint32_t, std::vector<Vec3>> keypoints_;  // of the first frame
};

}  // namespace

std::span<const Format> bop_formats() {
  static const Format kFormats[] = {
      {{.name = "bop",
        .files = "train/000000/, models/ of BOP: poses, masks, depth, models",
        .png = true,
        .depth = true},
       {true, false},
       make_writer<BopWriter>}};
  return kFormats;
}

}  // namespace panwright::labels
