// Independent image decoder and encoder, stb's, to validate ours.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace panwright::image {

struct OracleImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<std::uint8_t> rgba;  // 4·width·height
};

// Decodes a valid PNG or JPEG file. Nothing for other files.
std::optional<OracleImage> oracle_decoded(const std::string& bytes);

// A baseline JPEG file of RGB texels without subsampling.
std::string oracle_jpeg(int width, int height, const std::vector<std::uint8_t>& rgb, int quality);

}  // namespace panwright::image
