// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <cstring>

#include "experiments/scenes/public/motions.hpp"
#include "experiments/scenes/read_mesh.hpp"
#include "experiments/scenes/text_scanner.hpp"

namespace bvlab {
namespace {

struct Joint {
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  Vec3<double> axis = Vec3<double>::UnitZ();
};

/// As much of URDF as a chain of revolute joints is written in.
class Urdf {
 public:
  Urdf(const std::string& text, std::string name) : text_(text), name_(std::move(name)) {}

  std::vector<Joint> chain() const {
    std::vector<Joint> joints;
    for (std::size_t at = 0; (at = text_.find("<joint ", at)) != text_.npos;) {
      const std::size_t end = text_.find("</joint>", at);
      if (end == text_.npos) throw Unusable(name_, "a joint that does not end");
      const std::string_view element = std::string_view(text_).substr(at, end - at);
      if (element.find("type=\"revolute\"") != element.npos) joints.push_back(joint(element));
      at = end;
    }
    if (joints.empty()) throw Unusable(name_, "has no revolute joint");
    return joints;
  }

 private:
  Joint joint(std::string_view element) const {
    Joint joint;
    const Vec3<double> rpy = three(element, "<origin ", "rpy=\"");
    joint.origin.translation() = three(element, "<origin ", "xyz=\"");
    joint.origin.linear() = (Eigen::AngleAxisd(rpy[2], Vec3<double>::UnitZ()) *
                             Eigen::AngleAxisd(rpy[1], Vec3<double>::UnitY()) *
                             Eigen::AngleAxisd(rpy[0], Vec3<double>::UnitX()))
                                .toRotationMatrix();
    joint.axis = three(element, "<axis ", "xyz=\"");
    if (!(joint.axis.norm() > 0)) throw Unusable(name_, "an axis of length 0");
    joint.axis.normalize();
    return joint;
  }
  Vec3<double> three(std::string_view element, std::string_view tag, std::string_view key) const {
    const auto fault = [&] {
      return Unusable(name_, "a joint without three numbers in " + std::string(tag.substr(1)) +
                                 std::string(key.substr(0, key.size() - 2)));
    };
    const std::size_t from = element.find(tag);
    if (from == element.npos) throw fault();
    element = element.substr(from, element.find('>', from) - from);
    const std::size_t value = element.find(key);
    if (value == element.npos) throw fault();
    element.remove_prefix(value + key.size());
    TextScanner words(element.substr(0, element.find('"')), name_);
    if (!words.next_line()) throw fault();
    const double x = words.coordinate(), y = words.coordinate(), z = words.coordinate();
    return {x, y, z};
  }

  const std::string& text_;
  std::string name_;
};

/// A frame of the log: the pose of the base, and the angles.
struct Logged {
  Eigen::Isometry3d base;
  std::vector<double> angles;
};

/// Two lines of text (names, then a letter of type for each), then records with two bytes before
/// each. Integers and floats, four bytes each, little endian; another body's records are passed by.
std::vector<Logged> frames_of(const std::string& bytes, const std::string& name,
                              std::size_t joints) {
  const std::size_t names = bytes.find('\n'), types = bytes.find('\n', names + 1);
  if (names == bytes.npos || types == bytes.npos) throw Unusable(name, "has no lines of names");
  const std::string form = bytes.substr(names + 1, types - names - 1);
  constexpr std::size_t angles_at = 17;
  if (form.find_first_not_of("Iif") != form.npos || form.size() < angles_at + joints)
    throw Unusable(name, "is not a log of a body with " + std::to_string(joints) + " joints");
  std::vector<Logged> frames;
  const std::size_t size = 4 * form.size() + 2;
  for (std::size_t at = types + 1; at + size <= bytes.size(); at += size) {
    if (bytes.compare(at, 2, "\xaa\xbb") != 0)
      throw Unusable(name, "byte " + std::to_string(at) + ": not the start of a record");
    const auto number = [&](std::size_t column) {
      float value;
      std::memcpy(&value, bytes.data() + at + 2 + 4 * column, 4);
      if (!std::isfinite(value)) throw Unusable(name, "a number that is not finite");
      return static_cast<double>(value);
    };
    std::uint32_t body;
    std::memcpy(&body, bytes.data() + at + 2 + 8, 4);
    if (body != 0) continue;
    Logged frame;
    frame.base = Eigen::Translation3d(number(3), number(4), number(5)) *
                 Eigen::Quaterniond(number(9), number(6), number(7), number(8)).normalized();
    for (std::size_t k = 0; k < joints; ++k) frame.angles.push_back(number(angles_at + k));
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace

PublicMotion arm(const PublicFiles& files, const std::string& urdf, const std::string& log,
                 const std::vector<std::string>& meshes, const MotionRequest& request) {
  const auto joints = Urdf(files[urdf], urdf).chain();
  if (joints.size() + 1 < meshes.size())
    throw Unusable(urdf, "has " + std::to_string(joints.size()) + " joints");
  const auto frames = frames_of(files[log], log, joints.size());
  if (frames.size() < request.frames)
    throw Unusable(log, "has " + std::to_string(frames.size()) + " frames, not " +
                            std::to_string(request.frames));
  PublicMotion motion{{}, {{request.frames, meshes.size(), 7}, {}}};
  for (const auto& each : meshes)
    motion.meshes.push_back({stem(each), parse_mesh(files[each], each)});
  for (std::size_t frame = 0; frame < request.frames; ++frame) {
    Eigen::Isometry3d at = frames[frame].base;
    for (std::size_t link = 0; link < meshes.size(); ++link) {
      if (link > 0)
        at = at * joints[link - 1].origin *
             Eigen::AngleAxisd(frames[frame].angles[link - 1], joints[link - 1].axis);
      const Eigen::Quaterniond q = Eigen::Quaterniond(at.linear()).normalized();
      const Vec3<double> t = at.translation();
      motion.trace.data.insert(motion.trace.data.end(),
                               {t[0], t[1], t[2], q.w(), q.x(), q.y(), q.z()});
    }
  }
  return motion;
}

}  // namespace bvlab
