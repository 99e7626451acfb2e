# Of no distribution: where CMAKE_PREFIX_PATH names an installation.
bvlab_optional(BOX3D FIND box3d)
bvlab_peer(FOUND ${BVLAB_BOX3D} LINK box3d::box3d BOXES boxes.cpp)
