// Products of instruments.
#pragma once

#include <string>
#include <variant>

#include "base/diagnostic.h"
#include "image/image.h"

namespace panwright::workspace {

struct ImageProduct {
  image::Image image;  // its metadata ends with the record
  image::PngExposure exposure{0};
  image::FileOptions files;
  std::string record;        // of files without ids
  std::string named_record;  // of files with ids: their names too
};

using Product = std::variant<ImageProduct>;

// Writes a file of a product, atomically.
//
//   sync  seconds until it was on the disk, added
// Fails: E0103.
bool write(ImageProduct& product, const std::string& output, DiagnosticLog& log, double* sync);

}  // namespace panwright::workspace
