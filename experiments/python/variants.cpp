// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/python/variants.hpp"

#include "experiments/commands/require_threads.hpp"
#include "experiments/files/unusable.hpp"
#include "experiments/replay/configurations.hpp"

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
  variant.volume = words.volume;
  variant.strategy = words.strategy;
  // What is not said is what the kernel is compiled for.
  set_kernel(variant, words.kernel);
  if (words.fan_out) variant.fan_out = *words.fan_out;
  if (words.frame) variant.frame = *words.frame;
  variant.build = words.build;
  variant.leaf_size = words.leaf_size;
  variant.fit = words.fit;
  if (words.configuration) {
    const Variant standard = default_variant();
    for (const auto& [name, is_set] :
         {std::pair("volume", words.volume != standard.volume),
          std::pair("strategy", words.strategy != standard.strategy),
          std::pair("fan_out", words.fan_out.has_value()),
          std::pair("frame", words.frame.has_value()),
          std::pair("kernel", words.kernel != standard.kernel),
          std::pair("build", words.build != standard.build),
          std::pair("leaf_size", words.leaf_size != standard.leaf_size),
          std::pair("fit", words.fit != standard.fit)})
      if (is_set) refuse_beside_configuration(name);
    variant = configured(variant, *words.configuration);
  }
  check(variant);
  return variant;
}

}  // namespace bvlab
