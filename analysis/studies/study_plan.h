// StudyPlan lists the runs of a study with their scene, seed and values.
// Invariant: every run of a plan can begin, because the constructor has read all scenes with all
// values.
#pragma once

#include <string>
#include <vector>

#include "analysis/studies/study.h"
#include "analysis/studies/study_options.h"
#include "scenes/file/key.h"

namespace throng {

/// A run that is ready to begin.
struct PlannedRun {
  Scene scene;
  CullerOptions culler;
  Strategy strategy = Strategy::kPipeline;
  double plan_growth = 1;  ///< factor by which `avatars` enlarged the sides of the plan
  std::vector<std::string> notes;
};

class StudyPlan {
 public:
  /// Reads each scene with the values of each point. Throws InputError naming the line of the value
  /// that a scene rejects.
  explicit StudyPlan(Study study);

  size_t runs() const { return study_.runs(); }
  const Study& study() const { return study_; }
  /// Notes on deviations from the files, each once; for example enlarged plans.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Hash of everything that the study asks for, including scenes and models but not their paths.
  /// Plans of equal identity have equal tables.
  uint64_t identity() const { return identity_; }

  /// Column names: "run", "runs", "study", "scene", "seed", then the parameters.
  std::vector<std::string> columns() const;
  /// Cells of a run, for columns(). Runs count from 0. Thread-safe.
  std::vector<std::string> cells(size_t run) const;
  PlannedRun planned(size_t run) const;

 private:
  struct RunPosition {
    size_t scene = 0, point = 0, seed = 0;
  };
  RunPosition position_of(size_t run) const;
  std::vector<size_t> rows_of(size_t point) const;
  PlannedRun planned(size_t scene, size_t point, LoadedModels& models) const;
  [[noreturn]] void rethrow_at_value(size_t scene, size_t point);

  Study study_;
  LoadedModels models_;
  std::vector<uint64_t> own_seeds_;  ///< indexed by scene and point, if the study has no seeds
  uint64_t identity_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace throng
