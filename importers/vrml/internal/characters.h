// Classes of the bytes of a VRML text.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace panwright::importers::vrml {

// Class of each byte. Bytes from 0x80 on belong to words, which so may be of any encoding.
inline constexpr std::array<std::uint8_t, 256> kCharacterClasses = [] {
  std::array<std::uint8_t, 256> out{};  // 1 blank, 2 word, 6 word that may begin a number
  for (int c = 0x21; c < 256; ++c) out[static_cast<std::size_t>(c)] = 2;
  for (const char c : {' ', '\t', '\n', '\r', ',', '\f', '\v'})
    out[static_cast<unsigned char>(c)] = 1;
  for (const char c : {'"', '#', '[', ']', '{', '}', '\x7f'})
    out[static_cast<unsigned char>(c)] = 0;
  for (const char c : std::string_view("0123456789+-.")) out[static_cast<unsigned char>(c)] = 6;
  return out;
}();

inline std::uint8_t class_of(char c) { return kCharacterClasses[static_cast<unsigned char>(c)]; }
inline bool is_blank(char c) { return class_of(c) == 1; }
inline bool is_word(char c) { return (class_of(c) & 2) != 0; }
inline bool may_begin_number(char c) { return class_of(c) == 6; }

// Returns true if words are equal, except for the case of their letters.
inline bool same_but_for_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return (x | 0x20) == (y | 0x20); });
}

// Returns the first byte that is not UTF-8, or npos.
std::size_t first_not_utf8(std::string_view text);

}  // namespace panwright::importers::vrml
