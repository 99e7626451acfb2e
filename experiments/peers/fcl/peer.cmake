bvlab_optional(FCL FIND fcl)
bvlab_peer(FOUND ${BVLAB_FCL} MISSED
           NAMES fcl-obb fcl-obbrss fcl-kios fcl-rss fcl-aabb fcl-kdop16 fcl-kdop18 fcl-kdop24 fcl-gjk libccd-gjk
           LINK fcl MESHES meshes.cpp convex.cpp BOXES boxes.cpp WORLDS worlds.cpp TRIANGLES triangles.cpp)
# FCL's types hold Eigen's, which are laid out by the widest register: as in the library that is linked, Debian's for
# any x86-64, one from source as it was compiled. Otherwise a call of FCL's would crash.
if(BVLAB_FCL)
  target_link_libraries(bvlab_meshes_of_fcl PRIVATE bvlab_closest_features)
  set(alike -UEIGEN_DONT_VECTORIZE)
  if(BVLAB_PEERS_FROM_SOURCE)
    string(REGEX MATCH "-march=[^ ]+" theirs "${BVLAB_PEERS_FLAGS}")
    string(REGEX MATCH "-march=[^ ]+" ours "${CMAKE_CXX_FLAGS}")
    if(BVLAB_NATIVE)
      set(ours -march=native)
    endif()
    if(NOT "${theirs}" STREQUAL "${ours}")
      message(FATAL_ERROR "BVLAB_PEERS: FCL was compiled with '${theirs}', this build is with '${ours}', and Eigen's types "
                          "differ: leave it out by -DBVLAB_WITHOUT=fcl, or make it again with '${ours}'")
    endif()
  elseif(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    list(PREPEND alike -march=x86-64)
  endif()
  foreach(source meshes convex boxes worlds)
    set_source_files_properties(${BVLAB_PEER_FOLDER}/${source}.cpp PROPERTIES COMPILE_OPTIONS "${alike}")
  endforeach()
endif()
