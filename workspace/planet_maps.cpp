#include "workspace/internal/planet_maps.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "base/file.h"
#include "image/decode.h"
#include "light/map_rows.h"

namespace panwright::workspace {
namespace {

constexpr std::uint64_t kMostFileBytes = 4ull << 30;
constexpr std::uint64_t kMostMapBytes = 1ull << 30;

class MapReceiver : public image::RowReceiver {
 public:
  explicit MapReceiver(light::MapValues values) : values_(values) {}

  image::ImageProblem begin(const image::ImageHead& head) override {
    head_ = head;
    if (head.width != 2 * std::uint64_t{head.height})
      return {Code("E0201"),
              fmt::format("a map of {} by {} pixels, expected twice as wide as high: longitudes "
                          "from -180 to 180 degrees, the north at the top",
                          head.width, head.height)};
    std::uint32_t turn = 0;
    if (head.extent) {
      const image::Extent& extent = *head.extent;
      const double pixel = 360.0 / head.width;
      if (!(std::fabs(extent.width - 360) < pixel && std::fabs(extent.height - 180) < pixel &&
            std::fabs(extent.north - 90) < pixel && std::fabs(extent.west) < 720))
        return {Code("E0201"),
                fmt::format("a map of longitudes {:.6g} to {:.6g} and latitudes {:.6g} to {:.6g} "
                            "degrees, expected the whole planet",
                            extent.west, extent.west + extent.width, extent.north - extent.height,
                            extent.north)};
      const double columns = std::round((extent.west + 180) / pixel);
      const double width = head.width;
      turn = static_cast<std::uint32_t>(columns - width * std::floor(columns / width));
    }
    rows_.emplace(head.width, head.height, values_, turn, head.no_data);
    return {};
  }
  void row(std::span<const std::uint8_t> rgba) override { rows_->add(rgba); }

  const image::ImageHead& head() const { return head_; }
  const light::MapRows& rows() const { return *rows_; }

 private:
  light::MapValues values_;
  image::ImageHead head_;
  std::optional<light::MapRows> rows_;
};

void tell(const std::string& path, const MapReceiver& map, DiagnosticLog& log) {
  const image::ImageHead& head = map.head();
  const light::MapRows& rows = map.rows();
  if (rows.step() > 1)
    log.report_file(Code("N5042"), path,
                    fmt::format("a map of {} by {} pixels: means of {} by {} are used", head.width,
                                head.height, rows.step(), rows.step()),
                    "docs/sky.md");
  if (rows.holes() > 0) {
    const auto& hole = *rows.first_hole();
    const double all = static_cast<double>(head.width) * head.height;
    log.report_file(Code("W5043"), path,
                    fmt::format("{} pixels ({:.2g} %) are holes, the first of column {}, row {}: "
                                "they get the mean of the others",
                                rows.holes(), 100 * static_cast<double>(rows.holes()) / all,
                                hole.column, hole.row),
                    "docs/sky.md");
  }
}

std::optional<light::MapPixels> map_pixels(const std::string& path, light::MapValues values,
                                           DiagnosticLog& log) {
  const auto bytes = read_file(path, kMostFileBytes, log);
  if (!bytes) return std::nullopt;
  MapReceiver map(values);
  const auto problem = image::decode_rows(std::as_bytes(std::span(*bytes)), kMostMapBytes, map);
  if (problem.code) {
    log.report_file(*problem.code, path, problem.message,
                    *problem.code == Code("E0201") ? "docs/sky.md" : "");
    return std::nullopt;
  }
  tell(path, map, log);
  return map.rows().pixels();
}

}  // namespace

std::shared_ptr<const light::BodyMap> albedo_map(const PlanetFiles& files, const Vec3& albedo,
                                                 DiagnosticLog& log) {
  light::MapPixels map;
  if (!files.map.empty()) {
    auto ground = map_pixels(files.map, light::MapValues::colour, log);
    if (!ground) return nullptr;
    map = *std::move(ground);
  }
  if (!files.clouds.empty()) {
    const auto clouds = map_pixels(files.clouds, light::MapValues::cover, log);
    if (!clouds) return nullptr;
    bool dimmed = false;
    map = light::with_clouds(map, *clouds, albedo, dimmed);
    if (dimmed)
      log.report_file(Code("W5043"), files.clouds,
                      "the clouds alone reflect more than the albedo: they are dimmed, the ground "
                      "is black",
                      "a larger albedo=, or thinner clouds");
  }
  return std::make_shared<light::BodyMap>(std::move(map));
}

std::shared_ptr<const light::BodyMap> night_map(const std::string& path, DiagnosticLog& log) {
  auto map = map_pixels(path, light::MapValues::colour, log);
  if (!map) return nullptr;
  return std::make_shared<light::BodyMap>(*std::move(map), light::BodyMap::Scale::none);
}

}  // namespace panwright::workspace
