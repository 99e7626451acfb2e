# Found by experiments/CMakeLists.txt: it also makes meshes, and is the oracle.
if(BVLAB_TBB)
  set(boxes BOXES boxes.cpp)
  set(threads TBB::tbb)
endif()
bvlab_peer(FOUND ${BVLAB_CGAL} MISSED NAMES cgal LINK CGAL::CGAL ${threads}
           MESHES meshes.cpp ${boxes} TRIANGLES triangles.cpp)
