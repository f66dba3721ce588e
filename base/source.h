// Source files and places in them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
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

// Bytes of a file, kept alive by its holders: a string, or a mapping. A NUL stands behind
// the last one. It is used like a pointer to them.
class SharedText {
 public:
  SharedText() = default;
  SharedText(std::nullptr_t) {}
  SharedText(std::shared_ptr<const std::string> text)
      : view_(text ? std::string_view(*text) : std::string_view()), owner_(std::move(text)) {}
  // view: of a file that `mapping` maps
  SharedText(std::shared_ptr<const void> mapping, std::string_view view)
      : view_(view), owner_(std::move(mapping)), mapped_(true) {}

  const std::string_view& operator*() const { return view_; }
  const std::string_view* operator->() const { return &view_; }
  bool operator==(std::nullptr_t) const { return view_.data() == nullptr; }
  explicit operator bool() const { return view_.data() != nullptr; }

  // Gives back the memory of bytes [begin, end) of a mapping. They stay readable from the file. No
  // effect on a string.
  void forget(std::size_t begin, std::size_t end) const;

 private:
  std::string_view view_;
  std::shared_ptr<const void> owner_;
  bool mapped_ = false;
};

// One reading of one file. A file included twice has two entries, each with its own includer; a
// part that is used has one of its own.
struct SourceFile {
  std::string name;  // as the user would type it
  SharedText bytes;  // null: not text, or not readable
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

  // Cost: O(log lines), in any order of calls; O(bytes of the file) for the first one, and for the
  // first one far into a long line of UTF-8.
  Position position(FileId id, std::uint32_t offset) const;

  // The text of a line without its end, as UTF-8. Empty when the file is not text.
  std::string line_text(FileId id, std::uint32_t line) const;

 private:
  const std::vector<std::uint32_t>& line_starts(FileId id) const;

  // Start of a character of a UTF-8 text, and the number of characters before it.
  struct Mark {
    std::uint32_t offset = 0;
    std::uint32_t characters = 0;
  };
  const Mark& mark_before(FileId id, std::uint32_t offset) const;

  std::vector<SourceFile> files_;
  mutable std::vector<std::vector<std::uint32_t>> line_starts_;
  mutable std::vector<std::vector<Mark>> marks_;  // of texts with long lines: one in each piece
};

// Converts bytes of an encoding to UTF-8; invalid bytes become U+FFFD.
std::string to_utf8(std::string_view bytes, Encoding encoding);

}  // namespace panwright
