#include "base/source.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>

namespace panwright {

namespace {

constexpr std::size_t kPiece = std::size_t{4} << 20;  // bytes of a mapping in memory at a time
constexpr std::uint32_t kMarkPiece = 1024;            // bytes whose characters are counted anew

// Length of the well-formed UTF-8 sequence at text[i], or 0.
std::size_t utf8_length(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(i);
  if (lead < 0x80) return 1;
  std::size_t length = lead >= 0xf0 && lead < 0xf5 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc2 ? 2 : 0;
  if (lead >= 0xf5 || length == 0 || i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(i + k) & 0xc0) != 0x80) return 0;
  // overlong forms, surrogates and values past U+10FFFF
  const unsigned char next = byte(i + 1);
  if (lead == 0xe0 && next < 0xa0) return 0;
  if (lead == 0xed && next > 0x9f) return 0;
  if (lead == 0xf0 && next < 0x90) return 0;
  if (lead == 0xf4 && next > 0x8f) return 0;
  return length;
}

// note: in runs short enough for a byte to count them, which compilers do 16 or 32 at a time
std::size_t count_of(char wanted, std::string_view text) {
  constexpr std::size_t kRun = 255;
  std::size_t count = 0;
  for (std::size_t begin = 0; begin < text.size(); begin += kRun) {
    std::uint8_t in_run = 0;
    for (const char c : text.substr(begin, kRun)) in_run += c == wanted ? 1 : 0;
    count += in_run;
  }
  return count;
}

}  // namespace

void SharedText::forget(std::size_t begin, std::size_t end) const {
  if (!mapped_) return;
  // whole pages; clean ones of a file, so that nothing is lost
  static const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  begin -= begin % page;
  end -= end % page;
  if (begin < end) madvise(const_cast<char*>(view_.data()) + begin, end - begin, MADV_DONTNEED);
}

FileId SourceMap::add(SourceFile file) {
  files_.push_back(std::move(file));
  line_starts_.emplace_back();
  marks_.emplace_back();
  return static_cast<FileId>(files_.size() - 1);
}

const SourceFile& SourceMap::file(FileId id) const {
  assert(id < files_.size());
  return files_[id];
}

const std::vector<std::uint32_t>& SourceMap::line_starts(FileId id) const {
  auto& starts = line_starts_[id];
  if (!starts.empty()) return starts;
  if (!files_[id].bytes) {
    starts.push_back(0);
    return starts;
  }
  const SharedText& bytes = files_[id].bytes;
  const std::string_view text = *bytes;
  const auto in_pieces = [&](const auto& body) {
    for (std::size_t begin = 0; begin < text.size(); begin += kPiece) {
      const std::size_t end = std::min(begin + kPiece, text.size());
      body(begin, end);
      bytes.forget(begin, end);
    }
  };
  // at once: a list that grows would take twice the room, beside a text that may be large
  std::size_t feeds = 0;
  std::size_t returns = 0;
  in_pieces([&](std::size_t begin, std::size_t end) {
    const std::string_view piece = text.substr(begin, end - begin);
    feeds += count_of('\n', piece);
    returns += count_of('\r', piece);
  });
  starts.reserve(feeds + returns + 1);
  starts.push_back(0);
  in_pieces([&](std::size_t begin, std::size_t end) {
    if (returns == 0) {
      const std::string_view whole = text.substr(0, end);
      for (std::size_t i = begin; (i = whole.find('\n', i)) != whole.npos;)
        starts.push_back(static_cast<std::uint32_t>(++i));
      return;
    }
    for (std::size_t i = begin; i < end; ++i) {
      if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') continue;
      if (text[i] == '\n' || text[i] == '\r') starts.push_back(static_cast<std::uint32_t>(i + 1));
    }
  });
  return starts;
}

const SourceMap::Mark& SourceMap::mark_before(FileId id, std::uint32_t offset) const {
  std::vector<Mark>& marks = marks_[id];
  const SharedText& bytes = files_[id].bytes;
  if (marks.empty()) {
    marks.reserve(bytes->size() / kMarkPiece + 1);
    std::size_t i = 0, forgotten = 0;
    for (std::uint32_t characters = 0; i < bytes->size(); ++characters) {
      if (i / kMarkPiece >= marks.size())
        marks.push_back({static_cast<std::uint32_t>(i), characters});
      i += std::max<std::size_t>(1, utf8_length(*bytes, i));
      if (i < forgotten + kPiece && i < bytes->size()) continue;
      bytes.forget(forgotten, i);
      forgotten = i;
    }
  }
  const std::size_t piece = std::min<std::size_t>(offset / kMarkPiece, marks.size() - 1);
  return marks[marks[piece].offset > offset ? piece - 1 : piece];
}

Position SourceMap::position(FileId id, std::uint32_t offset) const {
  const auto& starts = line_starts(id);
  const auto after = std::upper_bound(starts.begin(), starts.end(), offset);
  const auto line = static_cast<std::uint32_t>(after - starts.begin());
  const std::uint32_t start = starts[line - 1];
  const SourceFile& source = files_[id];
  if (!source.bytes || source.encoding != Encoding::utf8) return {line, offset - start + 1};
  const std::string_view text = *source.bytes;
  const std::size_t stop = std::min<std::size_t>(offset, text.size());
  // the number of characters between two places, the second one within or behind the last of them
  const auto characters = [&](std::size_t i, std::size_t end) {
    std::uint32_t count = 0;
    for (std::size_t next = i; i < end; i = next) {
      next += std::max<std::size_t>(1, utf8_length(text, i));
      if (next > end) break;  // a place inside a character counts as the character's
      ++count;
    }
    return count;
  };
  if (stop < start + std::size_t{4} * kMarkPiece) return {line, 1 + characters(start, stop)};
  const Mark& near = mark_before(id, static_cast<std::uint32_t>(stop));
  const Mark& first = mark_before(id, start);
  return {line, 1 + near.characters + characters(near.offset, stop) - first.characters -
                    characters(first.offset, start)};
}

std::string SourceMap::line_text(FileId id, std::uint32_t line) const {
  const SourceFile& source = files_[id];
  if (!source.bytes || source.encoding == Encoding::binary || line == 0) return {};
  const auto& starts = line_starts(id);
  if (line > starts.size()) return {};
  const std::string_view text = *source.bytes;
  std::size_t end = line < starts.size() ? starts[line] : text.size();
  const std::size_t begin = starts[line - 1];
  while (end > begin && (text[end - 1] == '\n' || text[end - 1] == '\r')) --end;
  return to_utf8(text.substr(begin, end - begin), source.encoding);
}

std::string to_utf8(std::string_view bytes, Encoding encoding) {
  std::string out;
  out.reserve(bytes.size());
  for (std::size_t i = 0; i < bytes.size();) {
    const auto byte = static_cast<unsigned char>(bytes[i]);
    if (encoding == Encoding::latin1 && byte >= 0x80) {
      out.push_back(static_cast<char>(0xc0 | (byte >> 6)));
      out.push_back(static_cast<char>(0x80 | (byte & 0x3f)));
      ++i;
      continue;
    }
    const std::size_t length = byte < 0x80 ? 1 : utf8_length(bytes, i);
    if (length == 0) {
      out += "\xef\xbf\xbd";
      ++i;
    } else {
      out.append(bytes.substr(i, length));
      i += length;
    }
  }
  return out;
}

}  // namespace panwright
