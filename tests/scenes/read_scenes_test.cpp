// SPDX-License-Identifier: BSD-3-Clause
/// DAE, 3MF and glTF: what their nodes show, to the last digit of float64 where the file has it, or
/// a refusal by name; and XML that is none.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/read_mesh.hpp"
#include "experiments/scenes/xml.hpp"
#include "tests/scenes/refusal.hpp"
#include "tests/scenes/zipped.hpp"

namespace bvlab {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return at == text.npos ? text : text.replace(at, from.size(), to);
}

// --- DAE -----------------------------------------------------------------------------------------

const std::string faces =
    "<triangles count=\"4\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
    "<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>";
const std::string instance = "<instance_geometry url=\"#g\"/>";

/// A tetrahedron in nodes.
std::string dae(const std::string& nodes = "<node id=\"n\">" + instance + "</node>",
                const std::string& primitives = faces, const std::string& libraries = "") {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset/>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 2 0 0 0 0.1</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
)" + primitives +
         "</mesh></geometry></library_geometries>\n" + libraries +
         "<library_visual_scenes><visual_scene id=\"s\">" + nodes +
         "</visual_scene></library_visual_scenes>\n"
         "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";
}

std::string node(const std::string& transformation) {
  return "<node id=\"n\">" + transformation + instance + "</node>";
}

TEST(ReadScenes, DaeKeepsEveryDigitAndItsVertices) {
  const TriangleMesh mesh =
      parse_mesh(dae(node("<translate>388096.25 5948996.1 0</translate>")), "a.dae");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}));
  EXPECT_EQ(mesh.vertices.at(3), Vec3<double>(388096.25, 5948996.1, 0.1));
}

TEST(ReadScenes, DaeTransformationsOfNodes) {
  const auto last = [](const std::string& transformation) {
    return parse_mesh(dae(node(transformation)), "a.dae").vertices.at(2);
  };
  EXPECT_EQ(last("<matrix>0 -1 0 5 1 0 0 6 0 0 1 7 0 0 0 1</matrix>"), Vec3<double>(3, 6, 7));
  EXPECT_EQ(last("<translate>10 0 0</translate><rotate>0 0 2 90</rotate><scale>1 3 1</scale>"),
            Vec3<double>(4, 0, 0));
  EXPECT_EQ(last("<rotate>0 0 1 -180</rotate>"), Vec3<double>(0, -2, 0));
  EXPECT_LT((last("<rotate>0 0 1 30</rotate>") - Vec3<double>(-1, std::sqrt(3), 0)).norm(), 1e-15);
  EXPECT_EQ(last("<lookat>0 0 9 0 0 0 0 1 0</lookat>"), Vec3<double>(0, 2, 9));
  EXPECT_EQ(last("<rotate>0 0 0 0</rotate>"), Vec3<double>(0, 2, 0));
  const std::string within =
      "<node><scale>2 2 2</scale>" + node("<translate>1 0 0</translate>") + "</node>";
  EXPECT_EQ(parse_mesh(dae(within), "a.dae").vertices.at(2), Vec3<double>(2, 4, 0));
  const std::string shared =
      "<library_nodes><node id=\"l\">" + instance + "</node></library_nodes>";
  const TriangleMesh twice = parse_mesh(
      dae("<node><translate>1 0 0</translate><instance_node url=\"#l\"/></node>" + node(""), faces,
          shared),
      "a.dae");
  EXPECT_EQ(twice.vertices.size(), 8u);
  EXPECT_EQ(twice.vertices[2], Vec3<double>(1, 2, 0));
  for (const auto& [wrong, line] :
       {std::pair("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2</matrix>",
                  "<matrix>: its last row is not 0 0 0 1"),
        {"<matrix>1 0 0</matrix>", "<matrix>: holds 3 numbers, not 16"},
        {"<translate>1,5 0 0</translate>", "<translate>: '1,5' is not a number"},
        {"<scale>1 NaN 1</scale>", "<scale>: 'NaN' is not finite"},
        {"<rotate>0 0 0 90</rotate>", "<rotate>: has no axis"},
        {"<skew>45 0 1 0 1 0 0</skew>", "<skew>: is not read"},
        {"<instance_geometry url=\"#x\"/>", "<instance_geometry>: there is no geometry '#x'"},
        {"<instance_node url=\"#x\"/>", "<instance_node>: there is no node '#x'"},
        {"<instance_node url=\"b.dae#x\"/>",
         "<instance_node>: refers to 'b.dae#x': other files are not read"},
        {"<instance_controller url=\"#c\"/>",
         "<instance_controller>: skins and morphs are not applied, so not read"}})
    EXPECT_EQ(refusal(dae(node(wrong)), "a.dae"), std::string("a.dae: line 9: ") + line);
}

TEST(ReadScenes, DaePrimitives) {
  const auto of = [](const std::string& kind, const std::string& lists) {
    return dae(node(""), "<" + kind +
                             "><input semantic=\"VERTEX\" source=\"#v\" offset=\"1\"/>"
                             "<input semantic=\"NORMAL\" source=\"#p\" offset=\"0\"/>" +
                             lists + "</" + kind.substr(0, kind.find(' ')) + ">");
  };
  const auto triangles = [](const std::string& text) {
    return parse_mesh(text, "a.dae").triangles;
  };
  EXPECT_EQ(triangles(of("polylist count=\"2\"",
                         "<vcount>3 4</vcount><p>0 0 0 2 0 1 0 0 0 1 0 2 0 3</p>"))
                .size(),
            3u);
  EXPECT_EQ(
      triangles(of("polygons count=\"2\"", "<p>0 0 0 2 0 1</p><p>0 0 0 1 0 2 0 3</p>")).size(), 3u);
  EXPECT_EQ(triangles(of("tristrips count=\"2\"", "<p>0 0 0 1 0 2 0 3</p><p>0 3 0 2 0 1</p>")),
            (Triangles{{0, 1, 2}, {2, 1, 3}, {3, 2, 1}}));
  EXPECT_EQ(triangles(of("trifans count=\"1\"", "<p>0 0 0 1 0 2 0 3</p>")),
            (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(refusal(of("lines count=\"1\"", "<p>0 0 0 1</p>"), "a.dae"), "a.dae: has no triangles");
  for (const auto& [kind, lists, line] :
       {std::tuple("triangles count=\"2\"", "<p>0 0 0 2 0 1</p>",
                   "<triangles>: holds 1 faces, where its count is 2"),
        {"triangles count=\"1\"", "<p>0 0 0 2 0 1 0 0</p>",
         "<triangles>: has 4 corners, where its faces need 3"},
        {"triangles count=\"1\"", "<p>0 0 0 2 0</p>",
         "<triangles>: holds 5 indices, no multiple of 2"},
        {"triangles count=\"1\"", "<p>0 0 0 2 0 4</p>",
         "<triangles>: vertex 4 does not exist: there are 4, from 0"},
        {"polylist count=\"1\"", "<vcount>4</vcount><p>0 0 0 2 0 1</p>",
         "<polylist>: has 3 corners, where its faces need 4"},
        {"polylist count=\"1\"", "<p>0 0 0 2 0 1</p>", "<polylist>: has no <vcount>"},
        {"polygons count=\"1\"", "<ph><p>0 0</p><h>0 0</h></ph>",
         "<ph>: polygons with holes are not read"}})
    EXPECT_EQ(refusal(of(kind, lists), "a.dae"), std::string("a.dae: line 8: ") + line);
  std::string said;
  ReadOptions options;
  options.say = [&](const std::string& line) { said = line; };
  parse_mesh(of("polylist count=\"2\"", "<vcount>2 3</vcount><p>0 0 0 1 0 0 0 1 0 2</p>"), "a.dae",
             options);
  EXPECT_EQ(said,
            "a.dae: line 8: a face of fewer than three corners is left out; triangles are "
            "numbered without it");
}

TEST(ReadScenes, DaeSources) {
  const std::string array = "count=\"12\">0 0 0 1 0 0 0 2 0 0 0 0.1<",
                    accessor = "count=\"4\" stride=\"3\"";
  const TriangleMesh wide = parse_mesh(
      replaced(replaced(dae(), array, "count=\"18\">9 9 0 0 0 9 1 0 0 9 0 2 0 9 0 0 0.1 9<"),
               accessor, "offset=\"2\" count=\"4\" stride=\"4\""),
      "a.dae");
  EXPECT_EQ(wide.vertices.at(3), Vec3<double>(0, 0, 0.1));
  const std::string reversed =
      replaced(replaced(dae(), "name=\"X\"", "name=\"Q\""), "name=\"Z\"", "name=\"X\"");
  EXPECT_EQ(parse_mesh(replaced(reversed, "name=\"Q\"", "name=\"Z\""), "a.dae").vertices.at(1),
            Vec3<double>(0, 0, 1));
  for (const char* count : {"5", "4000000000"})
    EXPECT_EQ(
        refusal(replaced(dae(), accessor, std::string("stride=\"3\" count=\"") + count + "\""),
                "a.dae"),
        "a.dae: line 5: <accessor>: " + std::string(count) +
            " times 3 from 0 on are not in the 12 numbers");
  EXPECT_EQ(refusal(replaced(dae(), "<scene>", "<!--<scene>"), "a.dae"),
            "a.dae: line 10: truncated: a comment does not end");
  EXPECT_EQ(refusal(replaced(dae(), "#s", "#none"), "a.dae"),
            "a.dae: line 10: <instance_visual_scene>: there is no visual_scene '#none'");
}

// --- 3MF -----------------------------------------------------------------------------------------

std::string model(const std::string& build = "<item objectid=\"1\"/>",
                  const std::string& more = "") {
  return "<?xml version=\"1.0\"?>\n<model unit=\"inch\" xml:lang=\"en\" "
         "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources>"
         "<object id=\"1\" name=\"part\"><mesh>\n<vertices><vertex x=\"0\" y=\"0\" z=\"0\"/>"
         "<vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"0.1\" z=\"0\"/></vertices>\n"
         "<triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\"/></triangles></mesh></object>" +
         more + "</resources>\n<build>" + build + "</build></model>\n";
}

TEST(ReadScenes, ThreeMF) {
  const TriangleMesh one = parse_mesh(as_3mf(model()), "a.3mf");
  EXPECT_EQ(one.triangles, (Triangles{{0, 1, 2}}));
  EXPECT_EQ(one.vertices.at(2), Vec3<double>(0, 0.1, 0));
  const std::string twice =
      "<object id=\"2\"><components><component objectid=\"1\"/><component objectid=\"1\" "
      "transform=\"0 1 0 -1 0 0 0 0 1 5 6 7\"/></components></object>";
  const auto parts = parse_parts(
      as_3mf(model("<item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 0 0 3\"/>", twice)),
      "a.3mf");
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[1].name, "part");
  EXPECT_EQ(parts[0].mesh, parts[1].mesh);
  EXPECT_EQ(parts[1].pose.translation, Vec3<double>(5, 6, 10));
  EXPECT_EQ((parts[1].pose.rotation * Vec3<double>(1, 0, 0)).eval(), Vec3<double>(0, 1, 0));
  const auto refused = [](const std::string& from, const std::string& to) {
    return refusal(as_3mf(replaced(model(), from, to)), "a.3mf");
  };
  for (const auto& [from, to, line] :
       {std::tuple("<vertex x=\"1\"", "<vertex x=\"1,0\"",
                   "line 4: <vertex>: '1,0' is not a number"),
        {"<vertex x=\"1\"", "<vertex", "line 4: <vertex>: has no attribute x"},
        {"<vertex x=\"1\"", "<vertx x=\"1\"", "line 4: <vertx>: is no vertex"},
        {"<vertex x=\"1\"", "<vertex x=1", "line 4: attribute 'x': its value is not quoted"},
        {"<vertex x=\"1\"", "<vertex x=\"1\" x=\"2\"", "line 4: a second attribute 'x'"},
        {"<vertex x=\"1\"", "<vertex x=\"inf\"", "line 4: <vertex>: 'inf' is not finite"},
        {"<vertex x=\"1\"", "<vertex & x=\"1\"", "line 4: a name is missing"},
        {"</vertices>", "</vertex>", "line 4: </vertex> where <vertices> is open"},
        {"v3=\"2\"", "v3=\"3\"",
         "line 5: <triangle>: vertex 3 does not exist: there are 3, from 0"},
        {"v3=\"2\"", "v3=\"-1\"", "line 5: <triangle>: '-1' is not an index"},
        {"v3=\"2\"", "v3=\"2.5\"", "line 5: <triangle>: '2.5' is not an index"},
        {"<triangle ", "<triangel ", "line 5: <triangel>: is no triangle"},
        {"objectid=\"1\"", "objectid=\"4\"", "line 6: <item>: there is no object 4"},
        {"<item ", "<item transform=\"1 0 0 0 1 0 0 0 1 5 0\" ",
         "line 6: <item>: holds 11 numbers, not 12"},
        {"<item ", "<item p:path=\"/3D/b.model\" ",
         "line 6: <item>: objects of other models are not read"},
        {"unit=", "requiredextensions=\"b\" unit=",
         "line 2: <model>: needs the extension 'b', which is not read"},
        {"</model>", "", "line 7: truncated: <model> of line 2 does not end"},
        {"</model>", "</model><model/>", "line 6: a second root"},
        {"<item objectid=\"1\"/>", "", "has no triangles"}})
    EXPECT_EQ(refused(from, to), std::string("a.3mf: ") + line) << from << to;
  const std::string nested =
      "<object id=\"2\"><components><component objectid=\"2\"/></components></object>";
  EXPECT_EQ(refusal(as_3mf(model("<item objectid=\"2\"/>", nested)), "a.3mf"),
            "a.3mf: line 5: <component>: objects without end");
}

TEST(ReadScenes, DamagedZipFiles) {
  const std::string whole = as_3mf(model());
  EXPECT_EQ(refusal("x", "a.3mf"), "a.3mf: not a ZIP file");
  EXPECT_EQ(refusal(whole.substr(0, whole.size() - 1), "a.3mf"),
            "a.3mf: truncated: the ZIP file has no directory");
  EXPECT_EQ(refusal(replaced(whole, "<vertex x=\"1\"", "<vertex x=\"9\""), "a.3mf"),
            "a.3mf: damaged: a file in the ZIP file is not the one that was packed");
  EXPECT_EQ(refusal(zipped({{"a", "b"}}), "a.3mf"), "a.3mf: not a 3MF file: holds no _rels/.rels");
  for (std::size_t at = 0; at < whole.size(); at += 7)
    for (const char wrong : {'\0', '\xff', '<'}) {
      std::string bytes = whole;
      bytes[at] = wrong;
      refusal(bytes, "a.3mf");
      refusal(bytes.substr(0, at), "a.3mf");
    }
}

// --- XML -----------------------------------------------------------------------------------------

std::string text_of(const std::string& xml) {
  const std::string name = "a";
  try {
    const Xml read(xml, name);
    return std::string(read.root().text()) + std::string(read.root().attribute("x").value_or(""));
  } catch (const Unusable& refusal) {
    return refusal.what();
  }
}

TEST(Xml, IsTakenOrRefused) {
  EXPECT_EQ(
      text_of("\xef\xbb\xbf<?xml version='1.0'?>\n<!DOCTYPE a>\n<a:b x = '&lt;&#65;&#x20ac;'/>\n"),
      "<A\xe2\x82\xac");
  EXPECT_EQ(text_of("<a>1<!-- 2 -->3<b>4</b><![CDATA[<5>]]>&amp;</a>"), "13<5>&");
  std::string pieces, many = "<a", expected;
  for (int i = 0; i < 20000; ++i) pieces += "1<!-- -->&amp;", expected += "1&";
  EXPECT_EQ(text_of("<a>" + pieces + "</a>"), expected);
  for (int i = 0; i < 2000; ++i) many += " x" + std::to_string(i) + "=''";
  EXPECT_EQ(text_of(many + "/>"), "a: line 1: more than 1000 attributes");
  for (const auto& [xml, line] :
       {std::pair("", "line 1: no XML"),
        {"  ", "line 1: no XML"},
        {"x", "line 1: text outside of all elements"},
        {"<a>\n<b>\n</a>", "line 3: </a> where <b> is open"},
        {"<a></a></a>", "line 1: </a> where nothing is open"},
        {"<a>&x;</a>", "line 1: unknown entity 'x'"},
        {"<a>&#0;</a>", "line 1: unknown entity '#0'"},
        {"<a>& b</a>", "line 1: unknown entity ' b'"},
        {"<a", "line 1: truncated: a tag does not end"},
        {"<a x='1'y='2'/>", "line 1: blanks are missing"},
        {"<a x/>", "line 1: attribute 'x' without a value"},
        {"<a x='<'/>", "line 1: '<' in attribute 'x'"},
        {"<a/><b/>", "line 1: a second root"},
        {"<a/>b", "line 1: text outside of all elements"},
        {"<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", "line 1: declared entities are not read"}})
    EXPECT_EQ(text_of(xml), std::string("a: ") + line) << xml;
}

// --- glTF ----------------------------------------------------------------------------------------

std::string gltf(const std::string& node, const std::string& mesh = "") {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0)" +
         node +
         R"(}, {}], "skins": [{"joints": [1]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 0}]}])" +
         mesh +
         R"(}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,)"
         R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

TEST(ReadScenes, GltfNodesAreNotRounded) {
  const std::string far = ", \"translation\": [388096.25, 5948996.1, 0.1]";
  EXPECT_EQ(parse_mesh(gltf(far), "a.gltf").vertices.at(0),
            Vec3<double>(388096.25, 5948996.1, 0.1));
  const std::string below = ", \"scale\": [3, 3, 3], \"children\": [1]}, {\"mesh\": 0" + far + "}]";
  for (const std::string roots : {"[0]", "[0, 2]"}) {
    const std::string three =
        replaced(replaced(gltf(""), "}, {}]", below), "\"nodes\": [0]", "\"nodes\": " + roots);
    const std::string all = replaced(
        three, "0.1]}]",
        "0.1]}, {\"mesh\": 0, \"matrix\": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.1, 0, 0, 1]}]");
    const TriangleMesh mesh = parse_mesh(all, "a.gltf");
    EXPECT_EQ(mesh.vertices.at(3), Vec3<double>(3 * 388096.25, 3 * 5948996.1, 3 * 0.1));
    ASSERT_EQ(mesh.vertices.size(), roots == "[0]" ? 6u : 9u);
    if (mesh.vertices.size() == 9) {
      EXPECT_EQ(mesh.vertices[6], Vec3<double>(0.1, 0, 0));
    }
  }
}

TEST(ReadScenes, WhatAGltfMoves) {
  for (const std::string rest :
       {"", ", \"weights\": [0]", ", \"rotation\": [0, 0, 0.7071068, 0.7071068]"})
    EXPECT_EQ(refusal(gltf(rest), "a.gltf"), "") << rest;
  EXPECT_EQ(refusal(gltf("", ", \"weights\": [0.0]"), "a.gltf"), "");
  const std::string morphs = "a.gltf: node 0: morph targets are not applied, so not read";
  EXPECT_EQ(refusal(gltf(", \"weights\": [0.5]"), "a.gltf"), morphs);
  EXPECT_EQ(refusal(gltf("", ", \"weights\": [1]"), "a.gltf"), morphs);
  EXPECT_EQ(refusal(gltf(", \"weights\": [0]", ", \"weights\": [1]"), "a.gltf"), "");
  EXPECT_EQ(refusal(gltf(", \"skin\": 0"), "a.gltf"),
            "a.gltf: node 0: skins are not applied, so not read");
  for (const std::string rotation : {"[0, 0, 0, 0]", "[0, 0, 1, 1]", "[0, 0, 0, 1.01]"})
    EXPECT_EQ(refusal(gltf(", \"rotation\": " + rotation), "a.gltf"),
              "a.gltf: node 0: its rotation is no quaternion of length 1");
  for (const std::string matrix : {"[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2]", "[1, 0]"})
    EXPECT_EQ(refusal(gltf(", \"matrix\": " + matrix), "a.gltf"),
              "a.gltf: node 0: its matrix is no 4 by 4 whose last row is 0 0 0 1");
  EXPECT_EQ(refusal(replaced(gltf(""), "VEC3", "VEC2"), "a.gltf"),
            "a.gltf: accessor 0: only positions of three float32 are read");
  EXPECT_EQ(refusal(std::string("glTF\2\0\0\0\xff\0\0\0", 12), "a.glb"),
            "a.glb: truncated: holds 12 of 255 bytes");
  EXPECT_EQ(parse_parts(gltf(""), "a.gltf").at(0).name, "");
}

}  // namespace
}  // namespace bvlab
