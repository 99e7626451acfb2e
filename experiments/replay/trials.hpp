// SPDX-License-Identifier: BSD-3-Clause
/// Which of several configurations answers the frames of a run, as the run finds out by itself.
///
/// One of them answers all frames. Now and then another is tried: it answers the same ten frames
/// (seven, if it takes much longer) beside it, and its answers are dropped. Both are timed, and the
/// one that takes less time goes on. No property of meshes or motions that was tried predicts which
/// one that is, and counts of tests do only with unit costs that hold for one processor. Frames
/// below 200 ns tell nothing.
///
/// Cost. The first trials, with the trees that have to be built for them, take at most a sixth of
/// the run: of its expected time where its length is known, else of the time so far. Where trees
/// have to be built, what trees on demand may have taken until then does not count. They are made
/// in the order of the list. Later trials take at most 1/32 of the time so far; what has not been
/// tried for longest comes first. A run of few frames therefore has no trial.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iomanip>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace bvlab {

class Trials {
 public:
  struct Candidate {
    std::string name;
    double build;          ///< the time that its trees are expected to take
    std::string trees;     ///< others of the same name have the same trees
    double in_frames = 0;  ///< the most that frames spend on making its trees on demand
  };

  /// The first candidate begins. `frames` is the length of the run, 0 where it is not known. All
  /// times are in nanoseconds.
  Trials(std::vector<Candidate> candidates, std::size_t frames) : length_(frames) {
    for (Candidate& each : candidates) states_.push_back({std::move(each)});
    for (State& each : states_)
      if (each.candidate.trees == states_[0].candidate.trees) each.candidate.build = 0;
  }

  /// What making pairs of bodies takes beside their trees.
  void expect_pairs(double took) { making_ = took; }

  std::size_t current() const { return current_; }
  /// What is tried in this frame.
  std::optional<std::size_t> tried() const { return tried_; }
  /// Whether this frame is to be timed.
  bool times() const { return tried_ || frame_ % every == 1; }

  /// Begins a frame. Where a trial begins with it, `made` is to be called.
  void next() { ++frame_; }
  /// What making the trees and pairs of `tried` took. Nothing: it can't be made.
  void made(std::optional<double> took) {
    State& state = states_[*tried_];
    state.is_known = true, state.last = frame_;
    if (took) {
      spend(*took);
      for (State& each : states_)
        if (each.candidate.trees == state.candidate.trees) each.candidate.build = 0;
    } else {
      state.is_possible = false, tried_.reset();
    }
  }
  /// A timed frame took `own`, and what is tried took `other` for it. A trial may begin or end.
  void took(double own, double other) {
    if (!tried_) {
      // The first frame makes trees; one that was interrupted does not stand for those until the
      // next timed one.
      if (frame_ == 1) return;
      const double mean = elapsed_ / static_cast<double>(frame_);
      elapsed_ += every * (frame_ > 1 + every ? std::min(own, 4 * mean) : own);
      return begin_trial(own);
    }
    elapsed_ += own, spend(other);
    own_[timed_] = own, other_[timed_] = other;
    ++timed_;
    const double ratio = median(other_) / median(own_);
    if (timed_ == trial || (timed_ == enough && ratio > hopeless)) end_trial(ratio);
  }

  /// The time that was spent on trials.
  double spent() const { return first_spent_ + later_spent_; }
  /// What answered how many frames, and what the others took, in a sentence.
  std::string reason() const {
    std::ostringstream text;
    text << std::setprecision(3) << states_[current_].candidate.name;
    if (switched_at_ > 0) text << " since frame " << switched_at_;
    const char* before = "; in trials of 10 frames, times beside it: ";
    for (const State& state : states_)
      if (&state != &states_[current_] && state.is_known && state.base > 0) {
        text << before << state.candidate.name << ' ' << state.own / state.base;
        before = ", ";
      }
    if (before[0] == ';') text << ": the run is too short for trials";
    return text.str();
  }

 private:
  /// Frames of a trial, of which the first are not counted: they write fronts. A frame of so many
  /// is timed where nothing is tried.
  static constexpr std::size_t trial = 10, uncounted = 4, enough = 7, every = 8;
  /// A trial ends after `enough` frames if the candidate takes more than `hopeless` times as long;
  /// to go on, it must take less than `better` times as long.
  static constexpr double hopeless = 1.3, better = 0.97, shortest = 200;
  static constexpr double first_share = 6, later_share = 32;

  struct State {
    Candidate candidate;
    bool is_possible = true, is_known = false;
    double own = 0,
           base = 0;  ///< times in trials, and of the current one beside it; later ones count more
    std::size_t last = 0;  ///< the frame of the last trial
  };

  void spend(double time) { (is_first_ ? first_spent_ : later_spent_) += time; }

  void begin_trial(double frame) {
    const auto price_of = [&](const State& state) {
      return state.candidate.build + making_ +
             trial * frame * (state.base > 0 ? state.own / state.base : 1);
    };
    State* best = nullptr;
    for (State& state : states_) {
      if (&state == &states_[current_] || !state.is_possible) continue;
      const double price = price_of(state);
      // What made trees on demand until now is no sign of what later frames take.
      const double frames = state.candidate.build > 0
                                ? std::max(0.0, elapsed_ - states_[0].candidate.in_frames)
                                : elapsed_;
      const double later = length_ > frame_ ? static_cast<double>(length_ - frame_) : 0;
      const double left = length_ ? frames / static_cast<double>(frame_ - 1) * later : frames;
      const double run = length_ ? elapsed_ + left : frames;
      const bool may_pay = first_share * price <= left;
      if (!may_pay) continue;
      if (!state.is_known) {
        if (first_share * (first_spent_ + price) > run) continue;
        best = &state;
        break;
      }
      if (!best || state.last < best->last) best = &state;
    }
    if (!best) return;
    // Of those that are known, not the next one that is cheap enough, or dear ones would wait for
    // ever.
    if (best->is_known && later_share * (later_spent_ + price_of(*best)) > elapsed_) return;
    tried_ = static_cast<std::size_t>(best - states_.data());
    is_first_ = !best->is_known;
    timed_ = 0;
  }
  void end_trial(double ratio) {
    State& state = states_[*tried_];
    const double base = median(own_);
    tried_.reset();
    if (base < shortest) return;
    state.own = state.own / 2 + base * ratio, state.base = state.base / 2 + base;
    const double settled = state.own / state.base;
    if (settled < better) {
      for (State& other : states_) other.base *= settled;
      State& beaten = states_[current_];
      beaten.own = beaten.base = base, beaten.base *= settled;
      beaten.is_known = true, beaten.last = frame_;
      current_ = static_cast<std::size_t>(&state - states_.data()), switched_at_ = frame_;
    }
  }
  /// Of the counted frames.
  double median(const std::array<double, trial>& times) const {
    if (timed_ <= uncounted) return 1;
    std::array<double, trial> counted;
    const auto end =
        std::copy(times.begin() + uncounted, times.begin() + static_cast<std::ptrdiff_t>(timed_),
                  counted.begin());
    const auto middle = counted.begin() + (end - counted.begin()) / 2;
    std::nth_element(counted.begin(), middle, end);
    return *middle;
  }

  std::vector<State> states_;
  std::size_t length_, frame_ = 0, current_ = 0, timed_ = 0, switched_at_ = 0;
  std::optional<std::size_t> tried_;
  bool is_first_ = false;
  double making_ = 0;
  double elapsed_ = 0 /* since the first frame */, first_spent_ = 0, later_spent_ = 0;
  std::array<double, trial> own_{}, other_{};
};

}  // namespace bvlab
