// SPDX-License-Identifier: BSD-3-Clause
/// World: many moving bodies, and the pairs of them that touch.
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <type_traits>

#include "experiments/files/unusable.hpp"
#include "experiments/python/meshes.hpp"
#include "experiments/python/module.hpp"
#include "experiments/python/pair_answers.hpp"
#include "experiments/python/pair_arrays.hpp"
#include "experiments/python/signals.hpp"
#include "experiments/python/variants.hpp"
#include "experiments/replay/player.hpp"
#include "experiments/replay/worlds.hpp"
#include "experiments/scenes/trace.hpp"

namespace bvlab {
namespace {

using namespace py::literals;

class PyWorld : public MadeByCalls {
 public:
  PyWorld(const py::object& meshes, std::optional<std::size_t> objects, const VariantWords& words,
          int threads, const PairArrays& pairs)
      : meshes_(meshes, 0),
        first_(counted(objects.value_or(meshes_.given()))),
        variant_(variant_from(words)),
        moved_to_(first_),
        stands_(first_),
        present_(first_, 0),
        is_new_(first_, 0) {
    if (first_ > 0 && meshes_.span().empty())
      throw Unusable("meshes", "at least one is needed for " + std::to_string(first_) + " bodies");
    threads_ = threads;
    choice_ = pair_choice(pairs, first_);
    chosen_ = PairFilter(choice_);
    engine_ = released([&] { return make_world(meshes_.span(), first_, variant_, threads); });
    engine_->choose(choice_);
    for (const TriangleMesh& mesh : meshes_.span()) small_.push_back(is_small(mesh));
  }

  std::size_t objects() const { return first_ + added_.size(); }

  std::uint32_t add(const py::object& mesh, const py::object& pose) {
    // All that calls Python comes before the turn: it may call this world.
    const Mesh given = mesh_of(mesh);
    std::optional<CArray<double>> row;
    if (!pose.is_none()) row = array_of<double>(pose, "pose", Numbers::real, {{"7", 7}});
    const Turn held(*this);
    const auto object = static_cast<std::uint32_t>(counted(objects() + 1) - 1);
    const Added body{given.triangles, {&meshes_.place_of(given), is_small(*given.triangles)}};
    const auto to = row ? std::optional(pose_of(row->data(), object, body.of)) : std::nullopt;
    released([&] { engine_->add(*body.of.mesh); });
    added_.push_back(body);
    moved_to_.emplace_back(), stands_.emplace_back();
    present_.push_back(0), is_new_.push_back(0);
    is_stale_ = true;
    if (to) place(object, *to);
    return object;
  }

  void move(const py::object& which, const py::object& pose) {
    // Also an integer of NumPy's; an array has an index, too, but is a sequence.
    if (PyIndex_Check(which.ptr()) && !PySequence_Check(which.ptr())) {
      const auto row = array_of<double>(pose, "pose", Numbers::real, {{"7", 7}});
      const std::uint32_t object = index(which);
      const Pose to = pose_of(row.data(), object, of(object));
      const Turn held(*this);
      place(object, to);
      return;
    }
    const auto objects = checked(array_of<std::int64_t>(which, "objects", Numbers::whole, {{"k"}}));
    const auto moves = moves_of(
        objects, array_of<double>(pose, "poses", Numbers::real,
                                  {{"k", static_cast<py::ssize_t>(objects.size())}, {"7", 7}}));
    const Turn held(*this);  // all of them or none
    for (const auto& [object, to] : moves) place(object, to);
  }

  void remove(const py::object& which) {
    const std::uint32_t object = index(which);
    const Turn held(*this);
    engine_->remove(object);
    set(object, std::nullopt);
  }

  void update() {
    const Turn held(*this);
    released([&] { settle(); });
  }

  py::array_t<double> timed_steps(const py::object& which, const py::object& poses) {
    const auto indices =
        array_of<std::int64_t>(which, "objects", Numbers::whole, {{"steps"}, {"k"}});
    const py::ssize_t steps = indices.shape(0), k = indices.shape(1);
    // An array without entries can promise any length.
    if (steps > std::numeric_limits<std::uint32_t>::max())
      throw Unusable("objects", "more steps than 32 bits number");
    const auto objects = checked(indices);  // before poses are asked for, which may change them
    const auto moves = moves_of(objects, array_of<double>(poses, "poses", Numbers::real,
                                                          {{"steps", steps}, {"k", k}, {"7", 7}}));
    std::vector<double> seconds;
    Signals signals;
    const auto play = [&] {
      for (py::ssize_t step = 0; step < steps; ++step) {
        const auto start = Clock::now();
        for (py::ssize_t m = step * k; m < (step + 1) * k; ++m)
          place(moves[static_cast<std::size_t>(m)].first,
                moves[static_cast<std::size_t>(m)].second);
        settle();
        seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
        signals();
      }
    };
    alone([&] { released(play); });
    return taken<double>(std::move(seconds), {steps});
  }

  // Arrays are made when the lock is given back: memory that Python asks for may have it collect
  // garbage, whose finalizers may call this world.
  py::array_t<std::uint32_t> touching() {
    return rows_of(fresh([&] { return touching_pairs(); }));
  }

  py::array_t<std::uint32_t> contacts() {
    return taken_rows<std::uint32_t, 4>(fresh(
        [&] { return released([&] { return answers().contacts(touching_pairs(), stands_); }); }));
  }

  py::tuple distances(double below, bool nearest) {
    if (!(below >= 0)) throw Unusable("below", "must be a number that is not negative");
    auto [pairs, distances, points] =
        fresh([&] { return released([&] { return within(below, nearest); }); });
    const auto count = static_cast<py::ssize_t>(distances.size());
    const auto rows = rows_of(std::move(pairs));
    const auto values = taken<double>(std::move(distances), {count});
    if (!nearest) return py::make_tuple(rows, values);
    return py::make_tuple(rows, values, records_of(std::move(points), {count}));
  }

  std::size_t near() {
    return fresh([&] { return engine_->near(); });
  }
  std::size_t queried() {
    return fresh([&] { return engine_->queried(); });
  }

 private:
  /// Before any memory is asked for.
  static std::size_t counted(std::size_t objects) {
    if (objects > std::numeric_limits<std::uint32_t>::max())
      throw Unusable("objects", "more than 32-bit indices can name");
    return objects;
  }

  /// No component of R v + t is beyond the largest number, with numbers below this.
  static constexpr double safe = std::numeric_limits<double>::max() / 8;

  /// One thread at a time; whoever waits lets Python go on. A signal handler that interrupts a call
  /// may not make another of the same world.
  class Turn {
   public:
    explicit Turn(PyWorld& world) : world_(world), held_(world.mutex_, std::defer_lock) {
      if (world.at_work_ == std::this_thread::get_id())
        throw std::runtime_error("World: is at work, in this thread");
      if (!held_.try_lock()) {
        const py::gil_scoped_release waiting;
        held_.lock();
      }
      world.at_work_ = std::this_thread::get_id();
    }
    ~Turn() { world_.at_work_ = std::thread::id(); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    PyWorld& world_;
    std::unique_lock<std::mutex> held_;
  };

  template <class Work>
  std::invoke_result_t<const Work&> alone(const Work& work) {
    const Turn held(*this);
    return work();
  }

  /// The same, where answers are those for the bodies as they stand.
  template <class Work>
  std::invoke_result_t<const Work&> fresh(const Work& work) {
    return alone([&] {
      if (is_stale_)
        throw std::runtime_error(std::string("World: ") +
                                 (is_updated_
                                      ? "bodies were moved, added or removed since the last update"
                                      : "there was no update yet") +
                                 "; call update() first");
      return work();
    });
  }

  std::uint32_t index(const py::object& given) const {
    const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(given.ptr()));
    if (!whole) throw py::error_already_set();
    int beyond = 0;
    const long long number = PyLong_AsLongLongAndOverflow(whole.ptr(), &beyond);
    if (beyond != 0) throw py::index_error("the number of a body is out of range");
    return index(number);
  }
  std::uint32_t index(std::int64_t number) const {
    if (number < 0 || static_cast<std::size_t>(number) >= objects())
      throw py::index_error("no body " + std::to_string(number) + "; there are " +
                            std::to_string(objects()));
    return static_cast<std::uint32_t>(number);
  }

  template <class T>
  using CArray = py::array_t<T, py::array::c_style>;

  /// A copy: whatever is called to make an array of the next argument may change this one.
  std::vector<std::uint32_t> checked(const CArray<std::int64_t>& indices) const {
    std::vector<std::uint32_t> all;
    const std::int64_t* first = indices.data();
    for (py::ssize_t k = 0; k < indices.size(); ++k) all.push_back(index(first[k]));
    return all;
  }

  using Move = std::pair<std::uint32_t, Pose>;

  std::vector<Move> moves_of(const std::vector<std::uint32_t>& objects,
                             const CArray<double>& rows) const {
    std::vector<Move> moves;
    moves.reserve(objects.size());
    const double* row = rows.data();
    for (const std::uint32_t object : objects) {
      moves.emplace_back(object, pose_of(row, object, of(object)));
      row += 7;
    }
    return moves;
  }

  /// What a body is made of, and whether no number can be too large for it.
  struct Made {
    const TriangleMesh* mesh;
    bool is_small;
  };
  struct Added {
    std::shared_ptr<const TriangleMesh> kept;
    Made of;
  };

  Made of(std::uint32_t object) const {
    if (object >= first_) return added_[object - first_].of;
    const std::size_t mesh = object % meshes_.span().size();
    return {&meshes_.span()[mesh], small_[mesh]};
  }

  static bool is_small(const TriangleMesh& mesh) {
    return std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                       [](const auto& v) { return v.cwiseAbs().maxCoeff() < safe; });
  }

  static Pose pose_of(const double* row, std::uint32_t object, const Made& body) {
    // Another thread may be writing there: what is checked is what is kept.
    double v[7];
    std::copy_n(static_cast<const volatile double*>(row), 7, v);
    const auto pose = pose_from({v[0], v[1], v[2]}, v[3], v[4], v[5], v[6]);
    if (!pose) {
      const bool finite = std::all_of(v, v + 7, [](double x) { return std::isfinite(x); });
      throw Unusable("pose", std::string(finite ? "zero quaternion" : "not a finite number") +
                                 " of body " + std::to_string(object));
    }
    const auto small = [](double x) { return std::abs(x) < safe; };
    if (!body.is_small || !std::all_of(v, v + 3, small))
      require_finite_corners(Trace{1, 1, {v, v + 7}}, "pose", std::span(body.mesh, 1));
    return *pose;
  }

  void place(std::uint32_t object, const Pose& pose) {
    engine_->move(object, pose);
    set(object, pose);
  }
  void settle() {
    engine_->update();
    for (const auto object : changed_) {
      present_[object] = moved_to_[object].has_value();
      if (present_[object]) stands_[object] = *moved_to_[object];
      is_new_[object] = 0;
    }
    changed_.clear();
    is_stale_ = false, is_updated_ = true;
  }
  /// From the next update on.
  void set(std::uint32_t object, const std::optional<Pose>& pose) {
    is_stale_ = true;
    moved_to_[object] = pose;
    if (!is_new_[object]) changed_.push_back(object);
    is_new_[object] = 1;
  }

  std::vector<ObjectPair> touching_pairs() {
    const auto all = engine_->touching();
    std::vector<ObjectPair> pairs(all.begin(), all.end());
    std::sort(pairs.begin(), pairs.end(), before);
    return pairs;
  }

  struct Within {
    std::vector<ObjectPair> pairs;
    std::vector<double> distances;
    std::vector<NearestPair> nearest;  ///< where asked for
  };
  Within within(double below, bool nearest) {
    auto near = answers().near(stands_, present_, below);
    std::erase_if(near, [&](const ObjectPair& pair) { return !chosen_(pair); });
    const auto all = answers().distances(near, stands_);
    const auto mesh = [&](std::uint32_t i) -> const TriangleMesh& { return *of(i).mesh; };
    Within kept;
    for (std::size_t k = 0; k < near.size(); ++k) {
      if (!(all[k].distance <= below)) continue;
      const auto& [i, j] = near[k];
      kept.pairs.push_back(near[k]), kept.distances.push_back(all[k].distance);
      if (nearest)
        kept.nearest.push_back(nearest_points(all[k], mesh(i), stands_[i], mesh(j), stands_[j]));
    }
    return kept;
  }

  PairAnswers& answers() {
    if (!answers_) answers_.emplace(meshes_.span(), first_, variant_);
    for (std::size_t i = answers_->size(); i < objects(); ++i)
      answers_->add(*added_[i - first_].of.mesh);
    return *answers_;
  }

  Meshes meshes_;
  std::size_t first_;  // bodies, of these meshes in turn
  std::vector<Added> added_;
  Variant variant_;
  std::mutex mutex_;
  std::atomic<std::thread::id> at_work_{};  // whose turn it is
  std::unique_ptr<WorldEngine> engine_;
  std::optional<PairAnswers> answers_;
  int threads_ = 1;
  PairChoice choice_;
  PairFilter chosen_;
  std::vector<bool> small_;                    // of each of the first bodies' meshes
  std::vector<std::optional<Pose>> moved_to_;  // of each body: where it is from the next update on
  std::vector<Pose> stands_;                   // where it stood in the last one
  std::vector<std::uint8_t> present_;          // in the last one
  std::vector<std::uint8_t> is_new_;           // whether it is among `changed_`
  std::vector<std::uint32_t> changed_;
  bool is_stale_ = true, is_updated_ = false;
};

}  // namespace

void add_world(py::module_& module) {
  const Variant d = default_variant();
  py::class_<PyWorld, std::shared_ptr<PyWorld>>(
      module, "World", py::module_local(),
      R"(Many moving bodies. Only pairs whose boxes overlap are queried, and only when one of the two has moved.

World(meshes)            body i has meshes[i]; a Mesh given twice is built once
World(meshes, objects=n) n bodies: body i has meshes[i mod len(meshes)]
World()                  no bodies; `add` gives it some

A body is in the scene from its first `move` on. Answers are those of `update`: after a move, an add or a
remove, and before the first update, all questions are a RuntimeError. Volume and
strategy are chosen by name, as in replay; if none of these words is given, nor fan_out, frame, kernel,
build, leaf_size or fit, configuration="recommended" is taken. Calls from
several threads run one after the other.

pairs, without, groups   which pairs are asked about, as in replay: pairs (k, 2) alone, without (k, 2),
                         no pairs within a group (objects,)); of the bodies that are given here)")
      .def(py::init(
               [](const py::object& meshes, std::optional<std::size_t> objects,
                  const std::optional<std::string>& volume,
                  const std::optional<std::string>& strategy,
                  const std::optional<std::uint32_t>& fan_out,
                  const std::optional<std::string>& frame, const std::optional<std::string>& kernel,
                  const std::optional<std::string>& configuration,
                  const std::optional<std::string>& build, std::optional<std::uint32_t> leaf_size,
                  const std::optional<std::string>& fit, const std::string& precision, int threads,
                  const py::object& pairs, const py::object& without, const py::object& groups) {
                 VariantWords words{volume,        strategy, "touching", fan_out, frame,     kernel,
                                    configuration, build,    leaf_size,  fit,     precision, 0};
                 if (!words.said() && !configuration) words.configuration = "recommended";
                 check(variant_from(words));
                 check_threads(threads);
                 return std::make_shared<PyWorld>(meshes, objects, words, threads,
                                                  pair_arrays(pairs, without, groups));
               }),
           "meshes"_a = py::tuple(), py::kw_only(), "objects"_a = py::none(),
           "volume"_a = py::none(), "strategy"_a = py::none(), "fan_out"_a = py::none(),
           "frame"_a = py::none(), "kernel"_a = py::none(), "configuration"_a = py::none(),
           "build"_a = py::none(), "leaf_size"_a = py::none(), "fit"_a = py::none(),
           "precision"_a = d.precision, "threads"_a = 1, "pairs"_a = py::none(),
           "without"_a = py::none(), "groups"_a = py::none())
      .def(
          "move", &PyWorld::move, "object"_a, "pose"_a,
          R"(Sets the pose of a body, or of several, from the next update on: move(i, pose), move(indices, poses).

pose     (7,) real: x y z qw qx qy qz, object to world; for k bodies (k, 7). All are moved or none.
ValueError: not finite, a zero quaternion. IndexError: no such body.)")
      .def(
          "add", &PyWorld::add, "mesh"_a, "pose"_a = py::none(),
          R"(Adds a body and returns its number, len(world) so far. Without a pose it waits for its first `move`.

A Mesh that the world has is not built again. Answers are known from the next update on.)")
      .def("remove", &PyWorld::remove, "object"_a,
           R"(Removes a body from the scene, from the next update on, until it is moved again.

All other bodies keep their numbers, and no new body gets this one: len(world) stays.)")
      .def("update", &PyWorld::update,
           "Queries the near pairs of which a body has moved. Bodies at rest cost nothing.")
      .def(
          "timed_steps", &PyWorld::timed_steps, "objects"_a, "poses"_a,
          R"(Moves and updates step by step in C++. Returns the time of each step: (steps,) float64, in s.

objects  (steps, k) integer: the bodies that move in each step; poses: (steps, k, 7) real. A loop in
Python takes longer by its own overhead.)")
      .def("touching", &PyWorld::touching,
           "uint32 (k, 2): the pairs i < j whose surfaces share a point, sorted.")
      .def(
          "contacts", &PyWorld::contacts,
          R"(uint32 (k, 4): body i, body j, triangle of i, triangle of j: all triangles that share a point; sorted.

Each pair that touches is traversed from the roots.)")
      .def(
          "distances", &PyWorld::distances, "below"_a, py::kw_only(), "nearest"_a = false,
          R"(The pairs no farther apart than `below`, and their distances: uint32 (k, 2), float64 (k,).

In units of the meshes; 0 where they touch. Each pair is traversed from the roots. With nearest=True
a third array has their nearest triangles and points, as bvlab.replay(..., nearest=True).nearest.)")
      .def_property_readonly("near", &PyWorld::near,
                             "The number of pairs whose boxes overlapped in the last update.")
      .def_property_readonly("queried", &PyWorld::queried,
                             "The number of pairs that the last update queried.")
      .def("__len__", &PyWorld::objects);
}

}  // namespace bvlab
