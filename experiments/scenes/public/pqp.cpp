// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "experiments/scenes/public/motions.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

/// A file of numbers, wherever its lines end.
class Numbers {
 public:
  Numbers(const std::string& bytes, const std::string& name) : scanner_(bytes, name) {}

  double next() {
    find();
    return scanner_.coordinate();
  }
  /// How many things of `each` numbers follow.
  std::size_t count(std::size_t each) {
    find();
    const auto said = scanner_.integer("a count");
    if (said < 1 || static_cast<std::size_t>(said) > scanner_.bytes_left() / each)
      scanner_.fault("a count that the file is too short for");
    return static_cast<std::size_t>(said);
  }
  [[noreturn]] void fault(const std::string& what) const { scanner_.fault(what); }

 private:
  void find() {
    while (scanner_.at_line_end())
      if (!scanner_.next_line()) scanner_.fault("ends too early");
  }
  TextScanner scanner_;
};

TriangleMesh soup(const std::string& bytes, const std::string& name) {
  Numbers numbers(bytes, name);
  const std::size_t count = numbers.count(9);
  TriangleMesh mesh;
  for (std::size_t t = 0; t < count; ++t) {
    const auto first = static_cast<std::uint32_t>(3 * t);
    for (int k = 0; k < 3; ++k) {
      const double x = numbers.next(), y = numbers.next(), z = numbers.next();
      mesh.vertices.emplace_back(x, y, z);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// x y z qw qx qy qz of each step.
std::vector<std::array<double, 7>> steps_of(const std::string& bytes, const std::string& name,
                                            std::size_t frames) {
  Numbers numbers(bytes, name);
  const std::size_t count = numbers.count(12);
  if (count < frames)
    throw Unusable(name, "has " + std::to_string(count) + " frames, not " + std::to_string(frames));
  std::vector<std::array<double, 7>> steps;
  for (std::size_t step = 0; step < frames; ++step) {
    Mat3<double> rotation;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) rotation(row, column) = numbers.next();
    if (std::abs(rotation.determinant() - 1) > 1e-2) numbers.fault("a matrix that is no rotation");
    const Eigen::Quaterniond q = Eigen::Quaterniond(rotation).normalized();
    const double x = numbers.next(), y = numbers.next(), z = numbers.next();
    steps.push_back({x, y, z, q.w(), q.x(), q.y(), q.z()});
  }
  return steps;
}

}  // namespace

PublicMotion pqp_paths(const PublicFiles& files, const std::string& first,
                       const std::string& second, const MotionRequest& request) {
  PublicMotion motion{{}, {{request.frames, 2, 7}, {}}};
  std::vector<std::vector<std::array<double, 7>>> steps;
  for (const std::string& each : {first, second}) {
    motion.meshes.push_back({stem(each), soup(files[each + ".tris"], each + ".tris")});
    steps.push_back(steps_of(files[each + ".path"], each + ".path", request.frames));
  }
  for (std::size_t frame = 0; frame < request.frames; ++frame)
    for (const auto& of : steps)
      motion.trace.data.insert(motion.trace.data.end(), of[frame].begin(), of[frame].end());
  return motion;
}

}  // namespace bvlab
