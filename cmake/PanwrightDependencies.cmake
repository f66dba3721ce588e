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
find_package(JPEG REQUIRED)  # libjpeg-turbo: its colour spaces with alpha are used
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(draco REQUIRED)  # draco_static: the shared library exports a tinygltf of its own
if(NOT TARGET PkgConfig::XXHASH)
  pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
  pkg_check_modules(SLEEF REQUIRED IMPORTED_TARGET sleef)
  pkg_check_modules(WEBP REQUIRED IMPORTED_TARGET libwebp)
  pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
endif()
