// SPDX-License-Identifier: BSD-3-Clause
/// `bvlab scene NAME`: writes a built-in scene as a trace, and its meshes.
#include <Eigen/Geometry>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "experiments/commands/commands.hpp"
#include "experiments/commands/variant_options.hpp"
#include "experiments/files/npy.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/touches_any.hpp"
#include "experiments/scenes/formula_mesh.hpp"
#include "experiments/scenes/named_mesh.hpp"
#include "experiments/scenes/public/public_scenes.hpp"
#include "experiments/scenes/read_mesh.hpp"
#include "experiments/scenes/scenes.hpp"

namespace bvlab {
namespace {

/// Of all scenes: each has some of them.
struct Arguments {
  std::vector<std::string> files, names;
  std::size_t polygons = 500, frames = 500;
  std::string scene, from, file, out, meshes;
  double scale = 1;
};

/// Meshes apart from their names.
struct Bodies {
  std::vector<std::string> names;
  std::vector<TriangleMesh> meshes;
};
Bodies bodies_of(std::vector<NamedMesh> named) {
  Bodies bodies;
  for (auto& [name, mesh] : named) {
    bodies.names.push_back(std::move(name));
    bodies.meshes.push_back(std::move(mesh));
  }
  return bodies;
}

template <class S>
std::string default_meshes() {
  if constexpr (requires { S::meshes; }) return std::string(S::meshes);
  return "bunny";
}

template <class S>
std::vector<NamedMesh> meshes_of(const S& scene, const Arguments& arguments) {
  if constexpr (HasOwnMeshes<S>) return scene.own_meshes();
  std::vector<NamedMesh> meshes;
  for (const auto& file : arguments.files)
    meshes.push_back(
        {std::filesystem::path(file).stem().string(), read_mesh(file, {.scale = arguments.scale})});
  for (const auto& name : arguments.names)
    for (auto& mesh : named_meshes(name, arguments.polygons)) meshes.push_back(std::move(mesh));
  if (meshes.empty()) meshes = named_meshes(default_meshes<S>(), arguments.polygons);
  return meshes;
}

/// 0-bunny.off, 1-torus.off ...: in the order in which replay takes them, and in which a shell
/// lists them.
std::vector<std::filesystem::path> places_of_meshes(const std::string& directory,
                                                    const std::vector<std::string>& names) {
  std::vector<std::filesystem::path> places;
  const std::size_t digits = std::to_string(names.empty() ? 0 : names.size() - 1).size();
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string number = std::to_string(i);
    number.insert(0, digits - number.size(), '0');
    places.push_back(std::filesystem::path(directory) / (number + "-" + names[i] + ".off"));
  }
  return places;
}

/// Throws Unusable where a mesh would replace one that is read, or the trace.
void require_places_of_meshes(const Arguments& arguments, const Bodies& bodies,
                              std::span<const NamedFile> read) {
  // In a folder that is still to be made there is nothing to replace.
  std::error_code error;
  if (!std::filesystem::exists(arguments.meshes, error)) return;
  std::vector<NamedFile> written{{"--out", arguments.out}};
  for (const auto& place : places_of_meshes(arguments.meshes, bodies.names))
    written.push_back({"--meshes", place});
  require_places(read, written);
}

void write(const Arguments& arguments, const Bodies& bodies, const Array<double>& trace) {
  if (const std::string& directory = arguments.meshes; !directory.empty()) {
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) throw Unusable(directory, "cannot be made: " + error.message());
    const auto places = places_of_meshes(directory, bodies.names);
    for (std::size_t i = 0; i < places.size(); ++i) write_off(places[i], bodies.meshes[i]);
  }
  write_npy<double>(arguments.out, trace.shape, trace.data);
}

/// Throws Unusable where the trace would replace what is read, or cannot be written.
void require_out(const Arguments& arguments, std::span<const NamedFile> read) {
  const NamedFile written[] = {{"--out", arguments.out}};
  require_places(read, written);
}

template <class S>
void run(const S& scene, const Arguments& arguments) {
  std::vector<NamedFile> read;
  for (const auto& mesh : arguments.files) read.push_back({"--mesh", mesh});
  if constexpr (requires { scene.trace; }) read.push_back({"--trace", scene.trace});
  require_out(arguments, read);
  if constexpr (requires { scene.check(); }) scene.check();
  const Bodies bodies = bodies_of(meshes_of(scene, arguments));
  require_places_of_meshes(arguments, bodies, read);
  std::vector<Extent> extents;
  for (const auto& mesh : bodies.meshes) extents.push_back(extent_of(mesh));
  // Trees are made for scenes that ask.
  const auto touches = HasOwnMeshes<S> ? TouchesAny() : touches_any(bodies.meshes, scene.objects);
  write(arguments, bodies, scene.generate(extents, touches));
}

/// An option of a scene as one of the command line.
struct Adding {
  CLI::App& command;

  template <class T>
  void operator()(std::string_view name, T& value, std::string_view meaning) const {
    const std::string flag = "--" + std::string(name), text(meaning);
    if constexpr (std::is_same_v<T, Length>) {
      command
          .add_option_function<std::string>(
              flag,
              [&value, flag](const std::string& word) {
                try {
                  value = length_from(word);
                } catch (const Unusable& fault) {
                  throw Unusable(flag, fault.what());
                }
              },
              text)
          ->type_name("LENGTH")
          ->default_str(text_of(value));
    } else if constexpr (std::is_unsigned_v<T>) {
      command.add_option(flag, value, text)->check(whole_number())->capture_default_str();
    } else if constexpr (std::is_floating_point_v<T>) {
      command.add_option(flag, value, text)->check(number())->capture_default_str();
    } else {
      command.add_option(flag, value, text)->capture_default_str();
    }
  }
};

void add_out_options(CLI::App& command, Arguments& arguments, const std::string& what_is_out,
                     const std::string& whose) {
  command.add_option("--out", arguments.out, what_is_out)->required();
  command.add_option("--meshes", arguments.meshes,
                     "directory to write the " + whose + "meshes to, as OFF");
}

template <class S>
void add(CLI::App& parent) {
  CLI::App* command = parent.add_subcommand(std::string(S::name), std::string(S::description));
  auto scene = std::make_shared<S>();
  auto arguments = std::make_shared<Arguments>();
  scene->visit_options(Adding{*command});
  add_out_options(*command, *arguments, "the trace: .npy, float64, (frames, objects, 7)", "");
  command->callback([scene, arguments] { run(*scene, *arguments); });
  if constexpr (HasOwnMeshes<S>) return;
  command->add_option("--mesh", arguments->files, "mesh file; object i is mesh i mod their number");
  add_scale_option(*command, arguments->scale);
  command->add_option("--shape", arguments->names,
                      "built-in mesh, as NAME[:POLYGONS[:SCALE]]; names are bunny, " +
                          formula_mesh_names() +
                          "; NAME-hull is its convex hull (default: " + default_meshes<S>() + ")");
  command->add_option("--polygons", arguments->polygons, "triangles of each built-in mesh")
      ->check(whole_number())
      ->capture_default_str();
  command->footer(
      "A LENGTH is a number, or one followed by `leaf` (radii of the smallest leaf "
      "sphere) or `body` (radii of the largest mesh).");
}

void run_public(const Arguments& arguments) {
  require_out(arguments, {});
  require_public_scene(arguments.scene);
  if (is_public_box_scene(arguments.scene)) {
    const auto boxes = public_boxes(arguments.scene, arguments.from, arguments.frames);
    return write_npy<float>(arguments.out, boxes.shape, boxes.data);
  }
  const auto touches = [](std::span<const TriangleMesh> meshes) {
    return touches_any(meshes, meshes.size());
  };
  auto motion = public_motion(arguments.scene, arguments.from, {arguments.frames, touches});
  const Bodies bodies = bodies_of(std::move(motion.meshes));
  require_places_of_meshes(arguments, bodies, {});
  write(arguments, bodies, motion.trace);
}

void add_public(CLI::App& parent) {
  CLI::App* command = parent.add_subcommand(
      "public", "public:NAME: meshes and motions of public repositories, at a fixed commit");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("name", arguments->scene, "see `bvlab list scenes`")->required();
  command->add_option(
      "--from", arguments->from,
      "a clone of the repository, or `git` to fetch the commit (default: files that "
      "were fetched before)");
  command
      ->add_option("--frames", arguments->frames,
                   "number of frames; for boxes, the equal parts of a simulation step")
      ->check(whole_number())
      ->capture_default_str();
  add_out_options(*command, *arguments, "the trace of bodies or of boxes, as .npy", "");
  command->callback([arguments] { run_public(*arguments); });
}

/// A part's name as that of a file: other characters than these could lead elsewhere.
std::string file_name_of(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
  return name.empty() ? "part" : name.substr(0, 100);
}

/// Every part is a body with a mesh of its own; their poses are the one frame of the trace.
void run_file(const Arguments& arguments) {
  const NamedFile read[] = {{"file", arguments.file}};
  require_out(arguments, read);
  const auto parts = read_parts(arguments.file, {.scale = arguments.scale});
  Bodies bodies;
  Array<double> trace{{1, parts.size(), 7}, {}};
  for (const MeshPart& part : parts) {
    bodies.names.push_back(file_name_of(part.name));
    bodies.meshes.push_back(*part.mesh);
    const Eigen::Quaterniond q(part.pose.rotation);
    const Vec3<double>& t = part.pose.translation;
    trace.data.insert(trace.data.end(), {t[0], t[1], t[2], q.w(), q.x(), q.y(), q.z()});
  }
  require_places_of_meshes(arguments, bodies, read);
  write(arguments, bodies, trace);
}

void add_file(CLI::App& parent) {
  CLI::App* command = parent.add_subcommand(
      "file", "the parts of a file (nodes of a DAE, glTF or 3MF, objects of an OBJ) as they stand");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("file", arguments->file, "a mesh file")->required();
  add_scale_option(*command, arguments->scale);
  add_out_options(*command, *arguments, "the trace: .npy, float64, (1, parts, 7)", "parts' ");
  command->callback([arguments] { run_file(*arguments); });
}

}  // namespace

void add_scene(CLI::App& app) {
  CLI::App* command = app.add_subcommand("scene", "Writes a built-in scene as a trace");
  Scenes::for_each([&]<class S>(std::type_identity<S>) { add<S>(*command); });
  add_public(*command);
  add_file(*command);
  command->allow_extras();
  command->callback([command] {
    if (!command->get_subcommands().empty()) return;
    const auto words = command->remaining();
    throw Unusable((words.empty() ? "scene: a name is needed" : "no scene '" + words[0] + "'") +
                   "; available: " + Scenes::names());
  });
}

}  // namespace bvlab
