#include "image/image.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <string>

#include "base/file.h"
#include "base/text.h"
#include "image/internal/writers.h"

namespace panwright::image {
namespace {

[[maybe_unused]] bool is_consistent(const Image& image) {
  const std::size_t pixels = image.pixels();
  const bool none = image.depth.empty() && image.range.empty() && image.normal.empty() &&
                    image.target_id.empty() && image.node_id.empty() && image.material_id.empty();
  const bool all = image.depth.size() == pixels && image.range.size() == pixels &&
                   image.normal.size() == 3 * pixels && image.target_id.size() == pixels &&
                   image.node_id.size() == pixels && image.material_id.size() == pixels;
  return image.width > 0 && image.height > 0 && image.radiance.size() == 3 * pixels &&
         image.coverage.size() == pixels && (none || all);
}

}  // namespace

void reset_ground_truth(Image& image, bool wanted) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  const std::size_t pixels = wanted ? image.pixels() : 0;
  image.depth.assign(pixels, kFar);
  image.range.assign(pixels, kFar);
  image.normal.assign(3 * pixels, 0);
  image.target_id.assign(pixels, 0);
  image.node_id.assign(pixels, 0);
  image.material_id.assign(pixels, 0);
}

std::optional<ImageFormat> image_format(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (extension == ".png") return ImageFormat::png;
  if (extension == ".exr") return ImageFormat::exr;
  if (extension == ".npy") return ImageFormat::npy;
  if (extension == ".npz") return ImageFormat::npz;
  if (extension == ".tif" || extension == ".tiff") return ImageFormat::tiff;
  if (extension == ".fits" || extension == ".fit") return ImageFormat::fits;
  return std::nullopt;
}

bool stores_ground_truth(ImageFormat format, const FileOptions& options) {
  if (format != ImageFormat::exr && format != ImageFormat::npz) return false;
  for (const FileLayer layer : {FileLayer::depth, FileLayer::range, FileLayer::normal,
                                FileLayer::target_id, FileLayer::node_id, FileLayer::material_id})
    if (options.has(layer)) return true;
  return false;
}

bool write_image(const std::filesystem::path& path, const Image& image, const PngExposure& exposure,
                 DiagnosticLog& log, double* sync_seconds, const FileOptions& options) {
  assert(is_consistent(image));
  const auto format = image_format(path);
  if (!format) {
    log.report_file(
        Code("E0202"), path.string(),
        fmt::format("images are written as .png, .exr, .npy, .npz, .tif or .fits, not {}",
                    in_quotes(path.extension().string())));
    return false;
  }
  if ((*format == ImageFormat::tiff || *format == ImageFormat::fits) && image.dn.empty()) {
    log.report_file(Code("E0202"), path.string(),
                    "the file holds numbers of a detector, and the camera has none; expected .png, "
                    ".exr, .npy or .npz",
                    "docs/detector.md");
    return false;
  }
  auto file = AtomicFile::create(path, log);
  if (!file) return false;
  bool written = false;
  switch (*format) {
    case ImageFormat::png:
      written = image.dn.empty() ? write_png(*file, image, exposure, log)
                                 : write_numbers_png(*file, image, log);
      break;
    case ImageFormat::tiff:
      written = write_tiff(*file, image, log);
      break;
    case ImageFormat::fits:
      written = write_fits(*file, image, log);
      break;
    case ImageFormat::exr:
      written = write_exr(*file, image, options, log);
      break;
    case ImageFormat::npy:
      written = write_npy(*file, image, log);
      break;
    case ImageFormat::npz:
      written = write_npz(*file, image, options, log);
      break;
  }
  return written && file->commit(log, sync_seconds);
}

}  // namespace panwright::image
