// SPDX-License-Identifier: BSD-3-Clause
/// THE list of public scenes, `public:NAME`: meshes and motions that nobody here made, out of
/// public repositories at a fixed commit. A further one is an entry of the list, and its files'
/// SHA-256.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/scenes/public/motions.hpp"

namespace bvlab {

struct PublicSceneName {
  std::string name, description;
};
std::vector<PublicSceneName> public_scenes();

/// Whether a name is of that form.
bool is_public_scene(std::string_view scene);
/// Whether it is one of boxes.
bool is_public_box_scene(const std::string& scene);

/// Throws Unusable with the names there are where there is none of that name.
void require_public_scene(const std::string& scene);

/// `from` is a clone, "git", or empty for files that were kept: see public_files.hpp. Throws
/// Unusable where they are absent.
PublicMotion public_motion(const std::string& scene, const std::string& from,
                           const MotionRequest& request);
Array<float> public_boxes(const std::string& scene, const std::string& from, std::size_t frames);

}  // namespace bvlab
