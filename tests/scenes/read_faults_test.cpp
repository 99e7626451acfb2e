// SPDX-License-Identifier: BSD-3-Clause
/// Files as users have them, in the forms that readers have got wrong: each is the cube or the box
/// that it says, or is refused by name.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/random.hpp"
#include "experiments/scenes/read_mesh.hpp"

namespace bvlab {
namespace {

using namespace std::string_literals;

/// [-1,1]^3.
TriangleMesh cube() {
  TriangleMesh mesh;
  for (const double z : {-1, 1})
    for (const auto& [x, y] :
         {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)})
      mesh.vertices.push_back({double(x), double(y), z});
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                    {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  return mesh;
}

std::string text_of(const Vec3<double>& v) {
  return std::to_string(static_cast<int>(v[0])) + " " + std::to_string(static_cast<int>(v[1])) +
         " " + std::to_string(static_cast<int>(v[2]));
}

/// Lines of the cube: of its vertices, with something before and after each, and of its faces.
std::string vertices(const std::string& before = "", const std::string& after = "") {
  std::string text;
  for (const auto& v : cube().vertices) text += before + text_of(v) + after + "\n";
  return text;
}
std::string faces(const std::string& before, std::uint32_t first, const std::string& after = "") {
  std::string text;
  for (const auto& [i, j, k] : cube().triangles)
    text += before + std::to_string(i + first) + after + " " + std::to_string(j + first) + after +
            " " + std::to_string(k + first) + after + "\n";
  return text;
}

std::string obj() { return vertices("v ") + faces("f ", 1); }
std::string off(const std::string& header = "OFF\n8 12 0\n") {
  return header + vertices() + faces("3 ", 0);
}
const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string face_list = "property list uchar int vertex_indices\n";
std::string ply_header(const std::string& more = "", const std::string& format = "ascii") {
  return "ply\nformat " + format + " 1.0\nelement vertex 8\n" + xyz + more + "element face 12\n" +
         face_list + "end_header\n";
}
std::string ply() { return ply_header() + vertices() + faces("3 ", 0); }
std::string stl() {
  std::string text = "solid a\n";
  const TriangleMesh mesh = cube();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const auto& corner : mesh.corners(i)) text += "vertex " + text_of(corner) + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid a\n";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

template <class T>
void put(std::string& bytes, T value, bool big = false) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (big) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

/// A binary STL of the cube, with something after each triangle and at the end.
std::string binary_stl(std::uint32_t count, const std::string& header = "x",
                       const std::string& attributes = "", std::uint16_t announced = 0) {
  std::string bytes = header;
  bytes.resize(80, ' ');
  put(bytes, count);
  const TriangleMesh mesh = cube();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    bytes.append(12, '\0');
    for (const auto& corner : mesh.corners(i))
      for (int d = 0; d < 3; ++d) put(bytes, static_cast<float>(corner[d]));
    put(bytes, announced);
    bytes += attributes;
  }
  return bytes;
}

struct Outcome {
  TriangleMesh mesh;
  std::string refusal, said;
};

Outcome read(const std::string& bytes, const std::string& name) {
  Outcome outcome;
  ReadOptions options;
  options.say = [&](const std::string& line) { outcome.said += line; };
  try {
    outcome.mesh = parse_mesh(bytes, name, options);
  } catch (const Unusable& error) {
    outcome.refusal = error.what();
  }
  return outcome;
}

std::string refusal(const std::string& bytes, const std::string& name) {
  return read(bytes, name).refusal;
}

/// The triangles as sets of positions: whoever holds the same surface.
std::multiset<std::multiset<std::array<double, 3>>> surface(const TriangleMesh& mesh) {
  std::multiset<std::multiset<std::array<double, 3>>> all;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::multiset<std::array<double, 3>> triangle;
    for (const auto& corner : mesh.corners(i)) triangle.insert({corner[0], corner[1], corner[2]});
    all.insert(triangle);
  }
  return all;
}

void expect_cube(const std::string& bytes, const std::string& name, const std::string& what) {
  const Outcome outcome = read(bytes, name);
  EXPECT_EQ(outcome.refusal, "") << what;
  EXPECT_EQ(outcome.said, "") << what;
  EXPECT_EQ(surface(outcome.mesh), surface(cube())) << what;
}

std::string utf16(const std::string& text, bool big) {
  std::string bytes = big ? "\xfe\xff" : "\xff\xfe";
  for (const char c : text) {
    if (big) bytes += '\0';
    bytes += c;
    if (!big) bytes += '\0';
  }
  return bytes;
}

const std::vector<std::pair<std::string, std::string>> texts = {
    {"a.obj", obj()}, {"a.off", off()}, {"a.ply", ply()}, {"a.stl", stl()}};

TEST(ReadFaults, MarksAndEncodings) {
  for (const auto& [name, text] : texts) {
    expect_cube(text, name, "plain " + name);
    expect_cube("\xef\xbb\xbf" + text, name, "UTF-8 mark " + name);
    expect_cube(utf16(text, false), name, "UTF-16 little " + name);
    expect_cube(utf16(text, true), name, "UTF-16 big " + name);
    expect_cube(utf16(text, false).substr(2), name, "UTF-16 without a mark " + name);
    EXPECT_EQ(refusal("\xff\xfe\0\0"s + text, name),
              name + ": is UTF-32 text: only UTF-8 and UTF-16 are read");
    EXPECT_EQ(refusal(utf16(text, false) + "x", name),
              name + ": truncated: ends within a character of UTF-16");
    expect_cube(text + "\x1a", name, "DOS's end of a file " + name);
  }
  // Vertices keep their numbers, also where a vertex is used by no face.
  EXPECT_EQ(read("\xef\xbb\xbf" + vertices("v ") + "v 9 9 9\n" + faces("f ", 1), "a.obj")
                .mesh.vertices.size(),
            9u);
  // Files that were joined.
  expect_cube("g a\n\xef\xbb\xbf" + obj(), "a.obj", "a mark within");
}

TEST(ReadFaults, EndsOfLines) {
  for (const auto& [name, text] : texts) {
    expect_cube(replaced(text, "\n", "\r"), name, "CR " + name);
    expect_cube(replaced(text, "\n", "\r\n"), name, "CR LF " + name);
    expect_cube(replaced(text, "\n", "\n\n \t\n"), name, "blank lines " + name);
    std::string mixed;
    for (std::size_t i = 0, line = 0; i < text.size(); ++i)
      mixed +=
          text[i] == '\n' ? std::array{"\n", "\r\n", "\r"}[line++ % 3] : std::string(1, text[i]);
    expect_cube(mixed, name, "mixed " + name);
    expect_cube(text.substr(0, text.size() - 1), name, "no end of the last line " + name);
  }
  EXPECT_EQ(refusal("# a\rv 0 0 0\rv 1 x 0\r", "a.obj"), "a.obj: line 3: 'x' is not a number");
  EXPECT_EQ(refusal("# a\r\nv 0 0 0\r\nv 1 x 0\r\n", "a.obj"),
            "a.obj: line 3: 'x' is not a number");
}

/// What is not read may hold anything.
TEST(ReadFaults, NumbersThatAreNone) {
  for (const std::string none :
       {"-1.#IND", "1.#QNAN", "1.#INF000", "nan", "-nan(ind)", "inf", "-inf", "NaN", "1,5", "x"}) {
    const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
    const std::string three = " " + none + " " + none + " " + none;
    expect_cube(ply_header(normals) + vertices("", three) + faces("3 ", 0), "a.ply", none);
    expect_cube(replaced(ply_header(normals), "element vertex 8\n" + xyz + normals,
                         "element vertex 8\n" + normals + xyz) +
                    vertices(three.substr(1) + " ") + faces("3 ", 0),
                "a.ply", none + " first");
    expect_cube(off("NOFF\n8 12 0\n").substr(0, 12) + vertices("", three) + faces("3 ", 0), "a.off",
                none);
    expect_cube(vertices("v ") + "vn" + three + "\nvt " + none + "\n" + faces("f ", 1, "//1"),
                "a.obj", none);
    expect_cube(replaced(stl(), "0 0 0\nouter", none + " 0 " + none + "\nouter"), "a.stl", none);
    // A coordinate may not.
    const bool is_word = none == "1,5" || none == "x";
    const std::string fault =
        is_word ? "'" + none + "' is not a number" : "coordinate '" + none + "' is not finite";
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::array<std::string, 3> words{"0", "0", "0"};
      words[axis] = none;
      const std::string vertex = words[0] + " " + words[1] + " " + words[2] + "\n";
      EXPECT_EQ(refusal("v 0 0 0\nv " + vertex + "v 0 0 1\nf 1 2 3\n", "a.obj"),
                "a.obj: line 2: " + fault);
      EXPECT_EQ(refusal("OFF\n3 1 0\n" + vertex + "0 0 0\n0 0 1\n3 0 1 2\n", "a.off"),
                "a.off: line 3: " + fault);
      EXPECT_EQ(
          refusal(replaced(ply(), "end_header\n-1 -1 -1\n", "end_header\n" + vertex), "a.ply"),
          "a.ply: line 10: " + fault);
      EXPECT_EQ(refusal("solid\nfacet\nouter loop\nvertex " + vertex, "a.stl"),
                "a.stl: line 4: " + fault);
    }
  }
  // A '#' is part of data in PLY, and a comment elsewhere.
  EXPECT_EQ(refusal(replaced(ply(), "1 1 1\n", "1 1 1 # last\n"), "a.ply"),
            "a.ply: line 16: more values than the header promises for each vertex");
  expect_cube(replaced(obj(), "\n", " # end\n"), "a.obj", "comments");
  expect_cube(replaced(off(), "\n", "# end\n"), "a.off", "comments");
}

TEST(ReadFaults, PlyRowsOfAnotherLength) {
  EXPECT_EQ(refusal(replaced(ply(), "1 1 1\n", "1 1\n"), "a.ply"),
            "a.ply: line 17: more values than the header promises for each vertex");
  EXPECT_EQ(refusal(replaced(ply(), "vertex 8", "vertex 9"), "a.ply"),
            "a.ply: truncated: holds 11 of 12 of element face");
  EXPECT_EQ(refusal(replaced(ply(), "face 12", "face 13"), "a.ply"),
            "a.ply: truncated: holds 12 of 13 of element face");
  EXPECT_EQ(refusal(replaced(ply(), "face 12", "face 10"), "a.ply"),
            "a.ply: holds 12 of element face, where the header promises 10");
  EXPECT_NE(refusal(replaced(ply(), "vertex 8", "vertex 7"), "a.ply"), "");
  EXPECT_EQ(refusal(replaced(ply(), "vertex 8", "vertex 4000000000"), "a.ply"),
            "a.ply: truncated: holds 20 of 4000000000 of element vertex");
  // A list may take several lines.
  expect_cube(replaced(ply(), "3 0 2 1\n", "3\n0 2\n1\n"), "a.ply", "wrapped");
  for (const std::string name : {"vertex_index", "vertex_indexes", "vertices", "indices"})
    expect_cube(replaced(ply(), "vertex_indices", name), "a.ply", name);
  EXPECT_EQ(refusal(replaced(ply(), "vertex_indices", "corners"), "a.ply"),
            "a.ply: element face has not one list vertex_indices or vertex_index");
  EXPECT_EQ(refusal(replaced(ply(), face_list, face_list + replaced(face_list, "indices", "index")),
                    "a.ply"),
            "a.ply: element face has not one list vertex_indices or vertex_index");
  EXPECT_EQ(
      refusal(ply_header("property double x\n") + vertices("", " 7") + faces("3 ", 0), "a.ply"),
      "a.ply: line 7: a second property 'x'");
  EXPECT_EQ(refusal(replaced(ply(), "3 0 2 1", "3 0 2 8"), "a.ply"),
            "a.ply: line 18: vertex 8 does not exist: there are 8, from 0");
}

/// Elements that others made of vertices.
TEST(ReadFaults, PlyElementsThatAreNotRead) {
  const std::string fans = "element trifans 1\n" + replaced(face_list, "uchar", "int");
  const Outcome outcome =
      read(replaced(ply(), "end_header\n", fans + "end_header\n") + "4 0 1 2 3\n", "a.ply");
  EXPECT_EQ(outcome.said, "a.ply: element trifans, which lists vertices, is passed over");
  EXPECT_EQ(surface(outcome.mesh), surface(cube()));
}

/// Rows of the cube as binary PLY; `Index` is the type of a strip's or face's entries.
template <class Index>
std::string binary_ply(const std::string& types, bool big,
                       const std::vector<std::vector<Index>>& rows,
                       const std::string& element = "face") {
  std::string bytes = "ply\nformat binary_"s + (big ? "big" : "little") +
                      "_endian 1.0\nelement vertex 8\n" + xyz + "element " + element + " " +
                      std::to_string(rows.size()) + "\nproperty list " + types +
                      " vertex_indices\nend_header\n";
  for (const auto& v : cube().vertices)
    for (int d = 0; d < 3; ++d) put(bytes, static_cast<float>(v[d]), big);
  for (const auto& row : rows) {
    put(bytes, static_cast<std::int32_t>(row.size()), big);
    for (const Index entry : row) put(bytes, entry, big);
  }
  return bytes;
}

TEST(ReadFaults, PlyStrips) {
  const std::vector<int> strip = {0, 1, 3, 2, 7, 6, 4, 5, -1, 7, 4, 3, 0, -1, 0, 4, 1, 5, 2, 6};
  // By orientation: every triangle of the strips as the rule has it.
  std::vector<std::array<std::uint32_t, 3>> expected;
  for (std::size_t i = 0, length = 0; i < strip.size(); ++i) {
    length = strip[i] < 0 ? 0 : length + 1;
    if (length < 3) continue;
    auto a = static_cast<std::uint32_t>(strip[i - 2]), b = static_cast<std::uint32_t>(strip[i - 1]);
    if (length % 2 == 0) std::swap(a, b);
    expected.push_back({a, b, static_cast<std::uint32_t>(strip[i])});
  }
  const auto as = [&]<class T>(T) {
    return std::vector<std::vector<T>>{{strip.begin(), strip.end()}};
  };
  for (const bool big : {false, true})
    for (const auto& bytes : {binary_ply("int int", big, as(std::int32_t{}), "tristrips"),
                              binary_ply("int char", big, as(std::int8_t{}), "tristrips"),
                              binary_ply("int short", big, as(std::int16_t{}), "tristrips"),
                              binary_ply("int uint", big, as(std::uint32_t{}), "tristrips"),
                              binary_ply("uint ushort", big, as(std::uint16_t{}), "tristrips"),
                              binary_ply("int uchar", big, as(std::uint8_t{}), "tristrips")}) {
      const Outcome outcome = read(bytes, "a.ply");
      EXPECT_EQ(outcome.refusal, "");
      EXPECT_EQ(outcome.mesh.triangles, expected);
    }
  std::string text = replaced(ply_header(), "element face 12", "element tristrips 1") + vertices() +
                     std::to_string(strip.size());
  for (const int entry : strip) text += " " + std::to_string(entry);
  EXPECT_EQ(read(text + "\n", "a.ply").mesh.triangles, expected);
  // Each strip ends with -1: two sides of the cube.
  const std::vector<std::vector<int>> sides = {{0, 1, 3, 2, -1, 4, 5, 7, 6, -1}};
  EXPECT_EQ(
      read(binary_ply("int int", false, sides, "tristrips"), "a.ply").mesh.triangles,
      (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 3}, {3, 1, 2}, {4, 5, 7}, {7, 5, 6}}));
  // Joined by repeated vertices: what joins them is no part of the surface.
  const std::vector<std::vector<int>> joined = {{0, 1, 2, 3, 3, 4, 4, 5, 6, 7}};
  EXPECT_EQ(
      read(binary_ply("int int", false, joined, "tristrips"), "a.ply").mesh.triangles,
      (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {2, 1, 3}, {4, 5, 6}, {6, 5, 7}}));
  const std::vector<std::vector<int>> wrong = {{0, 1, 8}};
  EXPECT_EQ(refusal(binary_ply("int int", false, wrong, "tristrips"), "a.ply"),
            "a.ply: tristrips 0: vertex 8 does not exist: there are 8, from 0");
  const std::vector<std::vector<int>> negative = {{0, 1, -1}};
  EXPECT_EQ(refusal(binary_ply("int int", false, negative), "a.ply"),
            "a.ply: face 0: vertex -1 does not exist: there are 8, from 0");
}

TEST(ReadFaults, BinaryPlySizes) {
  std::vector<std::vector<int>> rows;
  for (const auto& [i, j, k] : cube().triangles) rows.push_back({int(i), int(j), int(k)});
  const std::string bytes = binary_ply("int int", false, rows);
  expect_cube(bytes, "a.ply", "binary");
  expect_cube("\xef\xbb\xbf" + bytes, "a.ply", "a mark before binary data");
  for (const std::string end : {"\r\n", "\r"}) {
    const std::size_t header = bytes.find("end_header\n") + 11;
    expect_cube(replaced(bytes.substr(0, header), "\n", end) + bytes.substr(header), "a.ply",
                "ends of the header's lines");
  }
  // Data that begins with a LF, after a header whose lines end with CR.
  const std::string tiny =
      "ply\rformat binary_big_endian 1.0\relement vertex 1\rproperty char x\rproperty char y\r"
      "property char z\relement face 1\rproperty list char char vertex_index\rend_header\r";
  EXPECT_EQ(read(tiny + "\n\1\2\3\0\0\0"s, "a.ply").mesh.vertices.at(0), Vec3<double>(10, 1, 2));
  EXPECT_EQ(refusal(replaced(bytes, "face 12", "face 10"), "a.ply"),
            "a.ply: holds 12 of element face, where the header promises 10");
  EXPECT_EQ(refusal(replaced(bytes, "face 12", "face 14"), "a.ply"),
            "a.ply: truncated: holds 12 of 14 of element face");
  EXPECT_EQ(refusal(replaced(bytes, "vertex 8", "vertex 99"), "a.ply"),
            "a.ply: truncated: holds 24 of 99 of element vertex");
  const Outcome outcome = read(bytes + "\n", "a.ply");
  EXPECT_EQ(outcome.said, "a.ply: 1 bytes beyond the last element are passed over");
  EXPECT_EQ(surface(outcome.mesh), surface(cube()));
}

TEST(ReadFaults, BinaryStl) {
  for (const std::string header : {"x", "solid", "solid made by x", "SOLID", "\xef\xbb\xbfsolid",
                                   "solid of facets and vertexes"}) {
    expect_cube(binary_stl(12, header), "a.stl", header);
    for (const std::string& end : {"\r\n"s, "\0\0"s, "ab"s, std::string(49, 'x')}) {
      const Outcome outcome = read(binary_stl(12, header) + end, "a.stl");
      EXPECT_EQ(outcome.refusal, "") << header;
      EXPECT_EQ(outcome.said, "a.stl: " + std::to_string(end.size()) +
                                  " bytes beyond the 12 triangles are passed over");
      EXPECT_EQ(surface(outcome.mesh), surface(cube()));
    }
    EXPECT_EQ(refusal(binary_stl(10, header), "a.stl"),
              "a.stl: holds 12 triangles, where the header promises 10");
    EXPECT_EQ(refusal(binary_stl(0, header), "a.stl"),
              "a.stl: holds 12 triangles, where the header promises 0");
    EXPECT_EQ(refusal(binary_stl(13, header), "a.stl"),
              "a.stl: truncated: holds 12 of 13 triangles");
    EXPECT_EQ(refusal(binary_stl(0xffffffff, header), "a.stl"),
              "a.stl: truncated: holds 12 of 4294967295 triangles");
    EXPECT_EQ(refusal(binary_stl(12, header).substr(0, 600), "a.stl"),
              "a.stl: truncated: holds 10 of 12 triangles");
    // Attributes after each triangle, as long as it says; colours instead of a length.
    for (const std::string& attributes : {"abcd"s, std::string(50, 'x'), std::string(100, '\0')})
      expect_cube(binary_stl(12, header, attributes, static_cast<std::uint16_t>(attributes.size())),
                  "a.stl", "attributes");
    expect_cube(binary_stl(12, header, "", 0x801f), "a.stl", "colours");
    EXPECT_EQ(surface(read(binary_stl(12, header, "", 0x801f) + "\r\n", "a.stl").mesh),
              surface(cube()));
    EXPECT_EQ(refusal(binary_stl(12, header, "ab", 2) + "x", "a.stl"),
              "a.stl: holds 25 bytes beyond 12 triangles, where one announces 2");
    EXPECT_EQ(refusal(binary_stl(12, header, "abcd", 4).substr(0, 84 + 12 * 54 - 4), "a.stl"),
              "a.stl: holds 44 bytes beyond 12 triangles, where one announces 4");
  }
}

TEST(ReadFaults, TextStl) {
  const std::string text = stl();
  std::string upper = text;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  expect_cube(upper, "a.stl", "capitals");
  expect_cube(replaced(text, "\n", " "), "a.stl", "one line");
  expect_cube(replaced(replaced(text, "endloop", "end loop"), "endfacet", "end facet"), "a.stl",
              "end apart");
  expect_cube(replaced(text, "solid a", "solid a vertex facet of it"), "a.stl",
              "a name of keywords");
  expect_cube(replaced(text, "solid a\n", "solid\n"), "a.stl", "no name");
  expect_cube(text.substr(text.find("facet")), "a.stl", "no solid");
  expect_cube("  \n" + text, "a.stl", "blanks first");
  expect_cube(replaced(text, "facet normal 0 0 0\n", "facet\n"), "a.stl", "no normal");
  expect_cube(replaced(text, "solid a\nfacet", "solid a\ncolor 1 0 0\nfacet"), "a.stl", "a colour");
  expect_cube(replaced(text, "outer loop\n", ""), "a.stl", "no loop");
  EXPECT_EQ(read(text + text, "a.stl").mesh.triangles.size(), 24u);
  EXPECT_EQ(refusal("solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nfacet\n",
                    "a.stl"),
            "a.stl: line 7: a facet within a facet");
  EXPECT_EQ(refusal("solid\nfacet\nendfacet\nendsolid\n", "a.stl"),
            "a.stl: line 3: a facet of fewer than three corners");
  EXPECT_EQ(refusal("solid\nvertex 0 0 0\n", "a.stl"),
            "a.stl: line 2: a vertex outside of a facet");
  EXPECT_EQ(refusal("solid\nfacte\n", "a.stl"), "a.stl: line 2: unknown word 'facte'");
  // What a corner is lost by, also where all is on one line.
  for (const auto& [wrong, shown] :
       {std::pair("vertx 1 1 1", "vertx"), {"1 1 1", "1"}, {"vertex 1 1 1 1", "1"}})
    EXPECT_EQ(refusal(replaced(replaced(text, "vertex 1 1 1", wrong), "\n", " "), "a.stl"),
              "a.stl: line 1: unknown word '"s + shown + "'");
  expect_cube(replaced(replaced(replaced(text, "solid a", "solid"), "outer loop", "color 1 0 0"),
                       "\n", " "),
              "a.stl", "colours on one line");
}

TEST(ReadFaults, OffHeaders) {
  for (const std::string header :
       {"OFF8 12 0\n", "OFF8 12\n", "OFF 8 12 0\n", "OFF\n8\n12\n0\n", "8 12 0\n", "off\n8 12 0\n",
        "OFF # cube\n# of 8\n8 12 18 # counts\n", "COFF\n8 12 0\n", "NOFF8 12 0\n",
        "CNOFF\n8 12 0\n", "STOFF\n8 12 0\n", "STCNOFF\n8 12 0\n", "NCOFF 8 12 0\n"})
    expect_cube(off(header), "a.off", header);
  for (const std::string header : {"4OFF\n8 12 0\n", "nOFF\n3\n8 12 0\n", "4nOFF\n4\n8 12 0\n"})
    EXPECT_NE(refusal(off(header), "a.off").find("only three coordinates a vertex are read"),
              std::string::npos)
        << header;
  EXPECT_EQ(refusal(off("OFFx 12 0\n"), "a.off"),
            "a.off: line 1: not an OFF file: begins with 'OFFx'");
  EXPECT_EQ(refusal(off("OFF\n9 12 0\n"), "a.off"),
            "a.off: truncated: holds 11 of 12 faces, one a line");
  EXPECT_EQ(refusal(off("OFF\n9 11 0\n"), "a.off"),
            "a.off: line 11: a vertex of 4 values, where the first has 3");
  EXPECT_EQ(refusal(off("OFF\n7 12 0\n"), "a.off"),
            "a.off: holds 20 lines of vertices and faces, where the header promises 7 and 12");
  EXPECT_EQ(refusal(off("OFF\n8 10 0\n"), "a.off"),
            "a.off: holds 20 lines of vertices and faces, where the header promises 8 and 10");
  expect_cube("COFF\n8 12 0\n" + vertices("", " 255 0 0 255") +
                  replaced(faces("3 ", 0), "\n", " 0.5 0.5 0.5 1\n"),
              "a.off", "colours");
}

TEST(ReadFaults, Obj) {
  for (const std::string after : {"/1", "//2", "/1/2", "/", "//"})
    expect_cube(vertices("v ") + faces("f ", 1, after), "a.obj", after);
  for (const std::string after : {" 1.0", " 0.5 0.5 0.5", " 1 0.5 0.5 0.5"})
    expect_cube(vertices("v ", after) + faces("f ", 1), "a.obj", after);
  std::string negative;
  for (const auto& [i, j, k] : cube().triangles)
    negative += "f " + std::to_string(int(i) - 8) + " " + std::to_string(int(j) - 8) + " " +
                std::to_string(int(k) - 8) + "\n";
  expect_cube(vertices("v ") + negative, "a.obj", "negative");
  expect_cube(replaced(obj(), "f 1 3 2\n", "f 1 \\\n3\\\r\n2\n"), "a.obj", "continued");
  expect_cube("# C:\\cube\\\n" + obj(), "a.obj", "a comment that ends with a backslash");
  EXPECT_EQ(refusal("v 0 0 0\nf 1 \\\n1 \\\n1\nv 1 x 0\n", "a.obj"),
            "a.obj: line 5: 'x' is not a number");
  // Numbers of vertices and faces that some write first are compared with what follows.
  for (const std::string counts : {"8 12\n", "# cube\n\n8 12\r\n"})
    expect_cube(counts + obj(), "a.obj", counts);
  EXPECT_EQ(refusal("# cube\n8 13\n" + obj(), "a.obj"),
            "a.obj: line 2: promises 8 vertices and 13 faces, where there are 8 and 12");
  for (const std::string counts : {"8 12 0\n", "8\n", "8 x\n", "-8 12\n", "8.0 12\n"})
    EXPECT_TRUE(refusal(counts + obj(), "a.obj").starts_with("a.obj: line 1: unknown word"))
        << counts;
  EXPECT_EQ(refusal("o cube\n8 12\n" + obj(), "a.obj"), "a.obj: line 2: unknown word '8'");
  // A vertex or a face that the end of another line has taken.
  for (const std::string first : {"usemtl C:\\a\\\n", "g C:\\a\\\r\n", "vn 0 0 1\\\n  \\\n\t"})
    EXPECT_EQ(refusal(first + obj() + "v 9 9 9\n", "a.obj"),
              "a.obj: line 1: the backslash at its end makes the next line a part of it");
  expect_cube("g a \\\n b\n" + obj(), "a.obj", "a name continued");
  EXPECT_EQ(refusal(replaced(obj(), "v 1 1 1\nv", "v 1 1 1 v"), "a.obj"),
            "a.obj: line 7: 'v' is not a number");
  expect_cube(vertices("v ", " nan nan 1.#IND") + faces("f ", 1), "a.obj", "colours that are none");
  // What may have been meant as a vertex or a face is not passed over.
  for (const std::string word : {"V", "F", "vv", "1", "-1", "\xc2\xa0v"})
    EXPECT_TRUE(
        refusal(obj() + word + " 1 2 3\n", "a.obj").starts_with("a.obj: line 21: unknown word"))
        << word;
  EXPECT_EQ(refusal(obj() + "call b.obj\n", "a.obj"),
            "a.obj: line 21: call: other files are not read");
  for (const std::string form :
       {"surf 0 1 0 1 1 2 3 4\nend", "bsp 1 2 3", "bzp 1 2 3", "cdp 1 2 3"}) {
    const Outcome outcome = read("cstype bezier\n" + obj() + form + "\n", "a.obj");
    EXPECT_EQ(outcome.said, "a.obj: surfaces of free form are left out");
    EXPECT_EQ(surface(outcome.mesh), surface(cube()));
  }
  expect_cube(obj() + "usemtl a\nmtllib b c\ns off\nlod 1\nl 1 2\np 1\nvp 1 2\n", "a.obj",
              "passed over");
}

/// Triangles after a face of two corners have lower numbers: that is said.
TEST(ReadFaults, FacesOfTwoCorners) {
  const std::string two = "0 0 0\n1 0 0\n0 1 0\n";
  const Outcome from_off = read("OFF\n3 3 0\n" + two + "2 0 1\n3 0 1 2\n1 0\n", "a.off");
  EXPECT_EQ(from_off.mesh.triangles.size(), 1u);
  EXPECT_EQ(
      from_off.said,
      "a.off: line 6: a face of fewer than three corners is left out (2 in all); triangles are "
      "numbered without it");
  EXPECT_EQ(read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 2 3\n", "a.obj").said,
            "a.obj: line 4: a face of fewer than three corners is left out; triangles are numbered "
            "without it");
  EXPECT_EQ(
      read(replaced(ply(), "3 0 2 1\n", "2 0 2\n"), "a.ply").said,
      "a.ply: line 18: a face of fewer than three corners is left out; triangles are numbered "
      "without it");
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    sum += (b - a).cross(c - a).norm() / 2;
  }
  return sum;
}

TriangleMesh polygon(const std::vector<Vec3<double>>& corners) {
  std::string text = "OFF\n" + std::to_string(corners.size()) + " 1 0\n";
  char line[128];
  for (const auto& v : corners) {
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", v[0], v[1], v[2]);
    text += line;
  }
  text += std::to_string(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) text += " " + std::to_string(i);
  return parse_mesh(text + "\n", "a.off");
}

/// The area of what is covered once, from whichever corner, either way round, turned and far away.
void expect_area(const std::vector<std::pair<double, double>>& flat, double expected,
                 const std::string& what) {
  for (std::size_t start = 0; start < flat.size(); ++start)
    for (const bool reversed : {false, true})
      for (int turned = 0; turned < 4; ++turned) {
        std::vector<Vec3<double>> corners;
        for (std::size_t k = 0; k < flat.size(); ++k) {
          const auto& [x, y] = flat[(start + k) % flat.size()];
          corners.push_back(turned == 0   ? Vec3<double>(x, y, 0)
                            : turned == 1 ? Vec3<double>(0, x, y)
                            : turned == 2 ? Vec3<double>(y + 4e6, 7, x - 4e6)
                                          : Vec3<double>(x, y, x + 2 * y));
        }
        if (reversed) std::reverse(corners.begin(), corners.end());
        const TriangleMesh mesh = polygon(corners);
        EXPECT_EQ(mesh.triangles.size(), flat.size() - 2);
        const double stretched = turned == 3 ? std::sqrt(6.0) : 1;
        EXPECT_NEAR(area(mesh), expected * stretched, 1e-9 * (1 + expected)) << what;
      }
}

TEST(ReadFaults, PolygonsKeepTheirArea) {
  expect_area({{0, 0}, {2, 0}, {2, 2}, {3, 2}, {2, 2}, {0, 2}}, 4, "spike");
  expect_area({{0, 0}, {2, 0}, {2, 2}, {5, 2}, {4, 2}, {2, 2}, {0, 2}}, 4, "spike with a corner");
  expect_area({{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 1}, {1, 2}, {0, 2}}, 4, "spike inwards");
  expect_area({{0, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 5}, {1, 2}, {0, 2}}, 4, "spike outwards");
  expect_area({{0, 0}, {2, 0}, {2, 2}, {2, 3}, {2, 1}, {2, 2}, {0, 2}}, 4, "spike over an edge");
  expect_area({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}, 4, "on the edges");
  expect_area({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {0, 3}}, 4.5, "a fan of nothing");
  expect_area({{0, 0}, {0, 0}, {2, 0}, {2, 2}, {2, 2}, {2, 2}, {0, 2}}, 4, "repeated");
  expect_area({{0, 0}, {4, 0}, {1, 1}, {0, 4}}, 4, "arrow");
  expect_area({{0, 0}, {4, 0}, {4, 4}, {2, 2}, {0, 4}}, 12, "notch");
  expect_area({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}, 8, "notch that touches");
  expect_area({{0, 0}, {1, 1}, {2, 0}, {2, 2}, {1, 1}, {0, 2}}, 2, "waist");
  expect_area({{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {2, 2}, {2, 4}, {4, 4}, {4, 2}, {2, 2}}, 32,
              "hole");
  expect_area({{0, 0},
               {9, 0},
               {9, 9},
               {0, 9},
               {0, 0},
               {1, 1},
               {1, 3},
               {3, 3},
               {3, 1},
               {1, 1},
               {0, 0},
               {5, 1},
               {5, 3},
               {7, 3},
               {7, 1},
               {5, 1}},
              73, "two holes from one corner");
  expect_area({{0, 0}, {1, 0}, {2, 0}, {1, 0}}, 0, "a line");
  expect_area({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {3, 2}, {3, 3}, {0, 3}}, 7, "C");
}

/// Combs, stars and spirals with spikes at random, larger than what dynamic programming is for.
TEST(ReadFaults, LargePolygonsKeepTheirArea) {
  Random random(3);
  for (int round = 0; round < 40; ++round) {
    std::vector<Vec3<double>> corners;
    const int n = 20 + static_cast<int>(random.below(400));
    double twice = 0;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * M_PI * i / n, radius = random.uniform(1, 3);
      const Vec3<double> at(radius * std::cos(angle), radius * std::sin(angle), 0);
      corners.push_back(at);
      if (random.happens(0.2)) corners.push_back(at);
      if (random.happens(0.2)) corners.insert(corners.end(), {at * random.uniform(1, 5), at});
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto &p = corners[i], &q = corners[(i + 1) % corners.size()];
      twice += p[0] * q[1] - p[1] * q[0];
    }
    const TriangleMesh mesh = polygon(corners);
    EXPECT_EQ(mesh.triangles.size(), corners.size() - 2);
    EXPECT_NEAR(area(mesh), twice / 2, 1e-9 * twice);
  }
}

}  // namespace
}  // namespace bvlab
