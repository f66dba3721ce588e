#include "pxn/text/encoding.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/text.h"
#include "pxn/text/characters.h"

namespace panwright::pxn::xml {

namespace {

constexpr std::string_view kAccepted = "pxn files are UTF-8, US-ASCII or ISO-8859-1";
// a declaration is one short line; what has no end by then is not one
constexpr std::size_t kLongestDeclaration = 512;

bool same_word(std::string_view a, std::string_view upper) {
  if (a.size() != upper.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const char c = a[i] >= 'a' && a[i] <= 'z' ? static_cast<char>(a[i] - 'a' + 'A') : a[i];
    if (c != upper[i]) return false;
  }
  return true;
}

struct Signature {
  std::string_view bytes;
  std::string_view name;
};

// Wide encodings, by their mark or by how they write "<?" or "<".
std::string_view wide_encoding(std::string_view bytes) {
  using namespace std::string_view_literals;
  constexpr Signature kSignatures[] = {
      {"\0\0\xfe\xff"sv, "UTF-32"}, {"\xff\xfe\0\0"sv, "UTF-32"}, {"\0\0\0<"sv, "UTF-32"},
      {"<\0\0\0"sv, "UTF-32"},      {"\xfe\xff"sv, "UTF-16"},     {"\xff\xfe"sv, "UTF-16"},
      {"\0<"sv, "UTF-16"},          {"<\0"sv, "UTF-16"},          {"\x4c\x6f\xa7\x94"sv, "EBCDIC"},
  };
  for (const Signature& s : kSignatures)
    if (bytes.starts_with(s.bytes)) return s.name;
  return {};
}

enum class Charset { utf8, ascii, latin1 };

class PrologReader {
 public:
  PrologReader(std::string_view bytes, FileId file, DiagnosticLog& log)
      : bytes_(bytes), file_(file), log_(log) {}

  Prolog run() {
    if (const std::string_view wide = wide_encoding(bytes_); !wide.empty()) {
      log_.sources().set_encoding(file_, Encoding::binary);
      report(Code("E1003"), 0, std::min<std::size_t>(2, bytes_.size()),
             fmt::format("the file is {}; {}", wide, kAccepted));
      return {};
    }
    if (bytes_.starts_with("\xef\xbb\xbf")) {
      mark_ = true;
      at_ = 3;
    }
    if (bytes_.substr(at_).starts_with("<?xml") && at_ + 5 < bytes_.size() &&
        is_blank(bytes_[at_ + 5]) && !declaration())
      return {};
    Prolog prolog{true, charset_ == Charset::latin1 ? Encoding::latin1 : Encoding::utf8,
                  static_cast<std::uint32_t>(at_)};
    log_.sources().set_encoding(file_, prolog.encoding);
    check_bytes();
    return prolog;
  }

 private:
  void report(Code code, std::size_t begin, std::size_t end, std::string message,
              std::string hint = {}) {
    log_.report(code, {file_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)},
                std::move(message), std::move(hint));
  }

  // False when the file cannot be read at all.
  bool declaration() {
    const std::size_t begin = at_;
    const std::size_t close = bytes_.substr(0, begin + kLongestDeclaration).find("?>", begin);
    if (close == std::string_view::npos) {
      report(Code("E1001"), begin, begin + 5, "the XML declaration is not closed by '?>'");
      at_ = std::min(bytes_.find_first_of("<\n", begin + 1), bytes_.size());
      return true;
    }
    at_ = begin + 5;
    constexpr std::string_view kNames[] = {"version", "encoding", "standalone"};
    std::size_t next = 0;
    bool ok = true;
    while (true) {
      while (at_ < close && is_blank(bytes_[at_])) ++at_;
      if (at_ >= close) break;
      const std::size_t start = at_;
      std::string_view value;
      std::size_t value_begin = 0;
      while (next < 3 && !bytes_.substr(at_).starts_with(kNames[next])) ++next;
      if (next == 3 || !quoted_value(at_ + kNames[next].size(), close, value, value_begin)) {
        report(
            Code("E1001"), start, close,
            "the XML declaration holds version=\"1.0\", then encoding=\"…\" and standalone=\"…\" "
            "where they are needed, and nothing else");
        break;
      }
      ok = ok && accept(next, value, value_begin);
      ++next;
    }
    at_ = close + 2;
    return ok;
  }

  bool quoted_value(std::size_t at, std::size_t close, std::string_view& value,
                    std::size_t& value_begin) {
    while (at < close && is_blank(bytes_[at])) ++at;
    if (at >= close || bytes_[at] != '=') return false;
    ++at;
    while (at < close && is_blank(bytes_[at])) ++at;
    if (at >= close || (bytes_[at] != '"' && bytes_[at] != '\'')) return false;
    const std::size_t end = bytes_.find(bytes_[at], at + 1);
    if (end >= close) return false;
    value_begin = at + 1;
    value = bytes_.substr(at + 1, end - at - 1);
    at_ = end + 1;
    return true;
  }

  bool accept(std::size_t which, std::string_view value, std::size_t begin) {
    if (which == 0 && !value.starts_with("1."))
      report(Code("E1001"), begin, begin + value.size(),
             fmt::format("XML version {} is not known; write \"1.0\"", in_quotes(value)));
    if (which == 2 && value != "yes" && value != "no")
      report(Code("E1001"), begin, begin + value.size(),
             fmt::format("standalone is {}, expected \"yes\" or \"no\"", in_quotes(value)));
    if (which != 1) return true;
    if (same_word(value, "UTF-8") || same_word(value, "UTF8")) {
      charset_ = Charset::utf8;
    } else if (same_word(value, "US-ASCII") || same_word(value, "ASCII")) {
      charset_ = Charset::ascii;
    } else if (same_word(value, "ISO-8859-1") || same_word(value, "ISO_8859-1") ||
               same_word(value, "LATIN1")) {
      charset_ = Charset::latin1;
    } else {
      report(Code("E1003"), begin, begin + value.size(),
             fmt::format("the encoding {} is not read; {}",
                         in_quotes(to_utf8(value, Encoding::latin1)), kAccepted));
      return false;
    }
    if (mark_ && charset_ != Charset::utf8) {
      report(
          Code("E1003"), begin, begin + value.size(),
          fmt::format("the file begins with the mark of UTF-8 and declares {}", in_quotes(value)));
      return false;
    }
    return true;
  }

  // The length of the sequence at i when it is text, 0 when it is not.
  std::size_t sequence(std::size_t i) const {
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(bytes_[k]); };
    const unsigned char lead = byte(i);
    if (lead < 0x80) return lead >= 0x20 || is_blank(static_cast<char>(lead)) ? 1 : 0;
    if (charset_ == Charset::latin1) return 1;
    if (charset_ == Charset::ascii || lead < 0xc2 || lead > 0xf4) return 0;
    const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (i + length > bytes_.size()) return 0;
    std::uint32_t value = lead & (0xffu >> (length + 1));
    for (std::size_t k = 1; k < length; ++k) {
      if ((byte(i + k) & 0xc0) != 0x80) return 0;
      value = value << 6 | (byte(i + k) & 0x3fu);
    }
    const bool overlong = (length == 3 && value < 0x800) || (length == 4 && value < 0x10000);
    const bool surrogate = value >= 0xd800 && value <= 0xdfff;
    const bool not_xml = value == 0xfffe || value == 0xffff || value > 0x10ffff;
    return overlong || surrogate || not_xml ? 0 : length;
  }

  void check_bytes() {
    std::size_t bad = 0;
    std::size_t first = 0;
    for (std::size_t i = 0; i < bytes_.size();) {
      // eight bytes at once where all of them are printable ASCII
      while (i + 8 <= bytes_.size()) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes_.data() + i, 8);
        constexpr std::uint64_t kOnes = 0x0101010101010101u;
        const std::uint64_t below_blank = (word - 0x20 * kOnes) & ~word;
        if (((below_blank | word) & 0x80 * kOnes) != 0) break;
        i += 8;
      }
      if (i >= bytes_.size()) break;
      const std::size_t length = sequence(i);
      if (length == 0 && bad++ == 0) first = i;
      i += std::max<std::size_t>(1, length);
    }
    if (bad == 0) return;
    const auto byte = static_cast<unsigned char>(bytes_[first]);
    constexpr std::string_view kNames[] = {"UTF-8", "US-ASCII", "ISO-8859-1"};
    const std::string_view name = kNames[static_cast<std::size_t>(charset_)];
    const std::string what =
        byte < 0x80 ? fmt::format("the control character 0x{:02X} is not allowed in text", byte)
                    : fmt::format("the byte 0x{:02X} is not valid {} text here", byte, name);
    const std::string others = bad > 1 ? fmt::format(", and so in {} other places", bad - 1) : "";
    report(Code("E1004"), first, first + 1, what + others,
           byte < 0x80 ? ""
                       : "if the file is ISO-8859-1, say so in its first line: "
                         "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>");
  }

  std::string_view bytes_;
  FileId file_;
  DiagnosticLog& log_;
  std::size_t at_ = 0;
  bool mark_ = false;
  Charset charset_ = Charset::utf8;
};

}  // namespace

Prolog read_prolog(std::string_view bytes, FileId file, DiagnosticLog& log) {
  return PrologReader(bytes, file, log).run();
}

}  // namespace panwright::pxn::xml
