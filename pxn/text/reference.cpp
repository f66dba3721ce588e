#include "pxn/text/reference.h"

#include <charconv>
#include <utility>

#include "pxn/text/xml.h"

namespace panwright::pxn::xml {

Reference reference_at(std::string_view text) {
  const std::size_t end = text.substr(0, 16).find(';');
  if (end == std::string_view::npos || end < 2) return {};
  const std::string_view name = text.substr(1, end - 1);
  const auto length = static_cast<std::uint32_t>(end + 1);
  constexpr std::pair<std::string_view, char> kNamed[] = {
      {"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}};
  for (const auto& [known, character] : kNamed)
    if (name == known) return {length, static_cast<std::uint32_t>(character)};
  if (name[0] != '#' || name.size() < 2) return {};
  const bool hexadecimal = name[1] == 'x';
  const std::string_view digits = name.substr(hexadecimal ? 2 : 1);
  std::uint32_t c = 0;
  const auto [rest, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), c, hexadecimal ? 16 : 10);
  if (error != std::errc() || rest != digits.data() + digits.size()) return {};
  const bool allowed = c == 9 || c == 10 || c == 13 || (c >= 0x20 && c <= 0xd7ff) ||
                       (c >= 0xe000 && c <= 0xfffd) || (c >= 0x10000 && c <= 0x10ffff);
  return allowed ? Reference{length, c} : Reference{};
}

namespace {

void append_utf8(std::uint32_t c, std::string& out) {
  const auto tail = [&](int shift) {
    out.push_back(static_cast<char>(0x80 | (c >> shift & 0x3f)));
  };
  if (c < 0x80) {
    out.push_back(static_cast<char>(c));
  } else if (c < 0x800) {
    out.push_back(static_cast<char>(0xc0 | c >> 6));
    tail(0);
  } else if (c < 0x10000) {
    out.push_back(static_cast<char>(0xe0 | c >> 12));
    tail(6);
    tail(0);
  } else {
    out.push_back(static_cast<char>(0xf0 | c >> 18));
    tail(12);
    tail(6);
    tail(0);
  }
}

}  // namespace

std::string decoded(const Document& document, std::uint32_t begin, std::uint32_t end,
                    std::vector<std::uint32_t>* source_offsets) {
  std::string out;
  out.reserve(end - begin);
  const auto mark = [&](std::uint32_t offset) {
    if (source_offsets != nullptr) source_offsets->resize(out.size(), offset);
  };
  for (std::uint32_t i = begin; i < end;) {
    const std::uint32_t start = i;
    const char c = document.bytes[i];
    if (c == '&') {
      const Reference known = reference_at(document.bytes.substr(i, end - i));
      append_utf8(known.length != 0 ? known.character : '&', out);
      i += std::max(known.length, 1u);
    } else if (c == '\r') {
      out.push_back('\n');
      i += i + 1 < end && document.bytes[i + 1] == '\n' ? 2 : 1;
    } else if (document.encoding == Encoding::latin1) {
      append_utf8(static_cast<unsigned char>(c), out);
      ++i;
    } else {
      out.push_back(c);
      ++i;
    }
    mark(start);
  }
  if (source_offsets != nullptr) source_offsets->push_back(end);
  return out;
}

}  // namespace panwright::pxn::xml
