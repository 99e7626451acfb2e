// SPDX-License-Identifier: BSD-3-Clause
/// Boxes in float against double: the same boxes, so far from the origin, given to a method in
/// double (the truth), rounded to the nearest float, and rounded outward (which misses no pair).
/// Pairs too many and too few, and time.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "experiments/files/unusable.hpp"
#include "experiments/replay/box_methods.hpp"
#include "experiments/replay/method_names.hpp"
#include "experiments/scenes/boxes.hpp"
#include "experiments/studies/study.hpp"

namespace bvlab {
namespace {

template <class T>
using Frames = std::vector<std::vector<Box<T>>>;
using PairSets = std::vector<std::vector<Pair>>;

struct Settings {
  std::vector<std::string> methods, sets;
  std::vector<double> offsets;
  std::size_t boxes, frames;
  unsigned seed;
};

StudyParameters parameters() {
  return {
      words_parameter("methods", {"blocks", "sort-and-sweep"}, "that are compared", method_names()),
      words_parameter("sets", {"random", "adjacent"}, "of boxes", box_set_names()),
      numbers_parameter("offsets", {0, 1e2, 1e4, 1e6}, {}, "of all boxes from the origin"),
      whole_parameter("boxes", 10000, {1, 1e7}, "boxes"),
      whole_parameter("frames", 5, {1, 1e6}, "frames, the start included"),
      whole_parameter("seed", 1, seeds, "of the random numbers")};
}

Settings settings_of(const StudyDefinition& definition) {
  return {definition.words("methods"),   definition.words("sets"),
          definition.numbers("offsets"), definition.whole("boxes"),
          definition.whole("frames"),    static_cast<unsigned>(definition.whole("seed"))};
}

/// The set drifting, each corner with digits that no float has, all moved by `offset`.
Frames<double> frames_of(const Settings& settings, const std::string& set, double offset) {
  BoxMotion motion("drift", 0.02, set, make_box_set(set, settings.boxes, settings.seed),
                   settings.seed);
  std::mt19937_64 random(settings.seed);
  std::uniform_real_distribution<double> digits(0, 0x1p-26);
  Frames<double> frames;
  for (std::size_t frame = 0; frame < settings.frames; ++frame) {
    auto& boxes = frames.emplace_back();
    for (const auto& box : motion.boxes()) {
      auto& wide = boxes.emplace_back();
      for (int axis = 0; axis < 3; ++axis) {
        const double lo = box.lo[axis], hi = box.hi[axis];
        wide.lo[axis] = lo * (1 + digits(random)) + offset;
        wide.hi[axis] = std::max(hi * (1 + digits(random)) + offset, wide.lo[axis]);
      }
    }
    motion.step();
  }
  return frames;
}

enum class Rounding { nearest, outward };

Frames<float> rounded_frames(const Frames<double>& frames, Rounding rounding) {
  Frames<float> result;
  for (const auto& boxes : frames) {
    auto& some = result.emplace_back();
    for (const auto& box : boxes) {
      auto& narrow = some.emplace_back();
      for (int axis = 0; axis < 3; ++axis) {
        narrow.lo[axis] = static_cast<float>(box.lo[axis]);
        narrow.hi[axis] = static_cast<float>(box.hi[axis]);
        if (rounding == Rounding::nearest) continue;
        if (static_cast<double>(narrow.lo[axis]) > box.lo[axis])
          narrow.lo[axis] = std::nextafter(narrow.lo[axis], -INFINITY);
        if (static_cast<double>(narrow.hi[axis]) < box.hi[axis])
          narrow.hi[axis] = std::nextafter(narrow.hi[axis], INFINITY);
      }
    }
  }
  return result;
}

double processor_ns() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

template <class T>
struct Played {
  PairSets pairs;
  double ns = 0;  ///< of all frames but the first

  Played(const std::string& name, const Frames<T>& frames) {
    const auto method = make_method<T>(name, {});
    for (const auto& boxes : frames) {
      const double start = processor_ns();
      const auto found = method->overlapping(boxes);
      if (!pairs.empty()) ns += processor_ns() - start;
      pairs.emplace_back(found.begin(), found.end());
    }
    for (auto& set : pairs) std::sort(set.begin(), set.end());
  }
};

/// Pairs of `a` that `b` has not.
std::size_t beyond(const PairSets& a, const PairSets& b) {
  std::size_t count = 0;
  for (std::size_t frame = 0; frame < a.size(); ++frame) {
    std::vector<Pair> difference;
    std::set_difference(a[frame].begin(), a[frame].end(), b[frame].begin(), b[frame].end(),
                        std::back_inserter(difference));
    count += difference.size();
  }
  return count;
}

std::size_t size_of(const PairSets& sets) {
  std::size_t count = 0;
  for (const auto& set : sets) count += set.size();
  return count;
}

void run(const StudyDefinition& definition, const std::filesystem::path& folder,
         const Progress& progress) {
  const Settings settings = settings_of(definition);
  StudyRecord record(definition, folder,
                     {"set", "offset", "method", "numbers", "repetition", "boxes", "frames",
                      "pairs", "false_positives", "false_negatives", "ns_per_frame"},
                     2, progress);
  const std::size_t all = settings.sets.size() * settings.offsets.size();
  std::size_t done = 0;
  for (const auto& set : settings.sets)
    for (const double offset : settings.offsets) {
      if (record.has({set, text_of(offset)})) {
        record.save(++done, all);
        continue;
      }
      const Frames<double> frames = frames_of(settings, set, offset);
      const Frames<float> nearest = rounded_frames(frames, Rounding::nearest),
                          outward = rounded_frames(frames, Rounding::outward);
      const PairSets truth = Played<double>("brute-force", frames).pairs;
      const auto add = [&](const std::string& method, const char* numbers, unsigned repetition,
                           const auto& played) {
        record.add({set, text_of(offset), method, numbers, std::to_string(repetition),
                    std::to_string(frames[0].size()), std::to_string(frames.size()),
                    std::to_string(size_of(truth)), std::to_string(beyond(played.pairs, truth)),
                    std::to_string(beyond(truth, played.pairs)),
                    text_of(std::round(played.ns / static_cast<double>(std::max<std::size_t>(
                                                       frames.size() - 1, 1))))});
      };
      for (unsigned repetition = 0; repetition < definition.repetitions; ++repetition)
        for (const auto& method : settings.methods) {
          add(method, "double", repetition, Played<double>(method, frames));
          add(method, "float, nearest", repetition, Played<float>(method, nearest));
          add(method, "float, outward", repetition, Played<float>(method, outward));
        }
      record.save(++done, all);
    }
}

}  // namespace

const StudyKind studies::box_precision = {
    "box-precision", "boxes in float against double: pairs too many, too few, and time", parameters,
    nullptr, run};

}  // namespace bvlab
