// SPDX-License-Identifier: BSD-3-Clause
/// Broad-phase methods and peers on the built-in sets, interleaved: for every set, number and
/// motion all variants run the same frames, in an order drawn anew for each repetition, and every
/// frame's pair set is compared by count and by a sum of hashes. A definition says which; the
/// record gets one row per (variant, set, motion, seed, repetition). Times are of this process's
/// processor time, which neighbours on the machine disturb less, beside those of the wall clock.
///
///     boxes_benchmark DEFINITION.toml [--record DIR]
#include "experiments/scenes/boxes.hpp"

#include <sys/resource.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>
#include <sstream>

#include "broadphase/settings.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/peers/boxes_peers.hpp"
#include "experiments/runner/box_methods.hpp"
#include "experiments/runner/record.hpp"

namespace bvlab {
namespace {

struct Case {
  std::string set, motion;
  std::size_t count;
  double displacement;
};
struct Variant {
  std::string method, coherent;
  bool slow = false;  ///< one frame took longer than the definition allows: not run on more boxes
};
struct Answer {
  std::uint64_t pairs = 0, hash = 0;
  bool operator==(const Answer&) const = default;
};
struct Outcome {
  std::vector<Answer> answers;
  double first_ns = 0, frame_ns = 0, wall_ns = 0;
};

double processor_ns() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}
double wall_ns() {
  return std::chrono::duration<double, std::nano>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

/// The same for the same set of pairs in any order.
Answer answer_of(std::span<const Pair> pairs) {
  Answer answer{pairs.size(), 0};
  for (const Pair& pair : pairs) {
    std::uint64_t x = (std::uint64_t{pair.i} << 32 | pair.j) * 0x9e3779b97f4a7c15u;
    x ^= x >> 29;
    answer.hash += x * 0xbf58476d1ce4e5b9u;
  }
  return answer;
}

/// A method of ours or a peer, through the same call.
class Player {
 public:
  Player(const Variant& variant, int threads) {
    if ((peer_ = make_box_peer(variant.method))) return;
    MethodSettings settings;
    settings.coherence = variant.coherent == "on" ? Coherence::on : Coherence::off;
    settings.threads = threads;
    method_ = make_method<float>(variant.method, settings);
  }
  std::span<const Pair> overlapping(Boxes<float> boxes) {
    return peer_ ? peer_->overlapping(boxes) : method_->overlapping(boxes);
  }

 private:
  std::unique_ptr<BoxPeer> peer_;
  std::unique_ptr<AnyMethod<float>> method_;
};

class Benchmark {
 public:
  explicit Benchmark(const toml::table& definition) : definition_(definition) {
    frames_ = definition["frames"].value_or(10);
    repetitions_ = definition["repetitions"].value_or(3);
    seed_ = definition["seed"].value_or(1);
    limit_ns_ = 1e9 * definition["seconds_a_frame"].value_or(1.0);
    for (const auto& name : strings("methods"))
      for (const auto& coherent : strings("coherent")) variants_.push_back({name, coherent});
    for (const auto& name : strings("peers")) variants_.push_back({name, "on"});
  }

  void run(Table& table) {
    for (const auto& set : strings("sets")) {
      for (auto& variant : variants_) variant.slow = false;
      for (const double count : numbers("counts"))
        for (const auto& motion : strings("motions"))
          for (const double displacement : numbers("displacements"))
            run_case({set, motion, static_cast<std::size_t>(count), displacement}, table);
    }
  }

 private:
  std::vector<std::string> strings(const char* key) const {
    std::vector<std::string> all;
    if (const auto* array = definition_[key].as_array())
      for (const auto& value : *array) all.push_back(value.value_or(std::string()));
    return all;
  }
  std::vector<double> numbers(const char* key) const {
    std::vector<double> all;
    if (const auto* array = definition_[key].as_array())
      for (const auto& value : *array) all.push_back(value.value_or(0.0));
    return all;
  }

  void run_case(const Case& c, Table& table) {
    const double largest = definition_["largest"][c.set].value_or(1e9);
    if (static_cast<double>(c.count) > largest) return;
    std::vector<std::vector<Box<float>>> frames;
    BoxMotion motion(c.motion, c.displacement, c.set,
                     make_box_set(c.set, c.count, static_cast<unsigned>(seed_)),
                     static_cast<unsigned>(seed_));
    for (int f = 0; f < frames_; ++f, motion.step()) frames.push_back(motion.boxes());
    std::vector<Answer> reference;
    std::mt19937 random(static_cast<unsigned>(seed_) + 77);
    for (int repetition = 0; repetition < repetitions_; ++repetition) {
      std::vector<std::size_t> order(variants_.size());
      for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
      // The reference, an independent one, is the first variant of the first repetition.
      std::shuffle(order.begin(), order.end(), random);
      if (repetition == 0)
        std::swap(*std::find(order.begin(), order.end(), reference_index()), order[0]);
      for (const std::size_t k : order) {
        if (variants_[k].slow) continue;
        const Outcome outcome = play(variants_[k], frames);
        if (reference.empty()) reference = outcome.answers;
        add_row(c, k, repetition, frames, outcome, reference, table);
      }
    }
    table.save();
    std::fprintf(stderr, "%s %zu %s %g done\n", c.set.c_str(), c.count, c.motion.c_str(),
                 c.displacement);
  }
  std::size_t reference_index() const {
    const auto name = definition_["reference"].value_or(std::string("cgal-1000"));
    for (std::size_t k = 0; k < variants_.size(); ++k)
      if (variants_[k].method == name) return k;
    throw Unusable("reference " + name + ": not among the methods and peers");
  }

  Outcome play(Variant& variant, const std::vector<std::vector<Box<float>>>& frames) const {
    Outcome outcome;
    std::vector<double> later, wall;
    Player player(variant, 1);
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const double start = processor_ns(), start_wall = wall_ns();
      const auto pairs = player.overlapping(frames[f]);
      const double ns = processor_ns() - start, took = wall_ns() - start_wall;
      outcome.answers.push_back(answer_of(pairs));
      if (f == 0)
        outcome.first_ns = ns;
      else
        later.push_back(ns), wall.push_back(took);
      variant.slow |= ns > limit_ns_;
      if (ns > limit_ns_ && f > 0) break;
    }
    outcome.frame_ns = median(later);
    outcome.wall_ns = median(wall);
    return outcome;
  }

  void add_row(const Case& c, std::size_t k, int repetition,
               const std::vector<std::vector<Box<float>>>& frames, const Outcome& outcome,
               const std::vector<Answer>& reference, Table& table) const {
    std::size_t differing = 0;
    for (std::size_t f = 0; f < outcome.answers.size(); ++f)
      differing += outcome.answers[f] != reference[std::min(f, reference.size() - 1)];
    const auto number = [](double value) {
      std::ostringstream text;
      text.precision(9);
      text << value;
      return text.str();
    };
    table.add({c.set, std::to_string(frames[0].size()), c.motion, number(c.displacement),
               variants_[k].method, variants_[k].coherent, std::to_string(seed_),
               std::to_string(repetition), std::to_string(outcome.answers.size()),
               std::to_string(outcome.answers.back().pairs), std::to_string(differing),
               number(outcome.first_ns), number(outcome.frame_ns), number(outcome.wall_ns)});
  }

  const toml::table& definition_;
  int frames_, repetitions_, seed_;
  double limit_ns_;
  std::vector<Variant> variants_;
};

int main_of(int argc, char** argv) {
  if (argc != 2 && !(argc == 4 && std::string(argv[2]) == "--record"))
    throw Unusable("usage: boxes_benchmark DEFINITION.toml [--record DIR]");
  std::ifstream file(argv[1]);
  if (!file) throw Unusable(std::string(argv[1]) + ": " + std::strerror(errno));
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  const toml::table definition = toml::parse(std::string_view(text), std::string_view(argv[1]));
  const auto name = definition["name"].value_or(std::string("boxes"));
  const std::filesystem::path record =
      argc == 4 ? std::filesystem::path(argv[3]) : fresh_record("experiments/record");
  std::filesystem::create_directories(record);
  open_record(record, text, "boxes_benchmark experiments/definitions/" + name + ".toml");
  Table table(record / (name + ".csv"),
              {"set", "boxes", "motion", "displacement", "method", "coherent", "seed", "repetition",
               "frames", "overlaps", "differing", "first_ns", "frame_ns", "wall_ns"});
  Benchmark(definition).run(table);
  std::printf("%s\n", record.c_str());
  return 0;
}

}  // namespace
}  // namespace bvlab

int main(int argc, char** argv) {
  try {
    return bvlab::main_of(argc, argv);
  } catch (const bvlab::Unusable& error) {
    std::fprintf(stderr, "boxes_benchmark: %s\n", error.what());
    return 2;
  } catch (const toml::parse_error& error) {
    std::fprintf(stderr, "boxes_benchmark: %s: %s\n", argv[1],
                 std::string(error.description()).c_str());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "boxes_benchmark: %s\n", error.what());
    return 1;
  }
}
