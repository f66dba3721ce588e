#include "importers/internal/gzip.h"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>

namespace panwright::importers::internal {

namespace {

constexpr std::string_view kMark("\x1f\x8b", 2);
constexpr std::size_t kPiece = 1 << 18;  // bytes unpacked at a time

class Inflater {
 public:
  // 15 + 16: the largest window, with the header and the checksum of gzip
  Inflater() : ready_(inflateInit2(&stream_, 15 + 16) == Z_OK) {}
  ~Inflater() {
    if (ready_) inflateEnd(&stream_);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  std::string run(std::string_view in, std::uint64_t max_bytes, std::string& out) {
    if (!ready_) return "no memory to unpack it";
    std::size_t consumed = 0;
    for (;;) {
      const std::size_t feed = std::min<std::size_t>(in.size() - consumed, 1u << 30);
      stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(in.data() + consumed));
      stream_.avail_in = static_cast<uInt>(feed);
      const std::size_t before = out.size();
      out.resize(before + kPiece);
      stream_.next_out = reinterpret_cast<Bytef*>(out.data() + before);
      stream_.avail_out = kPiece;
      const int status = inflate(&stream_, Z_NO_FLUSH);
      consumed += feed - stream_.avail_in;
      out.resize(before + kPiece - stream_.avail_out);
      if (out.size() > max_bytes) return fmt::format("it unpacks to more than {} bytes", max_bytes);
      if (status == Z_STREAM_END) {
        // members may follow each other; zeros and other padding may follow the last
        if (in.substr(consumed).starts_with(kMark)) {
          inflateReset(&stream_);
          continue;
        }
        return {};
      }
      if (status == Z_OK && (consumed < in.size() || stream_.avail_out == 0)) continue;
      if (status == Z_DATA_ERROR)
        return fmt::format("the gzip data are damaged near byte {}: {}", consumed,
                           stream_.msg ? stream_.msg : "wrong checksum");
      return fmt::format("the gzip data end too early, at byte {}", in.size());
    }
  }

 private:
  z_stream stream_{};
  bool ready_;
};

}  // namespace

Unpacked unpacked(SharedText bytes, std::uint64_t max_bytes) {
  // note: servers pack what is packed already
  constexpr int kMostTimes = 3;
  std::string problem;
  for (int i = 0; i < kMostTimes && problem.empty() && bytes->starts_with(kMark); ++i) {
    std::string out;
    problem = Inflater().run(*bytes, max_bytes, out);
    if (out.size() > max_bytes || (out.empty() && !problem.empty())) return {nullptr, problem};
    bytes = std::make_shared<const std::string>(std::move(out));
  }
  return {std::move(bytes), std::move(problem)};
}

}  // namespace panwright::importers::internal
