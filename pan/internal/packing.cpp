#include "pan/internal/packing.h"

#include <zstd.h>

#include <algorithm>
#include <cassert>
#include <cstring>

#include "base/parallel.h"
#include "pan/internal/block_hash.h"

namespace panwright::pan::internal {

namespace {

using layout::ChunkForm;
using Bytes = std::vector<std::byte>;

constexpr int kLevel = 3;
constexpr std::size_t kShort = 4096;  // bytes: sections up to here stay as they are
constexpr unsigned kFormBits = 2;
constexpr std::uint32_t kLengthMask = 0xffffffffu >> kFormBits;
static_assert(layout::kHashBlock <= kLengthMask);

std::uint64_t up_to_alignment(std::uint64_t bytes) {
  constexpr std::uint64_t kAlignment = layout::kSectionAlignment;
  return bytes / kAlignment * kAlignment + (bytes % kAlignment == 0 ? 0 : kAlignment);
}

// Byte k of every element, one after the other, for each k; each byte less that of the element
// before. A partial last element follows as it is.
void to_planes(std::span<const std::byte> from, std::uint32_t planes, std::byte* to) {
  const std::size_t count = from.size() / planes;
  for (std::uint32_t k = 0; k < planes; ++k) {
    unsigned before = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = static_cast<unsigned>(from[i * planes + k]);
      *to++ = static_cast<std::byte>(value - before);
      before = value;
    }
  }
  std::copy(from.begin() + static_cast<std::ptrdiff_t>(count * planes), from.end(), to);
}

void from_planes(std::span<const std::byte> from, std::uint32_t planes, std::byte* to) {
  // note: plane after plane of a few elements, so that what is written stays in the nearest cache
  constexpr std::size_t kBytes = 16384;
  const std::size_t count = from.size() / planes, tile = std::max<std::size_t>(1, kBytes / planes);
  std::vector<unsigned char> values(planes);
  for (std::size_t begin = 0; begin < count; begin += tile) {
    const std::size_t end = std::min(count, begin + tile);
    for (std::uint32_t k = 0; k < planes; ++k) {
      const std::byte* next = from.data() + k * count;
      unsigned value = values[k];
      for (std::size_t i = begin; i < end; ++i) {
        value += static_cast<unsigned>(next[i]);
        to[i * planes + k] = static_cast<std::byte>(value);
      }
      values[k] = static_cast<unsigned char>(value);
    }
  }
  const std::size_t whole = count * planes;
  std::copy(from.begin() + static_cast<std::ptrdiff_t>(whole), from.end(), to + whole);
}

Bytes compressed(std::span<const std::byte> raw) {
  Bytes out(ZSTD_compressBound(raw.size()));
  // note: a context of its own each time, so that no earlier work can decide any byte
  const std::size_t length = ZSTD_compress(out.data(), out.size(), raw.data(), raw.size(), kLevel);
  assert(!ZSTD_isError(length));
  out.resize(length);
  return out;
}

struct PackedChunk {
  ChunkForm form = ChunkForm::plain;
  Bytes bytes;
};

// The shortest of the forms, the first of them where two are as long.
PackedChunk pack_chunk(std::span<const std::byte> raw, std::uint32_t planes) {
  PackedChunk out{ChunkForm::zstd, compressed(raw)};
  if (planes > 1) {
    Bytes differences(raw.size());
    to_planes(raw, planes, differences.data());
    Bytes other = compressed(differences);
    if (other.size() < out.bytes.size()) out = {ChunkForm::planes, std::move(other)};
  }
  if (out.bytes.size() >= raw.size()) out = {ChunkForm::plain, {raw.begin(), raw.end()}};
  return out;
}

// One whole frame of known size, and nothing else.
bool decompress(std::span<const std::byte> frame, std::span<std::byte> to) {
  if (ZSTD_getFrameContentSize(frame.data(), frame.size()) != to.size() ||
      ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size())
    return false;
  return ZSTD_decompress(to.data(), to.size(), frame.data(), frame.size()) == to.size();
}

}  // namespace

std::uint64_t plain_stored_length(std::uint64_t raw_length) { return up_to_alignment(raw_length); }

std::uint64_t packed_stored_length(std::uint64_t packed_length, std::uint64_t raw_length) {
  constexpr std::uint64_t kMost = layout::kMaxCompression;
  return up_to_alignment(
      std::max(packed_length, raw_length / kMost + (raw_length % kMost == 0 ? 0 : 1)));
}

std::uint32_t plane_count(std::uint32_t kind, std::uint32_t stride) {
  if (kind == static_cast<std::uint32_t>(layout::SectionKind::indices)) return 6;
  if (kind == static_cast<std::uint32_t>(layout::SectionKind::texels)) return 4;
  return stride;
}

std::vector<std::byte> pack_section(std::span<const std::byte> raw, std::uint32_t planes) {
  if (raw.size() < kShort) return {};
  std::vector<PackedChunk> chunks(block_count(raw.size()));
  parallel_for(chunks.size(),
               [&](std::size_t i) { chunks[i] = pack_chunk(block(raw, i), planes); });
  std::vector<std::uint32_t> words;
  std::uint64_t length = 0;
  for (const PackedChunk& chunk : chunks) {
    words.push_back(static_cast<std::uint32_t>(chunk.form) << (32 - kFormBits) |
                    static_cast<std::uint32_t>(chunk.bytes.size()));
    length += chunk.bytes.size() + sizeof words.front();
  }
  const std::uint64_t plain = plain_stored_length(raw.size());
  if (packed_stored_length(length, raw.size()) > plain - plain / 8) return {};
  Bytes out;
  out.reserve(length);
  for (PackedChunk& chunk : chunks) {
    out.insert(out.end(), chunk.bytes.begin(), chunk.bytes.end());
    chunk.bytes = {};
  }
  const auto list = std::as_bytes(std::span(words));
  out.insert(out.end(), list.begin(), list.end());
  return out;
}

std::optional<PackedChunks> PackedChunks::of(std::span<const std::byte> packed,
                                             std::uint32_t planes, std::uint64_t raw_length) {
  assert(raw_length > 0 && planes > 0);
  const std::uint64_t count = block_count(raw_length);
  if (packed.size() / sizeof(std::uint32_t) < count) return {};
  const std::uint64_t list = packed.size() - count * sizeof(std::uint32_t);
  PackedChunks out;
  out.packed_ = packed;
  out.planes_ = planes;
  out.raw_length_ = raw_length;
  out.chunks_.reserve(count);
  std::uint64_t offset = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint32_t word;
    std::memcpy(&word, packed.data() + list + i * sizeof word, sizeof word);
    const Chunk chunk{offset, word & kLengthMask, word >> (32 - kFormBits)};
    if (chunk.form > static_cast<std::uint32_t>(ChunkForm::planes) || chunk.length > list - offset)
      return {};
    offset += chunk.length;
    out.chunks_.push_back(chunk);
  }
  if (offset != list) return {};
  return out;
}

std::uint64_t PackedChunks::end(std::size_t chunk) const {
  return std::min(begin(chunk + 1), raw_length_);
}

bool PackedChunks::unpack(std::size_t chunk, std::span<std::byte> section) const {
  assert(section.size() == raw_length_);
  const Chunk& it = chunks_[chunk];
  const auto from = packed_.subspan(it.offset, it.length);
  const auto to = section.subspan(begin(chunk), end(chunk) - begin(chunk));
  switch (static_cast<ChunkForm>(it.form)) {
    case ChunkForm::plain:
      if (from.size() != to.size()) return false;
      std::copy(from.begin(), from.end(), to.begin());
      return true;
    case ChunkForm::zstd:
      return decompress(from, to);
    case ChunkForm::planes: {
      Bytes differences(to.size());
      if (!decompress(from, differences)) return false;
      from_planes(differences, planes_, to.data());
      return true;
    }
  }
  return false;
}

}  // namespace panwright::pan::internal
