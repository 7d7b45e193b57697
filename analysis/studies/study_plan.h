// The runs of a study, one by one: which scene, which seed, which values.
// One rule: whoever has a plan knows that every run of it can begin: all scenes were read with all
// values before.
#pragma once

#include <string>
#include <vector>

#include "analysis/studies/study.h"
#include "analysis/studies/study_options.h"
#include "scenes/file/key.h"

namespace throng {

/// A run, ready to begin.
struct PlannedRun {
  Scene scene;
  CullerOptions culler;
  Strategy strategy = Strategy::kPipeline;
  double plan_growth = 1;  ///< factor by which `avatars` enlarged the sides of the plan
  std::vector<std::string> notes;
};

class StudyPlan {
 public:
  /// Reads each scene with each point's values. Throws InputError naming the line of the value that
  /// a scene does not take.
  explicit StudyPlan(Study study);

  size_t runs() const { return study_.runs(); }
  const Study& study() const { return study_; }
  /// What the runs do otherwise than their files say, each once: enlarged plans, for example.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Of all that the study asks for, scenes and models included, wherever they lie: two plans of
  /// the same identity have the same table.
  uint64_t identity() const { return identity_; }

  /// "run", "runs", "study", "scene", "seed", and the parameters.
  std::vector<std::string> columns() const;
  /// Of a run, counted from 0. May be asked from several threads.
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
  std::vector<uint64_t> own_seeds_;  ///< by scene and point, where the study names no seeds
  uint64_t identity_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace throng
