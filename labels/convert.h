// Conversion of frames' labels into the formats of data sets. docs/label-formats.md
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "base/job.h"
#include "base/result.h"
#include "world/world.h"

namespace panwright::labels {

struct FormatInfo {
  std::string_view name;    // "coco"
  std::string_view files;   // files that it writes, and their content
  bool one_target = false;  // it holds no second one
  bool png = false;         // it has the images of frames, as PNG files
  bool depth = false;       // it has their depth, of .npz or .exr files
  bool flow = false;        // it has the motion to the next frame
};
// All formats, in the order of formats.def.
std::span<const FormatInfo> formats();

// Model of a target, for formats that hold its shape.
struct TargetModel {
  std::string target;
  world::ModelPtr model;
};

struct Conversion {
  std::filesystem::path folder;      // of the files of frame_files.h and their images
  std::filesystem::path output;      // empty folder, made where it is not there
  bool again = false;                // it may have files of these frames, which are replaced
  std::vector<std::string> formats;  // each in output/FORMAT, or one in output itself
  std::vector<std::string> targets;  // those to write; empty: all
  std::vector<TargetModel> models;
};

struct Converted {
  std::uint64_t frames = 0;
  std::vector<std::filesystem::path> files;  // lists and tables, not those of single frames
};

// Writes the labels of all frames of a folder, in the order of their names. Frames are read one at
// a time: memory grows by some 1000 bytes a frame and target at most. The bytes depend on the
// labels and images alone. Images are linked, or copied where the file system has no links.
//
// Fails: E0001, E0103, E0201 for an unknown format, E9003; frames that cannot be read are left out,
// with their errors. Reports: W9002, once for each kind of value that a format cannot hold.
Result<Converted> convert(const Conversion& conversion, DiagnosticLog& log, const Job& job = {});

}  // namespace panwright::labels
