#include "tests/fuzz/targets_terrain.h"

#include <stdlib.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "terrain/shape.h"
#include "terrain/survey.h"
#include "tests/fuzz/require.h"

namespace panwright::fuzz {

namespace {

namespace fs = std::filesystem;

// Folder of this process, with the data that labels name.
class DataFolder {
 public:
  DataFolder() {
    std::string name = (fs::temp_directory_path() / "panwright-fuzz-XXXXXX").string();
    path_ = mkdtemp(name.data());
    std::string data(4096, '\0');
    for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<char>(i * 7 % 251);
    for (const char* file : {"a.img", "input.dat"})
      std::ofstream(path_ / file, std::ios::binary) << data;
  }
  ~DataFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool read_dem(const fs::path& path) {
  DiagnosticLog log;
  terrain::DemOptions options;
  options.gdal = false;
  options.memory = 64u << 20;
  const auto dem = terrain::Dem::open(path, options, log);
  require(static_cast<bool>(dem) != log.has_errors(), "a file or an error: " + to_text(log));
  if (!dem) return false;
  const auto& info = dem->info();
  // what it may hold by its size is held by other tests
  if (std::uint64_t{info.width} * info.height > 1u << 22) return true;
  std::uint64_t posts = 0;
  const bool all = dem->read(
      0, info.height,
      [&](const terrain::Rows& rows) {
        require(rows.heights.size() == std::uint64_t{rows.count} * info.width, "whole rows");
        require(rows.voids.size() == rows.heights.size(), "a kind for each post");
        for (std::size_t i = 0; i < rows.heights.size(); ++i)
          require((rows.voids[i] != terrain::VoidKind::none) == std::isnan(rows.heights[i]) ||
                      std::isinf(info.scale * 1e30) || !std::isfinite(info.scale * info.offset),
                  "no height where void");
        posts += rows.heights.size();
        return true;
      },
      log);
  require(all != log.has_errors(), "all rows or an error: " + to_text(log));
  require(!all || posts == std::uint64_t{info.width} * info.height, "all posts");
  (void)terrain::survey(*dem, {64}, log);
  return all;
}

bool read_plates(const fs::path& path) {
  DiagnosticLog log;
  terrain::ShapeOptions options;
  options.unit = 1;
  const auto shape = terrain::read_shape(path, options, log);
  require(static_cast<bool>(shape) != log.has_errors(), "a shape or an error: " + to_text(log));
  if (!shape) return false;
  for (const auto& plate : shape->plates)
    for (const std::uint32_t index : plate)
      require(index < shape->vertices.size(), "vertices of plates");
  (void)terrain::survey_shape(*shape);
  if (shape->plates.size() < 1000) (void)terrain::draw_shape(*shape, 16);
  return true;
}

}  // namespace

bool terrain(std::span<const std::byte> input) {
  static const DataFolder folder;
  const fs::path path = folder.path() / "input.lbl";
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(input.data()),
             static_cast<std::streamsize>(input.size()));
  const bool dem = read_dem(path);
  return read_plates(path) || dem;
}

}  // namespace panwright::fuzz
