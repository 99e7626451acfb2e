// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/scene_x3d.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "experiments/files/utf8.hpp"

namespace bvlab {
namespace {

constexpr double frames_a_second = 30;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

template <class Numbers>
std::string numbers(const Numbers& values) {
  std::string text;
  for (const auto value : values) {
    if (!text.empty()) text += ' ';
    text += number(value);
  }
  return text;
}

/// What an XML attribute in double quotes may hold.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : as_utf8(text)) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return result;
}

/// Axis and angle of a quaternion w x y z of any length but zero.
std::array<double, 4> axis_and_angle(const double* q) {
  const double sine = std::hypot(q[1], q[2], q[3]);
  if (sine == 0) return {0, 0, 1, 0};
  return {q[1] / sine, q[2] / sine, q[3] / sine, 2 * std::atan2(sine, q[0])};
}

/// Hues a golden section apart, so that neighbours differ however many there are.
std::array<double, 3> colour_of(std::size_t body) {
  const double hue = 6 * std::fmod(0.55 + 0.618034 * static_cast<double>(body), 1.0);
  std::array<double, 3> colour;
  for (int k = 0; k < 3; ++k) {
    const double away = std::abs(std::fmod(hue + 4.0 * (3 - k) / 2, 6.0) - 3);
    colour[static_cast<std::size_t>(k)] = 0.45 + 0.35 * std::clamp(away - 1, 0.0, 1.0);
  }
  return colour;
}
constexpr std::array<double, 3> touching_colour = {0.85, 0.1, 0.1};

class Writer {
 public:
  Writer(std::span<const TriangleMesh> meshes, const Trace& trace,
         std::span<const std::uint8_t> touching)
      : meshes_(meshes), trace_(trace), touching_(touching) {}

  std::string document(const std::string& title) {
    text_ =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<!DOCTYPE X3D PUBLIC \"ISO//Web3D//DTD X3D 3.3//EN\" "
        "\"https://www.web3d.org/specifications/x3d-3.3.dtd\">\n"
        "<X3D profile=\"Interchange\" version=\"3.3\">\n"
        "<head>\n<meta name=\"generator\" content=\"bvlab\"/>\n<meta name=\"title\" content=\"" +
        escaped(title) + "\"/>\n</head>\n<Scene>\n<NavigationInfo type='\"EXAMINE\" \"ANY\"'/>\n";
    add_viewpoint();
    for (std::size_t body = 0; body < trace_.objects; ++body) add_body(body);
    const double frames = static_cast<double>(std::max<std::size_t>(trace_.frames, 2) - 1);
    text_ += "<TimeSensor DEF=\"clock\" loop=\"true\" cycleInterval=\"" +
             number(frames / frames_a_second) + "\"/>\n";
    for (std::size_t body = 0; body < trace_.objects; ++body) add_motion(body);
    return text_ + "</Scene>\n</X3D>\n";
  }

 private:
  const double* pose(std::size_t frame, std::size_t body) const {
    return trace_.values.data() + 7 * (frame * trace_.objects + body);
  }

  /// From far enough to see all that the bodies go through.
  void add_viewpoint() {
    Vec3<double> low = Vec3<double>::Constant(std::numeric_limits<double>::infinity());
    Vec3<double> high = -low;
    double radius = 0;
    for (const auto& mesh : meshes_)
      for (const auto& vertex : mesh.vertices) radius = std::max(radius, vertex.norm());
    for (std::size_t frame = 0; frame < trace_.frames; ++frame)
      for (std::size_t body = 0; body < trace_.objects; ++body) {
        const double* p = pose(frame, body);
        low = low.cwiseMin(Vec3<double>(p[0], p[1], p[2]));
        high = high.cwiseMax(Vec3<double>(p[0], p[1], p[2]));
      }
    if (trace_.frames * trace_.objects == 0) return;
    const Vec3<double> centre = (low + high) / 2;
    const double away = 2.2 * ((high - low).norm() / 2 + radius);
    text_ += "<Viewpoint description=\"all bodies\" position=\"" +
             numbers(std::array{centre[0], centre[1], centre[2] + away}) +
             "\" centerOfRotation=\"" + numbers(centre) + "\"/>\n";
  }

  void add_body(std::size_t body) {
    const std::string id = std::to_string(body);
    text_ += "<Transform DEF=\"body" + id + "\"";
    if (trace_.frames > 0) {
      const double* p = pose(0, body);
      text_ += " translation=\"" + numbers(std::array{p[0], p[1], p[2]}) + "\" rotation=\"" +
               numbers(axis_and_angle(p + 3)) + "\"";
    }
    text_ += ">\n<Shape>\n<Appearance><Material DEF=\"colour" + id + "\" diffuseColor=\"" +
             numbers(colour(body, trace_.frames > 0 && touches(0, body))) + "\"/></Appearance>\n";
    const std::size_t mesh = body % meshes_.size();
    if (body == mesh)
      add_mesh(mesh);
    else
      text_ += "<IndexedTriangleSet USE=\"mesh" + std::to_string(mesh) + "\"/>\n";
    text_ += "</Shape>\n</Transform>\n";
  }

  /// Written where it is first used; both sides are drawn, since a mesh may be open.
  void add_mesh(std::size_t mesh) {
    text_ +=
        "<IndexedTriangleSet DEF=\"mesh" + std::to_string(mesh) + "\" solid=\"false\" index=\"";
    for (const auto& triangle : meshes_[mesh].triangles)
      for (const auto corner : triangle) text_ += std::to_string(corner) + ' ';
    text_ += "\">\n<Coordinate point=\"";
    for (const auto& vertex : meshes_[mesh].vertices) text_ += numbers(vertex) + ", ";
    text_ += "\"/>\n</IndexedTriangleSet>\n";
  }

  bool touches(std::size_t frame, std::size_t body) const {
    if (touching_.empty()) return false;
    const std::size_t n = trace_.objects;
    const std::uint8_t* row = touching_.data() + frame * trace_.pairs();
    for (std::size_t other = 0; other < n; ++other) {
      if (other == body) continue;
      const std::size_t i = std::min(body, other), j = std::max(body, other);
      if (row[i * (2 * n - i - 1) / 2 + (j - i - 1)]) return true;
    }
    return false;
  }
  static std::array<double, 3> colour(std::size_t body, bool touches) {
    return touches ? touching_colour : colour_of(body);
  }

  /// The interpolators of what changes; a body that rests, or never changes its colour, has none.
  void add_motion(std::size_t body) {
    const std::string id = std::to_string(body);
    std::vector<double> keys, places, turns, colour_keys, colours;
    bool moves = false, touches_now = false;
    const double last = static_cast<double>(std::max<std::size_t>(trace_.frames, 2) - 1);
    for (std::size_t frame = 0; frame < trace_.frames; ++frame) {
      const double *p = pose(frame, body), key = static_cast<double>(frame) / last;
      moves = moves || !std::equal(p, p + 7, pose(0, body));
      keys.push_back(key);
      places.insert(places.end(), p, p + 3);
      const auto turn = axis_and_angle(p + 3);
      turns.insert(turns.end(), turn.begin(), turn.end());
      const bool touched = touches_now;
      touches_now = touches(frame, body);
      const auto show = [&](bool touching) {
        const auto shown = colour(body, touching);
        colour_keys.push_back(key);
        colours.insert(colours.end(), shown.begin(), shown.end());
      };
      // Two colours at one key are a step, not a blend.
      if (frame > 0 && touches_now != touched) show(touched);
      if (frame == 0 || touches_now != touched) show(touches_now);
    }
    if (moves) {
      add_interpolator("Position", "place" + id, keys, places, "body" + id, "translation");
      add_interpolator("Orientation", "turn" + id, keys, turns, "body" + id, "rotation");
    }
    if (colour_keys.size() > 1)
      add_interpolator("Color", "touch" + id, colour_keys, colours, "colour" + id, "diffuseColor");
  }

  void add_interpolator(const std::string& kind, const std::string& name,
                        const std::vector<double>& keys, const std::vector<double>& values,
                        const std::string& node, const std::string& field) {
    text_ += "<" + kind + "Interpolator DEF=\"" + name + "\" key=\"" + numbers(keys) +
             "\" keyValue=\"" + numbers(values) + "\"/>\n";
    add_route("clock", "fraction_changed", name, "set_fraction");
    add_route(name, "value_changed", node, field);
  }
  void add_route(const std::string& from, const std::string& out, const std::string& to,
                 const std::string& in) {
    text_ += "<ROUTE fromNode=\"" + from + "\" fromField=\"" + out + "\" toNode=\"" + to +
             "\" toField=\"" + in + "\"/>\n";
  }

  std::span<const TriangleMesh> meshes_;
  const Trace& trace_;
  std::span<const std::uint8_t> touching_;
  std::string text_;
};

}  // namespace

std::string scene_x3d(std::span<const TriangleMesh> meshes, const Trace& trace,
                      std::span<const std::uint8_t> touching, const std::string& title) {
  return Writer(meshes, trace, touching).document(title);
}

}  // namespace bvlab
