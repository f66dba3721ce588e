// Numbers of a command line or a views file, with and without units.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "workspace/setting.h"

namespace panwright::workspace {

// Returns the words of a text, separated by blanks or commas.
std::vector<std::string_view> words_of(std::string_view text);

// Parses numbers separated by blanks or commas; nothing for other texts or another count than
// `count`.
std::optional<std::vector<double>> parse_numbers(std::string_view text, std::size_t count);

// Parses an angle to radians: a bare number is degrees; deg, rad, mrad, urad, arcmin and arcsec may
// follow it.
std::optional<double> parse_angle(std::string_view text);

// Parses a length to metres: a bare number is metres; m, mm, cm, dm, km, um, in and ft may follow
// it.
std::optional<double> parse_length(std::string_view text);

// Parses a time to seconds: a bare number is seconds; s, ms and us may follow it.
std::optional<double> parse_time(std::string_view text);

// Parses a share: "0.1%" or "0.001".
std::optional<double> parse_share(std::string_view text);

// Parses the size of an image, as "640x480" or "512": each side 1 to 16384.
std::optional<ImageSize> image_size(std::string_view size);

// Parses bytes: "2GB", "1.5 GiB", "4096"; units are powers of 1024.
std::optional<std::uint64_t> parse_bytes(std::string_view text);

}  // namespace panwright::workspace
