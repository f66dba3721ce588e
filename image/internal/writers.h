// Image writers, one per format. Private to image.
#pragma once

#include "base/file.h"
#include "image/image.h"

namespace panwright::image {

// Each writes the whole file; the caller commits. False: reported as E0103.
bool write_png(AtomicFile& file, const Image& image, const PngExposure& exposure,
               DiagnosticLog& log);
bool write_exr(AtomicFile& file, const Image& image, const FileOptions& options,
               DiagnosticLog& log);
bool write_npy(AtomicFile& file, const Image& image, DiagnosticLog& log);
bool write_npz(AtomicFile& file, const Image& image, const FileOptions& options,
               DiagnosticLog& log);

}  // namespace panwright::image
