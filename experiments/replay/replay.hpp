// SPDX-License-Identifier: BSD-3-Clause
/// A trace played through one variant of the engine: volume, strategy, query.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/scenes/trace.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"
#include "traversal/frame.hpp"
#include "traversal/front.hpp"
#include "traversal/nearest_points.hpp"

namespace bvlab {

enum class Count { off, on };

struct Variant {
  std::string volume = "sphere";
  std::string strategy = "recursive";  ///< a name, or name:parameter
  std::string query = "touching";
  std::string build = "top-down-principal";
  std::uint32_t leaf_size = 1;
  std::string fit = "published";  ///< or "tight", see bounding_volume.hpp
  std::string precision = "exact";
  double relative_error = 0;        ///< of distances
  std::uint32_t fan_out = 2;        ///< children per node, at most: 2, 4, 8 or 16
  std::string frame = "world";      ///< or "body", see traversal/frame.hpp
  std::string kernel = "gathered";  ///< or "siblings", "mixed": see kernels() in registry.hpp
  /// What it says of trees, strategy and kernel is what a run begins with; it may go on with
  /// another of the candidates that are recommended (configurations.hpp, trials.hpp).
  bool chooses_in_turn = false;
};

/// The frame of a variant whose names have been checked.
inline Frame frame_of(const Variant& variant) {
  return variant.frame == name_of(Frame::body) ? Frame::body : Frame::world;
}

/// Sets a kernel, and the fan-out and frame with which it is fastest.
void set_kernel(Variant& variant, std::string_view kernel);

/// Sets what an older definition says by `tree`: "binary" or "wide". Says whether it is one of
/// them.
bool set_tree(Variant& variant, std::string_view tree);

/// Whether a broad phase finds the pairs whose boxes overlap, and only these are queried, or every
/// pair is. Where it pays: with many more pairs than bodies, and nothing counted.
enum class BroadPhase : std::uint8_t { off, on, where_it_pays };

/// "off", "on" or "auto"; throws Unusable for another name.
BroadPhase broad_phase_from(std::string_view name);

/// Whether a trace has so many more pairs than bodies that a broad phase pays.
inline bool has_many_pairs(const Trace& trace) { return trace.pairs() >= 16 * trace.objects; }

struct ReplayOptions {
  Count count = Count::off;
  unsigned threads = 1;
  BroadPhase broad_phase = BroadPhase::off;
  bool keep_answers = true;         ///< fill `touching`, `contacts` or `distances`
  bool keep_nearest = false;        ///< fill `nearest`, where the query is for distances
  bool keep_series = false;         ///< fill `series`
  bool keep_frame_seconds = false;  ///< fill `frame_seconds`: a reading of the clock in each frame
  /// Called after every frame, for every pair, with what the strategy keeps of it, if it does.
  std::function<void(std::size_t frame, std::size_t pair, std::span<const NodePair>)> see_front;
  /// Called after every frame; what it throws ends the replay.
  std::function<void(std::size_t frame)> after_frame;
};

/// Counts of one frame, all pairs together.
struct FrameCounts {
  std::uint64_t n_u = 0, n_v = 0, n_p = 0, front = 0, hits = 0;
};

struct ReplayResult {
  double seconds = 0;        ///< posing and querying every frame
  double first_seconds = 0;  ///< the first frame alone
  double build_seconds = 0;  ///< of whole trees; what is built on demand is in `seconds`
  /// Where the variant chooses in turn: what was chosen and why; what trying others took.
  std::optional<std::string> chosen;
  double choosing_seconds = 0;
  /// Of all trees, those of kernel `siblings`, and how many of them have been made.
  std::size_t nodes = 0, nodes_made = 0;
  std::uint64_t n_b = 0, n_u = 0, n_v = 0, n_p = 0;  ///< where counted
  std::uint64_t considered = 0;  ///< pairs, over all frames, for which anything was tested
  /// Pairs whose boxes overlap, over all frames; nothing where no broad phase was used.
  std::optional<std::uint64_t> near;
  double front = 0;                    ///< mean entries per pair and frame
  std::uint64_t hits = 0;              ///< touching pairs, or contacts, over all frames
  std::vector<std::uint8_t> touching;  ///< (frames, pairs)
  std::vector<double> distances;       ///< (frames, pairs)
  std::vector<NearestPair> nearest;    ///< (frames, pairs), where asked for
  std::vector<std::array<std::uint32_t, 5>> contacts;  ///< frame, i, j, triangle of i, of j; sorted
  std::vector<FrameCounts> series;                     ///< one for each frame
  std::vector<double> frame_seconds;  ///< of each frame, where asked for; of threads the longest
};

/// Which vector of a result has the answers of a query.
enum class AnswerKind { yes_or_no, number, contacts };
/// By what is filled; by name where nothing is, as in a trace without frames.
inline AnswerKind kind_of_answers(const ReplayResult& result, std::string_view query) {
  if (!result.touching.empty() || query == "touching") return AnswerKind::yes_or_no;
  if (!result.distances.empty() || query == "distance") return AnswerKind::number;
  return AnswerKind::contacts;
}

/// Object i uses mesh i mod meshes.size(). Throws Unusable for unknown names.
ReplayResult replay(std::span<const TriangleMesh> meshes, const Trace& trace,
                    const Variant& variant, const ReplayOptions& options);

/// Throws Unusable with the names that exist where the variant names something unknown.
void check(const Variant& variant);

}  // namespace bvlab
