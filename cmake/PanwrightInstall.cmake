# cmake --install: headers, libraries, tool, schema, presets, and a package config for
# find_package(panwright).

include(CMakePackageConfigHelpers)
set(PANWRIGHT_CONFIG_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/panwright")

get_property(libraries GLOBAL PROPERTY PANWRIGHT_LIBRARIES)
set_target_properties(panwright_flags PROPERTIES EXPORT_NAME flags)
install(TARGETS panwright_flags ${libraries} EXPORT panwright
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT dev)
install(EXPORT panwright NAMESPACE panwright:: DESTINATION "${PANWRIGHT_CONFIG_DIR}"
        FILE panwright-targets.cmake COMPONENT dev)
# public headers only: sub-folders without any are named here
install(DIRECTORY base image ephemeris terrain geometry mli materials light sensor scene pan world trace sky transport scenario labels instruments importers exporters compiler pxn preview workspace server schemas
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/panwright" COMPONENT dev
        FILES_MATCHING PATTERN "*.h" PATTERN "*.def" PATTERN "internal" EXCLUDE
        REGEX "/(importers/(vrml|gltf|meshes|step|urdf|mjcf)|pxn/(text|expression|reader)|preview/(gl|model|frame)|labels/formats|terrain/gdal|server/(clients|page))$" EXCLUDE)
install(FILES schemas/pxn-0.xsd schemas/pxn.xsd schemas/views.schema.json schemas/labels.schema.json DESTINATION "${CMAKE_INSTALL_DATADIR}/panwright")
install(DIRECTORY materials/presets DESTINATION "${CMAKE_INSTALL_DATADIR}/panwright"
        FILES_MATCHING PATTERN "*.pxn")
install(DIRECTORY examples DESTINATION "${CMAKE_INSTALL_DATADIR}/panwright")
# beside the examples, which name them
install(DIRECTORY server/clients DESTINATION "${CMAKE_INSTALL_DATADIR}/panwright/server")
# pages with their images, as they link to each other
install(FILES LICENSE README.md CHANGELOG.md CONTRIBUTING.md DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(DIRECTORY docs DESTINATION "${CMAKE_INSTALL_DOCDIR}" FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg")

install(TARGETS panwright_tool RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
install(TARGETS panwright_gdal RUNTIME DESTINATION "${CMAKE_INSTALL_LIBEXECDIR}/panwright")
if(PANWRIGHT_HAS_STEP)
  install(TARGETS panwright_step RUNTIME DESTINATION "${CMAKE_INSTALL_LIBEXECDIR}/panwright")
endif()
if(PANWRIGHT_HAS_STUDIO)
  install(TARGETS panwright_studio RUNTIME DESTINATION "${CMAKE_INSTALL_LIBEXECDIR}/panwright")
endif()
foreach(name pxntopan pxn2pan vrmltopan gltftopan)
  install(CODE "file(CREATE_LINK panwright
    \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/${name}\" SYMBOLIC)")
endforeach()

configure_package_config_file(cmake/panwright-config.cmake.in
  "${CMAKE_CURRENT_BINARY_DIR}/panwright-config.cmake" INSTALL_DESTINATION "${PANWRIGHT_CONFIG_DIR}")
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/panwright-config-version.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/panwright-config.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/panwright-config-version.cmake"
              cmake/PanwrightDependencies.cmake
        DESTINATION "${PANWRIGHT_CONFIG_DIR}" COMPONENT dev)

# pkg-config, for programs without CMake: libraries from the top down, as a linker wants them
set(PANWRIGHT_PC_LIBS "")
foreach(library ${libraries})
  get_target_property(type ${library} TYPE)
  if(type STREQUAL "STATIC_LIBRARY")
    string(PREPEND PANWRIGHT_PC_LIBS "-l${library} ")
  endif()
endforeach()
file(RELATIVE_PATH PANWRIGHT_PC_UP "/prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/prefix")
configure_file(cmake/panwright.pc.in "${CMAKE_CURRENT_BINARY_DIR}/panwright.pc" @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/panwright.pc"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT dev)
