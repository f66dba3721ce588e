#include "tools/overlay_text.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/math.h"
#include "base/source.h"
#include "tools/templates.h"

#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_truetype.h>
#pragma GCC diagnostic pop

namespace panwright::tools {
namespace {

struct OverlayFont {
  OverlayFont() { stbtt_InitFont(&info, reinterpret_cast<const unsigned char*>(bytes.data()), 0); }

  std::string bytes = font_file();
  stbtt_fontinfo info{};
};

// Code points of a text, whatever its bytes.
std::vector<int> code_points(std::string_view text) {
  std::vector<int> out;
  for (const char c : to_utf8(text, Encoding::utf8)) {
    const int byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0) == 0x80)
      out.back() = out.back() << 6 | (byte & 0x3f);
    else
      out.push_back(byte < 0x80 ? byte : byte & (byte < 0xe0 ? 0x1f : byte < 0xf0 ? 0x0f : 0x07));
  }
  return out;
}

}  // namespace

void write_overlay_text(image::Image& image, const OverlayLine& line, std::string_view utf8) {
  static const OverlayFont font;
  const std::vector<int> text = code_points(utf8);
  int ascent = 0, advance = 0, bearing = 0;
  stbtt_GetFontVMetrics(&font.info, &ascent, nullptr, nullptr);
  stbtt_GetCodepointHMetrics(&font.info, 'x', &advance, &bearing);  // of all letters
  const float scale = std::min(
      stbtt_ScaleForPixelHeight(&font.info, static_cast<float>(line.height)),
      static_cast<float>(line.width) / static_cast<float>(std::max<std::size_t>(text.size(), 1)) /
          static_cast<float>(advance));
  const auto baseline = static_cast<int>(std::lround(line.y + scale * static_cast<float>(ascent)));
  std::vector<unsigned char> shares;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const float pen = static_cast<float>(line.x) + scale * static_cast<float>(advance * i);
    const float shift = pen - std::floor(pen);
    int left = 0, top = 0, right = 0, bottom = 0;
    stbtt_GetCodepointBitmapBoxSubpixel(&font.info, text[i], scale, scale, shift, 0, &left, &top,
                                        &right, &bottom);
    const int width = right - left, height = bottom - top;
    shares.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
    stbtt_MakeCodepointBitmapSubpixel(&font.info, shares.data(), width, height, width, scale, scale,
                                      shift, 0, text[i]);
    for (int k = 0; k < width * height; ++k) {
      const int x = static_cast<int>(pen) + left + k % width, y = baseline + top + k / width;
      if (x < 0 || y < 0 || x >= static_cast<int>(image.width) ||
          y >= static_cast<int>(image.height))
        continue;
      const std::size_t at =
          static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x);
      const float share = static_cast<float>(shares[static_cast<std::size_t>(k)]) / 255;
      const auto white = static_cast<float>(1 / kPi);  // in a PNG
      for (std::size_t c = 3 * at; c < 3 * at + 3; ++c)
        image.radiance[c] += share * (white - image.radiance[c]);
      image.coverage[at] += share * (1 - image.coverage[at]);
    }
  }
}

}  // namespace panwright::tools
