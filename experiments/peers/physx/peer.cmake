# An installation of PhysX 5: include/ and lib/ with its static libraries (release). It is never downloaded or built
# from here.
set(BVLAB_PHYSX "" CACHE PATH "An installation of PhysX 5: include/ and static libraries in lib/")
set(found OFF)
if(BVLAB_PHYSX)
  file(GLOB libraries ${BVLAB_PHYSX}/lib/*.a)
  if(NOT libraries OR NOT EXISTS ${BVLAB_PHYSX}/include/PxBroadPhase.h)
    message(FATAL_ERROR "BVLAB_PHYSX: ${BVLAB_PHYSX} has no include/PxBroadPhase.h or no lib/*.a")
  endif()
  set(found ON)
  file(STRINGS ${BVLAB_PHYSX}/include/foundation/PxPhysicsVersion.h version REGEX "define PX_PHYSICS_VERSION_(MAJOR|MINOR|BUGFIX) ")
  string(REGEX REPLACE "[^0-9;]*([0-9]+)[^;]*" "\\1" version "${version}")
  string(JOIN "." version ${version})
  string(APPEND BVLAB_LIBRARIES ", PhysX ${version} (from source)")
  add_library(bvlab_physx INTERFACE)
  target_include_directories(bvlab_physx SYSTEM INTERFACE ${BVLAB_PHYSX}/include)
  target_compile_definitions(bvlab_physx INTERFACE PX_PHYSX_STATIC_LIB DISABLE_CUDA_PHYSX $<$<CONFIG:Debug>:_DEBUG>)
  # Its parts name each other; those that nobody calls may name what is not there.
  target_link_libraries(bvlab_physx INTERFACE -Wl,--start-group ${libraries} -Wl,--end-group -Wl,--gc-sections
                                              pthread ${CMAKE_DL_LIBS})
endif()
bvlab_peer(FOUND ${found} NAMES physx LINK bvlab_physx MESHES meshes.cpp BOXES boxes.cpp)
