// SPDX-License-Identifier: BSD-3-Clause
/// A file of several parts: which of them touch, and what the file's unit changes.
#include <cstdio>
#include <map>
#include <string>

#include "experiments/scenes/read_mesh.hpp"
#include "traversal/counters.hpp"
#include "traversal/queries.hpp"
#include "traversal/world.hpp"

using namespace bvlab;

/// A cube of 10 millimetres, as an object of an OBJ file.
std::string cube(const std::string& name, int at) {
  std::string text = "o " + name + "\n";
  for (const int x : {at, at + 10})
    for (const char* yz : {" 0 0\n", " 0 10\n", " 10 0\n", " 10 10\n"})
      text += "v " + std::to_string(x) + yz;
  return text +
         "f -8 -7 -5 -6\nf -4 -2 -1 -3\nf -8 -4 -3 -7\nf -6 -5 -1 -2\nf -8 -6 -2 -4\n"
         "f -7 -3 -1 -5\n";
}

void print_touching(const std::string& file, const ReadOptions& options) {
  // From a file on the disk: read_parts(path, options).
  const std::vector<MeshPart> parts = parse_parts(file, "assembly.obj", options);
  std::map<const TriangleMesh*, Recommended::Hierarchy> trees;  // parts alike share a mesh
  std::vector<Recommended::Shape> shapes;
  for (const MeshPart& part : parts) {
    const auto known = trees.try_emplace(part.mesh.get(), Recommended::hierarchy(*part.mesh)).first;
    shapes.push_back({part.mesh.get(), &known->second});
  }
  World world(shapes);
  for (std::uint32_t i = 0; i < parts.size(); ++i) world.move(i, parts[i].pose);
  NotCounting counter;
  world.update(
      counter, [](const ObjectPair&) { return Touching(); },
      [&](std::uint32_t, const ObjectPair& pair, const Touching& query) {
        if (query.touching())
          std::printf("%s and %s touch at x = %g\n", parts[pair.i].name.c_str(),
                      parts[pair.j].name.c_str(), parts[pair.j].mesh->vertices[0][0]);
      },
      [](std::uint32_t) {});
}

// Without memory, the program ends. NOLINTNEXTLINE(bugprone-exception-escape)
int main() {
  const std::string file = cube("plate", 0) + cube("washer", 10) + cube("bolt", 25);
  print_touching(file, {});
  print_touching(file, {.scale = 0.001});
}
