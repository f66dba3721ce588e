// Other programs: where they are, and running them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/job.h"

namespace panwright {

// Path of an executable in the folders of $PATH; empty: not found.
std::filesystem::path find_program(const std::string& name);

// Runs a program without input and output; returns whether it succeeded. A cancelled job ends it.
//
//   words  its path, and its arguments
bool run_program(const std::vector<std::string>& words, const Job& job);

}  // namespace panwright
