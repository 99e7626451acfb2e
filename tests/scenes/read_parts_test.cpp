// SPDX-License-Identifier: BSD-3-Clause
/// Files of several parts, and what of a scene is applied: its nodes' transformations, but neither
/// axes nor unit.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <csignal>
#include <string>

#include "experiments/files/guarded.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/scenes/read_mesh.hpp"
#include "tests/scenes/refusal.hpp"

namespace bvlab {
namespace {

/// The tetrahedron (0,0,0) (1,0,0) (0,2,0) (0,0,3) in a node that `transformation` moves.
std::string dae(const std::string& asset, const std::string& transformation = "") {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
         asset + R"(</asset>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 2 0 0 0 3</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="part">)" +
         transformation + R"(<instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

std::pair<Vec3<double>, Vec3<double>> box_of(const TriangleMesh& mesh) {
  Vec3<double> lo = mesh.vertices.at(0), hi = lo;
  for (const auto& v : mesh.vertices) lo = lo.cwiseMin(v), hi = hi.cwiseMax(v);
  return {lo, hi};
}

TEST(ReadParts, AxesAndUnitsAreNotApplied) {
  for (const std::string axis : {"X_UP", "Y_UP", "Z_UP", ""})
    for (const std::string unit : {"0.001", "1", "0.0254", ""}) {
      std::string asset;
      if (!unit.empty()) asset += "<unit meter=\"" + unit + "\" name=\"u\"/>";
      if (!axis.empty()) asset += "<up_axis>" + axis + "</up_axis>";
      const auto [lo, hi] = box_of(parse_mesh(dae(asset), "a.dae"));
      EXPECT_EQ(lo, Vec3<double>(0, 0, 0)) << asset;
      EXPECT_EQ(hi, Vec3<double>(1, 2, 3)) << asset;
      // What the file's nodes do is.
      const auto moved =
          parse_mesh(dae(asset, "<translate>10 20 30</translate><scale>2 2 2</scale>"), "a.dae");
      EXPECT_EQ(box_of(moved).first, Vec3<double>(10, 20, 30)) << asset;
      EXPECT_EQ(box_of(moved).second, Vec3<double>(12, 24, 36)) << asset;
    }
}

/// glTF with a triangle in its buffer; `nodes` show it.
std::string gltf(const std::string& roots, const std::string& nodes) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": )" + roots +
         R"(}], "nodes": )" + nodes +
         R"(,
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,)"
         R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

/// Posed and put together, parts are the mesh.
void expect_whole(const std::vector<MeshPart>& parts, const TriangleMesh& mesh) {
  std::size_t triangle = 0;
  for (const MeshPart& part : parts)
    for (std::size_t i = 0; i < part.mesh->triangles.size(); ++i, ++triangle) {
      ASSERT_LT(triangle, mesh.triangles.size());
      const auto posed = part.pose(part.mesh->corners(i)), whole = mesh.corners(triangle);
      for (int k = 0; k < 3; ++k) EXPECT_LT((posed[k] - whole[k]).norm(), 1e-5) << part.name;
      EXPECT_LT(
          (part.pose.rotation.transpose() * part.pose.rotation - Mat3<double>::Identity()).norm(),
          1e-14);
      EXPECT_GT(part.pose.rotation.determinant(), 0);
    }
  EXPECT_EQ(triangle, mesh.triangles.size());
}

TEST(ReadParts, NodesOfAScene) {
  const std::string text = gltf("[0, 4]", R"([
    {"name": "base", "mesh": 0, "children": [1, 2, 3]},
    {"name": "moved", "mesh": 0, "translation": [10, 0, 0]},
    {"name": "turned", "mesh": 0, "translation": [0, 5, 0], "rotation": [0, 0, 0.6, 0.8]},
    {"name": "large", "mesh": 0, "scale": [2, 3, -4], "rotation": [0.6, 0, 0, 0.8]},
    {"name": "empty"}])");
  const auto parts = parse_parts(text, "a.gltf");
  ASSERT_EQ(parts.size(), 4u);
  const char* names[] = {"base", "moved", "turned", "large"};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(parts[i].name, names[i]);
  expect_whole(parts, parse_mesh(text, "a.gltf"));
  // Nodes alike share their mesh; a pose is a rotation and a translation, the rest is in the mesh.
  EXPECT_EQ(parts[0].mesh, parts[1].mesh);
  EXPECT_EQ(parts[0].mesh, parts[2].mesh);
  EXPECT_NE(parts[0].mesh, parts[3].mesh);
  EXPECT_EQ(parts[1].pose.translation, Vec3<double>(10, 0, 0));
  const ReadOptions scaled{.scale = 0.5};
  const auto smaller = parse_parts(text, "a.gltf", scaled);
  EXPECT_EQ(smaller[1].pose.translation, Vec3<double>(5, 0, 0));
  EXPECT_EQ(smaller[0].mesh, smaller[1].mesh);
  expect_whole(smaller, parse_mesh(text, "a.gltf", scaled));
  const auto of_dae =
      parse_parts(dae("<up_axis>Z_UP</up_axis>", "<translate>1 2 3</translate>"), "a.dae");
  ASSERT_EQ(of_dae.size(), 1u);
  EXPECT_EQ(of_dae[0].name, "part");
  EXPECT_EQ(of_dae[0].pose.translation, Vec3<double>(1, 2, 3));
  std::string without_a_name = dae("");
  without_a_name.replace(without_a_name.find(" name=\"part\""), 12, "");
  EXPECT_EQ(parse_parts(without_a_name, "a.dae").at(0).name, "n");
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(ReadParts, DamagedLists) {
  const std::string lists = "2 1 0 1 3";
  for (const std::string wrong : {"#", "x", "1.0", "\xff", "-1", "-", "+", "1,2", "[", "0x1"})
    EXPECT_EQ(refusal(replaced(dae(""), lists, "2 " + wrong + " 0 1 3"), "a.dae"),
              "a.dae: line 9: <p>: '" + (wrong == "\xff" ? "?" : wrong) + "' is not an index");
  EXPECT_EQ(refusal(replaced(dae(""), lists, "2\n1\r\n\t0 1 3"), "a.dae"), "");
  EXPECT_TRUE(refusal(replaced(dae(""), lists, "2 99 0 1 3"), "a.dae").starts_with("a.dae: "));
  EXPECT_EQ(refusal(replaced(dae(""), "id=\"pa\" count", "id=\"pa\" cosnt"), "a.dae"),
            "a.dae: line 4: <float_array>: has no attribute count");
}

/// What assimp 5.2 reads as another mesh, or crashes at.
TEST(ReadParts, DamagedNumbers) {
  const std::string last = "0 0 3</float_array>";
  for (const std::string wrong : {"1.#IND", "1.#QNAN", "x", "1,5", "0x1", "3f"})
    EXPECT_EQ(refusal(replaced(dae(""), last, "0 0 " + wrong + "</float_array>"), "a.dae"),
              "a.dae: line 4: <float_array>: '" + wrong + "' is not a number");
  for (const std::string wrong : {"NaN", "INF", "-INF"})
    EXPECT_TRUE(refusal(replaced(dae(""), last, "0 0 " + wrong + "</float_array>"), "a.dae")
                    .ends_with(" is not finite"));
  for (const std::string count : {"9", "15", "0"})
    EXPECT_EQ(refusal(replaced(dae(""), "count=\"12\"", "count=\"" + count + "\""), "a.dae"),
              "a.dae: line 4: <float_array>: holds 12 numbers, where its count is " + count);
  std::string unnamed = dae("");
  for (const char* name : {" name=\"X\"", " name=\"Y\"", " name=\"Z\""})
    unnamed = replaced(unnamed, name, "");
  EXPECT_EQ(refusal(unnamed, "a.dae"),
            "a.dae: line 5: <accessor>: fewer than three of its values have names");
  EXPECT_EQ(refusal(replaced(dae(""), last, "0 .0 +3.0E0\n</float_array>"), "a.dae"), "");
}

/// What moves, packs or repeats vertices is not passed over.
TEST(ReadParts, WhatOfAGltfIsNotRead) {
  const std::string one = gltf("[0]", R"([{"mesh": 0}])"), asset = "{\"version\": \"2.0\"}";
  const auto with = [&](const std::string& more) {
    return refusal(replaced(one, asset, asset + ", " + more), "a.gltf");
  };
  for (const std::string extension : {"EXT_meshopt_compression", "X"})
    EXPECT_EQ(with("\"extensionsRequired\": [\"" + extension + "\"]"),
              "a.gltf: extensionsRequired[0]: the extension '" + extension + "' is not read");
  EXPECT_EQ(with("\"extensionsUsed\": [\"EXT_mesh_gpu_instancing\"]"),
            "a.gltf: extensionsUsed[0]: the extension 'EXT_mesh_gpu_instancing' is not read");
  for (const std::string list : {"\"extensionsRequired\": [\"KHR_materials_unlit\"]",
                                 "\"extensionsRequired\": [\"KHR_mesh_quantization\"]",
                                 "\"extensionsUsed\": [\"EXT_meshopt_compression\"]"})
    EXPECT_EQ(with(list), "");
  // Other versions, of which assimp would take some for 2.0.
  const auto of_version = [&](const std::string& version) {
    return refusal(replaced(one, "\"2.0\"", "\"" + version + "\""), "a.gltf");
  };
  for (const std::string version : {"2", "2.0", "2.1"}) EXPECT_EQ(of_version(version), "");
  for (const std::string version : {"2>0", "20", " 2.0", "3.0", ""})
    EXPECT_EQ(of_version(version),
              "a.gltf: asset.version: '" + version + "' is not read, only 1 and 2");
  // The same as a GLB.
  const std::string json = replaced(one, asset, asset + R"(, "extensionsRequired": ["X"])");
  std::string glb = "glTF";
  for (const auto word : {std::uint32_t{2}, static_cast<std::uint32_t>(20 + json.size()),
                          static_cast<std::uint32_t>(json.size()), std::uint32_t{0x4e4f534a}})
    glb.append(reinterpret_cast<const char*>(&word), sizeof word);
  EXPECT_EQ(refusal(glb + json, "a.glb"),
            "a.glb: extensionsRequired[0]: the extension 'X' is not read");
  // The bytes of the vertices as indices: 12 triangles, some of which have 128 or 63.
  const auto indexed = [&](const std::string& count) {
    return replaced(
        replaced(one, "\"POSITION\": 0}", "\"POSITION\": 0}, \"indices\": 1"), "\"VEC3\"}",
        R"("VEC3"}, {"bufferView": 0, "componentType": 5121, "type": "SCALAR", "count": )" + count +
            "}");
  };
  EXPECT_EQ(parse_mesh(indexed("12"), "a.gltf").triangles.size(), 4u);
  EXPECT_EQ(refusal(indexed("36"), "a.gltf"),
            "a.gltf: accessors[1]: vertex 128 does not exist: there are 3, from 0");
}

/// However a scene's nodes refer to each other, and whatever it counts, reading it ends.
TEST(ReadParts, CyclesAndHugeCounts) {
  for (const char* nodes : {R"([{"mesh": 0, "children": [0]}])",
                            R"([{"mesh": 0, "children": [1]}, {"mesh": 0, "children": [0]}])"})
    EXPECT_EQ(refusal(gltf("[0]", nodes), "a.gltf"), "a.gltf: nodes[0]: is the child of two nodes");
  const std::string one = gltf("[0]", R"([{"mesh": 0}])");
  for (const char* count : {"4", "4000000000", "-1", "1e300"})
    for (const char* what : {"\"count\": 3", "\"byteLength\": 36}],"})
      EXPECT_NE(refusal(replaced(one, what, replaced(what, what[1] == 'c' ? "3" : "36", count)),
                        "a.gltf"),
                "")
          << what << count;
  const std::string instance = "<instance_node url=\"#n\"/>";
  EXPECT_NE(refusal(dae("", instance), "a.dae"), "");
  for (const std::string& text : {one, dae("")})
    for (std::size_t length = 0; length + 10 < text.size(); length += 37)
      EXPECT_NE(refusal(text.substr(0, length), &text == &one ? "a.gltf" : "a.dae"), "");
}

TEST(Guarded, TellsHowWorkEnded) {
  const Guard guard{1, 1 << 28};
  const std::string large(3000000, 'x');
  EXPECT_EQ(guarded(guard, [&] { return large; }).bytes, large);
  EXPECT_EQ(guarded(guard, [] { return std::string(); }).signal, 0);
  const auto endless = [] {
    for (volatile int i = 0;; i = i + 1) {
    }
    return std::string();
  };
  EXPECT_EQ(guarded(guard, endless).signal, SIGXCPU);
  EXPECT_EQ(guarded(guard, [] { return raise(SIGSEGV), std::string(); }).signal, SIGSEGV);
  EXPECT_EQ(guarded(guard, [] { return std::string(std::size_t{1} << 30, 'x'); }).signal, SIGABRT);
}

TEST(ReadParts, MarksAndEncodings) {
  const std::string nodes = gltf("[0]", R"([{"mesh": 0}])"), node = dae("");
  for (const auto& [name, text] : {std::pair("a.gltf", nodes), std::pair("a.dae", node)}) {
    std::string little = "\xff\xfe", big = "\xfe\xff";
    for (const char c : text) {
      little.append({c, '\0'});
      big.append({'\0', c});
    }
    for (const auto& bytes : {"\xef\xbb\xbf" + text, little, big})
      EXPECT_EQ(parse_mesh(bytes, name).triangles, parse_mesh(text, name).triangles) << name;
  }
}

TEST(ReadParts, ObjectsGroupsAndSolids) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  const auto parts = parse_parts(vertices +
                                     "f 1 2 3\ng left side\nf 2 3 4\ng part#1 # a comment\n"
                                     "f 1 3 4\ng left side\nf 1 2 3 4\ng empty\n",
                                 "a.obj");
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_EQ(parts[0].name, "");
  EXPECT_EQ(parts[1].name, "left side");
  EXPECT_EQ(parts[2].name, "part#1");
  EXPECT_EQ(parts[1].mesh->triangles.size(), 3u);
  EXPECT_EQ(parts[2].mesh->vertices.size(), 3u);
  EXPECT_EQ(parts[2].mesh->vertices[2], Vec3<double>(0, 0, 1));
  const auto objects =
      parse_parts(vertices + "o a\ng x\nf 1 2 3\ng y\nf 2 3 4\no b\nf 1 3 4\n", "a.obj");
  ASSERT_EQ(objects.size(), 3u);
  EXPECT_EQ(objects[0].name, "a/x");
  EXPECT_EQ(objects[2].name, "b");
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
      "0\nendloop\nendfacet\n";
  const auto solids = parse_parts(
      "solid a b\n" + facet + "endsolid a b\nsolid c\n" + facet + facet + "endsolid c\n", "a.stl");
  ASSERT_EQ(solids.size(), 2u);
  EXPECT_EQ(solids[0].name, "a b");
  EXPECT_EQ(solids[1].mesh->triangles.size(), 2u);
  EXPECT_EQ(parse_parts("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "a.off").size(), 1u);
}

TEST(ReadParts, ScaleIsChecked) {
  const std::string off = "OFF\n3 1 0\n0 0 0\n1e300 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(parse_mesh(off, "a.off", {.scale = 0.001}).vertices[2], Vec3<double>(0, 0.001, 0));
  for (const double scale : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e10})
    EXPECT_THROW(parse_mesh(off, "a.off", {.scale = scale}), Unusable) << scale;
}

}  // namespace
}  // namespace bvlab
