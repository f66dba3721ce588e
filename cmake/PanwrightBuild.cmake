# Language level, warnings and the functions that declare a folder's target.

include(GNUInstallDirs)
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # one cache serves every checkout of the project on a machine
  set(CMAKE_CXX_COMPILER_LAUNCHER env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1)
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
target_include_directories(panwright_flags INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/panwright>)
set(PANWRIGHT_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Werror=return-type)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # note: GCC 12 sees overlap in std::string's operator+ where there is none (GCC bug 105329)
  list(APPEND PANWRIGHT_WARNINGS -Wno-restrict)
endif()
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # a source that another one includes is a header to GCC
  list(APPEND PANWRIGHT_WARNINGS -Wno-subobject-linkage)
endif()

if(PANWRIGHT_SANITIZE)
  add_compile_options(-fsanitize=${PANWRIGHT_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=${PANWRIGHT_SANITIZE})
endif()

# panwright_precompile(name headers ...): where the option PANWRIGHT_PRECOMPILE is set. Sources include what they
# use all the same: the other builds have no such headers.
set(PANWRIGHT_COMMON_HEADERS algorithm array cmath cstdint filesystem functional map memory numeric optional set span string
    string_view unordered_map variant vector glm/glm.hpp glm/gtc/quaternion.hpp)
function(panwright_precompile name)
  if(NOT PANWRIGHT_PRECOMPILE)
    return()
  endif()
  foreach(header ${PANWRIGHT_COMMON_HEADERS} ${ARGN})
    target_precompile_headers(${name} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:<${header}$<ANGLE-R>>")
  endforeach()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    # the same text gives the same bytes, which ccache goes by
    target_compile_options(${name} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()

# panwright_library(name SOURCES ... PUBLIC ... PRIVATE ... [OPTIMISED]): folder = namespace = target. OPTIMISED: it
# computes much, and is optimised under AddressSanitizer too.
function(panwright_library name)
  cmake_parse_arguments(ARG "OPTIMISED" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(panwright_${name} STATIC ${ARG_SOURCES})
  add_library(panwright::${name} ALIAS panwright_${name})
  set_target_properties(panwright_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_options(panwright_${name} PRIVATE ${PANWRIGHT_WARNINGS})
  target_link_libraries(panwright_${name} PUBLIC panwright_flags ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  if(PANWRIGHT_SANITIZE MATCHES "address" AND ARG_OPTIMISED)
    target_compile_options(panwright_${name} PRIVATE -O2)
  endif()
  panwright_precompile(panwright_${name})
  set_property(GLOBAL APPEND PROPERTY PANWRIGHT_LIBRARIES panwright_${name})
endfunction()

# panwright_test(name SOURCES ... LINK ... LABELS ... [TIMEOUT s] [OPTIMISED] [PARALLEL] [SLOW_SANITIZED ...]): one executable,
# one ctest entry. OPTIMISED: the test itself computes much; the others compile faster without.
# PARALLEL: of the preset tsan too. SLOW_SANITIZED: tests that take long under AddressSanitizer and run
# code that others run too; they are left out there unless PANWRIGHT_SLOW_SANITIZED is set (scripts/test --fuzz).
function(panwright_test name)
  cmake_parse_arguments(ARG "OPTIMISED;PARALLEL" "TIMEOUT" "SOURCES;LINK;LABELS;SLOW_SANITIZED" ${ARGN})
  add_executable(${name}_tests ${ARG_SOURCES})
  target_compile_options(${name}_tests PRIVATE ${PANWRIGHT_WARNINGS})
  if(PANWRIGHT_SANITIZE MATCHES "address" AND NOT ARG_OPTIMISED)
    target_compile_options(${name}_tests PRIVATE -O0)
  elseif(NOT ARG_OPTIMISED)
    target_compile_options(${name}_tests PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  panwright_precompile(${name}_tests gmock/gmock.h gtest/gtest.h)
  target_include_directories(${name}_tests PRIVATE "${CMAKE_BINARY_DIR}/generated")
  target_link_libraries(${name}_tests PRIVATE ${ARG_LINK} GTest::gtest_main GTest::gmock)
  add_test(NAME ${name} COMMAND ${name}_tests)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 1500)
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT} ENVIRONMENT
    "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/support/leaks.supp:print_suppressions=0;TSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/support/races.supp:print_suppressions=0")
  if(PANWRIGHT_SLOW_SANITIZED)
    set_tests_properties(${name} PROPERTIES TIMEOUT 5000)
  elseif(ARG_SLOW_SANITIZED AND PANWRIGHT_SANITIZE MATCHES "address")
    string(REPLACE ";" ":" slow "${ARG_SLOW_SANITIZED}")
    set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT "GTEST_FILTER=-${slow}")
  endif()
  if(ARG_PARALLEL)
    set_property(TEST ${name} APPEND PROPERTY LABELS parallel)
    set_property(GLOBAL APPEND PROPERTY PANWRIGHT_PARALLEL_TESTS ${name}_tests)
  endif()
  if(NOT ARG_LABELS)
    set_property(GLOBAL APPEND PROPERTY PANWRIGHT_QUICK_TESTS ${name}_tests)
  endif()
endfunction()
