// Images of a sequence in one file: animated PNG, videos by ffmpeg, contact sheets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"

namespace panwright::image {

// Of videos that ffmpeg makes.
inline constexpr std::string_view kVideoExtensions[] = {".mp4",  ".mkv", ".mov",
                                                        ".webm", ".avi", ".gif"};

// Returns a PNG for people in place of one that holds a detector's numbers (image/shown.h); empty:
// the file is one for people. path: for a problem. Fails: E0102.
Result<std::string> shown_png(std::span<const std::byte> bytes, const std::filesystem::path& path,
                              DiagnosticLog& log);

// Joins images into a video by ffmpeg; replaces a file. Returns whether that succeeded.
//
//   ffmpeg   its path
//   pattern  of the images, numbered from 0 or 1, as "frames/%05d.png"
//   rate     images a second
bool encode_video(const std::filesystem::path& ffmpeg, const std::string& pattern, double rate,
                  const std::filesystem::path& output, const Job& job);

// Joins PNG files into an animated PNG, which is played without end (APNG 1.0 of PNG 3, W3C 2025).
// The compressed rows are copied, one image in memory at a time; numbers become shown_png().
//
//   rate  images a second
// Expects: an image or more. Fails: E0101, E0103, E0001; E0102 for files that are no PNG of one
// size and kind.
bool write_animation(const std::filesystem::path& path,
                     std::span<const std::filesystem::path> images, std::uint16_t rate,
                     DiagnosticLog& log, const Job& job);

// Writes a contact sheet, a PNG: at most `most` of the images, evenly chosen, in rows, each reduced
// by a whole number to at most `side` pixels; light is averaged, not codes. A detector's numbers
// are shown as light (image/shown.h).
//
// Expects, fails: as write_animation().
bool write_sheet(const std::filesystem::path& path, std::span<const std::filesystem::path> images,
                 std::size_t most, std::uint32_t side, DiagnosticLog& log, const Job& job);

}  // namespace panwright::image
