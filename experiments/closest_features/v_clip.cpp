// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/closest_features/v_clip.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace bvlab::closest_features {

void VClip::Clipped::cut(double at_from, double at_to, Feature neighbour) {
  if (excluded) return;
  if (at_from < 0 && at_to < 0) {
    excluded = true, excluding = neighbour;
  } else if (at_from < 0) {
    const double s = at_from / (at_from - at_to);
    if (s > low) low = s, by_low = neighbour;
  } else if (at_to < 0) {
    const double s = at_from / (at_from - at_to);
    if (s < high) high = s, by_high = neighbour;
  }
}

/// The edge of `side` in the other one's frame.
VClip::Clipped VClip::edge_across(int side) const {
  const auto& edge = of(side).edges()[features_[side].index];
  Clipped clipped;
  clipped.from = posed_->across(side, edge.tail);
  clipped.to = posed_->across(side, edge.head);
  return clipped;
}

/// Moves `side` to the neighbour at whose plane the other one's edge leaves its region, if the
/// distance to it goes on falling there. `slope(s)` has the sign of the distance's derivative along
/// the edge.
template <class Slope>
bool VClip::follow(int side, const Clipped& clipped, const Slope& slope) {
  std::optional<Feature> next;
  if (clipped.excluded)
    next = clipped.excluding;
  else if (clipped.by_low && slope(clipped.low) > 0)
    next = clipped.by_low;
  else if (clipped.by_high && slope(clipped.high) < 0)
    next = clipped.by_high;
  else if (clipped.low > clipped.high)
    next = clipped.by_low;  // rounding: slopes say that neither plane matters
  if (next) features_[side] = *next;
  return next.has_value();
}

/// The vertex of `side` against that of the other: moves to an edge behind whose plane it lies.
bool VClip::leaves_vertex(int side) {
  const Polytope& p = of(side);
  const std::uint32_t v = features_[side].index;
  const Vec3<double> away = posed_->across(1 - side, features_[1 - side].index) - p.vertices()[v];
  for (const auto e : p.edges_at(v)) {
    ++effort_->vertices;
    if (away.dot(p.vertices()[p.other_end(e, v)] - p.vertices()[v]) <= 0) continue;
    features_[side] = {Kind::edge, e};
    return true;
  }
  return false;
}

VClip::Step VClip::vertex_vertex() {
  return leaves_vertex(0) || leaves_vertex(1) ? Step::moved : Step::nearest;
}

/// The edge of `side` against a point in its frame: moves to the neighbour whose plane the point
/// lies most behind.
bool VClip::leaves_edge(int side, const Vec3<double>& x) {
  const Polytope& p = of(side);
  const auto& e = p.edges()[features_[side].index];
  const Vec3<double> from_tail = x - p.vertices()[e.tail], from_head = x - p.vertices()[e.head];
  const std::pair<double, Feature> planes[] = {
      {from_tail.dot(e.along), {Kind::vertex, e.tail}},
      {-from_head.dot(e.along), {Kind::vertex, e.head}},
      {-from_tail.dot(e.into_left), {Kind::face, e.left}},
      {-from_tail.dot(e.into_right), {Kind::face, e.right}}};
  effort_->vertices += 4;
  const auto* worst = std::min_element(std::begin(planes), std::end(planes),
                                       [](auto& a, auto& b) { return a.first < b.first; });
  if (worst->first >= 0) return false;
  features_[side] = worst->second;
  return true;
}

/// The vertex is of `side`.
VClip::Step VClip::vertex_edge(int side) {
  const Polytope& p = of(side);
  const std::uint32_t v = features_[side].index;
  if (leaves_edge(1 - side, posed_->across(side, v))) return Step::moved;
  Clipped edge = edge_across(1 - side);
  const Vec3<double>& at = p.vertices()[v];
  for (const auto e : p.edges_at(v)) {
    const Vec3<double> out = p.vertices()[p.other_end(e, v)] - at;
    edge.cut(-out.dot(edge.from - at), -out.dot(edge.to - at), {Kind::edge, e});
    ++effort_->vertices;
  }
  const auto slope = [&](double s) { return (edge.to - edge.from).dot(edge.at(s) - at); };
  return follow(side, edge, slope) ? Step::moved : Step::nearest;
}

VClip::Step VClip::edge_edge() {
  for (const int side : {0, 1}) {
    const Polytope& p = of(side);
    const auto& own = p.edges()[features_[side].index];
    const Vec3<double> tail = p.vertices()[own.tail], head = p.vertices()[own.head];
    Clipped edge = edge_across(1 - side);
    const auto slope = [&](double s) {
      const Vec3<double> w = edge.at(s) - tail;
      return (edge.to - edge.from).dot(w - w.dot(own.along) * own.along);
    };
    edge.cut((edge.from - tail).dot(own.along), (edge.to - tail).dot(own.along),
             {Kind::vertex, own.tail});
    edge.cut((head - edge.from).dot(own.along), (head - edge.to).dot(own.along),
             {Kind::vertex, own.head});
    effort_->vertices += 2;
    if (follow(side, edge, slope)) return Step::moved;
    edge.cut(-(edge.from - tail).dot(own.into_left), -(edge.to - tail).dot(own.into_left),
             {Kind::face, own.left});
    edge.cut(-(edge.from - tail).dot(own.into_right), -(edge.to - tail).dot(own.into_right),
             {Kind::face, own.right});
    effort_->vertices += 2;
    if (follow(side, edge, slope)) return Step::moved;
  }
  return Step::nearest;
}

/// The vertex is of `side`, the face of the other.
VClip::Step VClip::vertex_face(int side) {
  const Polytope& p = of(1 - side);
  const auto& face = p.faces()[features_[1 - side].index];
  const std::uint32_t v = features_[side].index;
  const Vec3<double> x = posed_->across(side, v);
  double worst = 0;
  std::uint32_t beyond = 0;
  for (std::size_t k = 0; k < 3; ++k)
    if (const double d = face.inward(p, k).dot(x - p.vertices()[face.vertices[k]]); d < worst)
      worst = d, beyond = face.edges[k];
  effort_->vertices += 3;
  if (worst < 0) {
    features_[1 - side] = {Kind::edge, beyond};
    return Step::moved;
  }
  const double height = p.above(face, x);
  if (height == 0) return Step::touching;
  for (const auto e : of(side).edges_at(v)) {
    const double end = p.above(face, posed_->across(side, of(side).other_end(e, v)));
    ++effort_->vertices;
    if (height > 0 ? end >= height : end <= height) continue;
    features_[side] = {Kind::edge, e};
    return Step::moved;
  }
  return height > 0 ? Step::nearest : local_minimum(1 - side, x);
}

/// `x` lies under the face of `side`, and nothing near it lies higher: either it is inside, or some
/// other face sees it.
VClip::Step VClip::local_minimum(int side, const Vec3<double>& x) {
  const Polytope& p = of(side);
  double highest = 0;
  std::uint32_t sees = features_[side].index;
  for (std::uint32_t f = 0; f < p.faces().size(); ++f)
    if (const double d = p.above(p.faces()[f], x); d > highest) highest = d, sees = f;
  effort_->vertices += p.faces().size();
  if (highest <= 0) return Step::touching;
  features_[side] = {Kind::face, sees};
  return Step::moved;
}

/// The edge is of `side`, the face of the other.
VClip::Step VClip::edge_face(int side) {
  const Polytope& p = of(1 - side);
  const auto& face = p.faces()[features_[1 - side].index];
  Clipped edge = edge_across(side);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& inward = face.inward(p, k);
    const Vec3<double>& on = p.vertices()[face.vertices[k]];
    edge.cut(inward.dot(edge.from - on), inward.dot(edge.to - on), {Kind::edge, face.edges[k]});
  }
  effort_->vertices += 3;
  if (edge.empty()) {
    // The face's edge that is nearest to this one.
    const Triangle segment = {edge.from, edge.to, edge.to};
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto &a = p.vertices()[face.vertices[k]], &b = p.vertices()[face.vertices[(k + 1) % 3]];
      if (const double d = bvlab::distance(segment, {a, b, b}).distance; d < least)
        least = d, features_[1 - side] = {Kind::edge, face.edges[k]};
    }
    return Step::moved;
  }
  const double low = p.above(face, edge.at(edge.low)), high = p.above(face, edge.at(edge.high));
  effort_->vertices += 2;
  if (low * high <= 0) return Step::touching;
  const bool nearer_low = std::abs(low) <= std::abs(high);
  if (const auto& cut = nearer_low ? edge.by_low : edge.by_high) {
    features_[1 - side] = *cut;
  } else {
    const auto& own = of(side).edges()[features_[side].index];
    features_[side] = {Kind::vertex, nearer_low ? own.tail : own.head};
  }
  return Step::moved;
}

VClip::Step VClip::step() {
  const Kind a = features_[0].kind, b = features_[1].kind;
  if (a == Kind::vertex && b == Kind::vertex) return vertex_vertex();
  if (a == Kind::edge && b == Kind::edge) return edge_edge();
  const int lower = a < b ? 0 : 1;
  if (std::min(a, b) == Kind::edge) return edge_face(lower);
  return std::max(a, b) == Kind::edge ? vertex_edge(lower) : vertex_face(lower);
}

Witness VClip::witness(Step last) const {
  Witness result;
  result.apart = last != Step::touching;
  for (const int side : {0, 1}) {
    const auto [kind, index] = features_[static_cast<std::size_t>(side)];
    auto& corners = result.corners[static_cast<std::size_t>(side)];
    if (kind == Kind::vertex) corners.add(index);
    if (kind == Kind::edge)
      corners.add(of(side).edges()[index].tail), corners.add(of(side).edges()[index].head);
    if (kind == Kind::face)
      for (const auto v : of(side).faces()[index].vertices) corners.add(v);
  }
  return result;
}

bool VClip::certain(const Witness& witness) const {
  if (!witness.apart) return true;
  const auto [distance, on_a, on_b] = witness.nearest_points(*posed_);
  for (const int side : {0, 1}) {
    const Vec3<double> on = side == 0 ? on_a : on_b,
                       towards = side == 0 ? on_b - on_a : on_a - on_b;
    const auto& corners = witness.corners[static_cast<std::size_t>(side)];
    for (std::size_t k = 0; k < corners.count; ++k) {
      // No neighbour of a vertex within a flat piece of surface lies beyond it, on either side of
      // that: the other point must be on the outer one.
      if (!any_face_sees(side, corners.vertices[k], towards)) return false;
      for (const auto e : of(side).edges_at(corners.vertices[k])) {
        const Vec3<double> x = posed_->in_world(side, of(side).other_end(e, corners.vertices[k]));
        // A vertex that is nearer by this leaves the distance right to 1e-12; the second term is
        // what rounding makes of the product.
        const double room = 1e-12 * distance * distance +
                            16 * unit_roundoff<double> * distance * (x.norm() + on.norm());
        if (towards.dot(x - on) > room) return false;
      }
    }
  }
  return true;
}

bool VClip::any_face_sees(int side, std::uint32_t vertex, const Vec3<double>& towards) const {
  const Polytope& p = of(side);
  const Pose& pose = side == 0 ? posed_->pose_a : posed_->pose_b;
  const Vec3<double> there = pose.rotation.transpose() * towards;
  const auto edges = p.edges_at(vertex);
  return std::any_of(edges.begin(), edges.end(), [&](std::uint32_t e) {
    return there.dot(p.faces()[p.edges()[e].left].normal) > 0 ||
           there.dot(p.faces()[p.edges()[e].right].normal) > 0;
  });
}

Witness VClip::nearest(const PosedPair& posed, Effort& effort) {
  posed_ = &posed, effort_ = &effort;
  const std::size_t most = of(0).edges().size() + of(1).edges().size();
  for (std::size_t steps = 0; steps < most; ++steps) {
    ++effort.steps;
    const Step last = step();
    if (last == Step::moved) continue;
    const Witness result = witness(last);
    if (certain(result)) return result;
    break;
  }
  ++gave_up_;
  features_ = {};
  return Gjk<Support::scan>().nearest(posed, effort);
}

}  // namespace bvlab::closest_features
