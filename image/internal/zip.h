// Zip archives, written with fixed dates. Private to image.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/file.h"

namespace panwright::image {

// Writer of an archive into a file, one entry after another, stored or deflated. Entries, offsets
// or totals from zip64_from bytes on use the zip64 records (the format's own limit; tests lower
// it).
class ZipWriter {
 public:
  explicit ZipWriter(AtomicFile& file, std::uint64_t zip64_from = 0xffffffffu)
      : file_(file), zip64_from_(zip64_from) {}

  // Adds an entry whose content is the two pieces, one after the other. False: reported as E0103.
  bool add(const std::string& name, std::span<const std::byte> head,
           std::span<const std::byte> body, DiagnosticLog& log, bool deflate = false);
  // Writes the central directory.
  bool finish(DiagnosticLog& log);

 private:
  struct Entry {
    std::string name;
    std::uint64_t size;
    std::uint64_t stored;  // bytes in the archive
    std::uint64_t offset;
    std::uint32_t crc;
    bool deflated;
  };
  bool put(std::span<const std::byte> bytes, DiagnosticLog& log);
  bool deflate(std::span<const std::byte> head, std::span<const std::byte> body,
               DiagnosticLog& log);

  AtomicFile& file_;
  std::uint64_t zip64_from_;
  std::uint64_t position_ = 0;
  std::vector<Entry> entries_;
};

// Reader of an archive in memory, of which any byte may be wrong.
class ZipReader {
 public:
  struct Entry {
    std::string name;
    std::uint64_t size;    // bytes of the content
    std::uint64_t stored;  // bytes in the archive
    std::uint64_t offset;  // of the local header
    std::uint32_t crc;
    std::uint16_t method;
  };

  explicit ZipReader(std::span<const std::byte> bytes);
  // False: there is no sound central directory.
  bool good() const { return good_; }
  const std::vector<Entry>& entries() const { return entries_; }  // in its order
  // True: there is, and the bytes of all entries lie where it says; they are not read.
  bool is_whole() const;
  // Returns the content, of entry.size bytes, which the caller has judged; none: damaged.
  std::optional<std::vector<std::byte>> content(const Entry& entry) const;

 private:
  std::uint64_t number(std::uint64_t at, unsigned count) const;
  bool read_directory();
  std::optional<std::span<const std::byte>> stored(const Entry& entry) const;

  std::span<const std::byte> bytes_;
  std::vector<Entry> entries_;
  bool good_ = false;
};

}  // namespace panwright::image
