// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/parts.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "experiments/scenes/places.hpp"

namespace bvlab {
namespace {

using Index = std::uint32_t;
using Point = Vec3<double>;
using Squares = std::array<Index, 3>;

const Point bay{4, 4, 3};
constexpr double thickness = 0.2, overlap = 0.001;
constexpr std::size_t parts_of_bay = 12;

/// Initialised from braces, so that what is drawn for it is drawn in order.
struct Box {
  Point low, high;
  Squares squares;
};

/// The corner that is `at` of the squares along each axis; the last is exactly at `high`.
Point corner(const Box& box, const Squares& at) {
  Point p;
  for (int d = 0; d < 3; ++d) {
    const double part = static_cast<double>(at[d]) / box.squares[d];
    p[d] = at[d] == box.squares[d] ? box.high[d] : box.low[d] + (box.high[d] - box.low[d]) * part;
  }
  return p;
}

/// A box whose sides are grids.
TriangleMesh mesh_of(const Box& box) {
  const auto& [low, high, squares] = box;
  TriangleMesh mesh;
  std::map<Squares, Index> made;
  const auto vertex = [&](const Squares& at) {
    const auto [place, fresh] = made.try_emplace(at, static_cast<Index>(mesh.vertices.size()));
    if (fresh) mesh.vertices.push_back(corner(box, at));
    return place->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool far : {false, true})
      for (Index i = 0; i < squares[u]; ++i)
        for (Index j = 0; j < squares[v]; ++j) {
          const auto at = [&](Index di, Index dj) {
            Squares place;
            place[axis] = far ? squares[axis] : 0, place[u] = i + di, place[v] = j + dj;
            return vertex(place);
          };
          const std::array<Index, 4> q{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
          if (far)
            mesh.triangles.insert(mesh.triangles.end(), {{q[0], q[1], q[2]}, {q[0], q[2], q[3]}});
          else
            mesh.triangles.insert(mesh.triangles.end(), {{q[0], q[2], q[1]}, {q[0], q[3], q[2]}});
        }
  }
  return mesh;
}

/// A prism about a line along `axis` through `centre`, from `low` to `high` on it.
struct Prism {
  int axis;
  Point centre;
  double low, high, radius;
  Index sides;
};

void add_prism(TriangleMesh& mesh, const Prism& prism) {
  const auto& [axis, centre, low, high, radius, sides] = prism;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto first = static_cast<Index>(mesh.vertices.size());
  for (const double end : {low, high}) {
    Point p = centre;
    p[axis] = end;
    mesh.vertices.push_back(p);
    for (Index k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      p[u] = centre[u] + radius * std::cos(angle), p[v] = centre[v] + radius * std::sin(angle);
      mesh.vertices.push_back(p);
    }
  }
  const Index top = first + sides + 1;
  for (Index k = 0; k < sides; ++k) {
    const Index here = 1 + k, next = 1 + (k + 1) % sides;
    mesh.triangles.insert(mesh.triangles.end(), {{first, first + next, first + here},
                                                 {top, top + here, top + next},
                                                 {first + here, first + next, top + next},
                                                 {first + here, top + next, top + here}});
  }
}

class Building {
 public:
  explicit Building(const Parts& options) : options_(options), random_(options.seed) {
    const std::size_t bays = (options.objects + parts_of_bay - 1) / parts_of_bay;
    while (side_ * side_ * side_ < bays) ++side_;
  }

  std::vector<NamedMesh> parts() {
    std::vector<NamedMesh> all;
    for (std::size_t b = 0; all.size() < options_.objects; ++b)
      add_bay(Vec3<std::size_t>(b % side_, b / side_ % side_, b / side_ / side_).cast<double>(),
              all);
    all.resize(options_.objects);
    return all;
  }

 private:
  /// Where a face stands that is joined to a face at `plane` of a part on its low side.
  double joined(double plane) {
    const std::size_t kind = options_.joints == "mixed"     ? joints_++ % 3
                             : options_.joints == "flush"   ? 0
                             : options_.joints == "overlap" ? 1
                                                            : 2;
    if (kind == 0) return plane;
    if (kind == 1) return plane - overlap;
    return std::nextafter(plane, std::numeric_limits<double>::infinity());
  }
  /// The same of a part on its high side.
  double joined_below(double plane) { return -joined(-plane); }

  Index drawn(Index low, Index high) {
    return low + static_cast<Index>(random_.below(high - low + 1));
  }

  /// Coordinates begin beyond 0, where a unit in the last place is next to nothing.
  void add_bay(const Point& number, std::vector<NamedMesh>& all) {
    const Point low = (number + Point(1, 1, 1)).cwiseProduct(bay), high = low + bay;
    const double floor = low[2], ceiling = high[2] - thickness;
    const auto add = [&](const char* name, TriangleMesh mesh) {
      all.push_back({name, std::move(mesh)});
    };
    const auto add_box = [&](const char* name, const Box& box) { add(name, mesh_of(box)); };
    const auto add_round = [&](const char* name, const Prism& prism) {
      TriangleMesh mesh;
      add_prism(mesh, prism);
      add(name, std::move(mesh));
    };
    add_box("slab", {{joined(low[0]), joined(low[1]), floor - thickness},
                     {high[0], high[1], floor},
                     {drawn(2, 9), drawn(2, 9), 1}});
    // The second wall stands between the first and the next bay's.
    add_box("wall", {{low[0], low[1], joined(floor)},
                     {high[0], low[1] + thickness, joined_below(ceiling)},
                     {drawn(2, 9), 1, drawn(2, 7)}});
    add_box("wall", {{low[0], joined(low[1] + thickness), joined(floor)},
                     {low[0] + thickness, joined_below(high[1]), joined_below(ceiling)},
                     {1, drawn(2, 9), drawn(2, 7)}});
    add_round("column",
              {2, low + Point(2, 2, 0), joined(floor), joined_below(ceiling), 0.15, drawn(8, 48)});
    for (const int axis : {0, 1})
      add_round("pipe", {axis, low + Point(1 + 0.5 * axis, 1.5 - 0.5 * axis, 2.6 - 0.3 * axis),
                         joined(low[axis]), high[axis], random_.uniform(0.03, 0.12), drawn(8, 64)});
    for (int k = 0; k < 6; ++k) add("bolt", bolt(low, k));
  }

  /// Its head stands on the slab, its shaft in it.
  TriangleMesh bolt(const Point& low, int k) {
    const double head = joined(low[2]);
    const Point at = low + Point(1 + 0.3 * k, 3, 0);
    TriangleMesh mesh;
    add_prism(mesh, {2, at, head, low[2] + random_.uniform(0.01, 0.03), 0.03, 6});
    add_prism(mesh, {2, at, low[2] - 0.75 * thickness, head, 0.015, drawn(6, 24)});
    return mesh;
  }

  const Parts& options_;
  Random random_;
  std::size_t side_ = 1, joints_ = 0;
};

}  // namespace

void Parts::check() const {
  need(joints == "flush" || joints == "overlap" || joints == "apart" || joints == "mixed",
       "joints: must be flush, overlap, apart or mixed");
  need(objects <= std::size_t{1} << 20, "objects: more than 2^20 parts");
  need_few_poses(frames, objects);
}

std::vector<NamedMesh> Parts::own_meshes() const {
  check();
  return Building(*this).parts();
}

Array<double> Parts::generate(std::span<const Extent>, const TouchesAny&) const {
  check();
  Array<double> trace{{frames, objects, 7}, {}};
  trace.data.reserve(frames * objects * 7);
  for (std::size_t k = 0; k < frames * objects; ++k)
    trace.data.insert(trace.data.end(), {0, 0, 0, 1, 0, 0, 0});
  return trace;
}

}  // namespace bvlab
