// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/python/variants.hpp"

#include "experiments/commands/require_threads.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/configurations.hpp"
#include "experiments/replay/registry.hpp"

namespace bvlab {

void check_threads(int threads) {
  if (threads < 1 || threads > 1024)
    throw Unusable("--threads " + std::to_string(threads) + ": must be 1 to 1024");
  require_threads(static_cast<std::size_t>(threads));
}

Variant variant_from(const VariantWords& words) {
  Variant variant;
  variant.query = words.query;
  variant.precision = words.precision;
  variant.relative_error = words.relative_error;
  if (words.configuration) {
    if (const char* name = words.said()) refuse_beside_configuration(name);
    variant = configured(variant, *words.configuration);
    check(variant);
    return variant;
  }
  variant.volume = words.volume.value_or(variant.volume);
  variant.strategy = words.strategy.value_or(variant.strategy);
  // What is not said is what the kernel is compiled for.
  set_kernel(variant, words.kernel.value_or(variant.kernel));
  variant.fan_out = words.fan_out.value_or(variant.fan_out);
  variant.frame = words.frame.value_or(variant.frame);
  variant.build = words.build.value_or(variant.build);
  variant.leaf_size = words.leaf_size.value_or(variant.leaf_size);
  variant.fit = words.fit.value_or(variant.fit);
  check(variant);
  require_fit(variant);
  return variant;
}

}  // namespace bvlab
