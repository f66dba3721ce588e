#include <algorithm>
#include <cstring>

#include "tests/support/pan_damage_collection.h"

namespace panwright::support {

using namespace pan::layout;

namespace {

constexpr std::uint64_t kHugeStorage = ~0ull;

// The section of texels, compressed by hand: chunks, then a word for each.
struct Packing {
  std::vector<std::byte> chunks;
  std::vector<std::uint32_t> words;
  std::uint64_t raw = 24;
};

void set_packing(OpenPan& f, const Packing& packing) {
  std::vector<std::byte> stored = packing.chunks;
  const auto list = std::as_bytes(std::span(packing.words));
  stored.insert(stored.end(), list.begin(), list.end());
  const std::uint64_t packed = stored.size();
  stored.resize((std::max(packed, (packing.raw + 255) / 256) + 63) / 64 * 64);
  f.replace_section(SectionKind::texels, stored);
  DirectoryEntry& entry = f.entry(SectionKind::texels);
  entry.codec = 1;
  entry.packed_length = packed;
  entry.raw_length = entry.count = packing.raw;
  f.header().required_features |= 1;
  f.header().minor = 1;
}

// Zstandard frames by hand (RFC 8878): one block of `count` equal bytes, no checksum.
std::vector<std::byte> frame_of_zeros(std::uint32_t count, std::uint32_t block) {
  const std::uint32_t header = block << 3 | 1u << 1 | 1u;  // size, RLE, last
  std::vector<std::byte> frame;
  for (const std::uint32_t byte :
       {0x28u, 0xb5u, 0x2fu, 0xfdu, 0xa0u, count & 255, count >> 8 & 255, count >> 16 & 255,
        count >> 24, header & 255, header >> 8 & 255, header >> 16 & 255, 0u})
    frame.push_back(static_cast<std::byte>(byte));
  return frame;
}

}  // namespace

void record_sizes(Collection& add) {
  const auto sized = [&](const char* what, SectionKind kind, std::uint32_t stride) {
    add.changed(Code("E4008"), what, [&](OpenPan& f) { f.restride_section(kind, stride); });
  };
  sized("records shorter than in format 1.0", SectionKind::instances, 12);
  sized("records of an odd size", SectionKind::instances, 17);
  sized("records off their alignment", SectionKind::nodes, 92);
  sized("records over the limit", SectionKind::frames, 4160);
  sized("elements of an array with a tail", SectionKind::positions, 16);
  sized("bytes with a tail", SectionKind::texels, 2);
  add.changed(Code("E4008"), "longer records that the header does not speak of", [](OpenPan& f) {
    f.restride_section(SectionKind::instances, 32);
    f.header().required_features = 0;
  });
  add.changed(Code("E4008"), "records of no size", [](OpenPan& f) {
    f.restride_section(SectionKind::instances, 32);
    f.entry(SectionKind::instances).stride = 0;
  });
  add.changed(Code("E4008"), "records of 2^32 - 64 bytes, none of them", [](OpenPan& f) {
    f.restride_section(SectionKind::keypoints, 64);
    f.resize_section(SectionKind::keypoints, 0);
    f.entry(SectionKind::keypoints).stride = 0xffffffc0u;
  });
  add.changed(Code("E4010"), "longer records with a node that is not there", [](OpenPan& f) {
    f.at<Instance>(SectionKind::instances, 1).node = 99;
    f.restride_section(SectionKind::instances, 32);
  });
  add.changed(Code("E4004"), "tiles that may not be ignored", [](OpenPan& f) {
    f.add_section(pan::layout::kReservedKinds[0].value, false, 64, std::vector<std::byte>(64));
  });
}

void compression(Collection& add) {
  constexpr std::uint32_t kZstd = 1u << 30, kPlanes = 2u << 30, kUnknown = 3u << 30;
  const auto packing = [&](Code code, const char* what, const Packing& packed) {
    add.changed(code, what, [&](OpenPan& f) { set_packing(f, packed); });
  };
  const std::vector<std::byte> plain(24), frame = frame_of_zeros(24, 24);
  const auto length = static_cast<std::uint32_t>(frame.size());
  packing(Code("E4015"), "a chunk of an unknown form", {plain, {kUnknown | 24}});
  packing(Code("E4015"), "a plain chunk that is too short",
          {{plain.begin(), plain.end() - 1}, {23}});
  packing(Code("E4015"), "a plain chunk that is too long", {std::vector<std::byte>(25), {25}});
  packing(Code("E4015"), "a chunk that begins past the end", {plain, {0x3fffffff}});
  packing(Code("E4015"), "chunks that leave bytes over", {std::vector<std::byte>(40), {24}});
  packing(Code("E4015"), "an empty frame", {{}, {kZstd}});
  packing(Code("E4015"), "bytes that are no frame", {plain, {kZstd | 24}});
  packing(Code("E4015"), "planes that are no frame", {plain, {kPlanes | 24}});
  packing(Code("E4015"), "a frame that says more than it has",
          {frame_of_zeros(24, 23), {kZstd | length}});
  packing(Code("E4015"), "a frame that has more than it says",
          {frame_of_zeros(24, 25), {kZstd | length}});
  packing(Code("E4015"), "a frame of another length", {frame_of_zeros(23, 23), {kZstd | length}});
  packing(Code("E4015"), "a frame of 4 GB in 13 bytes",
          {frame_of_zeros(0xffffffffu, 131072), {kZstd | length}});
  packing(Code("E4015"), "a frame with bytes behind it", [&] {
    std::vector<std::byte> two = frame;
    two.insert(two.end(), frame.begin(), frame.end());
    return Packing{two, {kZstd | 2 * length}};
  }());
  packing(Code("E4010"), "texels that are too many, compressed",
          {frame_of_zeros(28, 28), {kZstd | length}, 28});
  const auto entry = [&](const char* what, const std::function<void(DirectoryEntry&)>& change) {
    add.changed(Code("E4008"), what, [&](OpenPan& f) {
      set_packing(f, {frame, {kZstd | length}});
      change(f.entry(SectionKind::texels));
    });
  };
  entry("a bomb: a terabyte in 64 bytes",
        [](DirectoryEntry& e) { e.raw_length = e.count = 1ull << 40; });
  entry("a bomb near 2^64", [](DirectoryEntry& e) { e.raw_length = e.count = kHugeStorage; });
  entry("just over 256 times the stored bytes",
        [](DirectoryEntry& e) { e.raw_length = e.count = 256 * 64 + 1; });
  entry("a packed length past the section", [](DirectoryEntry& e) { e.packed_length = 65; });
  entry("a packed length near 2^64", [](DirectoryEntry& e) { e.packed_length = kHugeStorage; });
  entry("no room for the words of chunks", [](DirectoryEntry& e) { e.packed_length = 3; });
  entry("a compressed section of nothing", [](DirectoryEntry& e) { e.raw_length = e.count = 0; });
  add.changed(Code("E4008"), "compressed bytes with too much padding", [&](OpenPan& f) {
    set_packing(f, {frame, {kZstd | length}});
    std::vector<std::byte> stored(128);
    std::memcpy(stored.data(), &f.at<std::byte>(SectionKind::texels, 0), 64);
    f.replace_section(SectionKind::texels, stored);
  });
  add.changed(Code("E4008"), "compressed bytes with padding that is not zero", [&](OpenPan& f) {
    set_packing(f, {frame, {kZstd | length}});
    f.at<std::uint8_t>(SectionKind::texels, 63) = 1;
  });
  add.changed(Code("E4004"), "a codec of a later format", [&](OpenPan& f) {
    set_packing(f, {frame, {kZstd | length}});
    f.entry(SectionKind::texels).codec = 3;
  });
  add.changed(
      Code("E4009"), "a changed chunk",
      [&](OpenPan& f) {
        set_packing(f, {frame, {kZstd | length}});
        f.seal();
        f.at<std::uint8_t>(SectionKind::texels, 2) ^= 1;
      },
      Collection::Seal::none);
}

}  // namespace panwright::support
