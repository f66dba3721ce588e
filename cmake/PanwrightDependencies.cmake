# The libraries that Panwright links, all from Debian packages. Installed beside the package config,
# because a program that links the static libraries needs them too.

find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(glm REQUIRED)
find_package(fmt REQUIRED)
find_package(TBB REQUIRED)
find_package(embree 3 REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(OpenMesh REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(pugixml REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(JPEG REQUIRED)  # libjpeg-turbo: its colour spaces with alpha are used
find_package(PNG REQUIRED)
find_package(TIFF REQUIRED)
find_package(ZLIB REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(draco REQUIRED)  # draco_static: the shared library exports a tinygltf of its own
# note: the package config of Debian's OpenSubdiv 3.5.0 names a static library that is not packaged
if(NOT TARGET OpenSubdiv::osdCPU)
  find_path(PANWRIGHT_OPENSUBDIV_INCLUDE opensubdiv/version.h REQUIRED)
  find_library(PANWRIGHT_OPENSUBDIV_LIBRARY osdCPU REQUIRED)
  file(STRINGS "${PANWRIGHT_OPENSUBDIV_INCLUDE}/opensubdiv/version.h" OpenSubdiv_VERSION
       REGEX "#define OPENSUBDIV_VERSION v[0-9_]+")
  string(REGEX REPLACE ".* v" "" OpenSubdiv_VERSION "${OpenSubdiv_VERSION}")
  string(REPLACE "_" "." OpenSubdiv_VERSION "${OpenSubdiv_VERSION}")
  add_library(OpenSubdiv::osdCPU SHARED IMPORTED)
  set_target_properties(OpenSubdiv::osdCPU PROPERTIES
    IMPORTED_LOCATION "${PANWRIGHT_OPENSUBDIV_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${PANWRIGHT_OPENSUBDIV_INCLUDE}")
endif()
if(NOT TARGET PkgConfig::XXHASH)
  pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
  pkg_check_modules(SLEEF REQUIRED IMPORTED_TARGET sleef)
  pkg_check_modules(TOML REQUIRED IMPORTED_TARGET tomlplusplus)
  pkg_check_modules(WEBSOCKETS REQUIRED IMPORTED_TARGET libwebsockets)
  pkg_check_modules(WEBP REQUIRED IMPORTED_TARGET libwebp)
  pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
endif()
