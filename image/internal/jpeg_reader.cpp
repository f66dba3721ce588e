#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdio>

// note: needs FILE and size_t from above
#include <jpeglib.h>

#include <jerror.h>

#include "image/internal/image_reader.h"

namespace panwright::image {

namespace {

// A scan may touch every pixel and cost few bytes: 4,096² pixels and 200 scans take 3 s of 200 kB.
// Encoders write about ten.
constexpr std::uint64_t kMostScans = 200;
constexpr std::uint64_t kLeastMostScans = 16;       // whatever the size
constexpr std::uint64_t kMostVisits = 1ull << 32;   // of pixels
constexpr std::uint64_t kWorkingMemory = 16 << 20;  // bytes, beside coefficients

// Whether a warning of the library says that pixels are lost or made up.
bool means_deficit(int warning) {
  switch (warning) {
    case JWRN_ARITH_BAD_CODE:
    case JWRN_HIT_MARKER:
    case JWRN_HUFF_BAD_CODE:
    case JWRN_JPEG_EOF:
    case JWRN_MUST_RESYNC:
    case JWRN_NOT_SEQUENTIAL:
      return true;
    default:
      return false;
  }
}

class JpegReader : private ImageReader {
 public:
  JpegReader(std::span<const std::byte> bytes, std::uint64_t max_bytes, DecodedImage& out,
             RowReceiver* rows)
      : ImageReader("JPEG", bytes, max_bytes, out, rows) {}
  ~JpegReader() { jpeg_destroy_decompress(&jpeg_); }

  ImageProblem run() {
    if (!guarded([this] { read_header(); }) && jpeg_.err->msg_code != JERR_IMAGE_TOO_BIG)
      return problem_found();
    if (const ImageProblem problem = check_size(jpeg_.image_width, jpeg_.image_height);
        problem.code)
      return problem;
    if (!guarded([this] { start(); })) return problem_found();
    if (const ImageProblem problem = make_room(jpeg_.output_width, jpeg_.output_height);
        problem.code)
      return problem;
    if (!guarded([this] { read_rows(); })) return problem_found();
    return {};
  }

 private:
  static JpegReader& self(j_common_ptr jpeg) {
    return *static_cast<JpegReader*>(jpeg->client_data);
  }
  [[noreturn]] static void leave(j_common_ptr jpeg) { self(jpeg).stop(); }
  static void warn(j_common_ptr jpeg, int level) {
    const int code = jpeg->err->msg_code;
    if (level >= 0) return;
    if (means_deficit(code) || (code == JWRN_EXTRANEOUS_DATA && self(jpeg).passed_over_data()))
      leave(jpeg);
  }
  // Whether the bytes that were passed over before a marker look like the rest of a scan, of which
  // blocks were lost, and not like padding.
  bool passed_over_data() const {
    const std::size_t end = bytes_.size() - jpeg_.src->bytes_in_buffer;
    const auto count = static_cast<std::size_t>(jpeg_.err->msg_parm.i[0]);
    const auto passed = bytes_.subspan(end - std::min(end, count), std::min(end, count));
    return std::find(passed.begin(), passed.end(), std::byte{0xff}) != passed.end();
  }
  static void print_nothing(j_common_ptr) {}
  static void count_scans(j_common_ptr jpeg) {
    JpegReader& reader = self(jpeg);
    if (static_cast<std::uint64_t>(reader.jpeg_.input_scan_number) <= reader.most_scans()) return;
    reader.too_many_scans_ = true;
    leave(jpeg);
  }

  std::uint64_t most_scans() const {
    const std::uint64_t pixels = std::uint64_t{jpeg_.image_width} * jpeg_.image_height;
    return std::clamp(kMostVisits / std::max<std::uint64_t>(pixels, 1), kLeastMostScans,
                      kMostScans);
  }

  void read_header() {
    jpeg_.err = jpeg_std_error(&errors_);
    errors_.error_exit = leave;
    errors_.emit_message = warn;
    errors_.output_message = print_nothing;
    jpeg_.client_data = this;
    jpeg_create_decompress(&jpeg_);
    // room for the coefficients of four components
    jpeg_.mem->max_memory_to_use = static_cast<long>(2 * max_bytes_ + kWorkingMemory);
    progress_.progress_monitor = count_scans;
    jpeg_.progress = &progress_;
    jpeg_mem_src(&jpeg_, reinterpret_cast<const unsigned char*>(bytes_.data()),
                 static_cast<unsigned long>(bytes_.size()));
    jpeg_read_header(&jpeg_, TRUE);
  }

  void start() {
    const bool inks = jpeg_.jpeg_color_space == JCS_CMYK || jpeg_.jpeg_color_space == JCS_YCCK;
    jpeg_.out_color_space = inks ? JCS_CMYK : JCS_EXT_RGBA;
    jpeg_.dct_method = JDCT_ISLOW;
    jpeg_.do_fancy_upsampling = TRUE;
    jpeg_.do_block_smoothing = FALSE;  // it makes up what scans left out
    jpeg_start_decompress(&jpeg_);
  }

  void read_rows() {
    while (jpeg_.output_scanline < out_.height) {
      JSAMPROW rows[] = {row(jpeg_.output_scanline)};
      jpeg_read_scanlines(&jpeg_, rows, 1);
      if (jpeg_.out_color_space == JCS_CMYK) rgb_from_cmyk({rows[0], std::size_t{4} * out_.width});
      finish_row();
    }
    jpeg_finish_decompress(&jpeg_);
  }

  // Adobe's programs store inks inverted.
  void rgb_from_cmyk(std::span<std::uint8_t> line) const {
    const unsigned flip = jpeg_.saw_Adobe_marker ? 0 : 255;
    for (std::size_t i = 0; i < line.size(); i += 4) {
      const unsigned black = line[i + 3] ^ flip;
      for (std::size_t k = 0; k < 3; ++k) {
        const unsigned product = (line[i + k] ^ flip) * black;
        line[i + k] = static_cast<std::uint8_t>((product + 127) / 255);
      }
      line[i + 3] = 255;
    }
  }

  ImageProblem problem_found() {
    if (too_many_scans_)
      return {Code("E3002"), fmt::format("the JPEG has more than {} scans", most_scans())};
    std::array<char, JMSG_LENGTH_MAX> text{};
    switch (jpeg_.err->msg_code) {
      case JERR_OUT_OF_MEMORY:
      case JERR_NO_BACKING_STORE:
        return {Code("E3002"), "the JPEG needs more memory than the limit of all textures allows"};
      case JWRN_JPEG_EOF:
        return cut_short();
      default:
        jpeg_.err->format_message(reinterpret_cast<j_common_ptr>(&jpeg_), text.data());
        return damaged("near", bytes_.size() - jpeg_.src->bytes_in_buffer, text.data());
    }
  }

  bool too_many_scans_ = false;
  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
};

}  // namespace

ImageProblem decode_jpeg(std::span<const std::byte> bytes, std::uint64_t max_bytes,
                         DecodedImage& out, RowReceiver* rows) {
  return JpegReader(bytes, max_bytes, out, rows).run();
}

}  // namespace panwright::image
