// SPDX-License-Identifier: BSD-3-Clause
/// A motion trace: the pose of every object of a scene, frame by frame, and which pairs of objects
/// are queried.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hierarchies/geometry/pose.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"
#include "traversal/shape.hpp"

namespace bvlab {

/// A scene's poses, frame by frame: x y z qw qx qy qz for each object.
struct Trace {
  std::size_t frames = 0, objects = 0;
  std::vector<double> values;  ///< C order, shape (frames, objects, 7)
  /// The pairs that are asked about, in the order of all answers; null: all of them.
  std::shared_ptr<const std::vector<ObjectPair>> chosen = nullptr;

  std::size_t pairs() const {
    if (chosen) return chosen->size();
    return objects > 0 ? objects * (objects - 1) / 2 : 0;
  }

  /// The poses of one frame into `poses`, which has one entry for each object.
  void poses(std::size_t frame, std::span<Pose> poses) const;
};

/// The pairs that are asked about, in the order of all answers.
std::vector<ObjectPair> object_pairs(const Trace& trace);

/// A trace of these frames alone, in their order.
Trace part_of(const Trace& trace, std::span<const std::size_t> frames);

/// A trace's poses, frame by frame. Who stands where it stood in the frame asked for before is not
/// posed again: that is the work of no engine that is timed.
class PosesInTurn {
 public:
  /// The trace must outlive this.
  explicit PosesInTurn(const Trace& trace) : trace_(trace), poses_(trace.objects) {}

  /// Of one frame, one for each object: valid until the next call.
  std::span<const Pose> at(std::size_t frame);

 private:
  const Trace& trace_;
  std::vector<Pose> poses_;
  std::optional<std::size_t> frame_;
};

/// Refuses what is not a trace: shape, NaN, infinity, zero quaternions, more frames or objects than
/// 32 bits number.
Trace read_trace(const std::string& path);

/// The same from bytes in memory; messages name the file by `name`.
Trace parse_trace(std::string_view bytes, const std::string& name);

/// Refuses a trace by which a corner of a triangle does not stand in float64: where it overflows.
/// Object i uses mesh i mod their number; `name` is the trace's, for the message. O(frames objects)
/// unless numbers are near the largest there are.
void require_finite_corners(const Trace& trace, const std::string& name,
                            std::span<const TriangleMesh> meshes);

}  // namespace bvlab
