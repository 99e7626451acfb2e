bvlab_optional(BULLET PKG bullet)
bvlab_peer(FOUND ${BVLAB_BULLET} MISSED NAMES bullet LINK PkgConfig::bullet
           MESHES meshes.cpp BOXES boxes.cpp WORLDS worlds.cpp TRIANGLES triangles.cpp)
# A motion by Bullet's own simulation, written as a trace.
if(BVLAB_BULLET)
  add_executable(bvlab_heap EXCLUDE_FROM_ALL ${BVLAB_PEER_FOLDER}/heap.cpp)
  set_target_properties(bvlab_heap PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  target_link_libraries(bvlab_heap PRIVATE bvlab_scenes bvlab_options PkgConfig::bullet)
endif()
