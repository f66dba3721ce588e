// Contact sheet and video of the frames of `run`.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "tools/arguments.h"
#include "tools/command_context.h"

namespace panwright::tools {

struct AlbumOptions {
  std::string sheet;  // file; empty: none
  std::string video;  // file; empty: none
  bool any() const { return !sheet.empty() || !video.empty(); }
};
void declare(Arguments& arguments, AlbumOptions& options);

// Checks the names. Fails: E0201, E0202.
bool check(const AlbumOptions& options, DiagnosticLog& log);
// Declares the files, before anything is rendered and once the run has its folder. Fails: E0206,
// E0103.
bool claim_files(const AlbumOptions& options, DiagnosticLog& log);

// Makes both from the PNG files of the frames.
//
//   folder  of the run: names for ffmpeg are in it for a while
// Expects: a frame or more. Fails: as image::write_sheet(), write_animation(); E0103.
bool make_album(const AlbumOptions& options, std::span<const std::filesystem::path> frames,
                const std::filesystem::path& folder, CommandContext& context);

}  // namespace panwright::tools
