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
  // An id is one of its kind: a node and a geometry may have the same, two geometries may not.
  EXPECT_EQ(parse_mesh(dae("<node id=\"g\">" + instance + "</node>"), "a.dae").triangles.size(),
            4u);
  EXPECT_EQ(
      refusal(replaced(dae(), "</library_geometries>", "<geometry id=\"g\"/></library_geometries>"),
              "a.dae"),
      "a.dae: line 9: <instance_geometry>: there are two geometry '#g'");
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
  const std::string morphs = ".weights[0]: morph targets are not applied, so not read";
  EXPECT_EQ(refusal(gltf(", \"weights\": [0.5]"), "a.gltf"), "a.gltf: nodes[0]" + morphs);
  EXPECT_EQ(refusal(gltf("", ", \"weights\": [1]"), "a.gltf"), "a.gltf: meshes[0]" + morphs);
  EXPECT_EQ(refusal(gltf(", \"weights\": [0]", ", \"weights\": [1]"), "a.gltf"), "");
  EXPECT_EQ(refusal(gltf(", \"skin\": 0"), "a.gltf"),
            "a.gltf: nodes[0].skin: skins are not applied, so not read");
  for (const std::string rotation : {"[0, 0, 0, 0]", "[0, 0, 1, 1]", "[0, 0, 0, 1.01]"})
    EXPECT_EQ(refusal(gltf(", \"rotation\": " + rotation), "a.gltf"),
              "a.gltf: nodes[0].rotation: is no quaternion of length 1");
  for (const auto& [rest, line] :
       {std::pair("\"matrix\": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2]",
                  "matrix: its last row is not 0 0 0 1"),
        {"\"matrix\": [1, 0]", "matrix: holds 2 numbers, not 16"},
        {"\"translation\": [\"1\", 2, 3]", "translation[0]: is not a number"},
        {"\"scale\": 2", "scale: is not a list"}})
    EXPECT_EQ(refusal(gltf(std::string(", ") + rest), "a.gltf"),
              std::string("a.gltf: nodes[0].") + line);
  EXPECT_EQ(refusal(replaced(gltf(""), "VEC3", "VEC2"), "a.gltf"),
            "a.gltf: accessors[0].type: of positions is not VEC3");
  EXPECT_EQ(refusal(std::string("glTF\2\0\0\0\xff\0\0\0", 12), "a.glb"),
            "a.glb: truncated: holds 12 of 255 bytes");
  EXPECT_EQ(parse_parts(gltf(""), "a.gltf").at(0).name, "");
}

// --- What glTF has in its buffers ---

std::string base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  std::uint32_t held = 0;
  int bits = 0;
  for (const char c : bytes) {
    held = held << 8 | static_cast<unsigned char>(c);
    for (bits += 8; bits >= 6;) text += digits[held >> (bits -= 6) & 63];
  }
  if (bits > 0) text += digits[held << (6 - bits) & 63];
  return text.append((4 - text.size() % 4) % 4, '=');
}

template <class T>
std::string bytes_of(std::initializer_list<T> values) {
  return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(T)};
}

const std::string square =
    bytes_of<float>({0, 0, 0, 1, 0, 0, 1, 2, 0, 0, 2, 0}) + bytes_of<std::uint16_t>({0, 1, 2, 3});

/// A square as the 48 bytes of its corners and the 8 of their indices, and what else there is.
std::string buffered(const std::string& primitive, const std::string& position,
                     const std::string& index, const std::string& buffer = square,
                     const std::string& views = "") {
  return R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0})" +
         primitive + R"(}]}], "accessors": [{"type": "VEC3", )" + position +
         R"(}, {"type": "SCALAR", )" + index +
         R"(}], "bufferViews": [{"buffer": 0, "byteLength": 48},
    {"buffer": 0, "byteOffset": 48, "byteLength": 8})" +
         views + R"(], "buffers": [{"byteLength": )" + std::to_string(buffer.size()) +
         R"(, "uri": "data:application/gltf-buffer;base64,)" + base64(buffer) + "\"}]}";
}
const std::string corners = R"("bufferView": 0, "componentType": 5126, "count": 4)",
                  shorts = R"("bufferView": 1, "componentType": 5123, "count": 4)";

const std::vector<Vec3<double>> square_corners = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}};

void expect_square(const std::string& text) {
  EXPECT_EQ(refusal(text, "a.gltf"), "");
  if (refusal(text, "a.gltf").empty()) {
    EXPECT_EQ(parse_mesh(text, "a.gltf").vertices, square_corners);
  }
}

TEST(ReadScenes, GltfPrimitives) {
  const auto triangles = [](const std::string& more) {
    return parse_mesh(buffered(more, corners, shorts), "a.gltf").triangles;
  };
  EXPECT_EQ(triangles(R"(, "indices": 1, "mode": 5)"), (Triangles{{0, 1, 2}, {2, 1, 3}}));
  EXPECT_EQ(triangles(R"(, "indices": 1, "mode": 6)"), (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(triangles(R"(, "mode": 5)"), (Triangles{{0, 1, 2}, {2, 1, 3}}));
  for (const auto& [more, line] :
       {std::pair(R"(, "mode": 1)", "has no triangles"),
        {R"(, "mode": 7)", "meshes[0].primitives[0].mode: 7 does not exist"},
        {"", "meshes[0].primitives[0]: has 4 corners, no multiple of 3"},
        {R"(, "indices": 1)", "meshes[0].primitives[0]: has 4 corners, no multiple of 3"},
        {R"(, "indices": 0)", "accessors[0].type: of indices is not SCALAR"},
        {R"(, "indices": 2)", "accessors: there is no number 2: it has 2"},
        {R"(, "indices": 0.5)", "meshes[0].primitives[0].indices: is not a whole number"},
        {R"(, "indices": -1)", "meshes[0].primitives[0].indices: is not a whole number"}})
    EXPECT_EQ(refusal(buffered(more, corners, shorts), "a.gltf"), std::string("a.gltf: ") + line);
  EXPECT_EQ(
      refusal(buffered(R"(, "indices": 1)", corners, replaced(shorts, "5123", "5126")), "a.gltf"),
      "a.gltf: accessors[1].componentType: of indices is not whole");
  // Primitives of one list of positions share its vertices.
  const std::string two = replaced(buffered(R"(, "mode": 6)", corners, shorts), "\"mode\": 6}",
                                   R"("mode": 6}, {"attributes": {"POSITION": 0}, "mode": 5})");
  EXPECT_EQ(parse_mesh(two, "a.gltf").vertices.size(), 4u);
  EXPECT_EQ(parse_mesh(two, "a.gltf").triangles.size(), 4u);
}

TEST(ReadScenes, GltfNumbers) {
  const std::string fan = R"(, "mode": 6)";
  expect_square(buffered(fan, corners, shorts));
  // Rows of five floats, the last three of which are read.
  std::string wide;
  for (const auto& v : square_corners)
    wide += bytes_of<float>({9, 9, static_cast<float>(v[0]), static_cast<float>(v[1]), 0});
  const std::string strided = R"(, {"buffer": 0, "byteLength": 80, "byteStride": 20})",
                    in_rows =
                        R"("bufferView": 2, "byteOffset": 8, "componentType": 5126, "count": 4)";
  expect_square(buffered(fan, in_rows, shorts, wide, strided));
  // A row replaced, in rows with a stride and without; rows that are not there are 0.
  std::string wrong = wide;
  wrong.replace(48, 4, bytes_of<float>({7}));
  const std::string sparse =
      R"(, "sparse": {"count": 1, "indices": {"bufferView": 3, "componentType": 5121},
          "values": {"bufferView": 4}})";
  const std::string more = R"(, {"buffer": 0, "byteOffset": 80, "byteLength": 1},
          {"buffer": 0, "byteOffset": 81, "byteLength": 12})";
  const std::string replacement = "\2" + bytes_of<float>({1, 2, 0});
  expect_square(buffered(fan, in_rows + sparse, shorts, wrong + replacement, strided + more));
  const std::string zeros = R"("componentType": 5126, "count": 4)" +
                            replaced(replaced(sparse, "\"bufferView\": 3", "\"bufferView\": 2"),
                                     "\"bufferView\": 4", "\"bufferView\": 0");
  const std::string all = replaced(zeros, "\"sparse\": {\"count\": 1", "\"sparse\": {\"count\": 4"),
                    four = R"(, {"buffer": 0, "byteOffset": 56, "byteLength": 4})";
  expect_square(buffered(fan, all, shorts, square + std::string("\0\1\2\3", 4), four));
  EXPECT_EQ(refusal(buffered(fan, all, shorts, square + "\7\1\2\3", four), "a.gltf"),
            "a.gltf: accessors[0].sparse.indices: there is no row 7");
  EXPECT_EQ(refusal(replaced(buffered(fan, all, shorts, square + "0123", four), "5121", "5126"),
                    "a.gltf"),
            "a.gltf: accessors[0].sparse.indices.componentType: of indices is not whole");
  // Whole numbers, as they stand and as parts of the largest.
  const std::string bytes = std::string("\0\0\0\1\0\0\1\2\0\0\2\0", 12),
                    small = R"(, {"buffer": 0, "byteLength": 12})",
                    typed = R"("bufferView": 2, "count": 4, "componentType": )";
  for (const std::string type : {"5120", "5121"})
    expect_square(buffered(fan, typed + type, shorts, bytes + square, small));
  const TriangleMesh parts = parse_mesh(buffered(fan, typed + R"(5120, "normalized": true)", shorts,
                                                 "\x7f\x80" + bytes + square, small),
                                        "a.gltf");
  EXPECT_EQ(parts.vertices.at(0), Vec3<double>(1, -1, 0));
  for (const auto& [position, line] :
       {std::pair(R"("bufferView": 0, "componentType": 5126, "count": 5)",
                  ": 5 rows of 12 bytes from 0 on are not in its view of 48 bytes"),
        {R"("bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 4)",
         ": 4 rows of 12 bytes from 4 on are not in its view of 48 bytes"},
        {R"("bufferView": 0, "componentType": 5124, "count": 4)", ".componentType: does not exist"},
        {R"("bufferView": 0, "count": 4)", ": has no componentType"},
        {R"("componentType": 5126, "count": 4)", ": holds no numbers"}})
    EXPECT_EQ(refusal(buffered(fan, position, shorts), "a.gltf"),
              std::string("a.gltf: accessors[0]") + line);
}

TEST(ReadScenes, GltfBuffers) {
  const std::string whole = buffered(R"(, "mode": 6)", corners, shorts);
  for (const auto& [from, to, line] :
       {std::tuple("base64,AAAA", "base64,AA!A", "buffers[0].uri: is not in base 64"),
        {"data:application/gltf-buffer;base64,", "data:,", "buffers[0].uri: is not in base 64"},
        {"\"byteLength\": 56", "\"byteLength\": 57", "buffers[0]: truncated: holds 56 of 57 bytes"},
        {"\"byteLength\": 48", "\"byteLength\": 58",
         "bufferViews[0]: 58 bytes from 0 on are not in its buffer of 56"},
        {"\"buffer\": 0", "\"buffer\": 1", "buffers: there is no number 1: it has 1"},
        {"\"asset\"", "\"aset\"", "has no asset"},
        {"\"scenes\"", "\"scene\": 1, \"scenes\"", "scenes: there is no number 1: it has 1"},
        {"\"mesh\": 0", "\"mesh\": 0,, ", "line 1: is no JSON"},
        {"\"mesh\": 0", "\"mesh\": 1e999", "is JSON with a number that is not finite"},
        {"data:application/gltf-buffer;base64,", "a.bin?",
         "buffers[0].uri: refers to 'a.bin?AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAA...': other files are "
         "not read here"}})
    EXPECT_EQ(refusal(replaced(whole, from, to), "a.gltf"), std::string("a.gltf: ") + line);
  EXPECT_EQ(refusal(whole.substr(0, whole.size() - 3), "a.gltf"),
            "a.gltf: line 3: truncated: JSON does not end");
  // The binary chunk of a GLB, padded, and bytes beyond it.
  std::string json = whole;
  const std::size_t uri = json.find(", \"uri\"");
  json.erase(uri, json.find("}]}", uri) - uri);
  const auto glb = [&](std::uint32_t size) {
    const std::string binary = square + std::string(4, '\0');
    const auto chunk = [](std::uint32_t length, const char* kind) {
      return bytes_of<std::uint32_t>({length}) + std::string(kind, 4);
    };
    const std::string chunks = chunk(static_cast<std::uint32_t>(json.size()), "JSON") + json +
                               chunk(size, "BIN\0") + binary;
    return "glTF" + bytes_of<std::uint32_t>({2, 12 + static_cast<std::uint32_t>(chunks.size())}) +
           chunks;
  };
  EXPECT_EQ(parse_mesh(glb(60), "a.glb").vertices, square_corners);
  EXPECT_EQ(refusal(glb(61), "a.glb"), "a.glb: truncated: ends within a chunk");
  EXPECT_EQ(refusal(json, "a.gltf"), "a.gltf: buffers[0]: has no uri");
  std::string said;
  ReadOptions options;
  options.say = [&](const std::string& line) { said = line; };
  parse_mesh(glb(60) + "x", "a.glb", options);
  EXPECT_EQ(said, "a.glb: 1 bytes beyond the end are passed over");
}

}  // namespace
}  // namespace bvlab
