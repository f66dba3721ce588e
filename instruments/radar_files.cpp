// Histograms of RADARs as files.
#include "instruments/radar_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/file.h"
#include "base/text.h"
#include "image/arrays.h"
#include "image/image.h"
#include "image/srgb.h"
#include "image/whole.h"

namespace panwright::instruments {

namespace {

constexpr double kRangeOfDecibels = 60;
constexpr std::uint32_t kLeastSide = 640;  // pixels of the longer side of a PNG

image::Array doubles(std::string name, const std::vector<double>& values,
                     std::vector<std::uint64_t> shape) {
  image::Array out{std::move(name), "<f8", std::move(shape), {}};
  out.data.resize(values.size() * sizeof(double));
  std::memcpy(out.data.data(), values.data(), out.data.size());
  return out;
}

std::vector<double> axis(double first, double step, std::uint32_t count) {
  std::vector<double> out;
  for (std::uint32_t i = 0; i < count; ++i) out.push_back(first + step * i);
  return out;
}

bool write_histogram_npz(const RadarHistogram& h, const std::filesystem::path& path,
                         const std::string& record, DiagnosticLog& log) {
  const std::vector<std::uint64_t> plane{h.speeds, h.ranges};
  std::vector<image::Array> arrays;
  arrays.push_back(doubles("power_w", h.power, plane));
  arrays.push_back(doubles("mean_power_w", h.mean_power, plane));
  arrays.push_back(doubles("azimuth_rad", h.azimuth, plane));
  arrays.push_back(doubles("elevation_rad", h.elevation, plane));
  arrays.push_back(doubles("range_m", axis(h.first_range, h.range_step, h.ranges), {h.ranges}));
  arrays.push_back(doubles("speed_m_s", axis(h.first_speed, h.speed_step, h.speeds), {h.speeds}));
  arrays.push_back(doubles("response_sum", {h.response_sum}, {1}));
  image::Array text{"record", "|u1", {record.size()}, {}};
  text.data.resize(record.size());
  std::memcpy(text.data.data(), record.data(), record.size());
  arrays.push_back(std::move(text));
  return image::write_arrays(path, arrays, log);
}

bool write_histogram_csv(const RadarHistogram& h, const std::filesystem::path& path,
                         DiagnosticLog& log) {
  std::string text = "range_m,speed_m_s,power_w,mean_power_w,azimuth_rad,elevation_rad\n";
  const auto angle = [](double value) { return std::isnan(value) ? "" : format_double(value); };
  for (std::size_t i = 0; i < h.power.size(); ++i)
    text +=
        fmt::format("{},{},{},{},{},{}\n",
                    format_double(h.first_range + h.range_step * static_cast<double>(i % h.ranges)),
                    format_double(h.first_speed + h.speed_step * static_cast<double>(i / h.ranges)),
                    format_double(h.power[i]), format_double(h.mean_power[i]), angle(h.azimuth[i]),
                    angle(h.elevation[i]));
  return write_file(path, as_bytes(text), log);
}

// Colours of 0, 1/4, … 1, as codes of sRGB.
Vec3 heat(double share) {
  static constexpr std::array<std::array<double, 3>, 5> kStops{
      {{0, 0, 4}, {81, 18, 124}, {183, 55, 121}, {252, 137, 97}, {252, 253, 191}}};
  const double at = std::clamp(share, 0.0, 1.0) * 4;
  const auto low = std::min<std::size_t>(static_cast<std::size_t>(at), 3);
  const double f = at - static_cast<double>(low);
  Vec3 out(0);
  for (std::size_t k = 0; k < 3; ++k)
    out[static_cast<int>(k)] = ((1 - f) * kStops[low][k] + f * kStops[low + 1][k]) / 255;
  return out;
}

// Number of a code of sRGB as a radiance that write_image() turns into it.
float radiance_of(double code) {
  const double linear = code <= 0.04045 ? code / 12.92 : det::pow((code + 0.055) / 1.055, 2.4);
  return static_cast<float>(linear / kPi);
}

image::Image picture(const RadarHistogram& h, std::uint32_t scale, bool colours) {
  image::Image out;
  out.width = h.ranges * scale;
  out.height = h.speeds * scale;
  out.unit = "W";
  out.radiance.resize(3 * out.pixels());
  out.coverage.assign(out.pixels(), 1);
  const double most = *std::ranges::max_element(h.power);
  for (std::uint32_t y = 0; y < out.height; ++y)
    for (std::uint32_t x = 0; x < out.width; ++x) {
      const std::size_t row = h.speeds - 1 - y / scale;
      const double power = h.power[row * h.ranges + x / scale];
      Vec3 value(power);
      if (colours) {
        const double decibels = power > 0 && most > 0 ? 10 * det::log10(power / most) : -1e3;
        value = heat(1 + decibels / kRangeOfDecibels);
      }
      float* to = &out.radiance[3 * (std::size_t{y} * out.width + x)];
      for (int k = 0; k < 3; ++k)
        to[k] = colours ? radiance_of(value[k]) : static_cast<float>(value[k]);
    }
  return out;
}

}  // namespace

bool is_histogram_file(const std::filesystem::path& path) {
  const auto type = image::image_format(path);
  return path.extension() == ".csv" || type == image::ImageFormat::png ||
         type == image::ImageFormat::exr || type == image::ImageFormat::npz;
}

bool is_whole_histogram_file(const std::filesystem::path& path) {
  if (image::image_format(path)) return image::is_whole(path);
  DiagnosticLog none;
  const auto file = MappedFile::open(path, none);
  return file && !file->bytes().empty() && file->bytes().back() == std::byte{'\n'};
}

bool write_histogram(const RadarHistogram& histogram, const std::filesystem::path& path,
                     const std::string& record, DiagnosticLog& log) {
  const auto type = image::image_format(path);
  if (!type) return write_histogram_csv(histogram, path, log);
  if (*type == image::ImageFormat::npz) return write_histogram_npz(histogram, path, record, log);
  const bool colours = *type == image::ImageFormat::png;
  const std::uint32_t side = std::max(histogram.ranges, histogram.speeds);
  image::Image image = picture(histogram, colours ? (kLeastSide + side - 1) / side : 1, colours);
  image.metadata.emplace_back(image::kRecordName, record);
  return image::write_image(path, image, image::PngExposure(0), log);
}

}  // namespace panwright::instruments
