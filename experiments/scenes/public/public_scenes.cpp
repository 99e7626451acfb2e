// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/public/public_scenes.hpp"

#include <algorithm>

#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

constexpr PublicSource omplapp{"ompl/omplapp", "9c67afbb6354699f92dac6aeb637a63677597375"};
constexpr PublicSource pqp{"GammaUNC/PQP", "713de5b70dd1849b915f6412330078a9814e01ab"};
constexpr PublicSource fcl{"flexible-collision-library/fcl",
                           "e5efcc41b57b2d0da3bf183480f1298a6d531f44"};
constexpr PublicSource bullet{"bulletphysics/bullet3", "6c888f4abd7b46f572587360cc214985f02e5c6b"};
constexpr PublicSource ccd{"Continuous-Collision-Detection/Sample-Scalable-CCD-Data",
                           "d1de594b017d98b37be67f02f74e541e74804109"};

/// What is read, by SHA-256: files.sha256 beside this file.
constexpr PublicFile known[] = {
#include "public_files.inc"
};

using Files = std::vector<std::string>;

struct MeshScene {
  std::string_view name, description;
  const PublicSource& source;
  Files files;
  PublicMotion (*motion)(const PublicFiles&, const Files&, const MotionRequest&);
};

PublicMotion path(const PublicFiles& files, const Files& names, const MotionRequest& request) {
  return ompl_path(files, names[0], names[1], names[2], request);
}
PublicMotion search(const PublicFiles& files, const Files& names, const MotionRequest& request) {
  return ompl_search(files, names[0], names[1], names[2], request);
}
PublicMotion tori(const PublicFiles& files, const Files&, const MotionRequest& request) {
  return pqp_paths(files, "demos/falling/torus1", "demos/falling/torus2", request);
}
PublicMotion pair(const PublicFiles& files, const Files& names, const MotionRequest& request) {
  return search_among(files, names[0], names[1], request);
}
PublicMotion links(const PublicFiles& files, const Files& names, const MotionRequest& request) {
  return arm(files, names[0], names[1], {names.begin() + 2, names.end()}, request);
}

Files of_ompl(std::string robot, std::string environment, std::string last) {
  const std::string folder = "resources/3D/";
  return {folder + std::move(robot), folder + std::move(environment), folder + std::move(last)};
}

Files of_arm() {
  Files files{"data/kuka_iiwa/model.urdf", "examples/pybullet/examples/data/block_grasp_log.bin"};
  for (int link = 0; link < 8; ++link)
    files.push_back("data/kuka_iiwa/meshes/link_" + std::to_string(link) + ".stl");
  return files;
}

const std::vector<MeshScene>& scenes() {
  static const std::vector<MeshScene> list{
      {"alpha-1.1", "OMPL.app: two bent tubes come apart, along a solution", omplapp,
       of_ompl("alpha_robot.dae", "alpha_env-1.1.dae", "alpha-1.1.path"), path},
      {"alpha-1.2", "OMPL.app: two bent tubes come apart, along a solution", omplapp,
       of_ompl("alpha_robot.dae", "alpha_env-1.2.dae", "alpha-1.2.path"), path},
      {"alpha-1.5", "OMPL.app: two bent tubes come apart, along a solution", omplapp,
       of_ompl("alpha_robot.dae", "alpha_env-1.5.dae", "alpha-1.5.path"), path},
      {"apartment", "OMPL.app: a piano through an apartment", omplapp,
       of_ompl("Apartment_robot.dae", "Apartment_env.dae", "Apartment.path"), path},
      {"cubicles", "OMPL.app: a body through an office", omplapp,
       of_ompl("cubicles_robot.dae", "cubicles_env.dae", "cubicles.path"), path},
      {"easy", "OMPL.app: a twisted body through a wide hole", omplapp,
       of_ompl("Easy_robot.dae", "Easy_env.dae", "Easy.path"), path},
      {"escape", "OMPL.app: out of a long narrow passage", omplapp,
       of_ompl("escape_robot.dae", "escape_env.dae", "escape.path"), path},
      {"spirelli", "OMPL.app: along a spiral", omplapp,
       of_ompl("spirelli_robot.dae", "spirelli_env.dae", "spirelli.path"), path},
      {"twistycooler", "OMPL.app: a twisted body through a narrow hole", omplapp,
       of_ompl("Twistycooler_robot.dae", "Twistycooler_env.dae", "Twistycooler.path"), path},
      {"abstract", "OMPL.app: a search from the start, by a random tree", omplapp,
       of_ompl("Abstract_robot.dae", "Abstract_env.dae", "Abstract.cfg"), search},
      {"bugtrap", "OMPL.app: a rod in a trap, a search by a random tree", omplapp,
       of_ompl("bugtrap_robot.dae", "bugtrap_env.dae", "bugtrap.cfg"), search},
      {"torus",
       "PQP's demo: a torus falls along another one",
       pqp,
       {"demos/falling/torus1.tris", "demos/falling/torus1.path", "demos/falling/torus2.tris",
        "demos/falling/torus2.path"},
       tori},
      {"env-rob",
       "FCL's test meshes: a search by a random tree",
       fcl,
       {"test/fcl_resources/rob.obj", "test/fcl_resources/env.obj"},
       pair},
      {"kuka", "a robot arm grasps a block: links and logged joints of Bullet's examples", bullet,
       of_arm(), links},
  };
  return list;
}

struct BoxScene {
  std::string_view name, before, after;
};
constexpr BoxScene box_scenes[] = {
    {"cloth-ball", "cloth-ball/frames/cloth_ball92.ply", "cloth-ball/frames/cloth_ball93.ply"},
    {"armadillo-rollers", "armadillo-rollers/frames/326.ply", "armadillo-rollers/frames/327.ply"},
    {"n-body-simulation", "n-body-simulation/frames/balls16_18.ply",
     "n-body-simulation/frames/balls16_19.ply"},
    {"rod-twist", "rod-twist/frames/3036.ply", "rod-twist/frames/3037.ply"},
};

constexpr std::string_view prefix = "public:";

PublicFiles files_of(const std::string& scene, const PublicSource& source, const Files& names,
                     const std::string& from) {
  std::vector<PublicFile> files;
  for (const auto& name : names)
    files.push_back(*std::find_if(std::begin(known), std::end(known),
                                  [&](const PublicFile& file) { return file.path == name; }));
  return PublicFiles(scene, source, files, from);
}

template <class List>
auto find(const List& list, const std::string& scene) {
  return std::find_if(std::begin(list), std::end(list), [&](const auto& each) {
    return scene == std::string(prefix) + std::string(each.name);
  });
}

}  // namespace

bool is_public_scene(std::string_view scene) { return scene.starts_with(prefix); }

bool is_public_box_scene(const std::string& scene) {
  return find(box_scenes, scene) != std::end(box_scenes);
}

std::vector<PublicSceneName> public_scenes() {
  std::vector<PublicSceneName> names;
  for (const auto& each : scenes())
    names.push_back({std::string(prefix) + std::string(each.name), std::string(each.description)});
  for (const auto& each : box_scenes)
    names.push_back({std::string(prefix) + std::string(each.name),
                     "Scalable-CCD: boxes of swept edges, for `bvlab boxes`"});
  return names;
}

void require_public_scene(const std::string& scene) {
  if (find(scenes(), scene) != scenes().end() || is_public_box_scene(scene)) return;
  throw Unusable("no scene '" + scene +
                 "'; available: " + joined(public_scenes(), &PublicSceneName::name));
}

PublicMotion public_motion(const std::string& scene, const std::string& from,
                           const MotionRequest& request) {
  require_public_scene(scene);
  const auto found = find(scenes(), scene);
  if (found == scenes().end()) throw Unusable(scene, "is of boxes, not of meshes");
  if (request.frames > std::size_t{1} << 31) throw Unusable("frames: more than 2^31");
  return found->motion(files_of(scene, found->source, found->files, from), found->files, request);
}

Array<float> public_boxes(const std::string& scene, const std::string& from, std::size_t frames) {
  require_public_scene(scene);
  const auto found = find(box_scenes, scene);
  if (found == std::end(box_scenes)) throw Unusable(scene, "is of meshes, not of boxes");
  if (frames > 100000) throw Unusable("frames: more than 100000");
  const Files names{std::string(found->before), std::string(found->after)};
  return swept_edges(files_of(scene, ccd, names, from), names[0], names[1], frames);
}

}  // namespace bvlab
