# Of no distribution: where CMAKE_PREFIX_PATH names an installation, compiled for the same processor as we are, since
# its types hold Eigen's. Without vector registers Eigen's layout is another.
set(BVLAB_COAL OFF)
if(NOT BVLAB_ONE_LANE)
  bvlab_optional(COAL FIND coal)
endif()
bvlab_peer(FOUND ${BVLAB_COAL} NAMES coal-obb coal-obbrss coal-rss LINK coal::coal MESHES meshes.cpp)
