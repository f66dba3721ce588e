// Words of messages and helps.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace panwright::tools {

// "a, b or c".
std::string listed(const std::vector<std::string>& words, std::string_view last);

// Characters of a UTF-8 text: the columns that it takes.
std::size_t characters(std::string_view utf8);

// Lines of at most `width` characters, cut at blanks; line breaks of the text stay. Each line after
// the first begins with `indent` blanks, which count.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent);

// "1.2 MB".
std::string bytes_words(std::uint64_t bytes);

}  // namespace panwright::tools
