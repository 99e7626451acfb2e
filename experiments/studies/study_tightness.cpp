// SPDX-License-Identifier: BSD-3-Clause
/// How tightly volumes enclose their triangles, level by level of the tree, as tests feel it.
///
/// A probe is a point at a known distance from the triangles of a node. The node's volume says that
/// it is at least `gap` away, and what it leaves out of the distance, divided by the diameter of
/// the triangles, is what is recorded: 0 for a volume that tells distances as its triangles do.
///
/// The relative: tau, the farthest that a point of the volume is from the triangles (their
/// Hausdorff distance), over the same diameter (gottschalk2000thesis). Where the gap to a point is
/// the distance to the volume, what is left out is at most tau, since the volume's nearest point is
/// that near the triangles, and reaches it at a probe inside; so `largest` is below tau over the
/// diameter, and the mean is the average for tests of which that is the worst. Where the gap is
/// less than the distance to the volume, that is counted, too: tests feel it.
///
/// Probes lie off the surface (points of it by area) in any direction, by up to one diameter: there
/// is where a traversal meets a node, for from farther away its parent is enough. Uniformly, since
/// no volume leaves out more than the distance, and near probes would all say the same. Every level
/// has about as many, dealt out evenly to that number of its nodes; a leaf belongs to the level
/// in its place; nodes that are a point are left out.
#include <algorithm>
#include <cmath>
#include <random>

#include "experiments/replay/hierarchies_of.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/triangle_test.hpp"
#include "experiments/studies/statistics.hpp"
#include "experiments/studies/study.hpp"
#include "hierarchies/geometry/enclosing_sphere.hpp"

namespace bvlab {
namespace {

StudyParameters parameters() {
  std::vector<std::string> all;
  for (const auto& volume : volumes()) all.push_back(volume.name);
  return {
      words_parameter("mesh", {"bunny"}, "meshes, NAME or NAME:POLYGONS"),
      words_parameter("volumes", all, "that are fitted", all),
      words_parameter("builds", {Variant{}.build}, "see `bvlab list builds`"),
      words_parameter("fits", {"published", "tight"}, "how volumes are fitted"),
      one(wholes_parameter("polygons", {5000}, {1, 1e6}, "triangles of each mesh")),
      one(wholes_parameter("leaf_size", {1}, {1, 1 << 16}, "triangles in a leaf, at most")),
      one(wholes_parameter("nodes", {64}, {1, 1e6}, "nodes of a level that are probed, at most")),
      one(wholes_parameter("probes", {1024}, {1, 1e6}, "points for each level, at least")),
      one(wholes_parameter("seed", {1}, seeds, "of the random numbers"))};
}

/// Of a build, every volume by every fit.
std::vector<Variant> variants_of(const StudyDefinition& definition, const std::string& build) {
  std::vector<Variant> variants;
  for (const auto& volume : definition.words("volumes"))
    for (const auto& fit : definition.words("fits")) {
      Variant& variant = variants.emplace_back();
      variant.volume = volume, variant.build = build, variant.fit = fit;
      variant.leaf_size = static_cast<std::uint32_t>(definition.whole("leaf_size"));
    }
  return variants;
}

void check_variants(const StudyDefinition& definition) {
  for (const auto& build : definition.words("builds"))
    for (const Variant& variant : variants_of(definition, build)) bvlab::check(variant);
}

struct Probe {
  Vec3<double> at;
  double distance;  ///< from the triangles of its node
};

struct ProbedNode {
  std::uint32_t node;
  double diameter;  ///< of its triangles
  std::vector<Probe> probes;
};

struct ProbedLevel {
  std::size_t nodes;  ///< all there are; probed are some
  std::vector<ProbedNode> probed;
};

/// The largest distance of two corners: pairs are tried from the ball around them inward, until two
/// radii are less than what was found.
double diameter_of(const std::vector<Triangle>& triangles) {
  std::vector<Vec3<double>> points;
  for (const auto& t : triangles) points.insert(points.end(), t.begin(), t.end());
  const Vec3<double> centre = enclosing_sphere(points).centre;
  std::vector<std::pair<double, Vec3<double>>> outward;
  for (const auto& p : points) outward.emplace_back((p - centre).norm(), p);
  std::sort(outward.begin(), outward.end(),
            [](const auto& a, const auto& b) { return a.first > b.first; });
  double diameter = 0;
  for (std::size_t i = 0; i < outward.size(); ++i)
    for (std::size_t j = 0; j < i && outward[i].first + outward[j].first > diameter; ++j)
      diameter = std::max(diameter, (outward[i].second - outward[j].second).norm());
  return diameter;
}

/// Probes for the nodes of a topology, the same for every volume that is fitted to it.
class Prober {
 public:
  Prober(const TriangleMesh& mesh, const Topology& topology, const StudyDefinition& definition)
      : mesh_(mesh),
        topology_(topology),
        most_nodes_(definition.whole("nodes")),
        probes_(definition.whole("probes")),
        random_(definition.whole("seed")) {}

  std::vector<ProbedLevel> levels() {
    std::vector<ProbedLevel> levels;
    for (std::vector<std::uint32_t> level{0}, next; !level.empty();
         level = std::move(next), next.clear()) {
      for (const auto node : level)
        if (const auto& [first, count] = topology_.nodes[node]; count == 0)
          next.push_back(first), next.push_back(first + 1);
      ProbedLevel& probed = levels.emplace_back();
      probed.nodes = level.size();
      std::shuffle(level.begin(), level.end(), random_);
      const std::size_t nodes = std::min(level.size(), most_nodes_);
      const std::size_t probes = (probes_ + nodes - 1) / nodes;
      for (const auto node : level) {
        if (probed.probed.size() == nodes) break;
        if (ProbedNode done = around(node, probes); done.diameter > 0)
          probed.probed.push_back(std::move(done));
      }
    }
    return levels;
  }

 private:
  ProbedNode around(std::uint32_t node, std::size_t probes) {
    std::vector<Triangle> triangles;
    collect(node, triangles);
    ProbedNode probed{node, diameter_of(triangles), {}};
    if (!(probed.diameter > 0)) return probed;
    std::vector<double> areas;
    for (const auto& [a, b, c] : triangles) areas.push_back((b - a).cross(c - a).norm());
    // Where there is no area, any triangle.
    if (std::all_of(areas.begin(), areas.end(), [](double area) { return !(area > 0); }))
      areas.assign(areas.size(), 1);
    std::discrete_distribution<std::size_t> by_area(areas.begin(), areas.end());
    for (std::size_t i = 0; i < probes; ++i) {
      const Vec3<double> p =
          point_of(triangles[by_area(random_)]) + probed.diameter * uniform_(random_) * direction();
      double least = std::numeric_limits<double>::infinity();
      for (const auto& t : triangles) least = std::min(least, distance(t, {p, p, p}).distance);
      probed.probes.push_back({p, least});
    }
    return probed;
  }

  void collect(std::uint32_t node, std::vector<Triangle>& triangles) const {
    const auto& [first, count] = topology_.nodes[node];
    if (count == 0) collect(first, triangles), collect(first + 1, triangles);
    for (std::uint32_t place = first; place < first + count; ++place)
      triangles.push_back(mesh_.corners(topology_.primitives[place]));
  }

  Vec3<double> point_of(const Triangle& triangle) {
    double s = uniform_(random_), t = uniform_(random_);
    if (s + t > 1) s = 1 - s, t = 1 - t;
    return triangle[0] + s * (triangle[1] - triangle[0]) + t * (triangle[2] - triangle[0]);
  }

  Vec3<double> direction() {
    const double x = normal_(random_), y = normal_(random_), z = normal_(random_);
    return Vec3<double>(x, y, z).stableNormalized();
  }

  const TriangleMesh& mesh_;
  const Topology& topology_;
  std::size_t most_nodes_, probes_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_;
  std::normal_distribution<double> normal_;
};

/// What the volumes of each level leave out of its probes' distances, over the diameters,
/// ascending.
std::vector<std::vector<double>> left_out(const VolumeEntry& volume, const TriangleMesh& mesh,
                                          const Topology& topology, Fit fit,
                                          const std::vector<ProbedLevel>& levels) {
  std::vector<GapQuestion> questions;
  for (const auto& level : levels)
    for (const auto& [node, diameter, probes] : level.probed)
      for (const auto& probe : probes) questions.push_back({node, probe.at});
  const std::vector<double> gaps = volume.gaps(mesh, topology, fit, questions);
  std::vector<std::vector<double>> shares;
  auto told = gaps.begin();
  for (const auto& level : levels) {
    auto& of_level = shares.emplace_back();
    for (const auto& [node, diameter, probes] : level.probed)
      for (const auto& probe : probes) of_level.push_back((probe.distance - *told++) / diameter);
    std::sort(of_level.begin(), of_level.end());
  }
  return shares;
}

/// Of ascending values, between the two next to it.
double quantile(const std::vector<double>& values, double part) {
  const double place = part * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - std::floor(place)) * (values[above] - values[below]);
}

/// One row for each level that has a node larger than a point.
void add_rows(StudyRecord& record, const Variant& variant,
              const std::vector<std::vector<double>>& left,
              const std::vector<ProbedLevel>& levels) {
  for (std::size_t depth = 0; depth < levels.size(); ++depth) {
    const ProbedLevel& level = levels[depth];
    if (level.probed.empty()) continue;
    std::vector<double> diameters;
    for (const auto& node : level.probed) diameters.push_back(node.diameter);
    const auto& shares = left[depth];
    record.add(variant.volume, variant.build, variant.fit, depth, level.nodes, level.probed.size(),
               shares.size(), mean(diameters), mean(shares), shares.front(), quantile(shares, 0.25),
               quantile(shares, 0.5), quantile(shares, 0.75), shares.back());
  }
}

void run(const StudyDefinition& definition, StudyRecord& record) {
  record.each(definition.words("mesh"), [&](const std::string& name) {
    const TriangleMesh mesh = mesh_of(definition, name);
    for (const auto& build : definition.words("builds")) {
      const auto variants = variants_of(definition, build);
      const Topology topology = topology_of(mesh, variants.at(0));
      const auto levels = Prober(mesh, topology, definition).levels();
      for (const Variant& variant : variants) {
        const VolumeEntry& volume = volume_entry(variant.volume);
        const Fit fit = fit_of(variant);
        if (fit == Fit::tight && !volume.has_tight_fit) continue;
        add_rows(record, variant, left_out(volume, mesh, topology, fit, levels), levels);
      }
    }
  });
}

}  // namespace

const StudyKind studies::tightness = {
    "tightness",
    "what volumes leave out of distances, level by level of the tree",
    parameters,
    check_variants,
    {"mesh", "volume", "build", "fit", "level", "nodes", "probed", "probes", "diameter", "mean",
     "least", "lower_quartile", "median", "upper_quartile", "largest"},
    run};

}  // namespace bvlab
