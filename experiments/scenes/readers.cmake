# The readers of meshes, below experiments/: part of the program, of the fuzzers and of what is installed.
set(BVLAB_READERS files/guarded.cpp files/whole_file.cpp scenes/parse_3mf.cpp scenes/parse_dae.cpp
                  scenes/parse_gltf.cpp scenes/parse_obj.cpp scenes/parse_off.cpp scenes/parse_ply.cpp
                  scenes/parse_stl.cpp scenes/polygon.cpp scenes/read_mesh.cpp scenes/read_parts.cpp
                  scenes/read_with_assimp.cpp scenes/text_encoding.cpp scenes/unzipped.cpp scenes/xml.cpp)
set(BVLAB_READERS_HEADERS files/guarded.hpp files/numbers.hpp files/unusable.hpp files/whole_file.hpp scenes/mesh_formats.hpp
                          scenes/number_type.hpp scenes/polygon.hpp scenes/read_mesh.hpp scenes/text_encoding.hpp
                          scenes/text_scanner.hpp scenes/unzipped.hpp scenes/xml.hpp)
