// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/mesh_formats.hpp"
#include "experiments/scenes/unzipped.hpp"
#include "experiments/scenes/xml.hpp"

namespace bvlab {
namespace {

using Transformation = SceneNode::Transformation;

/// The part of the package that has the model.
std::string model_of(std::string_view bytes, const std::string& name) {
  const auto relations = unzipped(bytes, "_rels/.rels", name);
  if (!relations) throw Unusable(name, "not a 3MF file: holds no _rels/.rels");
  const Xml xml(*relations, name);
  std::string path;
  xml.root().each_child([&](const XmlElement& each) {
    if (path.empty() && each.attribute("Type").value_or("").ends_with("/3dmodel"))
      path = each.needed("Target");
  });
  if (path.empty()) throw Unusable(name, "not a 3MF file: names no model");
  path.erase(0, path.find_first_not_of('/'));
  auto model = unzipped(bytes, path, name);
  if (!model) throw Unusable(name, "its model '" + path + "' is missing");
  return std::move(*model);
}

/// A point is a row, to the left of the matrix.
Transformation transformation_of(const XmlElement& element) {
  Transformation t = Transformation::Identity();
  if (const auto written = element.attribute("transform")) {
    const auto n = element.numbers(*written, 12);
    t = Eigen::Map<const Transformation>(n.data());
  }
  return t;
}

class Model {
 public:
  Model(std::string_view bytes, const std::string& name) : xml_(bytes, name), name_(name) {}

  SceneGraph scene() {
    const XmlElement root = xml_.root();
    if (root.name() != "model") root.fault("not a 3MF model");
    require_extensions(root);
    root.needed_child("resources").each_child([&](const XmlElement& child) {
      if (child.name() == "object" &&
          !objects_.try_emplace(child.index("id"), child.number()).second)
        child.fault("a second object of that id");
    });
    root.needed_child("build").each_child([&](const XmlElement& item) {
      if (item.name() == "item") visit(item, Transformation::Identity(), 0);
    });
    return std::move(result_);
  }

 private:
  static void require_extensions(const XmlElement& root) {
    std::string_view needed = root.attribute("requiredextensions").value_or("");
    while (!needed.empty()) {
      const std::string_view prefix = needed.substr(0, needed.find(' '));
      needed.remove_prefix(std::min(prefix.size() + 1, needed.size()));
      const std::string_view extension =
          root.attribute("xmlns:" + std::string(prefix)).value_or("");
      // Colours; identifiers, and objects in other parts, which are refused where they are.
      if (!prefix.empty() && extension.find("/material/") == extension.npos &&
          extension.find("/production/") == extension.npos)
        root.fault("needs the extension '" + std::string(prefix) + "', which is not read");
    }
  }

  /// An item or a component: an object, and where it is.
  void visit(const XmlElement& place, const Transformation& parent, int depth) {
    if (depth > 100 || ++visited_ > most_nodes) place.fault("objects without end");
    if (place.attribute("path")) place.fault("objects of other models are not read");
    const std::uint32_t id = place.index("objectid");
    const auto found = objects_.find(id);
    if (found == objects_.end()) place.fault("there is no object " + std::to_string(id));
    const XmlElement object = xml_[found->second];
    const Transformation here = product(parent, transformation_of(place));
    const auto mesh = object.child("mesh"), components = object.child("components");
    if (!mesh && !components) object.fault("has neither a mesh nor components");
    if (mesh)
      result_.nodes.push_back(
          {std::string(object.attribute("name").value_or("")), {mesh_of(*mesh)}, here});
    if (components)
      components->each_child([&](const XmlElement& child) { visit(child, here, depth + 1); });
  }

  unsigned mesh_of(const XmlElement& element) {
    const auto [known, is_new] =
        meshes_.try_emplace(element.number(), static_cast<unsigned>(result_.meshes.size()));
    if (!is_new) return known->second;
    TriangleMesh& mesh = result_.meshes.emplace_back();
    element.each_child([&](const XmlElement& child) {
      if (child.name() == "beamlattice") child.fault("beams are not read");
    });
    element.needed_child("vertices").each_child([&](const XmlElement& vertex) {
      if (vertex.name() != "vertex") vertex.fault("is no vertex");
      mesh.vertices.push_back({vertex.number("x"), vertex.number("y"), vertex.number("z")});
    });
    element.needed_child("triangles").each_child([&](const XmlElement& triangle) {
      if (triangle.name() != "triangle") triangle.fault("is no triangle");
      auto& corners = mesh.triangles.emplace_back();
      constexpr const char* names[] = {"v1", "v2", "v3"};
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = triangle.index(names[k]);
        if (corners[k] >= mesh.vertices.size())
          triangle.fault(no_vertex(corners[k], mesh.vertices.size()));
      }
    });
    return known->second;
  }

  static constexpr std::size_t most_nodes = 1000000;

  Xml xml_;
  const std::string& name_;
  std::map<std::uint32_t, std::uint32_t> objects_;
  std::map<std::uint32_t, unsigned> meshes_;
  std::size_t visited_ = 0;
  SceneGraph result_;
};

}  // namespace

SceneGraph parse_3mf(std::string_view bytes, const std::string& name) {
  const std::string model = model_of(bytes, name);
  return Model(model, name).scene();
}

}  // namespace bvlab
