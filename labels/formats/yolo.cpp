// YOLO, as Ultralytics reads it: a text for each image, a line for each target or part.
#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "labels/internal/format.h"
#include "labels/internal/outline.h"
#include "labels/internal/pixels.h"

namespace panwright::labels {
namespace {

enum class YoloKind { boxes, poses, segments };

class YoloWriter : public LabelWriter {
 public:
  YoloWriter(Output& output, YoloKind kind) : output_(output), kind_(kind) {}

  bool add(const FrameLabels& frame) override {
    if (!output_.place_png(frame, std::filesystem::path("images/train") / (frame.name + ".png")))
      return false;
    Lines lines{frame, {}};
    for (const Thing& thing : frame.things)
      if (kind_ != YoloKind::poses || thing.label.empty()) write_thing(thing, lines);
    lines_.push_back(std::move(lines.rows));
    names_.push_back(frame.name);
    return kind_ == YoloKind::poses || write_last();
  }

  bool finish() override {
    if (kind_ == YoloKind::poses)
      for (; !names_.empty(); names_.pop_back(), lines_.pop_back())
        if (!write_last()) return false;
    if (kind_ == YoloKind::poses && points_ == 0)
      output_.lost({}, "no model has keypoints; lines hold boxes, which trainers of poses refuse");
    std::string text = "train: images/train\nval: images/train\n";
    if (kind_ == YoloKind::poses) text += fmt::format("kpt_shape: [{}, 3]\n", points_);
    text += "names:\n";
    for (const ThingClass* each : used())
      text += fmt::format("  {}: {}\n", number_of(*each), nlohmann::json(each->name()).dump());
    return output_.write_table("data.yaml", text);
  }

 private:
  // A line with the number of its keypoints, which all lines shall have alike.
  struct Row {
    std::string text;
    std::size_t points = 0;
  };
  struct Lines {
    const FrameLabels& frame;
    std::vector<Row> rows;
  };

  bool write_last() {
    std::string text;
    for (const Row& row : lines_.back()) {
      text += row.text;
      if (kind_ == YoloKind::poses)
        for (std::size_t k = row.points; k < points_; ++k) text += " 0 0 0";
      text += "\n";
    }
    if (!output_.write(std::filesystem::path("labels/train") / (names_.back() + ".txt"), text))
      return false;
    if (kind_ != YoloKind::poses) names_.clear(), lines_.clear();
    return true;
  }

  // Poses are of targets, numbered without the parts.
  std::vector<const ThingClass*> used() const {
    std::vector<const ThingClass*> out;
    for (const ThingClass* each : output_.classes_by_number())
      if (kind_ != YoloKind::poses || each->is_target()) out.push_back(each);
    return out;
  }
  std::size_t number_of(const ThingClass& wanted) const {
    if (kind_ != YoloKind::poses) return wanted.number;
    std::size_t number = 0;
    for (const auto& [id, each] : output_.classes())
      number += each.is_target() && each.number < wanted.number;
    return number;
  }

  void write_thing(const Thing& thing, Lines& lines) {
    const FrameLabels& frame = lines.frame;
    const PixelMask mask = pixels_of(thing.visible);
    if (mask.empty()) {
      if (thing.visible.width > 0)
        output_.lost(frame, fmt::format("'{}' covers no pixel by more than half; it is left out",
                                        output_.class_of(thing).name()));
      return;
    }
    const double width = frame.camera.width, height = frame.camera.height;
    Row row{std::to_string(number_of(output_.class_of(thing))), 0};
    const auto put = [&](double value) { row.text += fmt::format(" {:.9f}", value); };
    if (kind_ == YoloKind::segments) {
      for (const auto& [x, y] : outline_of(mask)) put(x / width), put(y / height);
    } else {
      put((mask.left + mask.width / 2.0) / width);
      put((mask.top + mask.height / 2.0) / height);
      put(mask.width / width);
      put(mask.height / height);
    }
    if (kind_ == YoloKind::poses) {
      for (const Keypoint& point : thing.keypoints) {
        const bool there = point.pixel && !point.truncated;
        put(there ? point.pixel->x / width : 0);
        put(there ? point.pixel->y / height : 0);
        row.text += !there ? " 0" : point.occluded ? " 1" : " 2";
      }
      row.points = thing.keypoints.size();
      points_ = std::max(points_, row.points);
    }
    lines.rows.push_back(std::move(row));
  }

  Output& output_;
  YoloKind kind_;
  std::vector<std::vector<Row>> lines_;  // of frames not yet written
  std::vector<std::string> names_;       // of these
  std::size_t points_ = 0;               // the most of any target
};

template <YoloKind kind>
struct YoloOf final : YoloWriter {
  explicit YoloOf(Output& output) : YoloWriter(output, kind) {}
};

}  // namespace

std::span<const Format> yolo_formats() {
  static const Format kFormats[] = {
      {{.name = "yolo",
        .files = "images/train/, labels/train/, data.yaml of YOLO: boxes",
        .png = true},
       {true, false},
       make_writer<YoloOf<YoloKind::boxes>>},
      {{.name = "yolo-pose", .files = "the same with keypoints, of targets", .png = true},
       {true, false},
       make_writer<YoloOf<YoloKind::poses>>},
      {{.name = "yolo-seg", .files = "the same with outlines in place of boxes", .png = true},
       {true, false},
       make_writer<YoloOf<YoloKind::segments>>}};
  return kFormats;
}

}  // namespace panwright::labels
