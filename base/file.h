// Files: bounded reads, mappings, and writes that leave the old file whole when they fail. All are
// recorded in the run's FileUses, where the log has one (base/file_uses.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "base/result.h"

namespace panwright {

// Returns whether a path is something other than a folder. Fails: E0101, with the file of a near
// name as a hint.
bool require_file(const std::filesystem::path& path, DiagnosticLog& log);

// Reads a whole file, at most max_bytes. Pipes and devices are waited for, until the job of the
// log's FileUses is cancelled.
//
// Fails: E0001, E0101, E0102, E0104. where: the place of the diagnostic (an include); none: the
// file.
Result<std::string> read_file(const std::filesystem::path& path, std::uint64_t max_bytes,
                              DiagnosticLog& log, SourceSpan where = {});

// A read-only mapping of a regular file.
class MappedFile {
 public:
  friend class AtomicFile;
  // Fails: E0101. An empty file maps to an empty span. Cost: O(1).
  static Result<MappedFile> open(const std::filesystem::path& path, DiagnosticLog& log);

  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  std::span<const std::byte> bytes() const { return {data_, size_}; }

  // Gives back the memory of whole pages within a part of the bytes; they are read again when they
  // are used again.
  void release(std::span<const std::byte> part) const;

 private:
  MappedFile(const std::byte* data, std::size_t size) : data_(data), size_(size) {}
  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

// A file that gets its name only when it is complete: written to a nameless file in the same folder
// (a temporary one where the file system lacks these), synced, renamed. Destroyed without commit(),
// it leaves nothing.
class AtomicFile {
 public:
  // Fails: E0103; E0206.
  static Result<AtomicFile> create(const std::filesystem::path& path, DiagnosticLog& log);

  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  // Appends, or writes at a place. False, once reported as E0103, when the disk refuses.
  bool write(std::span<const std::byte> bytes, DiagnosticLog& log);
  bool write_at(std::uint64_t offset, std::span<const std::byte> bytes, DiagnosticLog& log);
  // Appends zeros, whose room on the disk is taken where the file system can.
  bool extend(std::uint64_t length, DiagnosticLog& log);

  // Maps the bytes written so far, before the file has a name.
  //
  // Fails: E0102.
  Result<MappedFile> map(DiagnosticLog& log) const;

  // Syncs and renames. The seconds spent in fsync are added to *sync_seconds when given.
  bool commit(DiagnosticLog& log, double* sync_seconds = nullptr);
  // Renames alone: after a crash of the machine the file may be there and not whole.
  bool publish(DiagnosticLog& log);

 private:
  AtomicFile() = default;
  bool fail(const char* action, int error, DiagnosticLog& log);
  bool create_named();
  bool give_name();
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::filesystem::path path_;
  std::filesystem::path temporary_;  // empty: it has no name yet
};

// create, write, commit. "-" writes to standard output; devices, pipes and open streams
// (/dev/stdout) take the bytes as they are. A named pipe waits for its reader.
bool write_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                DiagnosticLog& log, double* sync_seconds = nullptr);
inline std::span<const std::byte> as_bytes(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

}  // namespace panwright
