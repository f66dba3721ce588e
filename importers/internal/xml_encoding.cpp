#include "importers/internal/xml_encoding.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "base/folder_names.h"
#include "base/text.h"

namespace panwright::importers::internal {

namespace {

using namespace std::string_view_literals;

// Windows-1252 from 0x80 to 0x9f; ISO-8859-1 has control characters there, which no file has.
constexpr std::array<std::uint16_t, 32> kWindows1252 = {
    0x20ac, 0x81,   0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
    0x2039, 0x0152, 0x8d,   0x017d, 0x8f,   0x90,   0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
    0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0x9d,   0x017e, 0x0178};

// ISO-8859-15 where it differs from ISO-8859-1.
constexpr std::pair<unsigned char, std::uint16_t> kLatin9[] = {
    {0xa4, 0x20ac}, {0xa6, 0x0160}, {0xa8, 0x0161}, {0xb4, 0x017d},
    {0xb8, 0x017e}, {0xbc, 0x0152}, {0xbd, 0x0153}, {0xbe, 0x0178}};

constexpr std::uint32_t kReplacement = 0xfffd;

void append(std::uint32_t c, std::string& out) {
  if (c < 0x80) {
    out += static_cast<char>(c);
    return;
  }
  const int more = c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
  constexpr unsigned kLead[] = {0, 0xc0, 0xe0, 0xf0};
  out += static_cast<char>(kLead[more] | c >> (6 * more));
  for (int k = more - 1; k >= 0; --k) out += static_cast<char>(0x80 | (c >> (6 * k) & 0x3f));
}

// Width of a code unit, and whether its largest byte comes first.
struct Wide {
  std::size_t bytes = 1;
  bool big = false;
};

Wide width_of(std::string_view text) {
  if (text.starts_with("\xff\xfe\0\0"sv) || text.starts_with("<\0\0\0"sv)) return {4, false};
  if (text.starts_with("\0\0\xfe\xff"sv) || text.starts_with("\0\0\0<"sv)) return {4, true};
  if (text.starts_with("\xff\xfe"sv) || text.starts_with("<\0"sv)) return {2, false};
  if (text.starts_with("\xfe\xff"sv) || text.starts_with("\0<"sv)) return {2, true};
  return {};
}

// UTF-16 or UTF-32 as UTF-8, without the mark. damaged: characters that are none.
std::string from_wide(std::string_view text, const Wide& wide, std::size_t& damaged) {
  const std::size_t units = text.size() / wide.bytes;
  damaged = text.size() % wide.bytes != 0 ? 1 : 0;
  const auto unit = [&](std::size_t i) {
    std::uint32_t out = 0;
    for (std::size_t k = 0; k < wide.bytes; ++k) {
      const std::size_t at = wide.big ? k : wide.bytes - 1 - k;
      out = out << 8 | static_cast<unsigned char>(text[i * wide.bytes + at]);
    }
    return out;
  };
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < units; ++i) {
    std::uint32_t c = unit(i);
    if (i == 0 && c == 0xfeff) continue;
    const std::uint32_t next = wide.bytes == 2 && i + 1 < units ? unit(i + 1) : 0;
    if (wide.bytes == 2 && c >= 0xd800 && c < 0xdc00 && next >= 0xdc00 && next < 0xe000) {
      c = 0x10000 + ((c - 0xd800) << 10) + (next - 0xdc00);
      ++i;
    }
    const bool sound = c <= 0x10ffff && (c < 0xd800 || c > 0xdfff);
    damaged += sound ? 0 : 1;
    append(sound ? c : kReplacement, out);
  }
  return out;
}

std::string from_bytes(std::string_view text, bool latin9) {
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  for (const char each : text) {
    const auto byte = static_cast<unsigned char>(each);
    std::uint32_t c = byte;
    if (!latin9 && byte >= 0x80 && byte < 0xa0) c = kWindows1252[byte - 0x80u];
    if (latin9)
      for (const auto& [from, to] : kLatin9)
        if (byte == from) c = to;
    append(c, out);
  }
  return out;
}

bool is_ascii(std::string_view text) {
  for (const char c : text)
    if (static_cast<unsigned char>(c) >= 0x80) return false;
  return true;
}

// The name in the declaration of a text, as written. Empty: none.
std::string_view declared_encoding(std::string_view text) {
  constexpr std::size_t kLongest = 512;
  text = text.substr(0, kLongest);
  if (!text.starts_with("<?xml")) return {};
  text = text.substr(0, text.find("?>"));
  std::size_t at = text.find("encoding");
  if (at == text.npos) return {};
  at = text.find_first_of("\"'", at);
  if (at == text.npos) return {};
  const std::size_t end = text.find(text[at], at + 1);
  return end == text.npos ? std::string_view() : text.substr(at + 1, end - at - 1);
}

bool is_marked(std::string_view text) {
  return text.starts_with("\xff\xfe"sv) || text.starts_with("\xfe\xff"sv) ||
         text.starts_with("\0\0\xfe\xff"sv);
}

// Text that is not XML: OBJ, say. The reader of VRML says what is wrong with its encoding.
bool is_other_text(std::string_view text) {
  return !text.starts_with("#VRML") &&
         std::ranges::none_of(text, [](char c) { return c >= 0 && c < '\t'; });
}

enum class Charset { utf8, wide, latin, latin9, unknown };

Charset charset_of(std::string_view name) {
  std::string key;
  for (const char c : lower_case(name))
    if (c != '-' && c != '_' && c != ' ') key += c;
  if (key.empty() || key == "utf8" || key == "usascii" || key == "ascii") return Charset::utf8;
  for (const std::string_view wide : {"utf16", "utf32", "ucs2", "ucs4", "iso10646ucs2", "unicode"})
    if (key.starts_with(wide)) return Charset::wide;
  for (const std::string_view latin :
       {"iso88591", "latin1", "l1", "windows1252", "cp1252", "1252", "ansi"})
    if (key == latin) return Charset::latin;
  return key == "iso885915" || key == "latin9" ? Charset::latin9 : Charset::unknown;
}

SharedText shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

}  // namespace

Recoded xml_in_utf8(SharedText bytes) {
  const std::string_view text = *bytes;
  if (const Wide wide = width_of(text); wide.bytes > 1) {
    std::size_t damaged = 0;
    std::string out = from_wide(text, wide, damaged);
    const std::size_t first = out.find_first_not_of(" \t\r\n");
    const bool xml = first != out.npos && out[first] == '<';
    if (!xml && !(is_marked(text) && damaged == 0 && is_other_text(out)))
      return {std::move(bytes), {}};
    const int bits = static_cast<int>(8 * wide.bytes);
    return {shared(std::move(out)),
            damaged == 0 ? std::string()
                         : fmt::format("the text is UTF-{}, and {} of it {} none", bits,
                                       counted(damaged, "character"), damaged == 1 ? "is" : "are")};
  }
  if (text.starts_with("\xef\xbb\xbf")) return {std::move(bytes), {}};
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == text.npos || text[first] != '<') return {std::move(bytes), {}};
  const std::string_view name = declared_encoding(text.substr(first));
  const Charset charset = charset_of(name);
  if (charset == Charset::latin || charset == Charset::latin9) {
    if (is_ascii(text)) return {std::move(bytes), {}};
    return {shared(from_bytes(text, charset == Charset::latin9)), {}};
  }
  if (is_ascii(text) && charset != Charset::wide) return {std::move(bytes), {}};
  const bool sound = to_utf8(text, Encoding::utf8) == text;
  std::string deviation;
  if (charset == Charset::utf8 && !sound)
    deviation = "the text is not UTF-8, as it should be; it is read as Windows-1252";
  else if (charset != Charset::utf8)
    deviation = fmt::format(
        "the text declares the encoding {}, {}; it is read as {}", in_quotes(name),
        charset == Charset::wide ? "and has characters of one byte" : "which is not supported",
        sound ? "UTF-8" : "Windows-1252");
  if (sound) return {std::move(bytes), std::move(deviation)};
  return {shared(from_bytes(text, false)), std::move(deviation)};
}

}  // namespace panwright::importers::internal
