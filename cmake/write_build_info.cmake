# Writes OUTPUT, a header, from SOURCE_DIR (its commit, where it is a checkout), COMPILER, BUILD_TYPE
# and LIBRARIES, "NAME=VERSION,…".
set(commit "")
find_program(GIT git)
if(GIT AND EXISTS "${SOURCE_DIR}/.git")
  execute_process(COMMAND "${GIT}" -C "${SOURCE_DIR}" describe --always --dirty --abbrev=12 --exclude=*
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(entries "")
string(REPLACE "," ";" LIBRARIES "${LIBRARIES}")
foreach(library ${LIBRARIES})
  string(REGEX REPLACE "^([^=]+)=(.*)$" "    {\"\\1\", \"\\2\"},\n" entry "${library}")
  string(APPEND entries "${entry}")
endforeach()
set(text "// Made by cmake/write_build_info.cmake.
#pragma once

namespace panwright::tools {

constexpr const char* kCommit = \"${commit}\";  // empty: not built from a checkout
constexpr const char* kCompiler = \"${COMPILER}\";
constexpr const char* kBuildType = \"${BUILD_TYPE}\";
struct Library {
  const char* name;
  const char* version;
};
constexpr Library kLibraries[] = {
${entries}};

}  // namespace panwright::tools
")
set(old "")
if(EXISTS "${OUTPUT}")
  file(READ "${OUTPUT}" old)
endif()
if(NOT old STREQUAL text)
  file(WRITE "${OUTPUT}" "${text}")
endif()
