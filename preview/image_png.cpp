#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/math.h"
#include "base/parallel.h"
#include "preview/internal/image_files.h"

namespace panwright::preview {
namespace {

// IEC 61966-2-1
double decoded(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : det::pow((encoded + 0.055) / 1.055, 2.4);
}

// threshold[k]: the least linear value whose code is k+1
std::array<double, 255> made_thresholds() {
  std::array<double, 255> thresholds{};
  for (std::size_t k = 0; k < thresholds.size(); ++k)
    thresholds[k] = decoded((static_cast<double>(k) + 0.5) / 255.0);
  return thresholds;
}

const std::array<double, 255>& thresholds() {
  static const std::array<double, 255> table = made_thresholds();
  return table;
}

}  // namespace

std::uint8_t srgb_code(double linear) {
  if (std::isnan(linear)) return 0;
  const auto& table = thresholds();
  return static_cast<std::uint8_t>(std::upper_bound(table.begin(), table.end(), linear) -
                                   table.begin());
}

double srgb_decoded(std::uint8_t code) { return decoded(code / 255.0); }

bool write_png(AtomicFile& file, const Image& image, double ev, DiagnosticLog& log) {
  const double scale = kPi * std::exp2(ev);
  std::vector<std::uint8_t> codes(image.radiance.size());
  const std::size_t row = std::size_t{3} * image.width;
  parallel_for(image.height, [&](std::size_t j) {
    for (std::size_t i = j * row; i < (j + 1) * row; ++i)
      codes[i] = srgb_code(scale * image.radiance[i]);
  });
  png_image head;
  std::memset(&head, 0, sizeof head);
  head.version = PNG_IMAGE_VERSION;
  head.width = image.width;
  head.height = image.height;
  head.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(head);
  std::vector<std::byte> bytes(size);
  if (!png_image_write_to_memory(&head, bytes.data(), &size, 0, codes.data(), 0, nullptr)) {
    log.report_file(Code::E0103, {}, fmt::format("the PNG encoder failed: {}", head.message));
    return false;
  }
  return file.write(std::span(bytes).first(size), log);
}

}  // namespace panwright::preview
