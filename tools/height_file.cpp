#include "tools/height_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "base/file.h"
#include "base/text.h"
#include "image/image.h"
#include "image/npy.h"
#include "image/png.h"
#include "workspace/open.h"

namespace panwright::tools {
namespace {

static_assert(std::endian::native == std::endian::little);

bool write_npy(const std::filesystem::path& path, const mli::Sheet& sheet, DiagnosticLog& log) {
  auto file = AtomicFile::create(path, log);
  return file &&
         file->write(
             as_bytes(image::npy_header("<f8", fmt::format("({}, {})", sheet.rows, sheet.columns))),
             log) &&
         file->write(std::as_bytes(std::span(sheet.heights)), log) && file->commit(log);
}

bool write_exr(const std::filesystem::path& path, const mli::Sheet& sheet, DiagnosticLog& log) {
  image::Image image;
  image.width = sheet.columns;
  image.height = sheet.rows;
  image.unit = "m";
  image.metadata.emplace_back("heightUnit", "m");
  image.coverage.assign(image.pixels(), 1.0f);
  image.radiance.reserve(3 * image.pixels());
  for (std::uint32_t row = sheet.rows; row-- > 0;)
    for (std::uint32_t column = 0; column < sheet.columns; ++column)
      image.radiance.insert(image.radiance.end(), 3, static_cast<float>(sheet.at(column, row)));
  return image::write_image(path, image, 0, log);
}

bool write_png(const std::filesystem::path& path, const mli::Sheet& sheet, std::string& detail,
               DiagnosticLog& log) {
  const double lowest = sheet.statistics.lowest;
  const double range = sheet.statistics.highest - lowest;
  std::vector<std::uint8_t> pixels;
  pixels.reserve(2 * sheet.heights.size());
  for (std::uint32_t row = sheet.rows; row-- > 0;)
    for (std::uint32_t column = 0; column < sheet.columns; ++column) {
      const double share = range > 0 ? (sheet.at(column, row) - lowest) / range : 0.0;
      const auto code =
          static_cast<std::uint32_t>(std::clamp(std::floor(share * 65535 + 0.5), 0.0, 65535.0));
      pixels.push_back(static_cast<std::uint8_t>(code >> 8));
      pixels.push_back(static_cast<std::uint8_t>(code & 0xff));
    }
  detail += fmt::format(", 0 is {} m, 65535 is {} m", format_double(lowest),
                        format_double(sheet.statistics.highest));
  image::PngOptions options;
  options.channels = 1;
  options.bytes = 2;
  options.comment = fmt::format("height: 0 is {} m, 65535 is {} m", format_double(lowest),
                                format_double(sheet.statistics.highest));
  const std::string bytes = image::png_file(sheet.columns, sheet.rows, pixels, options);
  return write_file(path, as_bytes(bytes), log);
}

}  // namespace

bool is_height_file(const std::filesystem::path& path, DiagnosticLog& log) {
  const std::string extension = workspace::extension_of(path);
  if (extension == ".npy" || extension == ".exr" || extension == ".png") return true;
  log.report_file(Code("E0202"), path.string(),
                  fmt::format("heights are written as .npy, .exr or .png, not {}",
                              in_quotes(path.extension().string())));
  return false;
}

bool write_heights(const std::filesystem::path& path, const mli::Sheet& sheet, std::string& detail,
                   DiagnosticLog& log) {
  if (!is_height_file(path, log)) return false;
  detail = fmt::format("{}x{}", sheet.columns, sheet.rows);
  const std::string extension = workspace::extension_of(path);
  if (extension == ".npy") return write_npy(path, sheet, log);
  if (extension == ".exr") return write_exr(path, sheet, log);
  return write_png(path, sheet, detail, log);
}

}  // namespace panwright::tools
