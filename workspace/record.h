// Record of an image's making, as text in its file, and its reader (docs/views.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "image/image.h"
#include "preview/context.h"
#include "workspace/frame.h"
#include "workspace/open.h"
#include "workspace/views.h"
#include "world/world.h"

namespace panwright::workspace {

// Source of a world.
struct RecordSource {
  std::vector<std::string> files;  // of its targets, in order, as typed; may be empty: not recorded
  OpenOptions open;                // options of opening them
};

// Returns one JSON object in ASCII: schema, program (with its version), targets (name, file, build
// identity), options of reading them, and the view with all choices, in the form of a views file.
// Keypoints are in it with their pixels and depths. No output, time or machine-specific path: files
// are as in `source`; those that are not UTF-8 are {"bytes": "…"}, hexadecimal.
//
//   world  as shown
//   frame  of any instrument
std::string record_text(const world::World& world, const Frame& frame, const RecordSource& source,
                        preview::ContextKind context = preview::ContextKind::automatic);

// Adds to a record the names of an image's ids: paths of nodes and names of materials by target,
// each by its number in the layer. Only those that the image has; nothing without ground truth.
void add_names(const world::World& world, const image::Image& image, std::string& record);

struct RecordedTarget {
  std::string name;
  std::string file;      // as typed; empty: unknown
  std::string build_id;  // hexadecimal
};

struct Record {
  std::string program;  // "panwright 1.0"
  std::vector<RecordedTarget> targets;
  OpenOptions open;
  View view;                 // without output and targets
  std::string context;       // "auto", "egl" or "osmesa"
  bool nodes_moved = false;  // by a program; options cannot
};

// Returns the version of this program in the form of records.
std::string recorded_program();

// Reads the record of an image: .png, .exr or .npz.
//
// Fails: E0101, E0102, E0202; E0207 without one that this program can read.
Result<Record> read_record(const std::filesystem::path& image, DiagnosticLog& log);

// Fits the intrinsics that stand for a field of view to another image size.
void keep_field_of_view(Settings& settings, const ImageSize& size);

// Finds the file of a recorded target: as recorded, from the working directory, else from the
// folder of the image or the nearest folder around it that has it. If not found: as recorded.
std::filesystem::path find_recorded(const std::string& file, const std::filesystem::path& image);

// Compares the opened files with the recorded ones. Reports: W0208.
void compare_with_record(const Record& record, const world::World& world,
                         const std::filesystem::path& image, DiagnosticLog& log);

}  // namespace panwright::workspace
