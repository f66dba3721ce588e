#include "image/video.h"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <vector>

#include "base/file.h"
#include "base/program.h"
#include "image/internal/image_codecs.h"
#include "image/png.h"
#include "image/shown.h"
#include "image/srgb.h"

namespace panwright::image {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostPixelBytes = 2ull << 30;

void append_number(std::uint64_t value, std::size_t bytes, std::string& out) {
  for (std::size_t k = bytes; k-- > 0;) out += static_cast<char>((value >> (8 * k)) & 0xff);
}

std::uint32_t number_at(std::string_view bytes) {
  std::uint32_t out = 0;
  for (const char c : bytes.substr(0, 4)) out = out << 8 | static_cast<std::uint8_t>(c);
  return out;
}

// parts: of the chunk's content
bool write_chunk(AtomicFile& file, std::string_view name,
                 std::initializer_list<std::string_view> parts, DiagnosticLog& log) {
  std::size_t length = 0;
  uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(name.data()), name.size());
  for (const std::string_view part : parts) {
    length += part.size();
    crc = crc32_z(crc, reinterpret_cast<const Bytef*>(part.data()), part.size());
  }
  std::string head, tail;
  append_number(length, 4, head);
  append_number(crc, 4, tail);
  bool good = file.write(as_bytes(head + std::string(name)), log);
  for (const std::string_view part : parts) good = good && file.write(as_bytes(part), log);
  return good && file.write(as_bytes(tail), log);
}

// A PNG file in parts.
struct PngParts {
  std::string header;  // content of IHDR
  bool srgb = false;   // with a chunk that says so
  std::string rows;    // compressed
};

// path: for a problem.
std::optional<PngParts> parts_of(std::string_view bytes, const fs::path& path, DiagnosticLog& log) {
  PngParts out;
  std::size_t at = kPngSignature.size();
  while (bytes.starts_with(kPngSignature) && at + 12 <= bytes.size()) {
    const std::size_t length = number_at(bytes.substr(at));
    const std::string_view name = bytes.substr(at + 4, 4);
    if (length > bytes.size() - at - 12) break;
    const std::string_view content = bytes.substr(at + 8, length);
    if (name == "IHDR") out.header = content;
    if (name == "sRGB") out.srgb = true;
    if (name == "IDAT") out.rows += content;
    if (name == "IEND" && out.header.size() == 13 && !out.rows.empty()) return out;
    at += 12 + length;
  }
  log.report_file(Code("E0102"), path.string(), "the file is not a whole PNG");
  return std::nullopt;
}

// The parts of a frame, of numbers as people look at them.
std::optional<PngParts> shown_parts_of(const fs::path& path, DiagnosticLog& log) {
  const auto file = MappedFile::open(path, log);
  if (!file) return std::nullopt;
  const auto shown = shown_png(file->bytes(), path, log);
  if (!shown) return std::nullopt;
  if (!shown->empty()) return parts_of(*shown, path, log);
  return parts_of({reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size()}, path,
                  log);
}

bool is_cancelled(const Job& job, DiagnosticLog& log) {
  if (job.cancelled()) report_cancelled(log);
  return job.cancelled();
}

// Mean light of blocks of times × times pixels; the last ones may be smaller. Codes RGB.
std::vector<std::uint8_t> reduced(const DecodedImage& image, std::uint32_t times,
                                  std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint8_t> out;
  out.reserve(std::size_t{3} * width * height);
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      double sum[3] = {};
      double count = 0;
      for (std::uint32_t v = y * times; v < std::min((y + 1) * times, image.height); ++v)
        for (std::uint32_t u = x * times; u < std::min((x + 1) * times, image.width); ++u) {
          const std::uint8_t* pixel = &image.rgba[4 * (std::size_t{v} * image.width + u)];
          for (std::size_t k = 0; k < 3; ++k) sum[k] += srgb_decoded(pixel[k]);
          count += 1;
        }
      for (const double each : sum) out.push_back(srgb_code(each / count));
    }
  return out;
}

}  // namespace

Result<std::string> shown_png(std::span<const std::byte> bytes, const fs::path& path,
                              DiagnosticLog& log) {
  if (bits_of_numbers(bytes) == 0) return std::string();
  DecodedImage image;
  const ImageProblem problem = decode_shown(bytes, kMostPixelBytes, image);
  if (problem.code) {
    log.report_file(Code("E0102"), path.string(), problem.message);
    return failed;
  }
  std::vector<std::uint8_t> grey;
  grey.reserve(image.rgba.size() / 4);
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) grey.push_back(image.rgba[i]);
  PngOptions options;
  options.channels = 1;
  options.says_srgb = true;
  return png_file(image.width, image.height, grey, options);
}

bool encode_video(const fs::path& ffmpeg, const std::string& pattern, double rate,
                  const fs::path& output, const Job& job) {
  // most players need even widths and heights
  return run_program(
      {ffmpeg.string(), "-y", "-loglevel", "error", "-framerate", fmt::format("{:g}", rate), "-i",
       pattern, "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", output.string()},
      job);
}

bool write_animation(const fs::path& path, std::span<const fs::path> images, std::uint16_t rate,
                     DiagnosticLog& log, const Job& job) {
  auto file = AtomicFile::create(path, log);
  if (!file) return false;
  std::string header;
  std::uint32_t sequence = 0;
  for (std::size_t k = 0; k < images.size(); ++k) {
    if (is_cancelled(job, log)) return false;
    const auto image = shown_parts_of(images[k], log);
    if (!image) return false;
    if (k == 0) {
      header = image->header;
      std::string control;
      append_number(images.size(), 4, control);
      append_number(0, 4, control);  // plays without end
      bool good =
          file->write(as_bytes(kPngSignature), log) && write_chunk(*file, "IHDR", {header}, log);
      if (image->srgb) good = good && write_chunk(*file, "sRGB", {std::string_view("\0", 1)}, log);
      if (!good || !write_chunk(*file, "acTL", {control}, log)) return false;
    }
    if (image->header != header) {
      log.report_file(Code("E0102"), images[k].string(),
                      "the image differs in size or kind from the first one");
      return false;
    }
    std::string frame;
    append_number(sequence++, 4, frame);
    frame += header.substr(0, 8);  // width, height
    append_number(0, 8, frame);    // place
    append_number(1, 2, frame);    // of a second, over
    append_number(rate, 2, frame);
    append_number(0, 2, frame);  // neither disposed of nor blended
    if (!write_chunk(*file, "fcTL", {frame}, log)) return false;
    std::string number;
    if (k > 0) append_number(sequence++, 4, number);
    if (!write_chunk(*file, k > 0 ? "fdAT" : "IDAT", {number, image->rows}, log)) return false;
  }
  return write_chunk(*file, "IEND", {}, log) && file->commit(log);
}

bool write_sheet(const fs::path& path, std::span<const fs::path> images, std::size_t most,
                 std::uint32_t side, DiagnosticLog& log, const Job& job) {
  const std::size_t count = std::min(most, images.size());
  const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  const std::size_t rows = (count + columns - 1) / columns;
  std::uint32_t width = 0, height = 0;  // of one, reduced
  std::size_t pitch = 0;
  std::vector<std::uint8_t> sheet;
  DecodedImage first;
  for (std::size_t k = 0; k < count; ++k) {
    if (is_cancelled(job, log)) return false;
    const fs::path& name = images[count == 1 ? 0 : k * (images.size() - 1) / (count - 1)];
    const auto file = MappedFile::open(name, log);
    if (!file) return false;
    DecodedImage image;
    const ImageProblem problem = decode_shown(file->bytes(), kMostPixelBytes, image);
    if (problem.code) {
      log.report_file(Code("E0102"), name.string(), problem.message);
      return false;
    }
    if (k > 0 && (image.width != first.width || image.height != first.height)) {
      log.report_file(Code("E0102"), name.string(), "the image differs in size from the first one");
      return false;
    }
    const std::uint32_t times = (std::max(image.width, image.height) + side - 1) / side;
    if (k == 0) {
      width = (image.width + times - 1) / times;
      height = (image.height + times - 1) / times;
      pitch = 3 * columns * width;
      sheet.assign(pitch * rows * height, 0);
      first.width = image.width;
      first.height = image.height;
    }
    const std::vector<std::uint8_t> small = reduced(image, times, width, height);
    std::uint8_t* corner =
        &sheet[(k / columns) * height * pitch + std::size_t{3} * (k % columns) * width];
    for (std::uint32_t y = 0; y < height; ++y)
      std::memcpy(corner + y * pitch, &small[std::size_t{3} * y * width], std::size_t{3} * width);
  }
  PngOptions options;
  options.channels = 3;
  options.says_srgb = true;
  return write_file(path,
                    as_bytes(png_file(static_cast<std::uint32_t>(columns) * width,
                                      static_cast<std::uint32_t>(rows) * height, sheet, options)),
                    log);
}

}  // namespace panwright::image
