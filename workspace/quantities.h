// Numbers as a command line or a views file has them, with and without units.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace panwright::workspace {

// Numbers separated by blanks or commas; nothing when the text is something else or the number of
// numbers is not `count`.
std::optional<std::vector<double>> parse_numbers(std::string_view text, std::size_t count);
// The same of lengths, each as parse_length() takes it. Metres.
std::optional<std::vector<double>> parse_lengths(std::string_view text, std::size_t count);

// An angle in radians: a bare number is degrees; deg, rad, mrad, urad, arcmin and arcsec may follow
// it.
std::optional<double> parse_angle(std::string_view text);

// A length in metres: a bare number is metres; m, mm, cm, dm, km, um, in and ft may follow it.
std::optional<double> parse_length(std::string_view text);

// A share: "0.1%" or "0.001".
std::optional<double> parse_share(std::string_view text);

}  // namespace panwright::workspace
