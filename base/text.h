// Numbers and text, independent of the locale.
#pragma once

#include <charconv>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace panwright {

// Reads a whole decimal number: optional sign, digits, point, exponent. Nothing else is accepted:
// no blanks, hexadecimal, infinities or NaN; overflow is refused, underflow becomes 0.
std::optional<double> parse_double(std::string_view text);

// The shortest text that reads back as the same double.
std::string format_double(double value);

// "1 triangle", "2 triangles".
std::string counted(std::size_t count, std::string_view noun);

// Text as the content of an element or a quoted attribute of XML and HTML: & < " as entities.
std::string markup_escaped(std::string_view text);

// Quotes a value for a message: control characters escaped, cut after 60 characters.
std::string in_quotes(std::string_view text);

// Returns true if a text starts with one of `marks`.
bool starts_with_any(std::string_view text, std::initializer_list<std::string_view> marks);

}  // namespace panwright
