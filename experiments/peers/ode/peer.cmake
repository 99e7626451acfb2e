bvlab_optional(ODE PKG ode)
bvlab_peer(FOUND ${BVLAB_ODE} MISSED NAMES ode LINK PkgConfig::ode
           MESHES meshes.cpp BOXES boxes.cpp TRIANGLES triangles.cpp)
