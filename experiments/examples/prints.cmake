# Runs an example, and compares what it prints with what the page beside it says that it prints.
#   cmake -DPROGRAM=... -DEXPECTED=README.md -DNAME=... -P prints.cmake
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE printed RESULT_VARIABLE fault)
if(NOT fault EQUAL 0)
  message(FATAL_ERROR "${NAME}: exit ${fault}")
endif()
file(READ ${EXPECTED} page)
string(FIND "${page}" "```\n${printed}```" place)
if(place EQUAL -1)
  message(FATAL_ERROR "${NAME} prints what ${EXPECTED} does not show:\n${printed}")
endif()
