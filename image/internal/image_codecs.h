// Decoders of single image formats. Private to image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "image/decode.h"

namespace panwright::image {

inline constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);
inline constexpr std::size_t kPngHeaderEnd = 33;  // signature and IHDR chunk

// Number of four bytes, the largest first, as in PNG. Expects: at + 4 <= size.
inline std::uint32_t big_endian(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8 | std::to_integer<unsigned>(bytes[at + k]);
  return value;
}

// Checks that an image of this size may be decoded into max_bytes of pixels (four bytes each).
//
// Problems: E3001 (empty), E3002. Does not overflow for sides below 2^31.
ImageProblem check_image_size(std::uint64_t width, std::uint64_t height, std::uint64_t max_bytes);

// The same for rows, of which one is kept.
ImageProblem check_row_size(std::uint64_t width, std::uint64_t height);

// Decoders with `rows` give these every row, and `out` holds one.

// Decodes a PNG file with libpng: every bit depth and colour type, interlaced ones too. Numbers
// are taken as they stand: gamma, profiles and other ancillary chunks are skipped. A wrong checksum
// in any chunk is damage.
//
// Problems: E3001 with the byte at which reading stopped; E3002. Cost: O(bytes + pixels); beside
// the pixels a few rows of memory. "Portable Network Graphics", ISO/IEC 15948:2004.
//
// Expects: the bytes begin with the signature of PNG.
ImageProblem decode_png(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                        DecodedImage& out, RowReceiver* rows = nullptr);

// Decodes a grey PNG of 8 or 16 bits, without interlacing, whose pixels are numbers: into grey of
// codes[number]; larger numbers have the last code. Problems: as decode_png(). Expects: codes.
ImageProblem decode_numbers_png(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                                std::span<const std::uint8_t> codes, DecodedImage& out);

// Decodes a JPEG file with libjpeg-turbo: baseline, progressive and arithmetic coding, grey, YCbCr,
// RGB, CMYK and YCCK of 8 bits. The inverse DCT is the accurate integer one ("islow") and chroma
// is interpolated; vector code gives the same bits as scalar code.
//
// A file with lost pixels is refused; bytes between segments are skipped.
//
// Problems: E3001 with the byte at which reading stopped; E3002. Cost: O(bytes + pixels·scans),
// with a limit of scans; of files with several scans 2 bytes for each sample beside the pixels.
// ITU-T T.81.
//
// Expects: the bytes begin with the mark of JPEG.
ImageProblem decode_jpeg(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                         DecodedImage& out, RowReceiver* rows = nullptr);

// Decodes a TIFF file with libtiff, row by row.
//
// Problems: E3001, E3002. "TIFF Revision 6.0", Adobe 1992.
ImageProblem decode_tiff_rows(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                              RowReceiver& to);

}  // namespace panwright::image
