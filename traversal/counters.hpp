// SPDX-License-Identifier: BSD-3-Clause
/// Counters of the terms of T = N_u C_u + N_v C_v + N_p C_p (gottschalk1996obbtree,
/// li1998incremental) and of tests of whole bodies, and a counter that counts nothing and compiles
/// to nothing.
#pragma once

#include <cstdint>

namespace bvlab {

/// Counts each event where it happens.
struct Counting {
  static constexpr bool counts = true;
  std::uint64_t n_b = 0;         ///< pairs of whole bodies tested: by spheres, directions or motion
  std::uint64_t n_u = 0;         ///< volumes posed
  std::uint64_t n_v = 0;         ///< pairs of volumes tested
  std::uint64_t n_p = 0;         ///< pairs of primitives tested
  std::uint64_t considered = 0;  ///< pairs of bodies for which anything at all was tested

  void bodies(std::uint64_t pairs) { n_b += pairs; }
  void posed(std::uint64_t volumes) { n_u += volumes; }
  void tested(std::uint64_t pairs) { n_v += pairs; }
  void primitives(std::uint64_t pairs) { n_p += pairs; }
  /// The tests so far.
  std::uint64_t tests() const { return n_b + n_v + n_p; }
  /// One pair's query is done; `before` is tests() before its first test. For pairs that are
  /// tested together it is the same for all.
  void queried(std::uint64_t before) { considered += tests() != before; }
  /// Adds the counts of another thread.
  void add(const Counting& other) {
    n_b += other.n_b, n_u += other.n_u, n_v += other.n_v, n_p += other.n_p;
    considered += other.considered;
  }
};

/// Compiles to nothing.
struct NotCounting {
  static constexpr bool counts = false;
  static constexpr std::uint64_t n_b = 0, n_u = 0, n_v = 0, n_p = 0, considered = 0;

  void bodies(std::uint64_t) {}
  void posed(std::uint64_t) {}
  void tested(std::uint64_t) {}
  void primitives(std::uint64_t) {}
  static constexpr std::uint64_t tests() { return 0; }
  void queried(std::uint64_t) {}
  template <class Other>
  void add(const Other&) {}
};

}  // namespace bvlab
