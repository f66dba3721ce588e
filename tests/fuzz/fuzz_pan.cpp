#include <algorithm>
#include <cstdint>
#include <cstring>

#include "tests/fuzz/targets.h"
#include "tests/support/pan_sample.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using panwright::pan::layout::DirectoryEntry;
using panwright::pan::layout::Header;

// Whether the header and every entry stay within the file, so that sums can be computed at all.
bool can_seal(const std::vector<std::byte>& bytes) {
  if (bytes.size() < sizeof(Header)) return false;
  Header header;
  std::memcpy(&header, bytes.data(), sizeof header);
  const std::uint64_t size = bytes.size();
  if (header.section_count > 64 || header.directory_offset < sizeof header ||
      header.directory_offset > size || header.directory_offset % 64 != 0 ||
      header.section_count * sizeof(DirectoryEntry) > size - header.directory_offset)
    return false;
  for (std::uint32_t i = 0; i < header.section_count; ++i) {
    DirectoryEntry entry;
    std::memcpy(&entry, bytes.data() + header.directory_offset + i * sizeof entry, sizeof entry);
    if (entry.offset > size || entry.stored_length > size - entry.offset) return false;
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  panwright::fuzz::pan(std::as_bytes(std::span(data, size)));
  return 0;
}

// Makes the checksums right again after most mutations, so that what lies behind them is reached.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  size = LLVMFuzzerMutate(data, size, max_size);
  if (seed % 8 == 0) return size;
  std::vector<std::byte> bytes(size);
  std::memcpy(bytes.data(), data, size);
  if (!can_seal(bytes)) return size;
  panwright::support::OpenPan pan(std::move(bytes));
  pan.seal();
  std::memcpy(data, pan.bytes().data(), size);
  return size;
}
