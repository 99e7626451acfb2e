// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/totals.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "experiments/files/whole_file.hpp"

namespace bvlab {

struct Totals::Object {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
};

Totals::Totals() : object_(std::make_unique<Object>()) {}
Totals::Totals(Totals&&) noexcept = default;
Totals& Totals::operator=(Totals&&) noexcept = default;
Totals::~Totals() = default;

std::string Totals::text() const {
  // Names of files may be no UTF-8: what is not becomes U+FFFD.
  return object_->json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void Totals::set_object(const char* key, const Totals& value) {
  object_->json[key] = value.object_->json;
}
void Totals::set_null(const char* key) { object_->json[key] = nullptr; }
void Totals::set_number(const char* key, double value) { object_->json[key] = value; }
void Totals::set_whole(const char* key, std::uint64_t value) { object_->json[key] = value; }
void Totals::set_text(const char* key, std::string_view value) { object_->json[key] = value; }

void write_totals(const Totals& totals, const std::string& path) {
  const std::string text = totals.text();
  if (!path.empty())
    write_whole(path, text);
  else
    std::fputs(text.c_str(), stdout);
}

}  // namespace bvlab
