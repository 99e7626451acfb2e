// SPDX-License-Identifier: BSD-3-Clause
/// What pairs of bodies are made of, by variants of which several may have the same trees.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>

#include "experiments/replay/player.hpp"
#include "experiments/replay/replay.hpp"

namespace bvlab {

/// Pairs of bodies under some query; AnyPairs<Query> for those who know which.
class PairsUnderSome {
 public:
  virtual ~PairsUnderSome() = default;
};

/// Object i uses mesh i mod meshes.size(). Meshes must outlive what is made.
class PairsFrom {
 public:
  PairsFrom(std::span<const TriangleMesh> of, std::size_t count, int on_threads)
      : meshes(of), objects(count), threads(on_threads) {}

  const std::span<const TriangleMesh> meshes;
  const std::size_t objects;
  const int threads;

  /// The trees that a variant asks for: made now by `make`, or kept since then.
  template <class Trees, class Make>
  std::shared_ptr<Trees> trees(const Variant& variant, const Make& make) {
    std::shared_ptr<void>& of = kept_[trees_of(variant)];
    if (!of) {
      const auto start = Clock::now();
      of = std::shared_ptr<Trees>(make());
      build_seconds_ += seconds_since(start);
    }
    return std::static_pointer_cast<Trees>(of);
  }
  /// What making trees took.
  double build_seconds() const { return build_seconds_; }

  /// What distinguishes the trees of a variant.
  static std::string trees_of(const Variant& variant) {
    return variant.kernel + ' ' + variant.volume + ' ' + variant.build + ' ' + variant.fit + ' ' +
           std::to_string(variant.leaf_size) + ' ' + std::to_string(variant.fan_out) + ' ' +
           variant.frame;
  }

 private:
  std::map<std::string, std::shared_ptr<void>> kept_;
  double build_seconds_ = 0;
};

/// The pairs of a variant whose names have been checked, none asked yet.
std::unique_ptr<PairsUnderSome> pairs_of(PairsFrom& from, const Variant& variant);

/// A replay with trees that are made once for several; meshes and bodies are those of `from`.
ReplayResult replay(const std::shared_ptr<PairsFrom>& from, const Trace& trace,
                    const Variant& variant, const ReplayOptions& options);

}  // namespace bvlab
