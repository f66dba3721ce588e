// Rows of PNG and JPEG images: linear values of their codes.
#include <fmt/core.h>

#include <array>
#include <limits>
#include <vector>

#include "image/decode.h"
#include "image/srgb.h"
#include "terrain/internal/found.h"

namespace panwright::terrain {

namespace {

// One channel of an image; pixels without alpha are voids.
class ImageRows : public RowSource, public image::RowReceiver {
 public:
  ImageRows(std::size_t channel, std::uint64_t memory) : channel_(channel), memory_(memory) {
    for (std::size_t k = 0; k < linear_.size(); ++k)
      linear_[k] = image::srgb_decoded(static_cast<std::uint8_t>(k));
  }

  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }

  image::ImageProblem begin(const image::ImageHead& head) override {
    width_ = head.width;
    height_ = head.height;
    if (std::uint64_t{2} * width_ * height_ > memory_) return {Code("E3002"), "it is too large"};
    codes_.reserve(std::size_t{width_} * height_);
    there_.reserve(codes_.capacity());
    return {};
  }
  void row(std::span<const std::uint8_t> rgba) override {
    for (std::size_t i = 0; i < rgba.size(); i += 4) {
      codes_.push_back(rgba[i + channel_]);
      there_.push_back(rgba[i + 3] != 0);
    }
  }

  bool read(std::uint32_t first, std::uint32_t count, const RowsReceiver& to, DiagnosticLog&,
            const Job& job) const override {
    std::vector<double> values(width_);
    std::vector<VoidKind> voids(width_);
    for (std::uint32_t y = first; y < first + count; ++y) {
      job.poll();
      for (std::size_t x = 0; x < width_; ++x) {
        const std::size_t at = std::size_t{y} * width_ + x;
        voids[x] = there_[at] ? VoidKind::none : VoidKind::missing;
        values[x] = there_[at] ? linear_[codes_[at]] : std::numeric_limits<double>::quiet_NaN();
      }
      if (!to({y, 1, values, voids})) return false;
    }
    return true;
  }

 private:
  std::size_t channel_;
  std::uint64_t memory_;
  std::uint32_t width_ = 0, height_ = 0;
  std::array<double, 256> linear_{};
  std::vector<std::uint8_t> codes_;
  std::vector<bool> there_;
};

}  // namespace

Result<Found> read_image(const Opening& opening, MappedFile file) {
  Found out;
  DemInfo& info = out.info;
  info.files = {opening.path.string()};
  info.format = "image";
  info.sample = "8-bit sRGB";
  info.bands = 3;
  info.quantity = Quantity::plain;
  if (opening.options.band > 3)
    return opening.fail(fmt::format("there is no band {}: it has three", opening.options.band));
  const auto rows = std::make_shared<ImageRows>(opening.options.band - 1, opening.options.memory);
  const image::ImageProblem problem =
      image::decode_rows(file.bytes(), opening.options.memory, *rows);
  if (problem.code) return opening.fail(problem.message);
  info.width = rows->width();
  info.height = rows->height();
  if (!opening.check_size(info)) return failed;
  out.rows = rows;
  const auto radius = opening.options.radius ? opening.options.radius : opening.options.body_radius;
  if (info.width != 2 * info.height || !radius) return out;
  info.map.radius = *radius;
  place_in_degrees(info, -180, 90, 360.0 / info.width, 360.0 / info.width);
  opening.note(
      "an image twice as wide as high is taken as the whole body, longitude 0 in its middle");
  return out;
}

}  // namespace panwright::terrain
