// What made an image, as text in its file, and back (docs/image-files.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/result.h"
#include "workspace/open.h"
#include "workspace/views.h"
#include "world/world.h"

namespace panwright::workspace {

// Where a world comes from.
struct RecordSource {
  std::vector<std::string> files;  // of its targets, in order, as their user wrote them; may be
                                   // empty: the record does not say
  OpenOptions open;                // that they were opened with
};

// One JSON object in ASCII: schema, program (with its version), targets (name, file, build
// identity), options of reading them, and the view with all that was chosen for it, as a views file
// writes it. No output, time or place of the machine: files stand as in `source`.
std::string record_text(const world::World& world, const world::Camera& camera,
                        std::optional<double> ev, const DrawOptions& draw,
                        const RecordSource& source);

struct RecordedTarget {
  std::string name;
  std::string file;      // as its user wrote it; empty: unknown
  std::string build_id;  // hexadecimal
};

struct Record {
  std::string program;  // "panwright 1.0"
  std::vector<RecordedTarget> targets;
  OpenOptions open;
  ViewText view;             // without output and targets
  std::string context;       // "auto", "egl" or "osmesa"
  bool nodes_moved = false;  // by a program, which no option can
};

// The version of this program as records have it.
std::string recorded_program();

// Reads the record of an image: .png, .exr or .npz.
//
// Fails: E0101, E0102, E0202; E0207 where there is none, or not one that this program can read.
Result<Record> read_record(const std::filesystem::path& image, DiagnosticLog& log);

// The file of a recorded target: as recorded, from the working directory, else from the folder of
// the image or the nearest folder around it that has it. Where there is none: as recorded.
std::filesystem::path find_recorded(const std::string& file, const std::filesystem::path& image);

// Compares what is opened with what was recorded. Reports: W0208.
void compare_with_record(const Record& record, const world::World& world,
                         const std::filesystem::path& image, DiagnosticLog& log);

}  // namespace panwright::workspace
