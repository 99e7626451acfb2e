// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/utf8.hpp"

#include <nlohmann/json.hpp>

namespace bvlab {

std::string as_utf8(std::string_view text) {
  using Json = nlohmann::json;
  const std::string quoted = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  return Json::parse(quoted).get<std::string>();
}

}  // namespace bvlab
