// SPDX-License-Identifier: BSD-3-Clause
/// The frame in which two volumes are tested.
#pragma once

#include <cstdint>
#include <string_view>

namespace bvlab {

/// world: all bodies are posed into one frame. A volume is posed when it is first needed, at most
/// once between two moves of its body, and serves all pairs. body: nothing is kept. Whenever two
/// volumes are tested, that of the first body is posed into the frame of the second, whose volumes
/// are used as stored. So the gathered kernel has N_u = N_v in a body's frame; wide kernels pose
/// one volume, or four, for all tests of a step. In the world frame the gathered kernel has N_u <=
/// 2 F N_v, with F the fan-out, since siblings are posed together; it is far less where volumes
/// serve many pairs. Wide kernels pose there what a step tests: a volume by itself, in a row and in
/// a block is posed three times. Pairs of which a
/// body is too far from the scene's origin for float (MovingBody::is_far) are tested as in a body's
/// frame.
enum class Frame : std::uint8_t { world, body };

constexpr std::string_view name_of(Frame frame) { return frame == Frame::world ? "world" : "body"; }

}  // namespace bvlab
