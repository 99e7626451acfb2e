# The laws of one volume or strategy, alone: for those from outside, while they are written.
#
#   bvlab_laws_of(VOLUME mine.hpp "Mine<float>")     the target laws_of_mine builds and runs them: the laws in
#   bvlab_laws_of(STRATEGY mine.hpp Mine)            float and double and the hunt for a false "disjoint"; the
#                                                    answers of recursion and the partition of the front
#
# Called for each of BVLAB_EXTRA_VOLUMES and BVLAB_EXTRA_STRATEGIES. A header's place is relative to the
# project, or absolute.
set(BVLAB_LAWS_DIRECTORY ${CMAKE_CURRENT_LIST_DIR})
function(bvlab_laws_of kind header type)
  get_filename_component(header "${header}" ABSOLUTE BASE_DIR ${PROJECT_SOURCE_DIR})
  bvlab_entry(entry "${type}" "${header}")
  set(sources "")
  if(kind STREQUAL "VOLUME")
    bvlab_split(volume "${entry}")
    set(id ${volume_id})
    set(templates ${BVLAB_LAWS_DIRECTORY}/volume_laws_test.cpp.in
                  ${BVLAB_LAWS_DIRECTORY}/../stress/volume_hunt_test.cpp.in)
  elseif(kind STREQUAL "STRATEGY")
    bvlab_split(strategy "${entry}")
    set(id ${strategy_id})
    set(templates ${BVLAB_LAWS_DIRECTORY}/strategy_laws_test.cpp.in)
  else()
    message(FATAL_ERROR "bvlab_laws_of: VOLUME or STRATEGY is needed, not '${kind}'")
  endif()
  foreach(template ${templates})
    get_filename_component(name ${template} NAME_WE)
    set(source ${CMAKE_CURRENT_BINARY_DIR}/laws_of_${id}/${name}.cpp)
    configure_file(${template} ${source} @ONLY)
    list(APPEND sources ${source})
  endforeach()
  add_executable(test_laws_of_${id} EXCLUDE_FROM_ALL ${sources})
  target_link_libraries(test_laws_of_${id} PRIVATE bvlab bvlab_options bvlab_scenes GTest::gtest_main)
  bvlab_lightly_optimised(test_laws_of_${id} bvlab_tests_read_once_lightly)
  add_custom_target(laws_of_${id} COMMAND test_laws_of_${id} USES_TERMINAL)
endfunction()

foreach(kind VOLUME STRATEGY)
  set(plural ${kind}S)
  string(REPLACE STRATEGYS STRATEGIES plural ${plural})
  foreach(each ${BVLAB_EXTRA_${plural}})
    bvlab_outside(type header "${each}")
    bvlab_laws_of(${kind} "${header}" "${type}")
  endforeach()
endforeach()
