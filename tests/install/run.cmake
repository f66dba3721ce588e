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
        share/panwright/examples/paper/figure8.pxn include/panwright/pan/model.h)
  if(NOT EXISTS "${WORK_DIR}/prefix/${file}")
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
run(${CMAKE_COMMAND} -S "${SOURCE_DIR}/tests/install" -B "${WORK_DIR}/outside" -G Ninja
    -DCMAKE_BUILD_TYPE=Release "-DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix")
run(${CMAKE_COMMAND} --build "${WORK_DIR}/outside")
set(model "${WORK_DIR}/prefix/share/panwright/examples/paper/figure8.pxn")
run("${WORK_DIR}/outside/outside" "${model}" "${WORK_DIR}/outside.pan")
run("${WORK_DIR}/prefix/bin/pxn2pan" -lic none.txt -o "${WORK_DIR}/tool.pan" "${model}")
run(${CMAKE_COMMAND} -E compare_files "${WORK_DIR}/outside.pan" "${WORK_DIR}/tool.pan")
