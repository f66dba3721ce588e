// EXR files of any channels of 32-bit floats.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.h"

namespace panwright::image {

struct ExrChannel {
  std::string name;
  std::vector<float> values;  // height*width, row 0 the top row
};

// Writes an EXR file, compressed without loss, atomically; not synced. The attributes are names and
// texts.
//
// Expects: channels of the size. Fails: E0103.
bool write_exr_file(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
                    std::span<const ExrChannel> channels,
                    std::span<const std::pair<std::string, std::string>> attributes,
                    DiagnosticLog& log);

}  // namespace panwright::image
