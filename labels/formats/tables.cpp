// Tables of poses of one target: SPARK, and URSO as pedropro/UrsoNet reads it.
#include <fmt/core.h>

#include "base/text.h"
#include "labels/internal/format.h"

namespace panwright::labels {
namespace {

std::string row_of(std::initializer_list<double> values) {
  std::string row;
  for (const double value : values) row += (row.empty() ? "" : ",") + format_double(value);
  return row;
}

class SparkWriter final : public LabelWriter {
 public:
  explicit SparkWriter(Output& output) : output_(output) {}

  bool add(const FrameLabels& frame) override {
    bool good = true;
    const Thing* target = output_.only_target(frame, good);
    if (target == nullptr) return good;
    const std::string name = frame.name + ".png";
    if (!output_.place_png(frame, std::filesystem::path("images") / name)) return false;
    const Quat& q = target->camera_from_thing.rotation;
    const Vec3& t = target->camera_from_thing.translation;
    table_ += fmt::format("0,{},{}\n", name, row_of({t.x, t.y, t.z, q.w, q.x, q.y, q.z}));
    return true;
  }

  bool finish() override { return output_.write_table("train.csv", table_); }

 private:
  Output& output_;
  std::string table_ = "sequence,filename,Tx,Ty,Tz,Qw,Qx,Qy,Qz\n";
};

// UrsoNet: x is the depth, y points right, z up; the target's y is mirrored, as in Unreal, and
// quaternions are those of JPL, the scalar last. With F = diag(1, -1, 1) the attitude in the axes
// right, up, depth is F·R·F, whose quaternion of JPL is (x, -y, z, w) of that of R.
class UrsoWriter final : public LabelWriter {
 public:
  explicit UrsoWriter(Output& output) : output_(output) {}

  bool add(const FrameLabels& frame) override {
    bool good = true;
    const Thing* target = output_.only_target(frame, good);
    if (target == nullptr) return good;
    const std::string name = "images/" + frame.name + ".png";
    if (!output_.place_png(frame, name)) return false;
    const Quat& q = target->camera_from_thing.rotation;
    const Vec3& t = target->camera_from_thing.translation;
    names_ += name + "\n";
    poses_ += row_of({t.z, t.x, -t.y, q.x, -q.y, q.z, q.w}) + "\n";
    return true;
  }

  bool finish() override {
    return output_.write_table("train_images.csv", names_) &&
           output_.write_table("train_poses_gt.csv", poses_);
  }

 private:
  Output& output_;
  std::string names_;
  std::string poses_ = "x,y,z,q1,q2,q3,q4\n";
};

}  // namespace

std::span<const Format> tables_formats() {
  static const Format kFormats[] = {
      {{"spark", "images/, train.csv of SPARK: the pose of one target", true, true},
       {false, false},
       make_writer<SparkWriter>},
      {{"urso", "images/, train_images.csv, train_poses_gt.csv of URSO: the pose of one target",
        true, true},
       {false, false},
       make_writer<UrsoWriter>}};
  return kFormats;
}

}  // namespace panwright::labels
