// SPDX-License-Identifier: BSD-3-Clause
/// replay, boxes, predict: what the commands of these names do, from arrays.
#include <pybind11/stl.h>

#include "experiments/files/unusable.hpp"
#include "experiments/python/arrays.hpp"
#include "experiments/python/meshes.hpp"
#include "experiments/python/module.hpp"
#include "experiments/python/pair_arrays.hpp"
#include "experiments/python/signals.hpp"
#include "experiments/python/variants.hpp"
#include "experiments/replay/coherence.hpp"
#include "experiments/replay/predict.hpp"
#include "experiments/replay/replay_boxes.hpp"
#include "experiments/replay/replay_totals.hpp"
#include "experiments/scenes/checked_trace.hpp"

namespace bvlab {
namespace {

using namespace py::literals;

/// What `replay` and `boxes` give.
struct Result : MadeByCalls {
  Result(py::object of_all, py::dict sums) : answers(std::move(of_all)), totals(std::move(sums)) {}

  py::object answers, nearest = py::none(), series = py::none(), frame_seconds = py::none();
  py::dict totals;
  std::optional<Trace> asked;  ///< without poses: which pairs
};

/// Made when it is asked for: there may be more of them than answers.
py::object pairs_of(const Result& result) {
  if (!result.asked) return py::none();
  return rows_of(object_pairs(*result.asked));
}

py::dict dictionary(const Totals& totals) {
  return py::module_::import("json").attr("loads")(totals.text());
}

Trace trace_from(const py::handle& poses) {
  const auto array =
      array_of<double>(poses, "poses", Numbers::real, {{"frames"}, {"objects"}, {"7", 7}});
  return checked_trace(static_cast<std::size_t>(array.shape(0)),
                       static_cast<std::size_t>(array.shape(1)),
                       {array.data(), array.data() + array.size()}, "poses");
}

py::object answers_of(ReplayResult& result, const Trace& trace, const std::string& query) {
  const std::vector<py::ssize_t> cells{static_cast<py::ssize_t>(trace.frames),
                                       static_cast<py::ssize_t>(trace.pairs())};
  const AnswerKind kind = kind_of_answers(result, query);
  if (kind == AnswerKind::yes_or_no) return taken<std::uint8_t>(std::move(result.touching), cells);
  if (kind == AnswerKind::number) return taken<double>(std::move(result.distances), cells);
  return taken_rows<std::uint32_t, 5>(std::move(result.contacts));
}

/// One row a frame: n_u, n_v, n_p, front, hits.
py::object series_of(std::vector<FrameCounts>&& rows) {
  const auto count = static_cast<py::ssize_t>(rows.size());
  return taken<FrameCounts>(std::move(rows), {count});
}

struct Wanted {
  bool count, answers, nearest, series, frame_seconds;
  int threads;
  BroadPhase broad_phase;
  PairArrays pairs;
};

std::shared_ptr<Result> play(const py::object& given_meshes, const py::object& given_poses,
                             const VariantWords& words, const Wanted& wanted) {
  Variant variant = variant_from(words);
  check_threads(wanted.threads);
  const Meshes meshes(given_meshes);
  Trace trace = trace_from(given_poses);
  trace.chosen = chosen_from(wanted.pairs, trace.objects);
  if (wanted.nearest && variant.query != "distance")
    throw Unusable("nearest", "is for query=\"distance\"; not for " + variant.query);
  ReplayOptions options;
  options.keep_nearest = wanted.nearest;
  options.broad_phase = wanted.broad_phase;
  options.count = wanted.count ? Count::on : Count::off;
  options.threads = static_cast<unsigned>(wanted.threads);
  options.keep_answers = wanted.answers;
  options.keep_series = wanted.series;
  options.keep_frame_seconds = wanted.frame_seconds;
  Signals signals;
  options.after_frame = [&](std::size_t) { signals(); };
  auto [result, totals] = released([&] {
    require_finite_corners(trace, "poses", meshes.span());
    ReplayResult played = replay(meshes.span(), trace, variant, options);
    Totals of_it = totals_of(played, meshes.span(), trace, variant, options);
    return std::pair(std::move(played), std::move(of_it));
  });
  auto all = std::make_shared<Result>(py::none(), dictionary(totals));
  if (wanted.answers) all->answers = answers_of(result, trace, variant.query);
  if (wanted.nearest)
    all->nearest = records_of(std::move(result.nearest), {static_cast<py::ssize_t>(trace.frames),
                                                          static_cast<py::ssize_t>(trace.pairs())});
  all->asked = Trace{0, trace.objects, {}, trace.chosen};
  if (wanted.series) all->series = series_of(std::move(result.series));
  if (wanted.frame_seconds) {
    const auto frames = static_cast<py::ssize_t>(result.frame_seconds.size());
    all->frame_seconds = taken<double>(std::move(result.frame_seconds), {frames});
  }
  return all;
}

template <class T>
std::shared_ptr<Result> play_boxes(const py::array& array, const BoxReplayOptions& options) {
  // Copied: other threads may write to the array while this runs, or resize it, and methods rely on
  // boxes that were checked.
  const auto* first = static_cast<const Box<T>*>(array.data());
  const std::vector<Box<T>> boxes(first, first + array.size() / 6);
  const BoxTrace<T> trace{static_cast<std::size_t>(array.shape(0)),
                          static_cast<std::size_t>(array.shape(1)), boxes, "trace"};
  auto result = released([&] { return replay_boxes(trace, options); });
  const py::dict totals = dictionary(totals_of(result, trace, options));
  py::object pairs = py::none();
  if (options.keep_pairs) pairs = taken_rows<std::uint32_t, 3>(std::move(result.pairs));
  return std::make_shared<Result>(std::move(pairs), totals);
}

std::shared_ptr<Result> boxes(const py::object& given, const std::string& method, bool coherent,
                              const std::string& precision, int threads, bool answers) {
  check_threads(threads);
  BoxReplayOptions options;
  options.method = method;
  options.precision = precision;
  options.coherence = coherent ? Coherence::on : Coherence::off;
  options.threads = threads;
  options.keep_pairs = answers;
  check(options);
  Signals signals;
  options.after_frame = [&](std::size_t) { signals(); };
  // float32 stays what it is; everything else is float64.
  const bool narrow = py::isinstance<py::array>(given) &&
                      py::reinterpret_borrow<py::array>(given).dtype().is(py::dtype::of<float>());
  const std::vector<Axis> axes{{"frames"}, {"boxes"}, {"6", 6}};
  if (narrow)
    return play_boxes<float>(array_of<float>(given, "trace", Numbers::real, axes), options);
  return play_boxes<double>(array_of<double>(given, "trace", Numbers::real, axes), options);
}

py::dict predicted(const py::object& given_meshes, const py::object& given_poses,
                   const VariantWords& words, std::optional<std::size_t> stride,
                   std::optional<std::size_t> window) {
  const Variant variant = variant_from(words);
  const Meshes meshes(given_meshes);
  const Trace trace = trace_from(given_poses);
  PredictOptions options = options_for(trace.frames);
  if (stride || window) {
    const PredictOptions otherwise;
    options = {.stride = stride.value_or(otherwise.stride),
               .window = window.value_or(otherwise.window)};
  }
  if (options.stride < 1 || options.window < 2)
    throw Unusable("--stride, --window", "must be at least 1 and 2");
  Signals signals;
  options.waiting = [&] { signals(); };
  const auto [rows, sums] = released([&] {
    require_finite_corners(trace, "poses", meshes.span());
    return std::pair(predict(meshes.span(), trace, variant, options),
                     coherence(meshes.span(), trace, variant, options.waiting));
  });
  py::dict strategies;
  for (const Predicted& row : rows)
    strategies[py::str(std::string(row.strategy))] =
        py::dict("n_v"_a = row.n_v, "n_p"_a = row.n_p, "seconds"_a = row.seconds,
                 "seconds_low"_a = row.low, "seconds_high"_a = row.high);
  py::list names;
  for (const auto name : candidates(rows)) names.append(std::string(name));
  const bool is_told = can_tell(rows) && names.size() == 1;
  return py::dict("fastest"_a = is_told ? py::object(names[0]) : py::object(py::none()),
                  "candidates"_a = names, "survival"_a = sums.survival(),
                  "strategies"_a = strategies);
}

py::object total(const Result& result, const char* key) {
  return result.totals.contains(key) ? py::object(result.totals[key]) : py::none();
}

/// What a copy is made of. All pairs of objects are their number, chosen ones are rows.
py::tuple state_of(const Result& result) {
  py::object objects = py::none(), chosen = py::none();
  if (result.asked) {
    objects = py::int_(result.asked->objects);
    if (result.asked->chosen) chosen = pairs_of(result);
  }
  return py::make_tuple(result.answers, result.totals, result.series, result.frame_seconds,
                        result.nearest, objects, chosen);
}

std::shared_ptr<Result> result_of(const py::tuple& state) {
  if (state.size() != 7 || !py::isinstance<py::dict>(state[1]))
    throw Unusable("Result", "is not what another version pickled");
  auto result = std::make_shared<Result>(state[0], state[1].cast<py::dict>());
  result->series = state[2], result->frame_seconds = state[3], result->nearest = state[4];
  if (state[5].is_none()) return result;
  const std::size_t objects = PyLong_AsSize_t(state[5].ptr());
  if (PyErr_Occurred()) throw py::error_already_set();
  result->asked = Trace{0, objects, {}};
  if (!state[6].is_none()) result->asked->chosen = chosen_rows(state[6]);
  return result;
}

void add_result(py::module_& module) {
  py::class_<Result, std::shared_ptr<Result>> type(
      module, "Result", py::module_local(),
      "The result of replay and boxes: answers, and totals as --json has them.");
  type.def_readonly("answers", &Result::answers,
                    R"(Answers as --out has them; see replay and boxes.
None where answers=False.)")
      .def_readonly(
          "nearest", &Result::nearest,
          R"(Per frame and pair, the nearest triangles and points; None unless nearest=True.

A structured array (frames, pairs): nearest["triangles"], uint32 (frames, pairs, 2), of i and of j;
nearest["points"], float64 (frames, pairs, 2, 3), on i and on j, in the world.)")
      .def_property_readonly(
          "pairs", &pairs_of,
          "uint32 (pairs, 2): the objects of each column of answers; None of boxes.")
      .def_readonly("totals", &Result::totals, "Times in s, counts, the variant; a dict as --json.")
      .def_readonly("series", &Result::series,
                    R"(Per frame, summed over all pairs: n_u, n_v, n_p, front, hits.
A structured array; None unless series=True. pandas.DataFrame(result.series) has them as columns.)")
      .def_readonly("frame_seconds", &Result::frame_seconds,
                    "(frames,) float64; None unless frame_seconds=True.");
  struct Field {
    const char *name, *what;
  };
  static constexpr Field fields[] = {
      {"seconds", "Posing and querying every frame, in s; no building."},
      {"build_seconds",
       "Building the hierarchies before the first frame, in s; on demand, the rest is in frames."},
      {"first_seconds", "The first frame alone, in s."},
      {"n_u", "Volumes posed; None unless count=True."},
      {"n_v", "Pairs of volumes tested; None unless count=True."},
      {"n_p", "Pairs of triangles tested; None unless count=True."},
      {"front", "Mean number of entries of the front, per pair and frame."}};
  for (const Field& field : fields)
    type.def_property_readonly(
        field.name, [name = field.name](const Result& result) { return total(result, name); },
        field.what);
  type.def(py::pickle(&state_of, &result_of));
  type.def("__repr__", [](const Result& result) {
    std::string text = "<bvlab.Result:";
    for (const char* key : {"volume", "strategy", "query", "method"})
      if (result.totals.contains(key))
        text += " " + py::str(result.totals[key]).cast<std::string>();
    for (const char* key : {"frames", "touching", "contacts", "overlaps", "seconds"})
      if (result.totals.contains(key))
        text += std::string(", ") + key + " " + py::str(result.totals[key]).cast<std::string>();
    return text + ">";
  });
}

}  // namespace

void add_replaying(py::module_& module) {
  // Modules in one process share what pybind11 knows of dtypes: see compile_in.
  if (!py::detail::get_numpy_internals().get_type_info<FrameCounts>(false))
    PYBIND11_NUMPY_DTYPE(FrameCounts, n_u, n_v, n_p, front, hits);
  add_result(module);
  const Variant d = default_variant();
  const BoxReplayOptions box;
  const std::optional<std::string> none;
  module.def(
      "replay",
      [](const py::object& meshes, const py::object& poses,
         const std::optional<std::string>& volume, const std::optional<std::string>& strategy,
         const std::string& query, std::optional<std::uint32_t> fan_out,
         const std::optional<std::string>& frame, const std::optional<std::string>& kernel,
         const std::optional<std::string>& configuration, const std::optional<std::string>& build,
         std::optional<std::uint32_t> leaf_size, const std::optional<std::string>& fit,
         const std::string& precision, double relative_error, bool count, int threads, bool answers,
         bool series, bool frame_seconds, bool nearest, const py::object& pairs,
         const py::object& without, const py::object& groups, const std::string& broad_phase) {
        return play(meshes, poses,
                    {volume, strategy, query, fan_out, frame, kernel, configuration, build,
                     leaf_size, fit, precision, relative_error},
                    {count, answers, nearest, series, frame_seconds, threads,
                     broad_phase_from(broad_phase), pair_arrays(pairs, without, groups)});
      },
      "meshes"_a, "poses"_a, py::kw_only(), "volume"_a = none, "strategy"_a = none,
      "query"_a = d.query, "fan_out"_a = none, "frame"_a = none, "kernel"_a = none,
      "configuration"_a = none, "build"_a = none, "leaf_size"_a = none, "fit"_a = none,
      "precision"_a = d.precision, "relative_error"_a = d.relative_error, "count"_a = false,
      "threads"_a = 1, "answers"_a = true, "series"_a = false, "frame_seconds"_a = false,
      "nearest"_a = false, "pairs"_a = py::none(), "without"_a = py::none(),
      "groups"_a = py::none(), "broad_phase"_a = "auto",
      R"(Answers a query for all pairs of a motion by one variant of the engine, as `bvlab replay`.

meshes   a Mesh, or a list of meshes (or of anything with .vertices and .faces); object i uses mesh
         i modulo their number
poses    (frames, objects, 7) real: x y z qw qx qy qz, object to world; see bvlab.poses
query    result.answers is, for all pairs (0,1) (0,2) ... (1,2) ... of objects:
         "touching"  uint8 (frames, pairs): 1 where the two surfaces share a point
         "contacts"  uint32 (k, 5): frame, object i, object j, triangle of i, triangle of j; sorted
         "distance"  float64 (frames, pairs), in units of the meshes: 0 where they touch
count    fills n_u, n_v, n_p of the totals (times include the counting); the recursive strategy runs
         once more, to find which tests were skipped
series   fills result.series, frame_seconds fills result.frame_seconds
nearest  of distances, fills result.nearest: the nearest triangles and points of each pair
pairs    (k, 2) integer: these pairs of objects alone, in the order of the answers; without, (k, 2): not
         these; groups, (objects,) integer: no pairs within a group (negative: in none). What is asked
         is result.pairs: column p of answers is pair result.pairs[p]
broad_phase  "on": only pairs whose boxes overlap are queried, all others are apart (answers are the same,
         counts are not); "off"; "auto": on for many bodies, where nothing is counted

fan_out  most children of a node: 2, 4, 8, 16 (default: 2); frame: "world" or "body", where volumes are
         tested (default: "world"); kernel: see bvlab.kernels() (default: "gathered"); fit: "published" or
         "tight" (default: "published")
volume, strategy, build and leaf_size are "sphere", "recursive", "top-down-principal" and 1 by default.

configuration="recommended" chooses volume, tree, strategy, build, fit and leaf size; it is refused beside
any of them. The names:
bvlab.volumes(), strategies(), queries(), frames(), kernels(), builds(), precisions(),
configurations().
Ctrl-C ends it. ValueError: the line that `bvlab replay` would print.)");
  module.def("boxes", &boxes, "trace"_a, py::kw_only(), "method"_a = box.method,
             "coherent"_a = true, "precision"_a = box.precision, "threads"_a = box.threads,
             "answers"_a = true,
             R"(Finds the overlapping pairs of boxes, frame by frame, as `bvlab boxes`.

trace    (frames, boxes, 6) real: lo x y z, hi x y z; touching counts as overlapping. float32 is
         compared as float32, all else as float64. It is copied, so it may be changed meanwhile.

result.answers: uint32 (k, 3): frame, i, j with i < j; every overlapping pair once, sorted.
bvlab.methods() has the names. ValueError: NaN, infinity, lo > hi, another shape.)");
  module.def(
      "predict",
      [](const py::object& meshes, const py::object& poses, const std::string& volume,
         const std::string& query, std::optional<std::uint32_t> fan_out,
         const std::optional<std::string>& frame, const std::string& build, std::uint32_t leaf_size,
         const std::string& fit, double relative_error, std::optional<std::size_t> stride,
         std::optional<std::size_t> window) {
        const VariantWords words{.volume = volume,
                                 .query = query,
                                 .fan_out = fan_out,
                                 .frame = frame,
                                 .build = build,
                                 .leaf_size = leaf_size,
                                 .fit = fit,
                                 .precision = default_variant().precision,
                                 .relative_error = relative_error};
        return predicted(meshes, poses, words, stride, window);
      },
      "meshes"_a, "poses"_a, py::kw_only(), "volume"_a = d.volume, "query"_a = d.query,
      "fan_out"_a = py::none(), "frame"_a = py::none(), "build"_a = d.build,
      "leaf_size"_a = d.leaf_size, "fit"_a = d.fit, "relative_error"_a = d.relative_error,
      "stride"_a = py::none(), "window"_a = py::none(),
      R"(Predicts the cost of each strategy on a motion, from windows of it, as `bvlab predict`.

A dict: fastest, the strategy that takes the fewest seconds (None where its interval overlaps that of
another, windows are too few, or there are no pairs or fewer than two frames); candidates, those that may be it, the likeliest first; survival, the
share of the front that persists for a frame (None where no bodies were near each other); strategies, of
each by its name {"n_v": volume tests, "n_p": triangle tests, "seconds": s, "seconds_low", "seconds_high"}.
Intervals are wide and mostly right: on 40 motions of 600 frames 312 of 320 held what a strategy then
took (of recursion's, the narrowest, 35 of 40). Half a width is 56 % of the seconds (median), so 7.3 of
eight strategies were candidates, the fastest always among them: to find which it is, replay these.
stride and window, in frames: None for all of a short trace. meshes, poses, fan_out and frame as in replay.
Ctrl-C ends it.)");
}

}  // namespace bvlab
