# The library as somebody else uses it: installed with Eigen alone, found by find_package, and an
# example compiled against it and run.
#   cmake -DSOURCE=... -DWORK=... -DGENERATOR=... [-DREADERS=ON] -P run.cmake
# With READERS, the example that reads a file's parts instead.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE fault OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT fault EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} -G "${GENERATOR}" -S ${SOURCE} -B ${WORK}/library -DBVLAB_BUILD_EXPERIMENTS=OFF -DBVLAB_BUILD_TESTS=OFF)
run(${CMAKE_COMMAND} --install ${WORK}/library --prefix ${WORK}/installed)
run(${CMAKE_COMMAND} -G "${GENERATOR}" -S ${SOURCE}/tests/library -B ${WORK}/example -DCMAKE_PREFIX_PATH=${WORK}/installed
    -DCMAKE_BUILD_TYPE=Release)
if(READERS)
  run(${CMAKE_COMMAND} --build ${WORK}/example --target parts)
  run(${WORK}/example/parts)
  if(NOT output MATCHES "plate and washer touch at x = 10\nplate and washer touch at x = 0\\.01\n")
    message(FATAL_ERROR "the parts of a file are not as they should be:\n${output}")
  endif()
  return()
endif()
run(${CMAKE_COMMAND} --build ${WORK}/example)
run(${WORK}/example/example)
foreach(line "apart by 1\\.[0-9]+" "[1-9][0-9]* pairs touch" "boxes 0 and 1 overlap")
  if(NOT output MATCHES "${line}")
    message(FATAL_ERROR "the example does not say '${line}':\n${output}")
  endif()
endforeach()

# The page about the library shows no code of its own: it points to this example.
file(READ ${SOURCE}/experiments/using.md using)
if(NOT using MATCHES "\\(\\.\\./tests/library/example\\.cpp\\)")
  message(FATAL_ERROR "experiments/using.md does not point to tests/library/example.cpp")
endif()
