// Formatting of messages and help texts.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace panwright::tools {

// Returns "a, b or c".
std::string listed(const std::vector<std::string>& words, std::string_view last);

// Returns the characters of a UTF-8 text, its width in columns.
std::size_t characters(std::string_view utf8);

// Wraps a text at blanks to lines of at most `width` characters, keeping its line breaks. Later
// lines begin with `indent` blanks, which count.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent);

// Returns "1.2 MB".
std::string bytes_words(std::uint64_t bytes);

// Returns bytes in base64 (RFC 4648).
std::string base64(std::string_view bytes);

}  // namespace panwright::tools
