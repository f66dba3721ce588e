// NPY array files (numpy.lib.format 1.0) and archives of them.
#include "image/npy.h"

#include <fmt/core.h>

#include <bit>
#include <string>

#include "image/internal/writers.h"
#include "image/internal/zip.h"

namespace panwright::image {
namespace {

static_assert(std::endian::native == std::endian::little);

// type: "<f4" or "<u4"; channels 0: a plane (H, W)
std::string header_of(const char* type, const Image& image, unsigned channels) {
  return npy_header(type, channels
                              ? fmt::format("({}, {}, {})", image.height, image.width, channels)
                              : fmt::format("({}, {})", image.height, image.width));
}

}  // namespace

std::string npy_header(std::string_view type, std::string_view shape) {
  std::string text =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
  // magic, version and length take 10 bytes; the data begins at a multiple of 64
  const std::size_t length = (10 + text.size() + 1 + 63) / 64 * 64 - 10;
  text.append(length - text.size() - 1, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(length & 0xff);
  header += static_cast<char>(length >> 8);
  return header + text;
}

bool write_npy(AtomicFile& file, const Image& image, DiagnosticLog& log) {
  return file.write(as_bytes(header_of("<f4", image, 3)), log) &&
         file.write(std::as_bytes(std::span(image.radiance)), log);
}

bool write_npz(AtomicFile& file, const Image& image, const FileOptions& options,
               DiagnosticLog& log) {
  ZipWriter zip(file);
  bool good = true;
  const auto add = [&](FileLayer layer, const char* type, unsigned channels, const auto& values) {
    if (!good || values.empty() || !options.has(layer)) return;
    const std::string name(kLayerNames[static_cast<std::size_t>(layer)]);
    good = zip.add(name + ".npy", as_bytes(header_of(type, image, channels)),
                   std::as_bytes(std::span(values)), log, options.compress);
  };
  for (const auto& [name, value] : image.metadata)
    if (good && name == kRecordName) good = zip.add("meta.json", as_bytes(value), {}, log);
  add(FileLayer::radiance, "<f4", 3, image.radiance);
  add(FileLayer::coverage, "<f4", 0, image.coverage);
  add(FileLayer::depth, "<f4", 0, image.depth);
  add(FileLayer::range, "<f4", 0, image.range);
  add(FileLayer::normal, "<f4", 3, image.normal);
  add(FileLayer::target_id, "<u4", 0, image.target_id);
  add(FileLayer::node_id, "<u4", 0, image.node_id);
  add(FileLayer::material_id, "<u4", 0, image.material_id);
  add(FileLayer::standard_error, "<f4", 3, image.standard_error);
  add(FileLayer::dn, "<u2", 0, image.dn);
  add(FileLayer::electrons, "<f4", 0, image.electrons);
  for (const auto& [name, values] : image.stages)
    if (good && options.has(FileLayer::stages))
      good = zip.add("stage_" + name + ".npy", as_bytes(header_of("<f4", image, 0)),
                     std::as_bytes(std::span(values)), log, options.compress);
  return good && zip.finish(log);
}

}  // namespace panwright::image
