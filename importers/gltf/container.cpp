#include "importers/gltf/container.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>

namespace panwright::importers::gltf {

namespace {

constexpr std::size_t kHeader = 12;
constexpr std::uint32_t kJson = 0x4e4f534a;
constexpr std::uint32_t kBinary = 0x004e4942;

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i)
    word |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  return word;
}

class Chunks {
 public:
  Chunks(std::string_view bytes, Container& out) : bytes_(bytes), out_(out) {}

  void read() {
    if (bytes_.size() < kHeader) return complain(bytes_.size(), "the header is cut short");
    const std::uint32_t version = word_at(bytes_, 4), length = word_at(bytes_, 8);
    if (version != 2) complain(4, fmt::format("the container has version {}, not 2", version));
    if (length <= kHeader) {
      complain(8, fmt::format("a length of {} bytes is too small", length));
    } else if (length > bytes_.size()) {
      complain(8, fmt::format("the file has {} bytes, its header says {}", bytes_.size(), length));
    } else {
      out_.extra = bytes_.size() - length;
      bytes_ = bytes_.substr(0, length);
    }
    std::size_t at = kHeader;
    for (std::uint32_t index = 0; at < bytes_.size(); ++index)
      if (!read_chunk(index, at)) break;
    if (!has_json_ && out_.problems.empty()) complain(kHeader, "no JSON chunk");
  }

 private:
  void complain(std::size_t at, std::string message) {
    out_.problems.push_back(fmt::format("byte {}: {}", at, message));
  }

  bool read_chunk(std::uint32_t index, std::size_t& at) {
    if (bytes_.size() - at < 8) {
      complain(at, "the header of a chunk is cut short");
      return false;
    }
    const std::uint32_t length = word_at(bytes_, at), type = word_at(bytes_, at + 4);
    const std::size_t body = at + 8;
    const std::size_t there = std::min<std::size_t>(length, bytes_.size() - body);
    if (there < length)
      complain(at, fmt::format("a chunk of {} bytes, found {}", length, there));
    else if (length % 4 != 0)
      complain(at, fmt::format("the length {} of a chunk is not a multiple of 4", length));
    const std::string_view bytes = bytes_.substr(body, there);
    if (index == 0 && type != kJson) complain(at, "the first chunk is not JSON");
    if (type == kJson) {
      if (has_json_)
        complain(at, "a second JSON chunk");
      else if (length == 0)
        complain(at, "the JSON chunk is empty");
      else
        out_.json = bytes;
      has_json_ = true;
    } else if (type == kBinary) {
      if (out_.binary)
        complain(at, "a second BIN chunk");
      else if (index > 1)
        complain(at, "the BIN chunk is not the second one");
      if (!out_.binary) out_.binary = bytes;
    }
    at = body + there;
    return there == length;
  }

  std::string_view bytes_;
  Container& out_;
  bool has_json_ = false;
};

}  // namespace

bool is_glb(std::string_view bytes) { return bytes.starts_with("glTF"); }

Container chunks_of(std::string_view bytes) {
  Container out;
  Chunks(bytes, out).read();
  return out;
}

}  // namespace panwright::importers::gltf
