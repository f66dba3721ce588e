// COCO, as of github.com/cocodataset/cocoapi: one JSON of images, categories and annotations.
#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "labels/internal/format.h"
#include "labels/internal/pixels.h"

namespace panwright::labels {
namespace {

constexpr double kOksSigma = 0.05;  // of all keypoints: that of no human one
constexpr const char* kCocoFile = "annotations.json";

class CocoWriter final : public LabelWriter {
 public:
  explicit CocoWriter(Output& output) : output_(output) {}

  bool add(const FrameLabels& frame) override {
    if (!file_) {
      auto file = AtomicFile::create(output_.folder() / kCocoFile, output_.log());
      if (!file) return false;
      file_.emplace(*std::move(file));
      if (!put("{\"annotations\":[")) return false;
    }
    const auto png = output_.png_of(frame);
    if (!png) output_.lost(frame, "it has no PNG image; file_name names what it has");
    images_.push_back({{"id", frame.number},
                       {"file_name", png ? *png : frame.image},
                       {"width", frame.camera.width},
                       {"height", frame.camera.height}});
    for (const Thing& thing : frame.things)
      if (!annotate(frame, thing)) return false;
    return true;
  }

  bool finish() override {
    Json categories = Json::array();
    for (const ThingClass* each : output_.classes_by_number()) {
      Json category{{"id", each->id}, {"name", each->name()}, {"supercategory", each->target}};
      if (!each->keypoints.empty()) {
        category["keypoints"] = each->keypoints;
        category["skeleton"] = Json::array();
        category["kpt_oks_sigmas"] = std::vector<double>(each->keypoints.size(), kOksSigma);
      }
      categories.push_back(std::move(category));
    }
    const Json info{{"description", "panwright labels"}, {"version", "1.0"}};
    const auto text = [](const Json& json) {
      return json.dump(-1, ' ', false, Json::error_handler_t::replace);
    };
    if (!put("],\n\"images\":" + text(images_) + ",\n\"categories\":" + text(categories) +
             ",\n\"info\":" + text(info) + ",\n\"licenses\":[]}\n") ||
        !file_->commit(output_.log()))
      return false;
    output_.add_table(kCocoFile);
    return true;
  }

 private:
  using Json = nlohmann::ordered_json;

  bool put(std::string_view text) { return file_->write(as_bytes(text), output_.log()); }

  bool annotate(const FrameLabels& frame, const Thing& thing) {
    const PixelMask mask = pixels_of(thing.visible);
    if (mask.empty()) {
      if (thing.visible.width > 0)
        output_.lost(frame, fmt::format("'{}' covers no pixel by more than half; it is left out",
                                        output_.class_of(thing).name()));
      return true;
    }
    const auto [width, height] = std::pair(frame.camera.width, frame.camera.height);
    Json json{{"id", ++annotations_},    {"image_id", frame.number},
              {"category_id", thing.id}, {"bbox", {mask.left, mask.top, mask.width, mask.height}},
              {"area", mask.count},      {"iscrowd", 0}};
    json["segmentation"] = {{"size", {height, width}},
                            {"counts", rle_text(rle_counts(mask, width, height))}};
    add_keypoints(frame, thing, json);
    return put((annotations_ == 1 ? "\n" : ",\n") +
               json.dump(-1, ' ', false, Json::error_handler_t::replace));
  }

  void add_keypoints(const FrameLabels& frame, const Thing& thing, Json& json) {
    const ThingClass& known = output_.class_of(thing);
    if (known.keypoints.empty()) return;
    std::size_t used = 0, labelled = 0;
    Json list = Json::array();
    for (const std::string& name : known.keypoints) {
      const auto at = std::ranges::find(thing.keypoints, name, &Keypoint::name);
      used += at != thing.keypoints.end();
      if (at == thing.keypoints.end() || at->truncated || !at->pixel) {
        for (int k = 0; k < 3; ++k) list.push_back(0);
        continue;
      }
      ++labelled;
      list.push_back(at->pixel->x - 0.5);  // COCO's pixel centres are whole numbers
      list.push_back(at->pixel->y - 0.5);
      list.push_back(at->occluded ? 1 : 2);
    }
    if (used < thing.keypoints.size())
      output_.lost(frame, fmt::format("'{}' has keypoints that its first frame has not; they are "
                                      "left out",
                                      known.name()));
    json["num_keypoints"] = labelled;
    json["keypoints"] = std::move(list);
  }

  Output& output_;
  std::optional<AtomicFile> file_;
  Json images_ = Json::array();
  std::uint64_t annotations_ = 0;
};

}  // namespace

std::span<const Format> coco_formats() {
  static const Format kFormats[] = {{{"coco", "annotations.json: masks, boxes, keypoints of COCO"},
                                     {true, false},
                                     make_writer<CocoWriter>}};
  return kFormats;
}

}  // namespace panwright::labels
