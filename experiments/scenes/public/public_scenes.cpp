// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/scenes/public/public_scenes.hpp"

#include <algorithm>

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

/// What is read, by SHA-256.
constexpr PublicFile known[] = {
    {"resources/3D/alpha_robot.dae",
     "d01ec840996df502ef292e19fd6e7ad8cb8708c47a4b17df05a5afc0923ab89e"},
    {"resources/3D/alpha_env-1.1.dae",
     "773376c08decb1a99b3a972e3080ef959c31d0ea526d26d10878dd4491725797"},
    {"resources/3D/alpha_env-1.2.dae",
     "17d56eee3322d4a5e5535dfefbe6965e824c10385e41e67606addcf6fd935004"},
    {"resources/3D/alpha_env-1.5.dae",
     "503c5715b4fa1384ff9c5433b08873fb7c243426cf5a39e1323a4a7206170ea8"},
    {"resources/3D/alpha-1.1.path",
     "e78b993352fd59b9e3f5733f042e413568299c9558c53053b3c71cf3fc3df966"},
    {"resources/3D/alpha-1.2.path",
     "5d73db7865fe45fa9e8d0bab3e0b3d8e25c06f80c0f643620c4a80114df3a50d"},
    {"resources/3D/alpha-1.5.path",
     "b09b7866d4251ba0d4fbc0f47a5cfd40a50865852dffc9db1282c030100c0fb9"},
    {"resources/3D/Apartment_robot.dae",
     "17102f67916ceaf6ecca18df75e0e00f409b86c4703581be5a45a7c7b6848be7"},
    {"resources/3D/Apartment_env.dae",
     "b1a5f3383cfc462aa1f39d8fe42e9a7f8419d6102f4334cf7a853cab13901216"},
    {"resources/3D/Apartment.path",
     "e44db789b5195d945e189f8d899cc026f9431599d5d2aaecce59279beb121985"},
    {"resources/3D/cubicles_robot.dae",
     "a19708fa2cf3a11f4c997ec680ce08ed7026ea5115b09baa878b59649436d9db"},
    {"resources/3D/cubicles_env.dae",
     "69e110d76e3ed7ad72a90d12dd0387f90f9228f54bf6ea8212f8073fd6f8e8b6"},
    {"resources/3D/cubicles.path",
     "3429f3106c0127f8b3691a18d80316b6768462bafb6b7e2814cb012205b9e5aa"},
    {"resources/3D/Twistycooler_robot.dae",
     "0bbc7f5e694823807bb38c6126c72aeaaf39033007f2f449ee6fc68cbbf8c352"},
    {"resources/3D/Twistycooler_env.dae",
     "3c1fd1f3a7ce5adf60d31e69cf14d93ce5d6c0a77b3bfc7bab46b48a4fb70a3a"},
    {"resources/3D/Twistycooler.path",
     "95163cbc5c88e61000f60c3caa261955da86f9e414786df94ba4631f7ae72475"},
    {"resources/3D/Easy_robot.dae",
     "318dd6b9db1e6e2ad57d0fb0a2d1025c835bdc5e77ccdb0cd787856372ab9fea"},
    {"resources/3D/Easy_env.dae",
     "7049406e8a7c717bd7789291fe9992cb3e7bc4a85658b8a3d1dff7dc0e6b0ee1"},
    {"resources/3D/Easy.path", "b849517fc938c5c7f8d2eac337ced808a17f7f2161ccfc87a4275a71470e6358"},
    {"resources/3D/escape_robot.dae",
     "12ed3073892ee6019f0e452108b7df00129311416f379a48cc223d770c85cb69"},
    {"resources/3D/escape_env.dae",
     "14b70e0eff73669b37995d28ee5d6a43d00a6e11c9476a9f56c7ac055364adc3"},
    {"resources/3D/escape.path",
     "19124bfda492e46d61051c439e4ca10ff085d2b891ca96c2f80554a0d61ce692"},
    {"resources/3D/spirelli_robot.dae",
     "f7f0acae28f8161b0f60dc5f546360d1e429878f491c42166cfcdb2936964be6"},
    {"resources/3D/spirelli_env.dae",
     "1706b663a8e51b98702bb55e221f47e331b8daa70e913b18557168790bb2671a"},
    {"resources/3D/spirelli.path",
     "f0bb34675f855d88974b99ca0d2afee80de4083de552227a928f0bd62a221a7e"},
    {"resources/3D/ring.dae", "316261ca88f550ca58bb7f12a4632562bc5a8b877a777a7c1da874e14776aa04"},
    {"resources/3D/pipedream_ring.path",
     "07b684792d6f1ec336c0042edea908e599857391ecb0c932e91d2ced14698d2c"},
    {"resources/3D/bugtrap_robot.dae",
     "ed08308b87208770172d66a2c00e78e5159fb2250a26bd2534b367371f6654c9"},
    {"resources/3D/bugtrap_env.dae",
     "0a45ecfbcff890447576151e53b6e8ecf8dc74504e4e0b42517a4100881eca30"},
    {"resources/3D/bugtrap.cfg",
     "a4aaf4f2702c1b0ee384e897775c39384e96213b78db7b9943c5c2b792af5daf"},
    {"resources/3D/Abstract_robot.dae",
     "cb56f305164e5daafc28346c8340d17cf5150caac2672c5c05442a88c5f97b67"},
    {"resources/3D/Abstract_env.dae",
     "debf8f8afbdce0fb3d274e4a0da345324d6b0417cfdc83575bb71b62a9469ebd"},
    {"resources/3D/Abstract.cfg",
     "1800757fa4ad141b6a0a25c90e3a58ba6bf85d2b0876787cbd0f2900052143ce"},
    {"demos/falling/torus1.tris",
     "14f6aae2bed10287f31454c1fdde9b9caedc818a8b2b5d2fabfaaed286816adb"},
    {"demos/falling/torus1.path",
     "2db26c4efb7133ab4ca4fd40d89621acc51feb4ee0397e08fa1654a231bbd8d8"},
    {"demos/falling/torus2.tris",
     "25ea64ee8f9310ad51601ff4b4924585eb8b38f010b115b8e4e428074c37cd3e"},
    {"demos/falling/torus2.path",
     "6572bb46409333782440d9168af4d9723c585c0059f223aa0c650c962d345c01"},
    {"test/fcl_resources/rob.obj",
     "09094a16291cca261d60c814fbd63b53d27d2af9a2634b5fa1f1dea669cd762a"},
    {"test/fcl_resources/env.obj",
     "7535dcb8d69f6449a4d116f16a5ecc8377f92549ae23ef85c485471c4bb5d643"},
    {"data/kuka_iiwa/model.urdf",
     "5c13c5b4bb88b5265223e0ec9a7706cbf81e9bb21cc0e18534273755a041788c"},
    {"examples/pybullet/examples/data/block_grasp_log.bin",
     "d9f28cd589e8ff9766fe2bc62401780f2f55a5896f395012c1354a456d4dc845"},
    {"data/kuka_iiwa/meshes/link_0.stl",
     "541e131185c398ba4562f94ddf988ec349cf50b78c07ddef0bce22b55f0292d3"},
    {"data/kuka_iiwa/meshes/link_1.stl",
     "9539f9491e1abf7c01e8abae5eaba878771e4a3ada41e76ebeb39cce922d2818"},
    {"data/kuka_iiwa/meshes/link_2.stl",
     "75d61826aa89de769935eafca2da207d51f5b0e72dbd52758e46ba6835e9206e"},
    {"data/kuka_iiwa/meshes/link_3.stl",
     "88aa914d0396e8ec0b744c98f71264062e5a3d8c5eedcd0f6c124c7c5ce2545b"},
    {"data/kuka_iiwa/meshes/link_4.stl",
     "505815a8ee3175103e748566ad3257e77abd9823055898147493d4d20946faf8"},
    {"data/kuka_iiwa/meshes/link_5.stl",
     "e26c3cbefa46e24ed02cc0dfe86bc7c89e53675623f8fee007d7860a48d2fa80"},
    {"data/kuka_iiwa/meshes/link_6.stl",
     "f29869219bdf92a0bac2004aaab5ec22e645fedfb0fc5d4776b663fab1b22f37"},
    {"data/kuka_iiwa/meshes/link_7.stl",
     "13a2c25ba8a1ae6b6d5d1c13b6f58bb8ce76ce5b61403698ddc9281edc139645"},
    {"cloth-ball/frames/cloth_ball92.ply",
     "00af75d30753654ea4c558d7d5fa81cc88ef7f326e0478a58c8a7aa01f0bb39b"},
    {"cloth-ball/frames/cloth_ball93.ply",
     "f6580730ad7ce66a36bb2a3c49ddd2b9d669e441ac81b7b366b627fd23d15e96"},
    {"armadillo-rollers/frames/326.ply",
     "fbddad4da3fb0c9c3bf13301c0be8abd2703dc6f226a962c84c1287ba1b350dc"},
    {"armadillo-rollers/frames/327.ply",
     "366b9b4231e7edef017dd6f1e24e24513cbca007ad8d51b954725a6404752868"},
    {"n-body-simulation/frames/balls16_18.ply",
     "7bda6634debc94f52b3af1f4fb763cdb1e608c17faceafd10e4af74dc0e95d1e"},
    {"n-body-simulation/frames/balls16_19.ply",
     "9ca09d52639ac65a3a6de9ac052ac660dfd6e8a3b65e255ac0bbe08a0f6738bf"},
    {"rod-twist/frames/3036.ply",
     "edd286b2e462e1c3ac72ae68567e9562561fade108d886282af0b27ef343abe8"},
    {"rod-twist/frames/3037.ply",
     "c2ad5a7ef2452434dccf2d0e4bb8a66f47c2aa7981967a8289f106c615181a6a"},
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
  std::string names;
  for (const auto& each : public_scenes()) names += (names.empty() ? "" : ", ") + each.name;
  throw Unusable("no scene '" + scene + "'; available: " + names);
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
