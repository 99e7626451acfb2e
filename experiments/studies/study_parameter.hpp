// SPDX-License-Identifier: BSD-3-Clause
/// Parameters of studies. Each kind of study has a table of them: the one source of defaults and
/// refusals, and of what `bvlab list study-parameters` prints.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "experiments/files/numbers.hpp"

namespace bvlab {

struct StudyParameter {
  enum class Type { word, number, whole };

  /// Of numbers.
  struct Bounds {
    double least = std::numeric_limits<double>::lowest();
    double most = std::numeric_limits<double>::max();
  };

  std::string name;
  Type type;
  bool is_list;                       ///< or one value
  std::vector<std::string> fallback;  ///< where none was written
  std::string what;
  Bounds bounds{};
  /// The words there are; where the list is empty, whoever uses a word checks it.
  std::vector<std::string> names{};
  bool takes_files = false;  ///< besides them, .npy

  /// What it is, between which bounds, and its default.
  std::string description() const;

  /// Throws Unusable, in one line that begins with the file, for values that it cannot have.
  void check(const std::vector<std::string>& values, const std::string& file) const;
};

using StudyParameters = std::vector<StudyParameter>;

/// A list of words or of numbers.
StudyParameter words_parameter(std::string name, std::vector<std::string> fallback,
                               std::string what, std::vector<std::string> names = {});
using NumberBounds = StudyParameter::Bounds;
StudyParameter numbers_parameter(std::string name, const std::vector<double>& fallback,
                                 NumberBounds bounds, std::string what);
StudyParameter wholes_parameter(std::string name, const std::vector<double>& fallback,
                                NumberBounds bounds, std::string what);

/// The same, of one value.
inline StudyParameter one(StudyParameter parameter) {
  parameter.is_list = false;
  return parameter;
}

inline constexpr NumberBounds seeds{1, 1e9};

/// The number that the text is. Throws Unusable, with the file and the name, where it is none.
double number_of(const std::string& text, const std::string& name, const std::string& file);

}  // namespace bvlab
