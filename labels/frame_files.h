// Files of a frame's labels, from which those of other formats follow. docs/label-formats.md
//
//   NAME.labels.json   all but masks and flow (schemas/labels.schema.json)
//   NAME.masks.npz     "ID.amodal", "ID.visible": uint8 crops, whose places the JSON has
//   NAME.forward.flo   flow, as of Middlebury; unknown: 1e10. Also NAME.backward.flo
#pragma once

#include <filesystem>
#include <string_view>

#include "base/diagnostic.h"
#include "base/result.h"
#include "labels/labels.h"

namespace panwright::labels {

inline constexpr std::string_view kLabelsExtension = ".labels.json";
inline constexpr std::string_view kMasksExtension = ".masks.npz";
inline constexpr std::string_view kForwardExtension = ".forward.flo";
inline constexpr std::string_view kBackwardExtension = ".backward.flo";

// Writes the files of a frame, each aside and renamed, the JSON last: a frame that has it is whole.
// An older JSON of the frame is removed first. The bytes depend on the labels alone. The seconds
// spent in fsync are added to *sync_seconds when given.
//
// Expects: a name without folders; finite numbers; masks within the image. Fails: E0103.
bool write_frame(const std::filesystem::path& folder, const FrameLabels& frame, DiagnosticLog& log,
                 double* sync_seconds = nullptr);

// Parts of a frame to read.
struct FrameParts {
  bool masks = true;
  bool flow = true;
};

// Reads what write_frame() wrote, to the same bits. All of it is checked: what is returned holds
// the promises of labels.h. Memory is bounded, whatever the bytes.
//
//   json   the frame's JSON; the other files lie beside it
//   parts  masks keep their places without coverage, flow is left out, where not asked for
// Fails: E0101, E0102, E0104, E9001.
Result<FrameLabels> read_frame(const std::filesystem::path& json, DiagnosticLog& log,
                               const FrameParts& parts = {});

// Returns whether the files of a frame are there and whole: the JSON and the masks are read as by
// read_frame(), of flow the sizes are compared.
//
//   forward, backward  flow that the frame has
bool has_whole_files(const std::filesystem::path& json, bool forward, bool backward);

}  // namespace panwright::labels
