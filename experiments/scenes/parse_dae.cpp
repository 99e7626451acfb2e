// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/polygon.hpp"
#include "experiments/scenes/xml.hpp"

namespace bvlab {
namespace {

using Transformation = SceneNode::Transformation;

/// Quarters of a turn are exact.
Mat3<double> rotation(const Vec3<double>& axis, double degrees) {
  double sine = std::sin(degrees * std::numbers::pi / 180);
  double cosine = std::cos(degrees * std::numbers::pi / 180);
  if (std::fmod(degrees, 90) == 0) sine = std::round(sine), cosine = std::round(cosine);
  const Vec3<double> n = axis.normalized();
  Mat3<double> cross;
  cross << 0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0;
  return cosine * Mat3<double>::Identity() + (1 - cosine) * n * n.transpose() + sine * cross;
}

Transformation looking_at(const XmlElement& element, const std::vector<double>& n) {
  const Vec3<double> eye(n[0], n[1], n[2]), at(n[3], n[4], n[5]), up(n[6], n[7], n[8]);
  const Vec3<double> back = (eye - at).normalized(), right = up.cross(back).normalized();
  if (!(right.norm() > 0.5) || !(back.norm() > 0.5)) element.fault("has no direction");
  Transformation t;
  t << right, back.cross(right), back, eye;
  return t;
}

/// COLLADA 1.4 and 1.5: what of it makes surfaces.
class Collada {
 public:
  Collada(std::string_view bytes, const std::string& name) : xml_(bytes, name), name_(name) {
    for (std::size_t i = 0; i < xml_.size(); ++i)
      if (const auto id = xml_[i].attribute("id")) {
        const auto [known, is_new] = ids_.try_emplace({xml_[i].name(), *id}, xml_[i].number());
        if (!is_new) known->second = twice;
      }
  }

  SceneGraph scene() {
    const XmlElement root = xml_.root();
    if (root.name() != "COLLADA") throw Unusable(name_, "not a COLLADA file");
    const auto shown = root.child("scene");
    const auto instance = shown ? shown->child("instance_visual_scene") : std::nullopt;
    if (!instance) throw Unusable(name_, "shows no scene");
    target(*instance, "visual_scene").each_child([&](const XmlElement& child) {
      if (child.name() == "node") visit(child, Transformation::Identity(), 0);
    });
    result_.note = note_.text();
    return std::move(result_);
  }

 private:
  /// What an element's attribute refers to by "#id".
  XmlElement target(const XmlElement& from, std::string_view name,
                    std::string_view attribute = "url") const {
    const std::string_view reference = from.needed(attribute);
    if (!reference.starts_with('#'))
      from.fault("refers to '" + std::string(reference) + "': other files are not read");
    const auto found = ids_.find({name, reference.substr(1)});
    const std::string what = std::string(name) + " '" + std::string(reference) + "'";
    if (found == ids_.end()) from.fault("there is no " + what);
    if (found->second == twice) from.fault("there are two " + what);
    return xml_[found->second];
  }

  static Transformation transformation_of(const XmlElement& element) {
    Transformation t = Transformation::Identity();
    const auto numbers = [&](std::size_t count) { return element.numbers(element.text(), count); };
    if (element.name() == "matrix") {
      const auto n = numbers(16);
      if (n[12] != 0 || n[13] != 0 || n[14] != 0 || n[15] != 1)
        element.fault("its last row is not 0 0 0 1");
      t = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(n.data());
    } else if (element.name() == "translate") {
      const auto n = numbers(3);
      t.col(3) = Vec3<double>(n[0], n[1], n[2]);
    } else if (element.name() == "scale") {
      const auto n = numbers(3);
      t.leftCols<3>().diagonal() = Vec3<double>(n[0], n[1], n[2]);
    } else if (element.name() == "rotate") {
      const auto n = numbers(4);
      const Vec3<double> axis(n[0], n[1], n[2]);
      if (axis.norm() == 0 && n[3] != 0) element.fault("has no axis");
      if (n[3] != 0) t.leftCols<3>() = rotation(axis, n[3]);
    } else if (element.name() == "lookat") {
      t = looking_at(element, numbers(9));
    } else if (element.name() == "skew") {
      element.fault("is not read");
    }
    return t;
  }

  void visit(const XmlElement& node, const Transformation& parent, int depth) {
    if (depth > 1000 || ++visited_ > most_nodes) node.fault("nodes without end");
    Transformation here = parent;
    node.each_child(
        [&](const XmlElement& child) { here = product(here, transformation_of(child)); });
    SceneNode found{
        std::string(node.attribute("name").value_or(node.attribute("id").value_or(""))), {}, here};
    node.each_child([&](const XmlElement& child) {
      if (child.name() == "instance_controller")
        child.fault("skins and morphs are not applied, so not read");
      if (child.name() == "instance_geometry")
        found.meshes.push_back(mesh_of(target(child, "geometry")));
    });
    if (!found.meshes.empty()) result_.nodes.push_back(std::move(found));
    node.each_child([&](const XmlElement& child) {
      if (child.name() == "node") visit(child, here, depth + 1);
      if (child.name() == "instance_node") visit(target(child, "node"), here, depth + 1);
    });
  }

  /// The number of a geometry's mesh.
  unsigned mesh_of(const XmlElement& geometry) {
    const auto [known, is_new] =
        meshes_.try_emplace(geometry.number(), static_cast<unsigned>(result_.meshes.size()));
    if (!is_new) return known->second;
    result_.meshes.emplace_back();
    geometry.each_child([&](const XmlElement& child) {
      if (child.name() == "mesh") {
        positions_.clear();
        child.each_child([&](const XmlElement& each) { read_primitives(each); });
      } else if (child.name() == "convex_mesh" || child.name() == "brep") {
        child.fault("is not read");
      }
    });
    return known->second;
  }

  static constexpr std::string_view kinds[] = {"triangles", "polylist", "polygons", "tristrips",
                                               "trifans"};

  /// What an element of primitives holds.
  struct Primitives {
    std::size_t stride = 0, offset = 0;
    std::optional<XmlElement> vertices;  // the input of that name
    std::vector<std::vector<std::uint32_t>> lists;
    std::optional<std::vector<std::uint32_t>> sizes;
  };

  static Primitives primitives_of(const XmlElement& element) {
    Primitives all;
    element.each_child([&](const XmlElement& child) {
      if (child.name() == "input") {
        const std::uint32_t at = child.index("offset", 0);
        if (at > 1000) child.fault("an offset of " + std::to_string(at));
        all.stride = std::max<std::size_t>(all.stride, at + 1);
        if (child.needed("semantic") == "VERTEX") all.vertices = child, all.offset = at;
      } else if (child.name() == "p") {
        all.lists.push_back(child.indices());
      } else if (child.name() == "vcount") {
        all.sizes = child.indices();
      } else if (child.name() == "ph") {
        child.fault("polygons with holes are not read");
      }
    });
    return all;
  }

  void read_primitives(const XmlElement& element) {
    const auto kind = std::find(std::begin(kinds), std::end(kinds), element.name());
    if (kind == std::end(kinds)) return;  // lines, sources, what others added
    const Primitives all = primitives_of(element);
    const std::uint32_t count = element.index("count");
    if (all.lists.empty() && count == 0) return;
    if (!all.vertices) element.fault("has no input VERTEX");
    const Positions from = positions_of(target(*all.vertices, "vertices", "source"));
    std::vector<std::uint32_t> corners;
    std::vector<std::size_t> ends;  // of each list, among the corners
    for (const auto& list : all.lists) {
      if (list.size() % all.stride != 0)
        element.fault("holds " + std::to_string(list.size()) + " indices, no multiple of " +
                      std::to_string(all.stride));
      for (std::size_t i = all.offset; i < list.size(); i += all.stride) {
        if (list[i] >= from.count) element.fault(no_vertex(list[i], from.count));
        corners.push_back(from.first + list[i]);
      }
      ends.push_back(corners.size());
    }
    if (element.name() == "triangles") {
      ends.assign(corners.size() / 3, 0);
      for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = 3 * (i + 1);
    } else if (element.name() == "polylist") {
      if (!all.sizes) element.fault("has no <vcount>");
      ends.clear();
      for (std::size_t end = 0; const std::uint32_t size : *all.sizes) ends.push_back(end += size);
    }
    append_faces(element, count, corners, ends);
  }

  void append_faces(const XmlElement& element, std::size_t count,
                    std::span<const std::uint32_t> corners, std::span<const std::size_t> ends) {
    if (ends.size() != count)
      element.fault("holds " + std::to_string(ends.size()) + " faces, where its count is " +
                    std::to_string(count));
    if (const std::size_t needed = ends.empty() ? 0 : ends.back(); needed != corners.size())
      element.fault("has " + std::to_string(corners.size()) + " corners, where its faces need " +
                    std::to_string(needed));
    for (std::size_t begin = 0; const std::size_t end : ends) {
      append(element, corners.subspan(begin, end - begin));
      begin = end;
    }
  }

  void append(const XmlElement& element, std::span<const std::uint32_t> corners) {
    TriangleMesh& mesh = result_.meshes.back();
    // Lines are counted from the beginning, so once.
    if (corners.size() < 3) note_.leave_out(note_.text().empty() ? element.place() : "");
    if (element.name() == "tristrips") return append_strip(mesh, corners);
    if (element.name() == "trifans") return append_fan(mesh, corners);
    append_polygon(mesh, corners);
  }

  /// Where in the mesh the positions of a source stand.
  struct Positions {
    std::uint32_t first, count;
  };

  Positions positions_of(const XmlElement& vertices) {
    std::optional<XmlElement> input;
    vertices.each_child([&](const XmlElement& child) {
      if (child.name() == "input" && child.needed("semantic") == "POSITION") input = child;
    });
    if (!input) vertices.fault("has no input POSITION");
    const XmlElement source = target(*input, "source", "source");
    const auto [known, is_new] = positions_.try_emplace(source.number());
    if (is_new) known->second = read_source(source);
    return known->second;
  }

  Positions read_source(const XmlElement& source) {
    const XmlElement accessor = source.needed_child("technique_common").needed_child("accessor");
    const XmlElement array = target(accessor, "float_array", "source");
    const auto numbers = array.numbers();
    const std::size_t promised = array.index("count");
    if (numbers.size() != promised)
      array.fault("holds " + std::to_string(numbers.size()) + " numbers, where its count is " +
                  std::to_string(promised));
    const std::size_t count = accessor.index("count"), stride = accessor.index("stride", 1),
                      offset = accessor.index("offset", 0);
    const auto axes = axes_of(accessor);
    if (stride <= *std::max_element(axes.begin(), axes.end()) || offset > numbers.size() ||
        (numbers.size() - offset) / stride < count)
      accessor.fault(std::to_string(count) + " times " + std::to_string(stride) + " from " +
                     std::to_string(offset) + " on are not in the " +
                     std::to_string(numbers.size()) + " numbers");
    auto& vertices = result_.meshes.back().vertices;
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (std::size_t i = 0; i < count; ++i) {
      const double* const at = &numbers[offset + i * stride];
      vertices.push_back({at[axes[0]], at[axes[1]], at[axes[2]]});
    }
    return {first, static_cast<std::uint32_t>(count)};
  }

  /// Which of a row's values are x, y and z: by their names, or else the first three that have one.
  static std::array<std::size_t, 3> axes_of(const XmlElement& accessor) {
    std::array<std::size_t, 3> named{}, first{};
    std::size_t number = 0, with_name = 0, found = 0;
    accessor.each_child([&](const XmlElement& child) {
      if (child.name() != "param") return;
      const std::string_view name = child.attribute("name").value_or("");
      if (!name.empty() && with_name < 3) first[with_name] = number;
      with_name += !name.empty();
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (name.size() == 1 && (name[0] | 0x20) == static_cast<char>('x' + axis))
          named[axis] = number, ++found;
      ++number;
    });
    if (with_name < 3) accessor.fault("fewer than three of its values have names");
    return found == 3 ? named : first;
  }

  static constexpr std::size_t most_nodes = 1000000;

  Xml xml_;
  const std::string& name_;
  static constexpr std::uint32_t twice = 0xffffffff;
  std::map<std::pair<std::string_view, std::string_view>, std::uint32_t> ids_;  // of each kind
  std::map<std::uint32_t, unsigned> meshes_;
  std::map<std::uint32_t, Positions> positions_;
  std::size_t visited_ = 0;
  SceneGraph result_;
  Note note_;
};

}  // namespace

SceneGraph parse_dae(std::string_view bytes, const std::string& name) {
  return Collada(bytes, name).scene();
}

}  // namespace bvlab
