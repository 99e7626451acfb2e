// SPDX-License-Identifier: BSD-3-Clause
/// Broad-phase methods and peers on the built-in sets, interleaved: for every set, number, motion
/// and displacement all variants run the same frames, in an order drawn anew for each repetition,
/// and every frame's pair set is compared with the reference's by count and by a sum of hashes.
/// A frame's time is the mean over all but the first (or over those from `steady_from` on), since
/// some methods save work up for later frames; beside it are the median, the 99th percentile and
/// the worst. Where `plays` is more than one, a row is made of so many plays, interleaved as well,
/// and each of its frames is the fastest of them: what else the machine did is not in the worst
/// frames. A method that is `told`, or a peer, gets the indices of the boxes that moved; the others
/// find out. A set is a built-in one or a file: the first frame of a box trace. Memory that
/// an earlier run freed is given back to the system first, so that the first frame is a first call.
/// A run that something else disturbed is made again. Processor time, which neighbours on the
/// machine disturb less, is beside that of the wall clock; `bytes` is the heap that a method
/// holds after its last frame.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "experiments/files/memory.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/peers/box_peers.hpp"
#include "experiments/replay/box_methods.hpp"
#include "experiments/scenes/boxes.hpp"
#include "experiments/studies/clocks.hpp"
#include "experiments/studies/statistics.hpp"
#include "experiments/studies/study.hpp"

namespace bvlab {
namespace {

struct Frames {
  std::vector<std::vector<Box<float>>> boxes;
  std::vector<std::vector<std::uint32_t>> moved;  ///< since the frame before; all in the first
};

struct Case {
  std::string set, motion;
  std::size_t count;
  double displacement;
  unsigned seed;
  Row key() const { return {set, text_of(count), motion, text_of(displacement), text_of(seed)}; }
};
struct Variant {
  std::string method, coherent, changes, sort;
  int threads;
};
struct Answer {
  std::uint64_t pairs = 0, hash = 0;
  bool operator==(const Answer&) const = default;
};
struct Outcome {
  std::vector<Answer> answers;
  std::vector<double> ns, wall;  ///< of each frame
  double first_ns = 0, frame_ns = 0, middle_ns = 0, p99_ns = 0, worst_ns = 0, wall_ns = 0,
         events = 0;
  std::size_t bytes = 0;
  bool slow = false;
};

struct Settings {
  std::vector<Case> cases;
  std::vector<Variant> variants;
  std::size_t reference = 0;
  int frames = 0;
  std::size_t steady_from = 1;
  std::size_t plays = 1;
  double limit_ns = 0;
};

bool is_file(const std::string& set) { return set.ends_with(".npy"); }

StudyParameters parameters() {
  const std::vector<std::string> sets = box_set_names();
  std::vector<std::string> methods;
  for (const auto* entry : method_entries()) methods.emplace_back(entry->name);
  StudyParameters all{
      words_parameter("sets", sets, "of boxes", sets),
      wholes_parameter("counts", {10000}, {1, 1e8}, "boxes in a set"),
      words_parameter("motions", {"drift"}, "of the boxes", box_motion_names()),
      numbers_parameter("displacements", {0.02}, {0, 1e6}, "a frame, in sizes of a box"),
      wholes_parameter("seed", {1}, seeds, "of the random numbers"),
      words_parameter("methods", methods, "see `bvlab list methods`", methods),
      words_parameter("coherent", {"on"}, "whether methods use past frames, or are told who moved",
                      {"on", "off", "told"}),
      words_parameter("changes", {"off"}, "whether begun and ended pairs are given", {"on", "off"}),
      words_parameter("sorts", {"radix"}, "how methods sort", {"radix", "comparison"}),
      wholes_parameter("threads", {1}, {1, 1024}, "of methods"),
      words_parameter("peers", {}, "other libraries", box_peer_names()),
      words_parameter("peers_if_built", {}, "peers that a build may not have"),
      one(words_parameter("reference", {},
                          "method or peer that the others are compared with; the last")),
      one(wholes_parameter("frames", {10}, {1, 1e6}, "frames, the start included")),
      one(wholes_parameter("steady_from", {1}, {1, 1e6}, "frame from which times are taken")),
      one(wholes_parameter("plays", {1}, {1, 1000}, "runs, of which each frame's fastest counts")),
      one(numbers_parameter("seconds_a_frame", {1}, {0}, "limit at which a variant is given up"))};
  all[0].takes_files = true;
  return all;
}

Settings settings_of(const StudyDefinition& definition) {
  Settings s;
  for (const auto& set : definition.words("sets"))
    for (const std::size_t count :
         is_file(set) ? std::vector<std::size_t>{1} : definition.wholes("counts"))
      for (const auto& motion : definition.words("motions"))
        for (const double displacement : definition.numbers("displacements"))
          for (const std::size_t seed : definition.wholes("seed"))
            s.cases.push_back({set, motion, count, displacement, static_cast<unsigned>(seed)});
  const auto coherent = definition.words("coherent");
  for (const auto& method : definition.words("methods"))
    for (const auto& c : coherent)
      for (const auto& reported : definition.words("changes"))
        for (const auto& sort : definition.words("sorts"))
          for (const std::size_t threads : definition.wholes("threads"))
            s.variants.push_back({method, c, reported, sort, static_cast<int>(threads)});
  auto peers = definition.words("peers");
  // Of libraries that not every machine has.
  const auto built = box_peer_names();
  for (const auto& peer : definition.words("peers_if_built"))
    if (std::find(built.begin(), built.end(), peer) != built.end()) peers.push_back(peer);
  const bool told = std::find(coherent.begin(), coherent.end(), "told") != coherent.end();
  for (const auto& peer : peers) {
    s.variants.push_back({peer, "on", "off", "", peer == "cgal-parallel" ? 2 : 1});
    if (told && make_box_peer(peer)->takes_moved())
      s.variants.push_back({peer, "told", "off", "", 1});
  }
  const auto references = definition.words("reference");
  const std::string reference = references.empty() ? s.variants.back().method : references.front();
  while (s.reference < s.variants.size() && s.variants[s.reference].method != reference)
    ++s.reference;
  if (s.reference == s.variants.size())
    throw Unusable(definition.file, "reference: " + reference + " is not among methods and peers");
  s.frames = static_cast<int>(definition.whole("frames"));
  s.steady_from = definition.whole("steady_from");
  if (s.steady_from > static_cast<std::size_t>(s.frames))
    throw Unusable(definition.file, "steady_from must be at most frames");
  s.plays = definition.whole("plays");
  s.limit_ns = 1e9 * definition.number("seconds_a_frame");
  return s;
}
void check_settings(const StudyDefinition& definition) { settings_of(definition); }

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
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
  explicit Player(const Variant& variant) {
    told_ = variant.coherent == "told";
    peer_ = make_box_peer(variant.method);
    if (peer_) return;
    MethodSettings settings;
    settings.coherence = variant.coherent == "off" ? Coherence::off : Coherence::on;
    settings.changes = variant.changes == "on" ? Changes::reported : Changes::unreported;
    settings.sort = variant.sort == "comparison" ? Sort::comparison : Sort::radix;
    settings.threads = variant.threads;
    method_ = make_method<float>(variant.method, settings);
  }
  std::span<const Pair> overlapping(Boxes<float> boxes, std::span<const std::uint32_t> moved) {
    if (peer_) return told_ ? peer_->update(boxes, moved) : peer_->overlapping(boxes);
    return told_ ? method_->update(boxes, moved) : method_->overlapping(boxes);
  }
  std::size_t events() const {
    if (peer_) return 0;
    const PairChanges changes = method_->changes();
    return changes.began.size() + changes.ended.size();
  }

 private:
  std::unique_ptr<BoxPeer> peer_;
  std::unique_ptr<AnyMethod<float>> method_;
  bool told_ = false;
};

Outcome play(const Variant& variant, const Frames& frames, const Settings& settings,
             double limit_ns) {
  Outcome outcome;
  std::vector<double> events;
  give_back_heap();
  const std::size_t heap = heap_bytes();
  Player player(variant);
  for (std::size_t f = 0; f < frames.boxes.size(); ++f) {
    const double start_wall = wall_seconds(), start = processor_seconds();
    const auto pairs = player.overlapping(frames.boxes[f], frames.moved[f]);
    const double ns = 1e9 * (processor_seconds() - start),
                 took = 1e9 * (wall_seconds() - start_wall);
    outcome.answers.push_back(answer_of(pairs));
    outcome.ns.push_back(ns), outcome.wall.push_back(took);
    if (f > 0 && f >= settings.steady_from) events.push_back(static_cast<double>(player.events()));
    outcome.slow |= ns > limit_ns;
    if (ns > limit_ns && (f > 0 || ns > 10 * limit_ns)) break;
  }
  const std::size_t now = heap_bytes();
  outcome.bytes = now > heap ? now - heap : 0;
  outcome.events = mean(events);
  return outcome;
}

/// Each frame by the faster of the plays that reached it: one that other work delayed until it was
/// given up takes nothing from another.
void keep_faster(Outcome& outcome, Outcome next) {
  if (next.ns.size() > outcome.ns.size()) std::swap(outcome, next);
  for (std::size_t f = 0; f < next.ns.size(); ++f) {
    outcome.ns[f] = std::min(outcome.ns[f], next.ns[f]);
    outcome.wall[f] = std::min(outcome.wall[f], next.wall[f]);
  }
}

void sum_up(Outcome& outcome, const Settings& settings) {
  if (outcome.ns.empty()) return;
  const auto from = static_cast<std::ptrdiff_t>(
      std::min(std::max<std::size_t>(settings.steady_from, 1), outcome.ns.size()));
  const std::vector<double> later(outcome.ns.begin() + from, outcome.ns.end());
  outcome.first_ns = outcome.ns[0];
  outcome.frame_ns = mean(later), outcome.middle_ns = median(later);
  outcome.p99_ns = percentile(later, 0.99);
  outcome.worst_ns = later.empty() ? 0 : *std::max_element(later.begin(), later.end());
  outcome.wall_ns = mean(std::span(outcome.wall).subspan(static_cast<std::size_t>(from)));
}

class BoxStudy {
 public:
  BoxStudy(const StudyDefinition& definition, StudyRecord& record)
      : settings_(settings_of(definition)), repetitions_(definition.repetitions), record_(record) {}

  void run() {
    record_.each(settings_.cases, &Case::key, [&](const Case& c) { run_case(c); });
  }

 private:
  void run_case(const Case& c) {
    const Frames frames = frames_of(c);
    std::vector<Answer> reference;
    for (unsigned repetition = 0; repetition < repetitions_; ++repetition) {
      std::vector<std::optional<Outcome>> outcomes(settings_.variants.size());
      for (std::size_t play = 0; play < settings_.plays; ++play)
        for (const std::size_t k : drawn_order(repetition == 0 && play == 0)) {
          if (slow_.contains(slow_key(k, c)) && k != settings_.reference) continue;
          play_once(c, k, frames, outcomes[k]);
          if (reference.empty()) reference = outcomes[k]->answers;
        }
      for (std::size_t k = 0; k < outcomes.size(); ++k)
        if (outcomes[k]) {
          sum_up(*outcomes[k], settings_);
          add_row(settings_.variants[k], repetition, frames, *outcomes[k], reference);
        }
    }
  }
  /// What the others are compared with comes first.
  std::vector<std::size_t> drawn_order(bool reference_first) {
    auto order = numbers_below(settings_.variants.size());
    record_.shuffle(order);
    if (reference_first)
      std::swap(*std::find(order.begin(), order.end(), settings_.reference), order[0]);
    return order;
  }
  void play_once(const Case& c, std::size_t k, const Frames& frames,
                 std::optional<Outcome>& outcome) {
    const double limit_ns = k == settings_.reference ? 1e18 : settings_.limit_ns;
    const auto once = [&] { return play(settings_.variants[k], frames, settings_, limit_ns); };
    // The fastest of several plays is undisturbed enough.
    const Outcome next = settings_.plays > 1 ? once() : undisturbed(once).result;
    const bool went_through = outcome && outcome->ns.size() == frames.boxes.size();
    if (next.slow && !went_through) slow_.insert(slow_key(k, c));
    if (outcome)
      keep_faster(*outcome, next);
    else
      outcome = next;
  }
  Frames frames_of(const Case& c) const {
    Frames frames;
    BoxMotion motion(c.motion, c.displacement, c.set,
                     is_file(c.set) ? first_frame(c.set) : make_box_set(c.set, c.count, c.seed),
                     c.seed);
    for (int f = 0; f < settings_.frames; ++f, motion.step()) {
      frames.boxes.push_back(motion.boxes());
      std::vector<std::uint32_t> moved;
      for (std::uint32_t k = 0; k < frames.boxes[f].size(); ++k)
        if (f == 0 || !(frames.boxes[f][k] == frames.boxes[f - 1][k])) moved.push_back(k);
      frames.moved.push_back(std::move(moved));
    }
    return frames;
  }
  static std::vector<Box<float>> first_frame(const std::string& file) {
    static constexpr std::size_t shape[] = {any_length, any_length, 6};
    const auto trace = read_npy<float>(file, shape);
    if (trace.shape[0] == 0) throw Unusable(file, "no frames");
    const Boxes<float> boxes(reinterpret_cast<const Box<float>*>(trace.data.data()),
                             trace.shape[1]);
    if (const auto fault = first_fault(boxes))
      throw Unusable(file, "box " + std::to_string(fault->box) + ": " + std::string(fault->what));
    return {boxes.begin(), boxes.end()};
  }
  /// What took longer than the definition allows is not run again on that set and motion: cases go
  /// on with more boxes, or with more displacement.
  static std::string slow_key(std::size_t k, const Case& c) {
    return std::to_string(k) + " " + c.set + " " + c.motion;
  }

  void add_row(const Variant& v, unsigned repetition, const Frames& frames, const Outcome& outcome,
               const std::vector<Answer>& reference) {
    std::size_t differing = 0;
    for (std::size_t f = 0; f < outcome.answers.size(); ++f)
      differing += f < reference.size() && outcome.answers[f] != reference[f];
    const auto whole = [](double value) { return std::llround(value); };
    record_.add(frames.boxes[0].size(), v.method, v.coherent, v.changes, v.sort, v.threads,
                repetition, outcome.answers.size(), outcome.answers.back().pairs,
                whole(outcome.events), differing, whole(outcome.first_ns), whole(outcome.frame_ns),
                whole(outcome.middle_ns), whole(outcome.p99_ns), whole(outcome.worst_ns),
                whole(outcome.wall_ns), outcome.bytes);
  }

  Settings settings_;
  unsigned repetitions_;
  StudyRecord& record_;
  std::set<std::string> slow_;
};

void run(const StudyDefinition& definition, StudyRecord& record) {
  BoxStudy(definition, record).run();
}

}  // namespace

const StudyKind studies::boxes = {
    "boxes",
    "broad-phase methods and peers on sets of boxes, frame by frame",
    parameters,
    check_settings,
    {"set",       "count",    "motion",   "displacement", "seed",     "boxes",
     "method",    "coherent", "changes",  "sort",         "threads",  "repetition",
     "frames",    "overlaps", "events",   "differing",    "first_ns", "frame_ns",
     "middle_ns", "p99_ns",   "worst_ns", "wall_ns",      "bytes"},
    run};

}  // namespace bvlab
