# Of no distribution: where CMAKE_PREFIX_PATH names an installation, compiled for the same processor as we are, since
# its types hold Eigen's.
bvlab_optional(COAL FIND coal)
bvlab_peer(FOUND ${BVLAB_COAL} NAMES coal-obb coal-obbrss coal-rss LINK coal::coal MESHES meshes.cpp)
