// MuJoCo models (MJCF) → scene. Private to importers.
#pragma once

#include <string_view>

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::mjcf {

// Whether the first element of a text is <mujoco>.
bool is_model(std::string_view text);

// Reads an unpacked file with the meshes and textures that it names. Each body is a node placed by
// its pose; joints move that node, those whose anchor is elsewhere one of their own around it, at
// the anchor. Their values are the file's, `ref` included. A free joint is a general one.
//
// Fails: E6002, E6220 where there is nothing to see and no body. Reports E6001, E6010, E6220,
// W6004, W6005, W6221, N6007, W6008, and what readers of meshes report.
Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log);

}  // namespace panwright::importers::mjcf
