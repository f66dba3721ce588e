# tools/build_info.h, made anew in each build: what was built, of what, with what. It changes only when
# one of these does.

set(PANWRIGHT_BUILD_INFO_DIR "${CMAKE_BINARY_DIR}/generated/build_info")

# NAME=VERSION of each library that the program is built with
set(libraries "")
foreach(pair
    fmt:fmt_VERSION glm:glm_VERSION nlohmann_json:nlohmann_json_VERSION tbb:TBB_VERSION embree:embree_VERSION
    meshoptimizer:meshoptimizer_VERSION openmesh:OpenMesh_VERSION opensubdiv:OpenSubdiv_VERSION openexr:OpenEXR_VERSION png:PNG_VERSION_STRING
    jpeg:JPEG_VERSION tiff:TIFF_VERSION_STRING zlib:ZLIB_VERSION_STRING draco:draco_VERSION xxhash:XXHASH_VERSION sleef:SLEEF_VERSION
    pugixml:pugixml_VERSION webp:WEBP_VERSION zstd:ZSTD_VERSION opencascade:OpenCASCADE_VERSION)
  string(REPLACE ":" ";" pair "${pair}")
  list(GET pair 0 name)
  list(GET pair 1 variable)
  if(DEFINED ${variable} AND NOT "${${variable}}" STREQUAL "")
    list(APPEND libraries "${name}=${${variable}}")
  endif()
endforeach()
string(REPLACE ";" "," libraries "${libraries}")

add_custom_target(panwright_build_info
  COMMAND ${CMAKE_COMMAND} "-DSOURCE_DIR=${PROJECT_SOURCE_DIR}" "-DOUTPUT=${PANWRIGHT_BUILD_INFO_DIR}/tools/build_info.h"
          "-DCOMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}" "-DBUILD_TYPE=${CMAKE_BUILD_TYPE}"
          "-DLIBRARIES=${libraries}" -P "${PROJECT_SOURCE_DIR}/cmake/write_build_info.cmake"
  BYPRODUCTS "${PANWRIGHT_BUILD_INFO_DIR}/tools/build_info.h"
  VERBATIM)
