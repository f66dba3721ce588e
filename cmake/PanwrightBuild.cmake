# Language level, warnings and the functions that declare a folder's target.

include(GNUInstallDirs)
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # one cache serves every checkout of the project on a machine
  set(CMAKE_CXX_COMPILER_LAUNCHER env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1
      CCACHE_DEPEND=1)  # a miss costs no preprocessing
  if(PANWRIGHT_PRECOMPILE)  # what it says of precompiled headers, which are as new as what they are used for
    list(APPEND CMAKE_CXX_COMPILER_LAUNCHER
         CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime)
  endif()
  list(APPEND CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE}")
  set(CMAKE_C_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()

add_library(panwright_flags INTERFACE)
add_library(panwright::flags ALIAS panwright_flags)
# note: all of this is for our own code. Whoever uses the installed libraries keeps their own flags: no
# public header depends on these, as the test "install" checks.
# note: -ffp-contract=off keeps results equal whatever the processor's FMA
target_compile_options(panwright_flags INTERFACE $<BUILD_INTERFACE:-ffp-contract=off>)
# note: GCC 12 at -O2 drops double → float → double of neighbouring components in its straight-line
# vectoriser, and with it roundings that decide bytes and measured errors
target_compile_options(panwright_flags INTERFACE
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>>)
target_compile_definitions(panwright_flags INTERFACE $<BUILD_INTERFACE:GLM_FORCE_CTOR_INIT>)
target_compile_features(panwright_flags INTERFACE cxx_std_20)
if(PANWRIGHT_PRECOMPILE)  # headers that are compiled once need the same definitions everywhere
  target_link_libraries(panwright_flags INTERFACE $<BUILD_INTERFACE:fmt::fmt> $<BUILD_INTERFACE:glm::glm>
                        $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>)
endif()
target_include_directories(panwright_flags INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/panwright>)
set(PANWRIGHT_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Werror=return-type)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # note: GCC 12 sees overlaps, overruns and unset members of std::string and std::optional where there are none (GCC bugs 105329, 105562, 105651)
  list(APPEND PANWRIGHT_WARNINGS -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread -Wno-maybe-uninitialized)
endif()
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # a source that another one includes is a header to GCC
  list(APPEND PANWRIGHT_WARNINGS $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
elseif(CMAKE_UNITY_BUILD)
  # to Clang, a name in a function shadows that of another source; the preset plain warns of true cases
  list(APPEND PANWRIGHT_WARNINGS -Wno-shadow)
endif()

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # the compiler collects its garbage when it holds 512 MB, not 128: a twentieth less time
  add_compile_options(--param=ggc-min-heapsize=524288)
endif()

if(PANWRIGHT_SANITIZE)
  add_compile_options(-fsanitize=${PANWRIGHT_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=${PANWRIGHT_SANITIZE})
  if(PANWRIGHT_SANITIZE MATCHES "undefined" AND NOT PANWRIGHT_SLOW_SANITIZED)
    # checks of every pointer are a fifth of a compilation: null ones end by a signal anyway, the others are nightly
    add_compile_options(-fno-sanitize=null,alignment,object-size,vptr,nonnull-attribute,returns-nonnull-attribute)
  endif()
endif()

# panwright_precompile(name [OPTIMISED | TEST]): where the option PANWRIGHT_PRECOMPILE is set, common headers are compiled
# once for all targets with the same flags. Sources include what they use all the same: nightly builds have no such headers.
set(PANWRIGHT_COMMON_HEADERS algorithm array cmath cstdint filesystem functional map memory numeric optional set span string
    string_view unordered_map variant vector fmt/format.h glm/glm.hpp glm/gtc/quaternion.hpp nlohmann/json.hpp)
function(panwright_precompile name)
  cmake_parse_arguments(ARG "OPTIMISED;LIGHT;TEST" "" "" ${ARGN})
  if(NOT PANWRIGHT_PRECOMPILE)
    return()
  endif()
  set(headers ${PANWRIGHT_COMMON_HEADERS})
  set(shared panwright_headers)
  if(ARG_TEST)
    list(APPEND headers gtest/gtest.h gmock/gmock.h)
    set(shared panwright_test_headers)
  endif()
  if(ARG_OPTIMISED AND (ARG_TEST OR PANWRIGHT_SANITIZE MATCHES "address"))
    string(APPEND shared _optimised)
  endif()
  if(NOT TARGET ${shared})
    set(empty "${CMAKE_BINARY_DIR}/generated/${shared}.cpp")
    file(GENERATE OUTPUT "${empty}" CONTENT "")
    add_library(${shared} OBJECT "${empty}")
    set_target_properties(${shared} PROPERTIES UNITY_BUILD OFF)
    target_compile_options(${shared} PRIVATE ${PANWRIGHT_WARNINGS})  # a macro follows from them
    target_link_libraries(${shared} PRIVATE panwright_flags)
    foreach(header ${headers})
      target_precompile_headers(${shared} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:<${header}$<ANGLE-R>>")
    endforeach()
    if(ARG_TEST)
      target_link_libraries(${shared} PRIVATE GTest::gtest GTest::gmock)
      set_target_properties(${shared} PROPERTIES POSITION_INDEPENDENT_CODE OFF)  # as programs
    endif()
    panwright_optimise(${shared} ${ARGN})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      # the same text gives the same bytes, which ccache goes by
      target_compile_options(${shared} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
    endif()
  endif()
  target_precompile_headers(${name} REUSE_FROM ${shared})
endfunction()

# panwright_unite(name): sources compiled as objects of at most 25, of equal counts. What objects have in common, headers and
# templates, is a third of their time. At the folder's end, when all sources are known.
function(panwright_unite name)
  cmake_language(EVAL CODE "cmake_language(DEFER CALL panwright_unite_now ${name})")
endfunction()
function(panwright_unite_now name)
  get_target_property(sources ${name} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  list(LENGTH sources count)
  math(EXPR objects "(${count} + 24) / 25")
  math(EXPR size "(${count} + ${objects} - 1) / ${objects}")
  set_target_properties(${name} PROPERTIES UNITY_BUILD_BATCH_SIZE ${size})
endfunction()

# panwright_optimise(name [OPTIMISED] [LIGHT] [TEST]): the level of what computes much; of what computes little, and of tests,
# which compile faster without.
function(panwright_optimise name)
  cmake_parse_arguments(ARG "OPTIMISED;LIGHT;TEST" "" "" ${ARGN})
  if(PANWRIGHT_SANITIZE MATCHES "address" AND ARG_OPTIMISED)
    target_compile_options(${name} PRIVATE -O2)
  elseif(ARG_TEST AND NOT ARG_OPTIMISED)
    target_compile_options(${name} PRIVATE $<$<NOT:$<CONFIG:Debug>>:-O0>)
  elseif(ARG_LIGHT AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    # note: g++ refuses headers precompiled with another level
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND NOT ARG_OPTIMISED)
    # a quarter of a compilation is of calls put in place, which only loops over much data gain from
    target_compile_options(${name} PRIVATE "$<$<NOT:$<CONFIG:Debug>>:SHELL:-mllvm -inline-threshold=25>")
  endif()
endfunction()

# panwright_library(name SOURCES ... PUBLIC ... PRIVATE ... [OPTIMISED | LIGHT]): folder = namespace = target. OPTIMISED: it
# computes much, and is optimised under AddressSanitizer too. LIGHT: it computes little.
function(panwright_library name)
  cmake_parse_arguments(ARG "OPTIMISED;LIGHT" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(panwright_${name} STATIC ${ARG_SOURCES})
  add_library(panwright::${name} ALIAS panwright_${name})
  set_target_properties(panwright_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_options(panwright_${name} PRIVATE ${PANWRIGHT_WARNINGS})
  target_link_libraries(panwright_${name} PUBLIC panwright_flags ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  set(kind "")
  if(ARG_OPTIMISED)
    set(kind OPTIMISED)
  elseif(ARG_LIGHT)
    set(kind LIGHT)
  endif()
  panwright_optimise(panwright_${name} ${kind})
  panwright_precompile(panwright_${name} ${kind})
  panwright_unite(panwright_${name})
  set_property(GLOBAL APPEND PROPERTY PANWRIGHT_LIBRARIES panwright_${name})
endfunction()

# panwright_libraries_first(name libraries...): a test's inline functions, compiled without optimisation, are not those
# that its libraries run: of several copies the linker keeps the first, which are theirs when they are linked whole, before the test.
function(panwright_libraries_first name)
  get_property(own GLOBAL PROPERTY PANWRIGHT_LIBRARIES)
  set(waiting ${ARGN})
  set(seen "")
  set(files "")
  while(waiting)
    list(POP_FRONT waiting library)
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" library "${library}")
    string(REPLACE "panwright::" "panwright_" library "${library}")
    if(NOT library IN_LIST own OR library IN_LIST seen)
      continue()
    endif()
    list(APPEND seen ${library})
    get_target_property(type ${library} TYPE)
    if(type STREQUAL "STATIC_LIBRARY")
      list(APPEND files $<TARGET_FILE:${library}>)
    endif()
    get_target_property(more ${library} INTERFACE_LINK_LIBRARIES)
    list(APPEND waiting ${more})
  endwhile()
  target_link_options(${name} BEFORE PRIVATE LINKER:--whole-archive ${files} LINKER:--no-whole-archive)
endfunction()

# panwright_test(name SOURCES ... LINK ... LABELS ... [SHARDS n] [TIMEOUT s] [OPTIMISED] [PARALLEL]
# [NIGHTLY ...] [SLOW_SANITIZED ...] [GL ...]): one program, one ctest entry, or n that share its tests (name.1, name.2, ...).
# NIGHTLY: slow tests that run in an entry of their own, name_nightly, in scripts/nightly alone. OPTIMISED: the test itself computes much.
# PARALLEL: of the preset tsan too. SLOW_SANITIZED: tests that take long under AddressSanitizer and run
# code that others run too; they are left out there unless PANWRIGHT_SLOW_SANITIZED is set (scripts/nightly).
# GL: tests that need OpenGL, left out of builds without.
# The label untrusted: code that reads bytes of files, which scripts/test runs under AddressSanitizer.
function(panwright_test name)
  cmake_parse_arguments(ARG "OPTIMISED;PARALLEL" "TIMEOUT;SHARDS" "SOURCES;LINK;LABELS;NIGHTLY;SLOW_SANITIZED;GL" ${ARGN})
  add_executable(${name}_tests ${ARG_SOURCES})
  set_target_properties(${name}_tests PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(${name}_tests PRIVATE ${PANWRIGHT_WARNINGS})
  set(kind TEST)
  if(ARG_OPTIMISED)
    list(APPEND kind OPTIMISED)
  endif()
  panwright_optimise(${name}_tests ${kind})
  panwright_precompile(${name}_tests ${kind})
  panwright_unite(${name}_tests)
  if(PANWRIGHT_PRECOMPILE)  # to GCC, macros of a precompiled gtest are not those of a system header
    target_compile_options(${name}_tests PRIVATE -Wno-dangling-else -Wno-missing-field-initializers)
  endif()
  target_include_directories(${name}_tests PRIVATE "${CMAKE_BINARY_DIR}/generated")
  target_link_libraries(${name}_tests PRIVATE ${ARG_LINK} GTest::gtest_main GTest::gmock)
  if(NOT ARG_OPTIMISED)
    panwright_libraries_first(${name}_tests ${ARG_LINK})
  endif()
  set(environment
    "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/support/leaks.supp:print_suppressions=0"
    "TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/support/races.supp:print_suppressions=0")
  set(slow ${ARG_NIGHTLY})
  if(NOT PANWRIGHT_GL)
    list(APPEND slow ${ARG_GL})
  endif()
  if(PANWRIGHT_SLOW_SANITIZED OR PANWRIGHT_SANITIZE MATCHES "thread")
    set(ARG_TIMEOUT 5000)
  elseif(PANWRIGHT_SANITIZE MATCHES "address")
    list(APPEND slow ${ARG_SLOW_SANITIZED})
  endif()
  string(REPLACE ";" ":" slow "${slow}")
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 1500)
  endif()
  if(ARG_PARALLEL)
    list(APPEND ARG_LABELS parallel)
    set_property(GLOBAL APPEND PROPERTY PANWRIGHT_PARALLEL_TESTS ${name}_tests)
  endif()
  if(untrusted IN_LIST ARG_LABELS)
    set_property(GLOBAL APPEND PROPERTY PANWRIGHT_UNTRUSTED_TESTS ${name}_tests)
  endif()
  set(entries ${name})
  if(ARG_SHARDS)
    set(entries "")
    foreach(shard RANGE 1 ${ARG_SHARDS})
      list(APPEND entries ${name}.${shard})
    endforeach()
  endif()
  set(index 0)
  foreach(entry ${entries})
    add_test(NAME ${entry} COMMAND ${name}_tests)
    set(sharded ${environment} "GTEST_FILTER=-${slow}")
    if(ARG_SHARDS)
      list(APPEND sharded GTEST_TOTAL_SHARDS=${ARG_SHARDS} GTEST_SHARD_INDEX=${index})
      math(EXPR index "${index} + 1")
    endif()
    set_tests_properties(${entry} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT} ENVIRONMENT "${sharded}")
  endforeach()
  if(ARG_NIGHTLY)
    string(REPLACE ";" ":" cases "${ARG_NIGHTLY}")
    add_test(NAME ${name}_nightly COMMAND ${name}_tests)
    set_tests_properties(${name}_nightly PROPERTIES LABELS "${ARG_LABELS};nightly" TIMEOUT ${ARG_TIMEOUT}
      ENVIRONMENT "${environment};GTEST_FILTER=${cases}")
  endif()
endfunction()
