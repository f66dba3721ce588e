// Reader of MuJoCo models (MJCF). Private to importers.
#pragma once

#include <string_view>

#include "importers/import.h"
#include "importers/internal/input_file.h"

namespace panwright::importers::mjcf {

// Returns true if the first element of a text is <mujoco>.
bool is_model(std::string_view text);

// Reads an unpacked file with its meshes and textures. Each body is a node placed by its pose.
// Joints move that node; those anchored elsewhere get a node of their own around it, at the anchor.
// Their values are the file's, `ref` included. A free joint is a general one.
//
// Fails: E6002, E6220 without geometry and bodies. Reports E6001, E6010, E6220, W6004, W6005,
// W6221, N6007, W6008, and those of mesh readers.
Result<Imported> read(Files& files, const InputFile& file, const Options& options,
                      DiagnosticLog& log);

}  // namespace panwright::importers::mjcf
