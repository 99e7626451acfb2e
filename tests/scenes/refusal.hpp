// SPDX-License-Identifier: BSD-3-Clause
/// How the readers of meshes refuse bytes.
#pragma once

#include <string>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/read_mesh.hpp"

namespace bvlab {

/// The line by which a mesh of this file name is refused; empty where it is read.
inline std::string refusal(const std::string& bytes, const std::string& name) {
  try {
    parse_mesh(bytes, name);
    return "";
  } catch (const Unusable& error) {
    return error.what();
  }
}

}  // namespace bvlab
