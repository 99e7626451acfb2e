bvlab_optional(BULLET PKG bullet)
bvlab_peer(FOUND ${BVLAB_BULLET} MISSED NAMES bullet LINK PkgConfig::bullet
           MESHES meshes.cpp BOXES boxes.cpp WORLDS worlds.cpp TRIANGLES triangles.cpp)
