// Files of point clouds: docs/lidar.md, Files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "instruments/lidar.h"

namespace panwright::instruments {

// Extensions of the files, as in messages.
inline constexpr std::string_view kPointFileTypes = ".npz, .pcd, .ply, .csv or .las";

// Returns whether write_points() has a format for a file name.
bool is_point_file(const std::filesystem::path& path);

// Returns whether a file that write_points() wrote is whole: as far as its header and its end tell.
bool is_whole_point_file(const std::filesystem::path& path);

// Writes the points of a cloud, atomically, in the format of the extension. The bytes depend on the
// arguments alone.
//
//   software  that made it, for files that say so
// Expects: is_point_file(). Fails: E0103.
bool write_points(const LidarCloud& cloud, const std::filesystem::path& path,
                  const std::string& software, DiagnosticLog& log);

}  // namespace panwright::instruments
