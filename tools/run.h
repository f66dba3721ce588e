// The whole program as a function.
#pragma once

#include "tools/command.h"

namespace panwright::tools {

// Runs `panwright` (or pxntopan, pxn2pan, vrmltopan, gltftopan, by the name in argv[0]) and returns
// the exit code of docs/conventions.md 18. Writes to standard output and standard error. Never
// throws. Does not change the process: signals are the host's.
int run(int argc, const char* const* argv, const Host& host = {});

}  // namespace panwright::tools
