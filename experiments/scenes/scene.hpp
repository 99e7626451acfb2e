// SPDX-License-Identifier: BSD-3-Clause
/// A scene: bodies and how they move, frame by frame, as a trace. A scene is a struct whose members
/// are its options; it names them once, for the command line and for definitions alike.
///
/// A further scene is one header that satisfies `Scene` and one line in scenes.hpp.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "experiments/files/npy.hpp"
#include "experiments/scenes/extent.hpp"
#include "experiments/scenes/length.hpp"
#include "hierarchies/geometry/pose.hpp"

namespace bvlab {

/// Does this object's surface share a point with any other's, all standing as in `poses`? What
/// answers it is above the scenes: the caller brings it.
using TouchesAny = std::function<bool(std::size_t object, std::span<const Pose> poses)>;

namespace detail {
/// Something that can be shown any option.
struct AnyOption {
  template <class T>
  void operator()(std::string_view /*name*/, T& /*value*/, std::string_view /*meaning*/) const {}
};
}  // namespace detail

/// Options are std::size_t, std::uint64_t, double, std::string or Length.
template <class S>
concept Scene = std::default_initializable<S> &&
    requires(S scene, const S fixed, std::span<const Extent> meshes, const TouchesAny& touches) {
  { S::name } -> std::convertible_to<std::string_view>;
  { S::description } -> std::convertible_to<std::string_view>;
  /// Calls its argument as (name, value, meaning) for each option, in order.
  scene.visit_options(detail::AnyOption{});
  /// The motion, of shape (frames, objects, 7); object i is mesh i mod (number of meshes).
  /// Depends on the options and the extents alone. Throws Unusable, naming the option that is.
  { fixed.generate(meshes, touches) } -> std::same_as<Array<double>>;
};

/// A scene that has its own meshes, one for each body, and takes no others. It does not ask what
/// touches.
template <class S>
concept HasOwnMeshes = requires(const S& scene) { scene.own_meshes(); };

}  // namespace bvlab
