bvlab_optional(FCL FIND fcl)
bvlab_peer(FOUND ${BVLAB_FCL} MISSED
           NAMES fcl-obb fcl-obbrss fcl-kios fcl-rss fcl-aabb fcl-kdop16 fcl-kdop18 fcl-kdop24 fcl-gjk libccd-gjk
           LINK fcl MESHES meshes.cpp convex.cpp BOXES boxes.cpp WORLDS worlds.cpp TRIANGLES triangles.cpp)
# FCL's types hold Eigen's, which are laid out by the widest register: as in the library that is linked, Debian's for
# any x86-64, one from source as we are. Without registers Eigen's layout is another, and a call of FCL's would crash.
if(BVLAB_FCL)
  target_link_libraries(bvlab_meshes_of_fcl PRIVATE bvlab_closest_features)
  if(NOT BVLAB_PEERS_FROM_SOURCE AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    foreach(source meshes convex boxes worlds)
      set_source_files_properties(${BVLAB_PEER_FOLDER}/${source}.cpp PROPERTIES COMPILE_OPTIONS "-march=x86-64;-UEIGEN_DONT_VECTORIZE")
    endforeach()
  endif()
endif()
