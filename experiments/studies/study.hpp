// SPDX-License-Identifier: BSD-3-Clause
/// An experiment that is not a product of replays: a definition with a `kind`, and lists of what to
/// run.
///
///     name = "triangles-error"
///     kind = "triangles"          # see THE list in study.cpp
///     description = "one line"
///     repetitions = 5
///     [parameters]                # see `bvlab list study-parameters`
///     pairs = 50000
///     [[figure]]                  # what plots/draw shows of it: see ../definitions/README.md
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/recorder/record.hpp"
#include "experiments/studies/experiment.hpp"
#include "experiments/studies/study_parameter.hpp"
#include "hierarchies/geometry/triangle_mesh.hpp"

namespace bvlab {

class StudyDefinition {
 public:
  std::string file, text, kind, name;
  unsigned repetitions = 1;

  /// What was written, or the default of a parameter in the table of its kind. Throws Unusable for
  /// values that the table does not allow.
  std::vector<std::string> words(const std::string& key) const;
  std::vector<double> numbers(const std::string& key) const;
  std::vector<std::size_t> wholes(const std::string& key) const;
  std::string word(const std::string& key) const { return words(key).at(0); }
  double number(const std::string& key) const { return numbers(key).at(0); }
  std::size_t whole(const std::string& key) const { return wholes(key).at(0); }

  std::map<std::string, std::vector<std::string>> parameters;  ///< as they were written
  bool has_figures = false;
};

/// 0, 1, ... up to `count`.
inline std::vector<std::size_t> numbers_below(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return numbers;
}

/// What a study has to work with: rows are saved as they are finished, and what a broken run has
/// finished is not done again.
class StudyRecord {
 public:
  StudyRecord(const StudyDefinition& definition, const std::filesystem::path& folder, Row columns,
              const Progress& progress);

  /// Calls measure(part), which adds rows, for each part of which there are none yet. They begin
  /// with key(part), a row or a text.
  template <class Parts, class Key, class Measure>
  void each(const Parts& parts, const Key& key, const Measure& measure) {
    for (std::size_t done = 0; const auto& part : parts) {
      key_ = Row{std::invoke(key, part)};
      if (!table_.has(key_)) measure(part);
      save(++done, std::size(parts));
    }
  }
  /// The same for parts that have a name alone.
  template <class Measure>
  void each(const std::vector<std::string>& names, const Measure& measure) {
    each(names, std::identity(), measure);
  }
  /// Calls measure(k, repetition) for each k below `count` in every repetition, each time in an
  /// order that is drawn anew.
  template <class Measure>
  void interleave(std::size_t count, const Measure& measure) {
    auto order = numbers_below(count);
    for (unsigned repetition = 0; repetition < repetitions_; ++repetition) {
      shuffle(order);
      for (const std::size_t k : order) measure(k, repetition);
    }
  }
  void shuffle(std::vector<std::size_t>& order) {
    std::shuffle(order.begin(), order.end(), random_);
  }
  /// Adds a row of the part that is measured.
  template <class... Fields>
  void add(const Fields&... fields) {
    Row row = key_;
    add_to(row, fields...);
    table_.add(std::move(row));
  }

 private:
  void save(std::size_t done, std::size_t all);

  Table table_;
  std::filesystem::path folder_;
  Progress progress_;
  unsigned repetitions_;
  std::mt19937_64 random_{20260101};
  Row key_;
};

/// The mesh of that name, NAME or NAME:POLYGONS, with as many triangles as `polygons` says. Throws
/// Unusable where the name is of several.
TriangleMesh mesh_of(const StudyDefinition& definition, const std::string& name);

/// The definition in the text if it has a kind (nothing if not: an experiment). Throws Unusable.
std::optional<StudyDefinition> study_from(const std::string& text, const std::string& file);

/// Throws Unusable for unknown kinds, parameters and names.
void check(const StudyDefinition& definition);
/// Throws Unusable where a record of `held` cannot go on as one of the definition: all but figures,
/// description and file is the same.
void check_extends(const StudyDefinition& held, const StudyDefinition& definition);
void run_study(const StudyDefinition& definition, const std::filesystem::path& folder,
               const Progress& progress);

/// One kind of study. `check`, where there is one, refuses what parameters are not together.
struct StudyKind {
  std::string_view name, description;
  StudyParameters (*parameters)();
  void (*check)(const StudyDefinition&);
  Row columns;
  void (*run)(const StudyDefinition&, StudyRecord&);
};

/// THE list of them.
std::span<const StudyKind* const> study_kinds();

namespace studies {

extern const StudyKind boxes;
extern const StudyKind distance;
extern const StudyKind stability;
extern const StudyKind tightness;
extern const StudyKind triangles;
extern const StudyKind worlds;

}  // namespace studies

}  // namespace bvlab
