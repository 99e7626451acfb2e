// SPDX-License-Identifier: BSD-3-Clause
/// What the fuzzer calls, and the test that replays its corpus: a reader each, given any bytes at
/// all. A reader may refuse them with Unusable, in one line; what it takes has to hold what it
/// says.
#pragma once

#include <string_view>

namespace bvlab::fuzz {

using Target = void (*)(std::string_view bytes);

void npy(std::string_view bytes);         ///< arrays of every type, of any shape of three axes
void trace(std::string_view bytes);       ///< poses, and posing by them
void boxes(std::string_view bytes);       ///< box traces, float32 or float64
void definition(std::string_view bytes);  ///< experiments, and their cells
void mesh(std::string_view bytes);        ///< the first byte chooses among off, obj, ply and stl
void scene(std::string_view bytes);       ///< the first byte chooses dae, gltf or 3mf

struct Named {
  std::string_view name;  ///< of the folder in the corpus, too
  Target target;
};
inline constexpr Named targets[] = {
    {"npy", npy}, {"trace", trace}, {"boxes", boxes}, {"definition", definition}, {"mesh", mesh},
    {"scene", scene}};

}  // namespace bvlab::fuzz
