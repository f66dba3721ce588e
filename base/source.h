// Source files and places in them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace panwright {

using FileId = std::uint32_t;
inline constexpr FileId kNoFile = 0xffffffffu;

// Bytes [begin, end) of one file, in that file's own encoding. file == kNoFile: no place.
struct SourceSpan {
  FileId file = kNoFile;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

enum class Encoding { utf8, latin1, binary };

// Line and column as a person counts them.
struct Position {
  std::uint32_t line = 1;    // 1-based; lines end at LF, CRLF or CR
  std::uint32_t column = 1;  // 1-based, in characters of the file's encoding
};

// One reading of one file. A file that is included twice has two entries, so that each of them
// knows who included it; a part that is used has one of its own.
struct SourceFile {
  std::string name;                          // as the user would type it
  std::shared_ptr<const std::string> bytes;  // null: not text, or not readable
  Encoding encoding = Encoding::utf8;
  SourceSpan included_at;
  bool used = false;  // included_at is where a part of it is used
};

class SourceMap {
 public:
  FileId add(SourceFile file);
  const SourceFile& file(FileId id) const;
  std::size_t size() const { return files_.size(); }
  void set_encoding(FileId id, Encoding encoding) { files_[id].encoding = encoding; }

  // Cost: O(bytes before the place) for the first call on a file; after it O(log lines), and in
  // UTF-8 the bytes between the place and the last one asked for on its line.
  Position position(FileId id, std::uint32_t offset) const;

  // The text of a line without its end, as UTF-8. Empty when the file is not text.
  std::string line_text(FileId id, std::uint32_t line) const;

 private:
  const std::vector<std::uint32_t>& line_starts(FileId id) const;

  // The place of a file whose column was counted last; counting goes on from there.
  struct Counted {
    std::uint32_t line = 0;  // 0: none yet
    std::uint32_t offset = 0;
    std::uint32_t column = 1;
  };

  std::vector<SourceFile> files_;
  mutable std::vector<std::vector<std::uint32_t>> line_starts_;
  mutable std::vector<Counted> counted_;
};

// Converts bytes of an encoding to UTF-8; bytes that are no text become U+FFFD.
std::string to_utf8(std::string_view bytes, Encoding encoding);

}  // namespace panwright
