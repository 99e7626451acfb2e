// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/peers/disagreements.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/files/numbers.hpp"
#include "experiments/peers/triangle_oracle.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "experiments/scenes/posed_triangles.hpp"
#include "traversal/all_pairs.hpp"

namespace bvlab {
namespace {

/// In rational numbers, where CGAL is there to say; by our own integers elsewhere.
bool exactly_touching(const Triangle& a, const Triangle& b) {
#if BVLAB_CGAL
  return oracle::intersect(a, b);
#else
  return intersect<Exact>(a, b);
#endif
}

/// One frame's judge.
class Judge {
 public:
  Judge(std::span<const TriangleMesh> meshes, const Trace& trace, std::uint32_t frame)
      : meshes_(meshes), poses_(trace.objects) {
    trace.poses(frame, poses_);
  }

  bool touching(std::uint32_t i, std::uint32_t j) const {
    const auto a = of(i), b = of(j);
    return std::any_of(a.begin(), a.end(), [&](const Triangle& s) {
      return std::any_of(b.begin(), b.end(), [&](const Triangle& t) {
        return boxes_meet(s, t) && exactly_touching(s, t);
      });
    });
  }

  bool touching(std::uint32_t i, std::uint32_t j, std::uint32_t s, std::uint32_t t) const {
    return exactly_touching(of(i)[s], of(j)[t]);
  }

  double distance(std::uint32_t i, std::uint32_t j) const {
    double least = std::numeric_limits<double>::infinity();
    const auto b = of(j);
    for (const Triangle& s : of(i))
      for (const Triangle& t : b) least = std::min(least, bvlab::distance(s, t).distance);
    return least;
  }

 private:
  std::vector<Triangle> of(std::uint32_t i) const {
    return posed_triangles(meshes_[i % meshes_.size()], poses_[i]);
  }

  std::span<const TriangleMesh> meshes_;
  std::vector<Pose> poses_;
};

bool same(double theirs, double ours, double slack) {
  return std::abs(theirs - ours) <= 1e-12 * ours + slack;
}

using Row = std::array<std::uint32_t, 5>;

std::vector<Row> odd_contacts(const ReplayResult& theirs, const ReplayResult& ours) {
  std::vector<Row> odd;
  std::set_symmetric_difference(theirs.contacts.begin(), theirs.contacts.end(),
                                ours.contacts.begin(), ours.contacts.end(),
                                std::back_inserter(odd));
  return odd;
}

}  // namespace

double distance_slack(std::span<const TriangleMesh> meshes, const Trace& trace) {
  double reach = 0, away = 0;
  for (const auto& mesh : meshes)
    for (const auto& vertex : mesh.vertices) reach = std::max(reach, vertex.norm());
  for (std::size_t row = 0; row < trace.frames * trace.objects; ++row)
    for (std::size_t d = 0; d < 3; ++d) away = std::max(away, std::abs(trace.values[7 * row + d]));
  // Two chains of about ten roundings each: into the world or the other's frame, and differences.
  return 20 * unit_roundoff<double> * (reach + away);
}

std::size_t differing(const ReplayResult& theirs, const ReplayResult& ours, double slack) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < ours.touching.size(); ++i)
    count += theirs.touching[i] != ours.touching[i];
  for (std::size_t i = 0; i < ours.distances.size(); ++i)
    count += !same(theirs.distances[i], ours.distances[i], slack);
  return count + odd_contacts(theirs, ours).size();
}

std::vector<Disagreement> disagreements(std::span<const TriangleMesh> meshes, const Trace& trace,
                                        const ReplayResult& theirs, const ReplayResult& ours,
                                        double slack, std::size_t most) {
  std::vector<Disagreement> list;
  const auto pairs = object_pairs(trace);
  const auto place = [&](std::size_t cell) {
    const auto& [i, j] = pairs[cell % pairs.size()];
    return Disagreement{static_cast<std::uint32_t>(cell / pairs.size()), i, j, {}, {}, {}, {}, {}};
  };
  for (std::size_t cell = 0; cell < ours.touching.size() && list.size() < most; ++cell) {
    if (theirs.touching[cell] == ours.touching[cell]) continue;
    Disagreement d = place(cell);
    d.theirs = std::to_string(theirs.touching[cell]), d.ours = std::to_string(ours.touching[cell]);
    d.exact = std::to_string(Judge(meshes, trace, d.frame).touching(d.i, d.j));
    list.push_back(std::move(d));
  }
  for (std::size_t cell = 0; cell < ours.distances.size() && list.size() < most; ++cell) {
    if (same(theirs.distances[cell], ours.distances[cell], slack)) continue;
    Disagreement d = place(cell);
    d.theirs = text_of(theirs.distances[cell]), d.ours = text_of(ours.distances[cell]);
    d.exact = text_of(Judge(meshes, trace, d.frame).distance(d.i, d.j));
    list.push_back(std::move(d));
  }
  for (const Row& row : odd_contacts(theirs, ours)) {
    if (list.size() >= most) break;
    const auto& [frame, i, j, s, t] = row;
    const bool found = std::binary_search(theirs.contacts.begin(), theirs.contacts.end(), row);
    list.push_back({frame, i, j, std::to_string(s), std::to_string(t), found ? "1" : "0",
                    found ? "0" : "1",
                    std::to_string(Judge(meshes, trace, frame).touching(i, j, s, t))});
  }
  return list;
}

}  // namespace bvlab
