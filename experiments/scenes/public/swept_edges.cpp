// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <limits>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/public/motions.hpp"
#include "experiments/scenes/read_mesh.hpp"
#include "hierarchies/geometry/scalar.hpp"

namespace bvlab {

Array<float> swept_edges(const PublicFiles& files, const std::string& before,
                         const std::string& after, std::size_t frames) {
  const TriangleMesh first = parse_mesh(files[before], before),
                     second = parse_mesh(files[after], after);
  if (first.vertices.size() != second.vertices.size())
    throw Unusable(after, "has " + std::to_string(second.vertices.size()) + " vertices, not " +
                              std::to_string(first.vertices.size()) + " as " + before);
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (const auto& corners : first.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(corners[k], corners[(k + 1) % 3]);
      edges.push_back({a, b});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Array<float> boxes{{frames, edges.size(), 6}, {}};
  boxes.data.reserve(frames * edges.size() * 6);
  for (std::size_t frame = 0; frame < frames; ++frame)
    for (const auto& edge : edges) {
      Vec3<double> lo = Vec3<double>::Constant(std::numeric_limits<double>::infinity()), hi = -lo;
      for (const auto v : edge)
        for (const std::size_t k : {frame, frame + 1}) {
          const double share = static_cast<double>(k) / static_cast<double>(frames);
          const Vec3<double> at =
              first.vertices[v] + share * (second.vertices[v] - first.vertices[v]);
          lo = lo.cwiseMin(at), hi = hi.cwiseMax(at);
        }
      for (int d = 0; d < 3; ++d) boxes.data.push_back(rounded_down<float>(lo[d]));
      for (int d = 0; d < 3; ++d) boxes.data.push_back(rounded_up<float>(hi[d]));
    }
  return boxes;
}

}  // namespace bvlab
