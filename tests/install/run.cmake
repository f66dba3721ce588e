# Installs the build into a fresh folder, builds an outside program against it and runs both.
foreach(variable BUILD_DIR WORK_DIR SOURCE_DIR)
  if(NOT DEFINED ${variable})
    message(FATAL_ERROR "${variable} is needed")
  endif()
endforeach()

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nexit code ${code}\n${out}")
  endif()
endfunction()

file(REMOVE_RECURSE "${WORK_DIR}")
run(${CMAKE_COMMAND} --install "${BUILD_DIR}" --prefix "${WORK_DIR}/prefix")
foreach(file bin/panwright bin/pxntopan bin/pxn2pan share/panwright/pxn.xsd share/panwright/pxn-0.xsd
        share/panwright/examples/paper/figure8.pxn include/panwright/pan/model.h
        share/man/man1/panwright.1 share/man/man1/panwright-render.1 share/bash-completion/completions/panwright
        share/zsh/site-functions/_panwright share/fish/vendor_completions.d/panwright.fish
        share/panwright/schemas/info.schema.json
        share/doc/panwright/README.md share/doc/panwright/docs/language-tour.md
        share/doc/panwright/docs/versions.md share/doc/panwright/docs/images/tour-servicer.png)
  if(NOT EXISTS "${WORK_DIR}/prefix/${file}")
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
# every file belongs to a package
file(GLOB scripts "${BUILD_DIR}/cmake_install.cmake" "${BUILD_DIR}/*/cmake_install.cmake")
foreach(script ${scripts})
  file(READ "${script}" text)
  if(text MATCHES "Unspecified")
    message(FATAL_ERROR "${script} installs files that belong to no component")
  endif()
endforeach()
# public headers alone, and none that includes another kind
set(include "${WORK_DIR}/prefix/include/panwright")
file(GLOB_RECURSE headers RELATIVE "${include}" "${include}/*.h")
foreach(header ${headers})
  file(READ "${include}/${header}" text)
  if(header MATCHES "(^|/)internal/" OR text MATCHES "// [^\n]*Private to")
    message(FATAL_ERROR "installed, and private: ${header}")
  endif()
  string(REGEX MATCHALL "#include \"[^\"]+\"" includes "${text}")
  foreach(line ${includes})
    string(REGEX REPLACE "#include \"([^\"]+)\"" "\\1" name "${line}")
    if(NOT EXISTS "${include}/${name}")
      message(FATAL_ERROR "${header} includes ${name}, which is not installed")
    endif()
  endforeach()
endforeach()

# the program of docs/using-the-library.md, as it stands there
file(READ "${SOURCE_DIR}/docs/using-the-library.md" page)
string(REGEX REPLACE ";" "\\\\;" page "${page}")
string(FIND "${page}" "```cpp\n" begin)
math(EXPR begin "${begin} + 7")
string(SUBSTRING "${page}" ${begin} -1 page)
string(FIND "${page}" "```" end)
string(SUBSTRING "${page}" 0 ${end} program)
string(REGEX REPLACE "\\\\;" ";" program "${program}")
string(REGEX MATCHALL "\n" lines "${program}")
list(LENGTH lines count)
if(NOT count LESS 40)
  message(FATAL_ERROR "the program of docs/using-the-library.md has ${count} lines")
endif()
file(WRITE "${WORK_DIR}/moving.cpp" "${program}")

run(${CMAKE_COMMAND} -S "${SOURCE_DIR}/tests/install" -B "${WORK_DIR}/outside" -G Ninja
    -DCMAKE_BUILD_TYPE=Release "-DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix")
run(${CMAKE_COMMAND} --build "${WORK_DIR}/outside")
set(model "${WORK_DIR}/prefix/share/panwright/examples/paper/figure8.pxn")
run("${WORK_DIR}/outside/outside" "${model}" "${WORK_DIR}/outside.pan")
run("${WORK_DIR}/prefix/bin/pxn2pan" -lic none.txt -o "${WORK_DIR}/tool.pan" "${model}")
run(${CMAKE_COMMAND} -E compare_files "${WORK_DIR}/outside.pan" "${WORK_DIR}/tool.pan")

# the same program without CMake, by the pkg-config file
file(GLOB pc "${WORK_DIR}/prefix/lib*/pkgconfig/panwright.pc" "${WORK_DIR}/prefix/lib/*/pkgconfig/panwright.pc")
if(NOT pc)
  message(FATAL_ERROR "not installed: panwright.pc")
endif()
get_filename_component(pc "${pc}" DIRECTORY)
run(sh -c "PKG_CONFIG_PATH='${pc}' sh -c 'c++ $(pkg-config --cflags panwright) \"${SOURCE_DIR}/tests/install/outside.cpp\" -o \"${WORK_DIR}/plain\" $(pkg-config --libs panwright)'")
run("${WORK_DIR}/plain" "${model}" "${WORK_DIR}/plain.pan")
run(${CMAKE_COMMAND} -E compare_files "${WORK_DIR}/plain.pan" "${WORK_DIR}/tool.pan")

# the installed program finds the installed reader of STEP, and holds nothing of it itself
if(STEP)
  run("${WORK_DIR}/prefix/bin/panwright" import "${SOURCE_DIR}/tests/importers/step/data/W6602.step"
      -o "${WORK_DIR}/step.pan" --keep-hidden)
  execute_process(COMMAND ldd "${WORK_DIR}/prefix/bin/panwright" OUTPUT_VARIABLE libraries)
  if(libraries MATCHES "libTK")
    message(FATAL_ERROR "the program links OpenCASCADE:\n${libraries}")
  endif()
endif()

# a film of two models
if(GL)
  set(examples "${WORK_DIR}/prefix/share/panwright/examples")
  execute_process(COMMAND "${WORK_DIR}/outside/moving" "${examples}/cubesat/cubesat.pxn"
                          "${examples}/paper/figure8.pxn"
                  WORKING_DIRECTORY "${WORK_DIR}" RESULT_VARIABLE code ERROR_VARIABLE err OUTPUT_QUIET)
  if(NOT code EQUAL 0 OR NOT EXISTS "${WORK_DIR}/frame19.exr")
    message(FATAL_ERROR "moving: exit code ${code}\n${err}")
  endif()
  file(SHA256 "${WORK_DIR}/frame0.exr" first)
  file(SHA256 "${WORK_DIR}/frame19.exr" last)
  if(first STREQUAL last)
    message(FATAL_ERROR "nothing moves")
  endif()
endif()
