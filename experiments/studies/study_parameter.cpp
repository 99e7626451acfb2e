// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/studies/study_parameter.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/files/joined.hpp"
#include "experiments/files/unusable.hpp"

namespace bvlab {
namespace {

using Type = StudyParameter::Type;

/// As it would be written: 1000000, not 1e+06.
std::string plain(double value) {
  const bool is_short = value == std::floor(value) && std::abs(value) < 1e15;
  return is_short ? std::to_string(static_cast<long long>(value)) : text_of(value);
}

/// "1 to 9", "at least 1", or nothing.
std::string range(const NumberBounds& bounds) {
  const NumberBounds any;
  if (bounds.most < any.most) return plain(bounds.least) + " to " + plain(bounds.most);
  return bounds.least > any.least ? "at least " + plain(bounds.least) : "";
}

std::vector<std::string> texts_of(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(plain(value));
  return texts;
}

}  // namespace

double number_of(const std::string& text, const std::string& name, const std::string& file) {
  if (const auto value = number_in<double>(text)) return *value;
  throw Unusable(file, name + " = " + text + ": not a number");
}

std::string StudyParameter::description() const {
  const char* const kinds[] = {"word", "number", "whole number"};
  std::string text = what + ": " + kinds[static_cast<int>(type)] + (is_list ? "s" : "");
  if (type != Type::word && !range(bounds).empty()) text += ", " + range(bounds);
  if (!names.empty()) text += ", of " + joined(names);
  if (takes_files) text += ", or files (.npy)";
  if (!fallback.empty()) text += fallback == names ? " [all]" : " [" + joined(fallback) + "]";
  return text;
}

void StudyParameter::check(const std::vector<std::string>& values, const std::string& file) const {
  const char* const thing = type == Type::word ? "word" : "number";
  if (!is_list && values.size() != 1) throw Unusable(file, name + " must be one " + thing);
  // Lists that are empty unless something is written may be written so.
  if (values.empty() && !fallback.empty())
    throw Unusable(file, name + " needs at least one " + thing);
  for (const auto& text : values) {
    if (type == Type::word) {
      const bool known = names.empty() || (takes_files && text.ends_with(".npy")) ||
                         std::find(names.begin(), names.end(), text) != names.end();
      if (!known) throw Unusable(file, name + ": no '" + text + "'; available: " + joined(names));
      continue;
    }
    const double value = number_of(text, name, file);
    const bool is_whole = value == std::floor(value);
    if (value >= bounds.least && value <= bounds.most && (type == Type::number || is_whole))
      continue;
    const std::string wanted = range(bounds);
    throw Unusable(file, name + " = " + text + ": must be a " +
                             (type == Type::whole ? "whole number" : "number") +
                             (wanted.starts_with("at") || wanted.empty() ? " " : " from ") +
                             wanted);
  }
}

StudyParameter words_parameter(std::string name, std::vector<std::string> fallback,
                               std::string what, std::vector<std::string> names) {
  return {std::move(name), Type::word, true, std::move(fallback), std::move(what), {},
          std::move(names)};
}

StudyParameter numbers_parameter(std::string name, const std::vector<double>& fallback,
                                 NumberBounds bounds, std::string what) {
  return {std::move(name), Type::number, true, texts_of(fallback), std::move(what), bounds};
}

StudyParameter wholes_parameter(std::string name, const std::vector<double>& fallback,
                                NumberBounds bounds, std::string what) {
  return {std::move(name), Type::whole, true, texts_of(fallback), std::move(what), bounds};
}

}  // namespace bvlab
