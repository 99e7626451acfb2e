// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/replay/scene_page.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "experiments/files/base64.hpp"
#include "experiments/files/totals.hpp"
#include "experiments/files/whole_file.hpp"
#include "experiments/replay/registry.hpp"
#include "experiments/replay/sets_over_time.hpp"
#include "experiments/replay/topology_of.hpp"
#include "traversal/all_pairs.hpp"

namespace bvlab {
namespace {

// Bytes before they become text, which adds a third; the engine that draws takes 0.6 MB.
constexpr std::size_t room_for_poses = 2'000'000, room_for_meshes = 2'000'000,
                      room_for_volumes = 1'000'000, room_for_fronts = 1'500'000;
constexpr std::size_t most_frames = 20'000, most_fronts = 1'000;

template <class T>
std::string text_of(const std::vector<T>& values) {
  return base64_of(std::as_bytes(std::span(values)));
}

std::uint32_t saturated(std::uint64_t count) {
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(count, std::numeric_limits<std::uint32_t>::max()));
}

/// What a page leaves out, in sentences; JSON objects with numbers for keys, since Totals have no
/// arrays.
class Sentences {
 public:
  void add(const std::string& sentence) { all_.set(std::to_string(count_++).c_str(), sentence); }
  const Totals& all() const { return all_; }

 private:
  Totals all_;
  std::size_t count_ = 0;
};

/// The upper levels of a hierarchy, level by level, so that what is left out is at the end.
struct Levels {
  std::vector<std::uint32_t> nodes;     ///< of the hierarchy, in the page's order
  std::vector<std::uint32_t> children;  ///< the first of two, in the page's order; 0 for none
  std::vector<std::uint32_t> place;     ///< of each node; of one left out, that of who is above it
  std::size_t levels = 0;
  bool whole = true;
};

Levels levels_of(const Topology& topology, std::size_t most_nodes) {
  Levels result;
  result.nodes = {0};
  result.place.assign(topology.nodes.size(), 0);
  for (std::size_t begin = 0; begin < result.nodes.size(); ++result.levels) {
    const std::size_t end = result.nodes.size();
    std::vector<std::uint32_t> next;
    for (std::size_t i = begin; i < end; ++i)
      if (const auto& node = topology.nodes[result.nodes[i]]; node.count == 0)
        next.push_back(node.first), next.push_back(node.first + 1);
    result.whole = end + next.size() <= most_nodes;
    for (std::size_t i = begin, child = end; i < end; ++i) {
      const bool inner = result.whole && topology.nodes[result.nodes[i]].count == 0;
      result.children.push_back(inner ? static_cast<std::uint32_t>(child) : 0);
      if (inner) child += 2;
    }
    if (result.whole) result.nodes.insert(result.nodes.end(), next.begin(), next.end());
    begin = end;
  }
  for (std::size_t i = 0; i < result.nodes.size(); ++i)
    result.place[result.nodes[i]] = static_cast<std::uint32_t>(i);
  std::vector<std::uint8_t> kept(topology.nodes.size());
  for (const auto node : result.nodes) kept[node] = 1;
  // Children come after their parent.
  for (std::size_t i = 0; i < topology.nodes.size(); ++i)
    if (const auto& node = topology.nodes[i]; node.count == 0)
      for (const auto child : {node.first, node.first + 1})
        if (!kept[child]) result.place[child] = result.place[i];
  return result;
}

class Page {
 public:
  Page(std::span<const TriangleMesh> meshes, const Trace& trace, const Variant& variant)
      : meshes_(meshes.first(std::min(meshes.size(), trace.objects))),
        trace_(trace),
        variant_(variant) {
    for (const auto& mesh : meshes_) origins_.push_back(LocalMesh(mesh).origin());
    const std::size_t bytes = trace.frames * trace.objects * 7 * sizeof(float);
    stride_ = std::max<std::size_t>({1, (bytes + room_for_poses - 1) / room_for_poses,
                                     (trace.frames + most_frames - 1) / most_frames});
    frames_ = (trace.frames + stride_ - 1) / stride_;
    if (stride_ > 1)
      left_out_.add("Of " + std::to_string(trace.frames) + " frames one in " +
                    std::to_string(stride_) + " is shown.");
  }

  /// Of the mesh of a body (LocalMesh): all that is drawn is relative to it, as volumes are.
  const Vec3<double>& mesh_origin(std::size_t body) const {
    return origins_[body % origins_.size()];
  }

  Totals data(const SceneNames& names) {
    Totals page;
    page.set("trace", names.trace)
        .set("volume", variant_.volume)
        .set("strategy", variant_.strategy)
        .set("query", variant_.query)
        .set("build", variant_.build)
        .set("fit", variant_.fit)
        .set("leaf_size", variant_.leaf_size)
        .set("frames", frames_)
        .set("stride", stride_)
        .set("objects", trace_.objects)
        .set("poses", text_of(poses()))
        .set("drawn_as", volume_entry(variant_.volume).drawn_as);
    add_meshes(page, names);
    add_run(page);
    page.set("left_out", left_out_.all());
    return page;
  }

 private:
  /// Relative to the middle of the first frame, so that float is enough; quaternions as given.
  std::vector<float> poses() const {
    std::vector<float> values;
    if (trace_.frames == 0) return values;
    std::vector<Pose> poses(trace_.objects);
    trace_.poses(0, poses);
    const Vec3<double> middle = centre_of(poses, *this);
    for (std::size_t frame = 0; frame < trace_.frames; frame += stride_) {
      trace_.poses(frame, poses);
      const double* v = trace_.values.data() + frame * trace_.objects * 7;
      for (std::size_t i = 0; i < trace_.objects; ++i, v += 7) {
        const Vec3<double> at =
            position_about(middle, poses[i], mesh_origin(i), Vec3<double>::Zero());
        for (int k = 0; k < 7; ++k) values.push_back(static_cast<float>(k < 3 ? at[k] : v[k]));
      }
    }
    return values;
  }

  void add_meshes(Totals& page, const SceneNames& names) {
    const VolumeEntry& volume = volume_entry(variant_.volume);
    const auto hierarchies = volume.hierarchies(meshes_, variant_);
    std::size_t triangles = 0;
    for (const auto& mesh : meshes_) triangles += mesh.triangles.size();
    const std::size_t thinned = triangles * 24 / room_for_meshes + 1;
    if (thinned > 1)
      left_out_.add("Of " + std::to_string(triangles) + " triangles one in " +
                    std::to_string(thinned) + " is drawn.");
    Totals all;
    for (std::size_t m = 0; m < meshes_.size(); ++m) {
      Totals mesh = drawn_mesh(LocalMesh(meshes_[m]).mesh(), thinned);
      mesh.set("name", names.meshes[m]).set("triangle_count", meshes_[m].triangles.size());
      add_volumes(mesh, volume, *hierarchies, m, names.meshes[m]);
      all.set(std::to_string(m).c_str(), mesh);
    }
    page.set("meshes", all);
  }

  /// Only vertices of triangles that are drawn.
  static Totals drawn_mesh(const TriangleMesh& mesh, std::size_t thinned) {
    std::vector<float> vertices;
    std::vector<std::uint32_t> triangles, number(mesh.vertices.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); t += thinned)
      for (const auto v : mesh.triangles[t]) {
        if (number[v] == 0) {
          for (int k = 0; k < 3; ++k) vertices.push_back(static_cast<float>(mesh.vertices[v][k]));
          number[v] = static_cast<std::uint32_t>(vertices.size() / 3);
        }
        triangles.push_back(number[v] - 1);
      }
    Totals result;
    result.set("vertices", text_of(vertices)).set("triangles", text_of(triangles));
    return result;
  }

  void add_volumes(Totals& mesh, const VolumeEntry& volume, const AnyHierarchies& hierarchies,
                   std::size_t m, const std::string& name) {
    const std::uint32_t root = 0;
    const std::size_t numbers = volume.drawn(hierarchies, m, {&root, 1}).size();
    const std::size_t most = room_for_volumes / meshes_.size() / (4 * numbers + 4);
    levels_.push_back(levels_of(topology_of(meshes_[m], variant_), most));
    const Levels& levels = levels_.back();
    if (!levels.whole)
      left_out_.add("Of the hierarchy over " + name + " levels below " +
                    std::to_string(levels.levels - 1) +
                    " are left out; the front is drawn by its nodes above these.");
    mesh.set("children", text_of(levels.children))
        .set("volumes", text_of(volume.drawn(hierarchies, m, levels.nodes)))
        .set("numbers", numbers);
  }

  void add_run(Totals& page) {
    ReplayOptions options;
    options.keep_series = true;
    const ReplayResult result = replay(meshes_, trace_, variant_, options);
    std::vector<std::uint32_t> series;
    for (std::size_t frame = 0; frame < trace_.frames; frame += stride_) {
      const FrameCounts& counts = result.series[frame];
      for (const auto count : {counts.n_u, counts.n_v, counts.n_p, counts.front})
        series.push_back(saturated(count));
    }
    page.set("series", text_of(series));
    const auto touching = touching_sets(result);
    SetsOverTime sets;
    std::map<std::uint32_t, std::size_t> times;
    for (const auto& frame : touching) {
      sets.add(frame);
      for (const auto pair : frame) ++times[pair];
    }
    page.set("touching", text_of(sets.bytes()));
    add_fronts(page, most_touching(times));
  }

  /// The pairs that touch, by their numbers, in each frame that is shown.
  std::vector<std::vector<std::uint32_t>> touching_sets(const ReplayResult& result) const {
    std::vector<std::vector<std::uint32_t>> sets(frames_);
    const std::size_t pairs = trace_.pairs(), n = trace_.objects;
    for (std::size_t f = 0; f < frames_; ++f)
      for (std::size_t p = 0, at = f * stride_ * pairs; p < pairs; ++p, ++at)
        if ((!result.touching.empty() && result.touching[at]) ||
            (!result.distances.empty() && result.distances[at] == 0))
          sets[f].push_back(static_cast<std::uint32_t>(p));
    for (const auto& [frame, i, j, of_i, of_j] : result.contacts)
      if (frame % stride_ == 0)
        sets[frame / stride_].push_back(
            static_cast<std::uint32_t>(std::size_t{i} * (2 * n - i - 1) / 2 + j - i - 1));
    return sets;
  }

  /// Those whose fronts are worth the most to see, and others after them.
  std::vector<std::uint32_t> most_touching(
      const std::map<std::uint32_t, std::size_t>& times) const {
    std::vector<std::pair<std::size_t, std::uint32_t>> order;
    for (const auto& [pair, count] : times) order.push_back({count, pair});
    std::sort(order.begin(), order.end(),
              [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<std::uint32_t> pairs;
    for (const auto& [count, pair] : order) pairs.push_back(pair);
    for (std::uint32_t p = 0; p < trace_.pairs() && pairs.size() < most_fronts; ++p)
      if (!times.contains(p)) pairs.push_back(p);
    if (pairs.size() > most_fronts) pairs.resize(most_fronts);
    return pairs;
  }

  /// Of each pair the nodes that its front stands on: twice a node's number, and one more for the
  /// second body.
  void add_fronts(Totals& page, const std::vector<std::uint32_t>& pairs) {
    const auto objects = all_object_pairs(static_cast<std::uint32_t>(trace_.objects));
    std::map<std::size_t, SetsOverTime> fronts;
    for (const auto pair : pairs) fronts[pair];
    bool kept = false;
    ReplayOptions options;
    options.keep_answers = false;
    options.see_front = [&](std::size_t frame, std::size_t pair,
                            std::span<const NodePair> entries) {
      kept = true;
      const auto front = fronts.find(pair);
      if (frame % stride_ != 0 || front == fronts.end()) return;
      const Levels &a = levels_[objects[pair].i % levels_.size()],
                   &b = levels_[objects[pair].j % levels_.size()];
      std::vector<std::uint32_t> nodes;
      for (const auto& entry : entries)
        nodes.push_back(2 * a.place[entry.a]), nodes.push_back(2 * b.place[entry.b] + 1);
      front->second.add(std::move(nodes));
    };
    replay(meshes_, trace_, variant_, options);
    Totals all;
    std::size_t bytes = 0, written = 0;
    for (const auto pair : pairs) {
      bytes += fronts[pair].bytes().size();
      if (!kept || bytes > room_for_fronts) break;
      all.set(std::to_string(pair).c_str(), text_of(fronts[pair].bytes()));
      ++written;
    }
    if (kept && written < trace_.pairs())
      left_out_.add("Fronts are included for " + std::to_string(written) + " pairs of " +
                    std::to_string(trace_.pairs()) + ": those that touch in most frames.");
    page.set("fronts", all);
  }

  std::span<const TriangleMesh> meshes_;
  std::vector<Vec3<double>> origins_;  // of meshes
  const Trace& trace_;
  const Variant& variant_;
  std::size_t stride_ = 1, frames_ = 0;
  std::vector<Levels> levels_;
  Sentences left_out_;
};

void replace_each(std::string& text, const std::string& before, const std::string& after,
                  const auto& with) {
  for (std::size_t at = 0; (at = text.find(before, at)) != std::string::npos;) {
    const std::size_t name = at + before.size(), end = text.find(after, name);
    const std::string whole = with(text.substr(name, end - name));
    text.replace(at, end + after.size() - at, whole);
    at += whole.size();
  }
}

/// Where the files of the page are: in the source tree, or where experiments/package puts them.
std::filesystem::path page_folder() {
  std::filesystem::path in_source = BVLAB_PAGE_DIRECTORY;
  std::error_code error;
  if (std::filesystem::exists(in_source / "replay.html", error)) return in_source;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  auto installed = program.parent_path() / "../../../share/bvlab/page";
  if (std::filesystem::exists(installed / "replay.html", error)) return installed;
  return in_source;
}

/// A script of the page, or of what npm gave at set-up (set_up_viewers in experiments/setup), which
/// a package has among the page's files. The page says what it lacks where npm gave nothing.
std::string script(const std::filesystem::path& folder, const std::string& file) {
  std::error_code error;
  for (const auto& place : {folder, std::filesystem::path(BVLAB_VIEWERS_DIRECTORY)})
    if (std::filesystem::exists(place / file, error)) return read_whole(place / file);
  return {};
}

}  // namespace

std::string scene_page(std::span<const TriangleMesh> meshes, const Trace& trace,
                       const Variant& variant, const SceneNames& names) {
  const std::filesystem::path folder = page_folder();
  std::string page = read_whole(folder / "replay.html");
  std::string data = Page(meshes, trace, variant).data(names).text();
  // A name must not end the script that it stands in.
  replace_each(data, "<", "", [](const auto&) { return std::string("\\u003c"); });
  replace_each(page, "<script src=\"", "\"></script>", [&](const std::string& file) {
    return "<script>\n" + script(folder, file) + "</script>";
  });
  replace_each(page, "<link rel=\"stylesheet\" href=\"", "\">", [&](const std::string& file) {
    return "<style>\n" + read_whole(folder / file) + "</style>";
  });
  replace_each(page, "<!--data", "-->", [&](const auto&) { return data; });
  return page;
}

}  // namespace bvlab
