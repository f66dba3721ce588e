#include <cmath>
#include <vector>

#include "base/file.h"
#include "base/math.h"
#include "base/parallel.h"
#include "base/png.h"
#include "base/srgb.h"
#include "preview/image/image_files.h"

namespace panwright::preview {

bool write_png(AtomicFile& file, const Image& image, double ev, DiagnosticLog& log) {
  const double scale = kPi * std::exp2(ev);
  std::vector<std::uint8_t> codes(image.radiance.size());
  const std::size_t row = std::size_t{3} * image.width;
  parallel_for(image.height, [&](std::size_t j) {
    for (std::size_t i = j * row; i < (j + 1) * row; ++i)
      codes[i] = srgb_code(scale * image.radiance[i]);
  });
  PngOptions options;
  options.channels = 3;
  options.says_srgb = true;
  return file.write(as_bytes(png_file(image.width, image.height, codes, options)), log);
}

}  // namespace panwright::preview
