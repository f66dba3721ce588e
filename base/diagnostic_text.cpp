#include <fmt/core.h>

#include <algorithm>

#include "base/diagnostic.h"
#include "base/text.h"

namespace panwright {

namespace {

struct Paint {
  bool on;
  std::string operator()(const char* code, std::string_view text) const {
    return on ? fmt::format("\x1b[{}m{}\x1b[0m", code, text) : std::string(text);
  }
};

const char* ink(Severity severity) {
  return severity == Severity::error ? "1;31" : severity == Severity::warning ? "1;35" : "1;36";
}

std::size_t characters(std::string_view utf8) {
  return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

// The first `count` characters of a UTF-8 text, in bytes.
std::size_t byte_offset(std::string_view utf8, std::size_t count) {
  std::size_t i = 0;
  while (i < utf8.size() && count > 0) {
    ++i;
    while (i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xc0) == 0x80) ++i;
    --count;
  }
  return i;
}

// The source line with a caret and tildes below it; a window of it when it is long.
void append_excerpt(const SourceMap& sources, const SourceSpan& where, const Paint& paint,
                    const char* color, std::string& out) {
  constexpr std::size_t kWindow = 100;
  const Position from = sources.position(where.file, where.begin);
  const Position to = sources.position(where.file, std::max(where.begin, where.end));
  std::string line = sources.line_text(where.file, from.line);
  if (line.empty()) return;
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  std::size_t length = characters(line);
  std::size_t caret = std::min<std::size_t>(from.column - 1, length);
  const std::size_t end = to.line == from.line ? to.column - 1 : length;
  std::size_t tildes = end > caret + 1 ? std::min(end, length) - caret - 1 : 0;
  std::string lead, tail;
  if (length > kWindow) {
    const std::size_t start = caret > kWindow / 2 ? caret - kWindow / 2 : 0;
    const std::size_t stop = std::min(length, start + kWindow);
    const std::size_t first = byte_offset(line, start), last = byte_offset(line, stop);
    if (stop < length) tail = "…";
    if (start > 0) lead = "…";
    line = lead + line.substr(first, last - first) + tail;
    tildes = std::min(tildes, stop > caret + 1 ? stop - caret - 1 : 0);
    caret = caret - start + (start > 0 ? 1 : 0);
  }
  out += fmt::format("{:>6} | {}\n       | {}{}\n", from.line, line, std::string(caret, ' '),
                     paint(color, std::string(1, '^').append(tildes, '~')));
}

void append_include_stack(const SourceMap& sources, FileId file, std::string& out) {
  for (FileId from = file; sources.file(from).included_at.file != kNoFile;
       from = sources.file(from).included_at.file) {
    const SourceFile& inner = sources.file(from);
    const SourceSpan at = inner.included_at;
    const Position p = sources.position(at.file, at.begin);
    out += fmt::format("    {} from {}:{}:{}\n", inner.used ? "used" : "included",
                       sources.file(at.file).name, p.line, p.column);
  }
}

}  // namespace

const char* severity_word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

std::string to_text(const DiagnosticLog& log, const TextStyle& style) {
  const Paint paint{style.color};
  const SourceMap& sources = log.sources();
  std::string out;
  for (const Diagnostic& entry : log.entries()) {
    const Severity severity = entry.severity();
    if (severity == Severity::note && !style.notes) continue;
    const bool located = entry.where.file != kNoFile;
    const bool text = located && sources.file(entry.where.file).bytes != nullptr;
    if (text) {
      const Position p = sources.position(entry.where.file, entry.where.begin);
      out += paint(
          "1", fmt::format("{}:{}:{}: ", sources.file(entry.where.file).name, p.line, p.column));
    } else {
      out += paint(
          "1", fmt::format("{}: ", located ? sources.file(entry.where.file).name : "panwright"));
    }
    out += paint(ink(severity), fmt::format("{}: ", severity_word(severity)));
    // a JSON pointer is all that says where, in a file without lines
    const std::string at =
        !text && entry.object.starts_with('/') ? fmt::format(" (at {})", entry.object) : "";
    out += fmt::format("{}{} [{}]\n", entry.message, at, code_info(entry.code).name);
    if (text) append_excerpt(sources, entry.where, paint, ink(severity), out);
    if (!entry.hint.empty()) out += fmt::format("    {}\n", entry.hint);
    if (located) append_include_stack(sources, entry.where.file, out);
  }
  if (log.hidden() > 0)
    out += fmt::format("panwright: {} not shown\n", counted(log.hidden(), "more problem"));
  return out;
}

}  // namespace panwright
