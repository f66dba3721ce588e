// The whole program as a function.
#pragma once

namespace panwright::tools {

// Runs `panwright` (or pxntopan, pxn2pan, by the name in argv[0]) and returns the exit code of
// docs/conventions.md 15. Writes to standard output and standard error. Never throws.
int run(int argc, const char* const* argv);

}  // namespace panwright::tools
