# Packages, in a build folder: `cpack -G DEB` makes panwright (program, reader of STEP files, schemas,
# presets, examples, pages), libpanwright-dev (static libraries, headers) and python3-panwright; `cpack -G TGZ` one archive
# of both; `cpack --config CPackSourceConfig.cmake` the sources.

set(CPACK_PACKAGE_NAME panwright)
set(CPACK_PACKAGE_VENDOR Panwright)
set(CPACK_PACKAGE_CONTACT "Panwright developers <developers@panwright.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION
"Panwright turns spacecraft written as pxn text, or imported from CAD files, into
compact pan files, and shows them as a rendezvous camera sees them.")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program dev)
if(PANWRIGHT_HAS_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME panwright)
# what the program links is found by dpkg-shlibdeps; OpenGL is loaded when it draws
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libegl1, libgl1-mesa-dri, libosmesa6")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "${CPACK_PACKAGE_DESCRIPTION}")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libpanwright-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEV_DESCRIPTION "Headers and static libraries of Panwright, with a CMake package and a pkg-config file.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "panwright (= ${PROJECT_VERSION}), libdraco-dev, libembree-dev, libfmt-dev, libglm-dev, libjpeg62-turbo-dev, libmeshoptimizer-dev, libopenexr-dev, libopenmesh-dev, libosd-dev, libpng-dev, libpugixml-dev, libsleef-dev, libtbb-dev, libtiff-dev, libtomlplusplus-dev, libwebp-dev, libxxhash-dev, libyaml-cpp-dev, libzstd-dev, nlohmann-json3-dev, zlib1g-dev")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-panwright)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= ${PANWRIGHT_PYTHON_VERSION}), python3 (<< ${PANWRIGHT_PYTHON_NEXT}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "libegl1, libgl1-mesa-dri, libosmesa6")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Panwright for Python: models, images and labels as NumPy arrays.")

set(CPACK_PANWRIGHT_SOURCE_DIR "${PROJECT_SOURCE_DIR}")
set(CPACK_PROJECT_CONFIG_FILE "${PROJECT_SOURCE_DIR}/cmake/cpack_settings.cmake")
set(CPACK_SOURCE_GENERATOR TGZ)
set(CPACK_SOURCE_PACKAGE_FILE_NAME "panwright-${PROJECT_VERSION}")
string(REGEX REPLACE "([.+*?()$])" "[\\1]" source_dir "${PROJECT_SOURCE_DIR}")
set(CPACK_SOURCE_IGNORE_FILES "^${source_dir}/(build|install|out|shared|[.]git|[.]cache)/;/__pycache__/")
include(CPack)
