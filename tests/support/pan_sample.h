// Pan models made in the tests, and tools to modify them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "pan/writer.h"

namespace panwright::support {

// Every kind of record of format 1.0: three nodes, a tetrahedron and a coloured, textured square,
// two materials, a 2 x 3 texture, a frame, sources, inputs, a budget, two keypoints and two decals.
pan::Contents small_contents();
std::vector<std::byte> small_pan();
// Returns the problems found by check() in a file with these contents; "" if valid.
std::string problems(const pan::Contents& contents);
// Number of its sections: the kinds of format 1.0.
inline constexpr std::size_t kSampleSections = 24;

// A sheet of 24 x 24 quads, a row of nodes with frames, and a texture: small, and most sections are
// long and regular enough to be compressed.
pan::Contents regular_contents();
std::vector<std::byte> compressed_pan();  // of it

// Wavy sheets of 512 x 512 quads, about 13 MB each with 4-byte indices, in the number nearest to a
// size. For speed: pan::write of it makes a file of that size.
pan::Contents large_contents(std::uint64_t bytes);

// The bytes of a pan file, open to changes behind the writer's back.
class OpenPan {
 public:
  explicit OpenPan(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}

  pan::layout::Header& header();
  pan::layout::DirectoryEntry& entry(std::size_t index);
  pan::layout::DirectoryEntry& entry(pan::layout::SectionKind kind);  // Expects: present
  // A record of a table, or an element of an array.
  template <class T>
  T& at(pan::layout::SectionKind kind, std::size_t index) {
    return reinterpret_cast<T*>(bytes_.data() + entry(kind).offset)[index];
  }

  // Puts a section behind the others. The bytes must be a multiple of 64.
  void add_section(std::uint32_t kind, bool optional, std::size_t stride,
                   std::vector<std::byte> bytes);
  // Replaces a section by one of another length, and moves what follows.
  void resize_section(pan::layout::SectionKind kind, std::size_t count);

  // Replaces the stored bytes of a section, a multiple of 64, and moves what follows. Its other
  // lengths stay.
  void replace_section(pan::layout::SectionKind kind, const std::vector<std::byte>& stored);
  // Changes the record size of a table: longer records are extended by bytes of the given value,
  // shorter ones truncated. Marks differing record sizes in the header.
  void restride_section(pan::layout::SectionKind kind, std::uint32_t stride,
                        std::byte tail = std::byte{0xa5});

  // Recomputes every checksum, as documented in docs/pan-format.md.
  OpenPan& seal();
  // Recomputes those of the directory and the header: for entries that point nowhere.
  OpenPan& seal_directory();
  OpenPan& seal_header();
  // Sets the build identity to that of the inputs, version and options; then seals.
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  // Replaces a section's stored bytes, and moves those after it.
  void move_after(pan::layout::SectionKind kind, std::uint64_t stored);
  std::vector<std::byte> bytes_;
};

}  // namespace panwright::support
