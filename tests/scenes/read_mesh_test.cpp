// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/read_mesh.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/random.hpp"
#include "tests/scenes/refusal.hpp"

namespace bvlab {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

TEST(ReadMesh, OffKeepsEveryDigitAndTheOrder) {
  const TriangleMesh mesh = parse_mesh(
      "OFF # a comment\n\n4 3 0\n0.1 0 0 1 2 3\n1 0 0 255 0 0\n0 +1e-320 0 4 5 6\n0 0 1 7 8 9\r\n"
      "3 2 1 0\n3 1 1 1 0.5 0.5 0.5\n3 2 1 0\n",
      "a.off");
  EXPECT_EQ(mesh.triangles, (Triangles{{2, 1, 0}, {1, 1, 1}, {2, 1, 0}}));
  EXPECT_EQ(mesh.vertices[0][0], 0.1);
  EXPECT_EQ(mesh.vertices[2][1], 1e-320);
  EXPECT_EQ(parse_mesh("OFF 3 1 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2", "A.OFF").triangles.size(), 1u);
  EXPECT_EQ(parse_mesh("3 1\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2", "a.off").triangles.size(), 1u);
  EXPECT_EQ(parse_mesh("COFF\n3 1 0\n0 0 0 1 1 1 1\n0 0 0 1 1 1 1\n0 0 0 1 1 1 1\n3 0 1 2", "a.off")
                .triangles.size(),
            1u);
}

TEST(ReadMesh, ObjThatIsCutOff) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(refusal(vertices + "f 3 2", "a.obj"), "a.obj: line 5: truncated: ends within a face");
  EXPECT_EQ(parse_mesh(vertices + "f 3 2\n", "a.obj").triangles.size(), 1u);
  EXPECT_EQ(parse_mesh(vertices + "f 3 2 1", "a.obj").triangles.size(), 2u);
}

TEST(ReadMesh, OffFaultsSayWhere) {
  const auto off = [](const std::string& bytes) { return refusal(bytes, "a.off"); };
  EXPECT_EQ(off(""), "a.off: is empty");
  EXPECT_EQ(off("# nothing\n"), "a.off: holds nothing");
  EXPECT_EQ(off("solid x"), "a.off: line 1: not an OFF file: begins with 'solid'");
  EXPECT_EQ(off("OFF"), "a.off: truncated: no counts");
  EXPECT_EQ(off("OFF BINARY\n"), "a.off: line 1: binary OFF is not read, only text");
  EXPECT_EQ(off("4OFF\n"), "a.off: line 1: '4OFF': only three coordinates a vertex are read");
  EXPECT_EQ(off("OFF\n-1 1 0\n"), "a.off: line 2: the number of vertices cannot be -1");
  EXPECT_EQ(off("OFF\n4000000000 4000000000 0\n0 0 0\n"),
            "a.off: truncated: holds 1 of 4000000000 vertices, one a line");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n"), "a.off: truncated: holds 0 of 1 faces, one a line");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0\n3 0 0 0\n"), "a.off: line 3: a coordinate is missing");
  EXPECT_EQ(off("OFF\n1 1 0\n0 nan 0\n3 0 0 0\n"), "a.off: line 3: coordinate 'nan' is not finite");
  EXPECT_EQ(off("OFF\n1 1 0\n0 1e999 0\n3 0 0 0\n"),
            "a.off: line 3: coordinate '1e999' is not finite");
  EXPECT_EQ(off("OFF\n1 1 0\n0 1e-400 0\n3 0 0 0\n"),
            "a.off: line 3: coordinate '1e-400' is too small for float64");
  EXPECT_EQ(off("OFF\n1 1 0\n0 -0.00025E-323 0\n3 0 0 0\n"),
            "a.off: line 3: coordinate '-0.00025E-323' is too small for float64");
  EXPECT_EQ(off("OFF\n1 1 0\n0 x 0\n3 0 0 0\n"), "a.off: line 3: 'x' is not a number");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n3 0 0 1\n"),
            "a.off: line 4: vertex 1 does not exist: there are 1, from 0");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n3 0 0 -1\n"),
            "a.off: line 4: vertex -1 does not exist: there are 1, from 0");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n3 0 0\n"), "a.off: line 4: the number of a vertex is missing");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n2 0 0\n"), "a.off: has no triangles");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n3 0 0 0\n3 0 0 0\n"),
            "a.off: holds 3 lines of vertices and faces, where the header promises 1 and 1");
  EXPECT_EQ(off("OFF\n0 0 0\n"), "a.off: has no triangles");
}

TEST(ReadMesh, ObjKeepsEveryDigitAndTheOrder) {
  const TriangleMesh mesh = parse_mesh(
      "# made by hand\nmtllib x.mtl\nv 0.1 0 0 1.0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nusemtl a\n"
      "f 1//1 2//1 3//1\nusemtl b\nf -1/2/1 -2 -3\nl 1 2\np 3\nusemtl a\nf 4 3 \\\n 2\nv 5 5 5\n",
      "a.obj");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {2, 1, 0}, {3, 2, 1}}));
  EXPECT_EQ(mesh.vertices[0][0], 0.1);
  EXPECT_EQ(refusal("v 0 0 0\nf 1 1 0\n", "a.obj"),
            "a.obj: line 2: vertex 0 does not exist: they are numbered from 1");
  EXPECT_EQ(refusal("v 0 0 0\nf 1 1 -2\n", "a.obj"),
            "a.obj: line 2: vertex -2 does not exist: there are 1 so far");
  EXPECT_EQ(refusal("v 0 0 0\nf 1 1 7\nv 1 1 1\n", "a.obj"),
            "a.obj: line 2: vertex 7 does not exist: there are 2");
  EXPECT_EQ(refusal("v 0 0 -inf\n", "a.obj"), "a.obj: line 1: coordinate '-inf' is not finite");
  EXPECT_EQ(refusal("v 0 0 0\nf 1 1 1e\n", "a.obj"),
            "a.obj: line 2: '1e' is not the number of a vertex");
  EXPECT_EQ(refusal("v 0 0 0\nl 1 1\n", "a.obj"), "a.obj: has no triangles");
}

TEST(ReadMesh, PlyTextAndBinary) {
  const std::string properties =
      "comment #x\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
      "property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string text =
      "ply\nformat ascii 1.0\n" + properties + "0.1 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2\n3 2 2 2\n";
  const TriangleMesh from_text = parse_mesh(text, "a.ply");
  EXPECT_EQ(from_text.vertices[0][0], 0.1);
  EXPECT_EQ(from_text.triangles, (Triangles{{0, 1, 2}, {2, 2, 2}}));

  for (const bool big : {false, true}) {
    std::string binary = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                         "_endian 1.0\n" + properties;
    const auto put = [&](auto value) {
      std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
      if (big) std::reverse(bytes.begin(), bytes.end());
      binary += bytes;
    };
    for (const auto& v : from_text.vertices) {
      for (int d = 0; d < 3; ++d) put(v[d]);
      put(std::uint8_t{9});
    }
    for (const auto& t : from_text.triangles) {
      put(std::uint8_t{3});
      for (const auto v : t) put(static_cast<std::int32_t>(v));
    }
    const TriangleMesh mesh = parse_mesh(binary, "a.PLY");
    EXPECT_EQ(mesh.vertices, from_text.vertices);
    EXPECT_EQ(mesh.triangles, from_text.triangles);
    EXPECT_EQ(refusal(binary.substr(0, binary.size() - 1), "a.ply"),
              "a.ply: truncated: holds 1 of 2 of element face");
  }
  const auto ply = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return refusal(changed, "a.ply");
  };
  EXPECT_EQ(ply("3 0 1 2", "3 0 1 3"),
            "a.ply: line 15: vertex 3 does not exist: there are 3, from 0");
  EXPECT_EQ(ply("3 0 1 2", "3 0 1 -1"),
            "a.ply: line 15: vertex -1 does not exist: there are 3, from 0");
  EXPECT_EQ(ply("3 0 1 2", "1e300 0 1 2"), "a.ply: line 15: a list of impossible length");
  EXPECT_EQ(ply("0.1", "1e-400"), "a.ply: line 12: coordinate '1e-400' is too small for float64");
  EXPECT_EQ(ply("0.1", "nan"), "a.ply: line 12: coordinate 'nan' is not finite");
  EXPECT_EQ(ply("vertex 3", "vertex 4000000000"),
            "a.ply: truncated: holds 5 of 4000000000 of element vertex");
  EXPECT_EQ(ply("double z", "double w"), "a.ply: vertices without x, y, z");
  EXPECT_EQ(ply("end_header", "end"), "a.ply: line 11: unknown word 'end'");
  EXPECT_EQ(ply("ply", "pla"), "a.ply: not a PLY file");
}

/// The least numbers there are, and zeros however they are written.
TEST(ReadMesh, SmallNumbers) {
  const TriangleMesh mesh = parse_mesh(
      "OFF\n3 1 0\n5e-324 -1e-310 2.5e-323\n-0.000e-999 0e5 .0\n1 0 0\n3 0 1 2\n", "a.off");
  EXPECT_EQ(mesh.vertices[0], Vec3<double>(5e-324, -1e-310, 2.5e-323));
  EXPECT_EQ(mesh.vertices[1], Vec3<double>(0, 0, 0));
}

TEST(ReadMesh, StlTextAndBinary) {
  const std::string facet =
      "facet normal 0 0 1\n outer loop\n  vertex 0.1 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n"
      " endloop\nendfacet\n";
  const std::string text = "solid a thing\n" + facet + facet + "endsolid\n";
  const TriangleMesh from_text = parse_mesh(text, "a.stl");
  EXPECT_EQ(from_text.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(from_text.vertices[3][0], 0.1);
  EXPECT_EQ(refusal(text.substr(0, text.size() - 18), "a.stl"),
            "a.stl: truncated: ends within a facet");
  EXPECT_EQ(refusal("solid a thing\n" + facet, "a.stl"), "a.stl: truncated: ends without endsolid");
  EXPECT_EQ(refusal("solid\nendsolid\n", "a.stl"), "a.stl: has no triangles");
  EXPECT_EQ(refusal("nothing", "a.stl"), "a.stl: not an STL file");

  std::string binary = "solid but binary";
  binary.resize(80);
  const std::uint32_t count = 2;
  binary.append(reinterpret_cast<const char*>(&count), 4);
  for (std::uint32_t i = 0; i < count; ++i) {
    const float record[12] = {0, 0, 1, 0.1f, 0, 0, 1, 0, 0, 0, 1, static_cast<float>(i)};
    binary.append(reinterpret_cast<const char*>(record), sizeof record).append(2, '\0');
  }
  const TriangleMesh mesh = parse_mesh(binary, "a.stl");
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.vertices[3], Vec3<double>(double{0.1f}, 0, 0));
  EXPECT_EQ(mesh.vertices[5], Vec3<double>(0, 1, 1));
  binary[0] = 'x';
  EXPECT_EQ(refusal(binary.substr(0, binary.size() - 1), "a.stl"),
            "a.stl: truncated: holds 1 of 2 triangles");
  binary[84 + 12 + 3] = '\x7f', binary[84 + 12 + 2] = '\xff';
  EXPECT_EQ(refusal(binary, "a.stl"), "a.stl: triangle 0: a coordinate is not finite");
}

/// Whatever is cut off or changed, a parser gives a mesh in order or an Unusable, nothing else.
TEST(ReadMesh, DamagedFilesAreRefusedOrReadInOrder) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n4 0 1 2 3\n"},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf -1 -2 -3 1\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
       "property float z\nelement face 1\nproperty list uchar int vertex_index\n"
       "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
      {"a.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\n"
       "property char y\nproperty char z\nelement face 1\nproperty list uchar uchar "
       "vertex_index\nend_header\n" +
           std::string("\1\2\3\3\0\0\0", 7)},
      {"a.stl",
       "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
       "endfacet\nendsolid\n"}};
  ReadOptions quiet;
  quiet.say = [](const std::string&) {};
  Random random(7);
  for (const auto& [name, good] : files) {
    EXPECT_EQ(refusal(good, name), "");
    std::size_t refused = 0;
    for (int i = 0; i < 20000; ++i) {
      std::string bytes = good;
      for (std::uint64_t changes = random.below(4); changes-- > 0 && !bytes.empty();) {
        const std::size_t at = random.below(bytes.size());
        switch (random.below(4)) {
          case 0:
            bytes[at] = static_cast<char>(random.below(256));
            break;
          case 1:
            bytes[at] = "0123456789-.e \n"[random.below(15)];
            break;
          case 2:
            bytes.erase(at, random.below(8));
            break;
          default:
            bytes.insert(at, bytes.substr(random.below(bytes.size()), random.below(8)));
        }
      }
      if (random.happens(0.2)) bytes.resize(random.below(bytes.size() + 1));
      try {
        const TriangleMesh mesh = parse_mesh(bytes, name, quiet);
        ASSERT_FALSE(mesh.triangles.empty());
        for (const auto& triangle : mesh.triangles)
          for (const auto v : triangle) ASSERT_LT(v, mesh.vertices.size());
        for (const auto& v : mesh.vertices) ASSERT_TRUE(v.allFinite());
      } catch (const Unusable& error) {
        ++refused;
        ASSERT_TRUE(std::string(error.what()).starts_with(name + ": ")) << error.what();
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
    EXPECT_GT(refused, 1000u);
  }
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    sum += (b - a).cross(c - a)[2] / 2;
    EXPECT_GE((b - a).cross(c - a)[2], 0);
  }
  return sum;
}

TEST(ReadMesh, PolygonsAreCoveredOnce) {
  // An arrowhead, whichever corner it starts at, and a comb.
  const char* arrow[] = {"0 0 0", "4 0 0", "1 1 0", "0 4 0"};
  for (std::size_t start = 0; start < 4; ++start) {
    std::string text = "OFF\n4 1 0\n";
    for (std::size_t k = 0; k < 4; ++k) text += arrow[(start + k) % 4] + std::string("\n");
    const TriangleMesh mesh = parse_mesh(text + "4 0 1 2 3\n", "a.off");
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(area(mesh), 4);
  }
  std::string comb = "v 0 0 0\nv 20 0 0\n", face = "f 1 2";
  for (int i = 20; i > 0; --i) {
    comb += "v " + std::to_string(i) + " 5 0\nv " + std::to_string(i - 0.5) + " 1 0\n";
    for (const int corner : {43 - 2 * i, 44 - 2 * i})
      face.append(1, ' ').append(std::to_string(corner));
  }
  const TriangleMesh mesh = parse_mesh(comb + face + "\n", "comb.obj");
  EXPECT_EQ(mesh.triangles.size(), 40u);
  const double shoelace = [&] {
    double twice = 0;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const auto &p = mesh.vertices[i], &q = mesh.vertices[(i + 1) % mesh.vertices.size()];
      twice += p[0] * q[1] - p[1] * q[0];
    }
    return twice / 2;
  }();
  EXPECT_NEAR(area(mesh), shoelace, 1e-12);
  // Knotted and flat ones become triangles all the same.
  EXPECT_EQ(parse_mesh("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\nf 1 1 1 1 1\n", "a.obj")
                .triangles.size(),
            5u);
}

class Files : public testing::Test {
 protected:
  void SetUp() override {
    directory =
        std::filesystem::temp_directory_path() / ("bvlab meshes " + std::to_string(::getpid()));
    std::filesystem::create_directories(directory);
  }
  void TearDown() override { std::filesystem::remove_all(directory); }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(directory / name, std::ios::binary) << text;
    return directory / name;
  }
  static std::string refusal_of(const std::filesystem::path& path) {
    try {
      read_mesh(path);
      return "";
    } catch (const Unusable& error) {
      return error.what();
    }
  }
  std::filesystem::path directory;
};

TEST_F(Files, WrittenOffIsReadBackToTheLastDigit) {
  const TriangleMesh mesh = formula_mesh("knot", 500);
  write_off(directory / "knot.off", mesh);
  const TriangleMesh back = read_mesh(directory / "knot.off");
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.triangles, mesh.triangles);
}

TEST_F(Files, MissingOrDirectoryIsSaid) {
  EXPECT_EQ(refusal_of(directory), directory.string() + ": is a directory");
  EXPECT_EQ(refusal_of(directory / "no.off"),
            (directory / "no.off").string() + ": No such file or directory");
  EXPECT_EQ(refusal_of(directory / "no.gltf"),
            (directory / "no.gltf").string() + ": No such file or directory");
}

TEST_F(Files, OtherFormatsThroughAssimp) {
  // assimp's reader of raw triangles leaves a hole among the nodes.
  EXPECT_EQ(read_mesh(write("a.raw", "part\n0 0 0 1 0 0 0 1 0\n")).triangles.size(), 1u);
  const auto unknown = write("a.nothing", "xyz");
  EXPECT_TRUE(
      refusal_of(unknown).starts_with(unknown.string() + ": not a mesh that assimp reads: "))
      << refusal_of(unknown);
}

TEST_F(Files, GltfReadsWhatIsBesideIt) {
  // Two nodes, one inside the other, show the same triangle.
  const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  write("a.bin", std::string(reinterpret_cast<const char*>(corners), sizeof corners));
  const std::string text = R"({"asset": {"version": "2.0"}, "scene": 0,
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0, "scale": [2, 2, 2], "children": [1]},
              {"mesh": 0, "translation": [10, 0, 0]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"uri": "a.bin", "byteLength": 36}]})";
  const auto scene = write("scene.gltf", text);
  const TriangleMesh mesh = read_mesh(scene);
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(mesh.vertices[1], Vec3<double>(2, 0, 0));
  EXPECT_EQ(mesh.vertices[3], Vec3<double>(20, 0, 0));
  EXPECT_EQ(mesh.vertices[5], Vec3<double>(20, 2, 0));
  std::filesystem::rename(directory / "a.bin", directory / "a b.bin");
  EXPECT_EQ(refusal_of(scene), scene.string() + ": buffers[0].uri: " +
                                   (directory / "a.bin").string() + ": No such file or directory");
  std::string coded = text;
  coded.replace(coded.find("a.bin"), 5, "a%20b.bin");
  EXPECT_EQ(read_mesh(write("scene.gltf", coded)).triangles, mesh.triangles);
}

}  // namespace
}  // namespace bvlab
