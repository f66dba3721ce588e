// Optical flow of KITTI 2015: PNG of 16 bits, u·64 + 2^15, v·64 + 2^15, 1 where known.
#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "image/png.h"
#include "labels/internal/format.h"

namespace panwright::labels {
namespace {

constexpr double kMostMotion = 512;  // pixels
constexpr const char* kWithoutFlow = "it has no flow to the next frame, and is left out";

class KittiWriter final : public LabelWriter {
 public:
  explicit KittiWriter(Output& output) : output_(output) {}

  // Frame N is N_10 beside its flow, and the one after it N_11. The last frame of a run has no flow
  // and is no loss.
  bool add(const FrameLabels& frame) override {
    const auto image = [&](std::uint64_t number, int time) {
      return output_.place_png(
          frame, std::filesystem::path("image_2") / fmt::format("{:06}_{}.png", number, time));
    };
    const bool follows = before_ && *before_ + 1 == frame.number;
    if (follows && !image(*before_, 11)) return false;
    if (before_ && !follows)
      output_.lost(frame, fmt::format("it does not follow frame {}, whose second image is left out",
                                      *before_));
    before_.reset();
    if (without_flow_) output_.lost(*without_flow_, kWithoutFlow);
    without_flow_.reset();
    if (!frame.forward) {
      if (follows) {
        without_flow_.emplace();
        without_flow_->name = frame.name;
      } else {
        output_.lost(frame, kWithoutFlow);
      }
      return true;
    }
    before_ = frame.number;
    return image(frame.number, 10) && output_.write(std::filesystem::path("flow_occ") /
                                                        fmt::format("{:06}_10.png", frame.number),
                                                    image_of(frame));
  }

  bool finish() override {
    if (before_)
      output_.lost(
          {}, fmt::format("no frame follows frame {}, whose second image is left out", *before_));
    return true;
  }

 private:
  std::string image_of(const FrameLabels& frame) {
    const Flow& flow = *frame.forward;
    std::vector<std::uint8_t> pixels;
    pixels.reserve(std::size_t{6} * flow.width * flow.height);
    const auto put = [&](std::uint32_t value) {
      pixels.push_back(static_cast<std::uint8_t>(value >> 8));
      pixels.push_back(static_cast<std::uint8_t>(value & 0xff));
    };
    bool too_far = false;
    for (std::size_t at = 0; at < flow.motion.size(); at += 2) {
      std::uint32_t code[2] = {0, 0};
      bool known = true;
      for (std::size_t k = 0; k < 2; ++k) {
        const double value = flow.motion[at + k];
        const double rounded = std::floor(value * 64 + 32768 + 0.5);
        if (!(rounded >= 0 && rounded <= 65535)) {
          known = false;
          too_far = too_far || std::fabs(value) >= kMostMotion - 1;
        } else {
          code[k] = static_cast<std::uint32_t>(rounded);
        }
      }
      put(known ? code[0] : 0);
      put(known ? code[1] : 0);
      put(known ? 1 : 0);
    }
    if (too_far) output_.lost(frame, "motion of 512 pixels and more is marked as unknown");
    image::PngOptions options;
    options.channels = 3;
    options.bytes = 2;
    return image::png_file(flow.width, flow.height, pixels, options);
  }

  Output& output_;
  std::optional<std::uint64_t> before_;  // number of the frame whose second image is the next one
  std::optional<FrameLabels> without_flow_;  // the frame before, if a loss unless it is the last
};

}  // namespace

std::span<const Format> kitti_formats() {
  static const Format kFormats[] = {
      {{.name = "kitti",
        .files = "flow_occ/, image_2/ of KITTI: flow to the next frame, in 1/64 pixel",
        .png = true,
        .flow = true},
       {false, true},
       make_writer<KittiWriter>}};
  return kFormats;
}

}  // namespace panwright::labels
