// SPEED and SPEED+, as of tpark94/speedplusbaseline: a list of images with the pose of one target.
#include <nlohmann/json.hpp>

#include "labels/internal/format.h"
#include "sensor/camera_file.h"

namespace panwright::labels {
namespace {

class SpeedWriter : public LabelWriter {
 public:
  SpeedWriter(Output& output, const char* quaternion) : output_(output), quaternion_(quaternion) {}

  bool add(const FrameLabels& frame) override {
    bool good = true;
    const Thing* target = output_.only_target(frame, good);
    if (target == nullptr) return good;
    if (frame.camera.projection != world::Projection::perspective)
      return output_.impossible(frame, "its camera is orthographic; the format's are perspective");
    if (!camera_) {
      camera_ = frame.camera;
      pixel_um_ = frame.pixel_um;
    } else if (!same_lens(frame.camera, *camera_)) {
      output_.lost(frame, "it has another lens than camera.json, that of the first frame");
    }
    const std::string name = frame.name + ".png";
    if (!output_.place_png(frame, std::filesystem::path("images") / name)) return false;
    const Quat& q = target->camera_from_thing.rotation;
    const Vec3& t = target->camera_from_thing.translation;
    // as a Hamilton quaternion SPEED's is that of camera_from_target
    const nlohmann::ordered_json line{{"filename", name},
                                      {quaternion_, {q.w, q.x, q.y, q.z}},
                                      {"r_Vo2To_vbs_true", {t.x, t.y, t.z}}};
    list_ += (list_.empty() ? "[\n" : ",\n") + line.dump();
    return true;
  }

  bool finish() override {
    if (!output_.write_table("train.json", (list_.empty() ? "[" : list_) + "\n]\n")) return false;
    if (!camera_) return true;
    const sensor::CameraFile file{
        {},
        camera_->width,
        camera_->height,
        {camera_->focal, camera_->principal,
         camera_->distortion ? camera_->distortion->distortion() : sensor::Distortion{}},
        pixel_um_};
    const auto text = sensor::camera_text(file, sensor::CameraFormat::speed, output_.log());
    return text && output_.write_table("camera.json", *text);
  }

 private:
  static bool same_lens(const world::Camera& a, const world::Camera& b) {
    const auto distortion = [](const world::Camera& camera) {
      return camera.distortion ? camera.distortion->distortion() : sensor::Distortion{};
    };
    return a.width == b.width && a.height == b.height && a.focal == b.focal &&
           a.principal == b.principal && distortion(a) == distortion(b);
  }

  Output& output_;
  const char* quaternion_;
  std::optional<world::Camera> camera_;
  std::optional<Vec2> pixel_um_;  // of the first frame
  std::string list_;
};

struct Speed2019 final : SpeedWriter {
  explicit Speed2019(Output& output) : SpeedWriter(output, "q_vbs2tango") {}
};
struct SpeedPlus final : SpeedWriter {
  explicit SpeedPlus(Output& output) : SpeedWriter(output, "q_vbs2tango_true") {}
};

}  // namespace

std::span<const Format> speed_formats() {
  static const Format kFormats[] = {
      {{"speed", "images/, train.json, camera.json of SPEED: the pose of one target", true, true},
       {false, false},
       make_writer<Speed2019>},
      {{"speedplus", "the same for SPEED+", true, true}, {false, false}, make_writer<SpeedPlus>}};
  return kFormats;
}

}  // namespace panwright::labels
