bvlab_optional(EMBREE FIND embree 3)
bvlab_peer(FOUND ${BVLAB_EMBREE} MISSED NAMES embree LINK embree MESHES meshes.cpp BOXES boxes.cpp)
