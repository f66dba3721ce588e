#include <fmt/core.h>

#include <set>
#include <system_error>

#include "base/file.h"
#include "image/decode.h"
#include "image/png.h"
#include "pxn/writer.h"

namespace panwright::pxn {

namespace {

namespace fs = std::filesystem;

// a file of more bytes than this is not looked at: uncompressed, its pixels would be more than
// allowed
constexpr std::uint64_t kMostTextureBytes = 1ull << 30;

// Whether a file reads as the same texels, where that says nothing of holes by brightness.
bool holds(const fs::path& path, const scene::Texture& texture) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  DiagnosticLog ignored;
  const auto bytes = read_file(path, kMostTextureBytes, ignored);
  if (!bytes) return false;
  image::DecodedImage image;
  if (image::decode_image(as_bytes(*bytes), texture.rgba.size(), image).code) return false;
  return image.width == texture.width && image.height == texture.height &&
         image.rgba == texture.rgba;
}

// A name that an include may have: below the folder of the text.
bool is_below(const std::string& name) {
  const fs::path path = fs::path(name).lexically_normal();
  return path.is_relative() && !path.empty() && *path.begin() != ".." &&
         name.find_first_of("{}") == std::string::npos;
}

}  // namespace

Result<std::vector<std::string>> write_textures(const scene::Scene& scene, const fs::path& text,
                                                DiagnosticLog& log) {
  const fs::path folder = text.parent_path();
  const std::string stem = text.stem().string();
  std::vector<std::string> names;
  std::size_t number = 0;
  for (const scene::Texture& texture : scene.textures) {
    const fs::path own = folder / texture.name;
    const bool may_keep = is_below(texture.name);
    if (may_keep && holds(own, texture)) {
      names.push_back(texture.name);
      continue;
    }
    std::error_code error;
    const bool free =
        may_keep && own.extension() == ".png" && !fs::exists(fs::symlink_status(own, error));
    if (free) fs::create_directories(own.parent_path(), error);
    names.push_back(free ? texture.name : fmt::format("{}-{}.png", stem, ++number));
    const std::string bytes = image::png_file(texture.width, texture.height, texture.rgba);
    if (!write_file(folder / names.back(), as_bytes(bytes), log)) return failed;
  }
  return names;
}

}  // namespace panwright::pxn
