# Nobody installs it as a library of its own: it is compiled from a checkout of ODE, where one is named. Read after
# ode, whose configuration it includes.
set(BVLAB_OPCODE "" CACHE PATH "The folder OPCODE of a checkout of ODE, for the peers of that name")
if(BVLAB_PEERS_FROM_SOURCE AND NOT BVLAB_OPCODE)
  set(BVLAB_OPCODE ${BVLAB_PEERS}/OPCODE)
endif()
set(found OFF)
if(BVLAB_OPCODE AND BVLAB_ODE)
  set(found ON)
  string(APPEND BVLAB_LIBRARIES ", OPCODE (from source: our flags)")
  file(GLOB opcode_sources ${BVLAB_OPCODE}/OPC_*.cpp ${BVLAB_OPCODE}/Opcode.cpp ${BVLAB_OPCODE}/Ice/*.cpp)
  add_library(bvlab_opcode STATIC ${opcode_sources})
  target_include_directories(bvlab_opcode SYSTEM PUBLIC ${BVLAB_OPCODE} ${BVLAB_OPCODE}/Ice)
  target_compile_options(bvlab_opcode PUBLIC -fpermissive -fno-strict-aliasing -w
                                      PRIVATE $<$<BOOL:${BVLAB_NATIVE}>:-march=native>)
  target_link_libraries(bvlab_opcode PUBLIC PkgConfig::ode)
endif()
bvlab_peer(FOUND ${found} NAMES opcode opcode-coherent LINK bvlab_opcode MESHES meshes.cpp)
