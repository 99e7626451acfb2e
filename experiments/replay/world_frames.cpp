// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/world_frames.hpp"

#include <algorithm>
#include <chrono>

namespace bvlab {
namespace {

struct Move {
  std::uint32_t object;
  Pose pose;
};

/// The bodies whose rows differ from the frame before; all of them in frame 0.
void find_moves(const Trace& trace, std::size_t frame, std::vector<Move>& moves) {
  moves.clear();
  constexpr std::size_t row = 7;
  const std::size_t size = trace.objects * row;
  for (std::size_t i = 0; i < trace.objects; ++i) {
    const double* now = trace.values.data() + frame * size + i * row;
    if (frame > 0 && std::equal(now, now + row, now - size)) continue;
    moves.push_back({static_cast<std::uint32_t>(i),
                     *pose_from({now[0], now[1], now[2]}, now[3], now[4], now[5], now[6])});
  }
}

bool before(const ObjectPair& a, const ObjectPair& b) { return a.i != b.i ? a.i < b.i : a.j < b.j; }

}  // namespace

WorldRun play_frames(WorldEngine& world, const Trace& trace, Answers answers) {
  using Clock = std::chrono::steady_clock;
  WorldRun run;
  std::vector<Move> moves;
  for (std::size_t frame = 0; frame < trace.frames; ++frame) {
    find_moves(trace, frame, moves);
    const auto start = Clock::now();
    for (const auto& [object, pose] : moves) world.move(object, pose);
    world.update();
    const auto touching = world.touching();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (answers == Answers::kept) {
      run.answers.emplace_back(touching.begin(), touching.end());
      std::sort(run.answers.back().begin(), run.answers.back().end(), before);
    }
    if (frame == 0) {
      run.first_seconds = seconds;
      continue;
    }
    run.seconds += seconds;
    run.near += world.near(), run.queried += world.queried();
    run.touching += touching.size(), run.moved += moves.size();
  }
  return run;
}

std::size_t differing(const WorldRun& run, const WorldRun& reference) {
  std::size_t count = 0;
  for (std::size_t frame = 0; frame < reference.answers.size(); ++frame) {
    const auto &a = run.answers[frame], &b = reference.answers[frame];
    std::vector<ObjectPair> difference;
    std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(),
                                  std::back_inserter(difference), before);
    count += difference.size();
  }
  return count;
}

}  // namespace bvlab
