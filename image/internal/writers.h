// Image writers, one per format. Private to image.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/file.h"
#include "image/image.h"

namespace panwright::image {

// Each writes the whole file; the caller commits. False: reported as E0103.
bool write_png(AtomicFile& file, const Image& image, const PngExposure& exposure,
               DiagnosticLog& log);
// Digital numbers of a detector. Expects: some.
bool write_numbers_png(AtomicFile& file, const Image& image, DiagnosticLog& log);
bool write_tiff(AtomicFile& file, const Image& image, DiagnosticLog& log);
bool write_fits(AtomicFile& file, const Image& image, DiagnosticLog& log);
// Returns the record in such a file; nothing: it has none, or is another.
std::optional<std::string> record_of_tiff(std::string_view bytes);
std::optional<std::string> record_of_fits(std::string_view bytes);
// Returns true for a file with all numbers that its header announces.
bool is_whole_tiff(std::string_view bytes);
bool is_whole_fits(std::string_view bytes);
// A PNG with the record after its first chunk.
bool write_with_record(AtomicFile& file, const Image& image, const std::string& png,
                       DiagnosticLog& log);
bool write_exr(AtomicFile& file, const Image& image, const FileOptions& options,
               DiagnosticLog& log);
bool write_npy(AtomicFile& file, const Image& image, DiagnosticLog& log);
bool write_npz(AtomicFile& file, const Image& image, const FileOptions& options,
               DiagnosticLog& log);

}  // namespace panwright::image
