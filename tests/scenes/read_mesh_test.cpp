// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/read_mesh.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>

#include "experiments/files/unusable.hpp"
#include "experiments/scenes/formula_mesh.hpp"

namespace bvlab {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

std::string refusal(const std::string& bytes, const std::string& name) {
  try {
    parse_mesh(bytes, name);
    return "";
  } catch (const Unusable& error) {
    return error.what();
  }
}

TEST(ReadMesh, OffKeepsEveryDigitAndTheOrder) {
  const TriangleMesh mesh = parse_mesh(
      "OFF # a comment\n\n4 3 0\n0.1 0 0\n1 0 0 255 0 0\n0 +1e-320 0\n0 0 1\r\n"
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
            "a.off: truncated: holds 1 of 4000000000 vertices");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n"), "a.off: truncated: holds 0 of 1 faces");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0\n"), "a.off: line 3: a coordinate is missing");
  EXPECT_EQ(off("OFF\n1 1 0\n0 nan 0\n"), "a.off: line 3: coordinate 'nan' is not finite");
  EXPECT_EQ(off("OFF\n1 1 0\n0 1e999 0\n"), "a.off: line 3: coordinate '1e999' is not finite");
  EXPECT_EQ(off("OFF\n1 1 0\n0 x 0\n"), "a.off: line 3: 'x' is not a number");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n3 0 0 1\n"),
            "a.off: line 4: vertex 1 does not exist: there are 1, from 0");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n3 0 0 -1\n"),
            "a.off: line 4: vertex -1 does not exist: there are 1, from 0");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n3 0 0\n"), "a.off: line 4: the number of a vertex is missing");
  EXPECT_EQ(off("OFF\n1 1 0\n0 0 0\n2 0 0\n"), "a.off: has no triangles");
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
  const auto glb = write("a.gltf", "not a scene");
  EXPECT_TRUE(refusal_of(glb).starts_with(glb.string() + ": not a mesh that assimp reads: "))
      << refusal_of(glb);
  EXPECT_EQ(refusal_of(glb).find('\n'), std::string::npos);
  const auto unknown = write("a.nothing", "xyz");
  EXPECT_TRUE(
      refusal_of(unknown).starts_with(unknown.string() + ": not a mesh that assimp reads: "))
      << refusal_of(unknown);
}

}  // namespace
}  // namespace bvlab
