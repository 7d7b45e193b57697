// Study describes scenes x seeds x parameters, as read from its YAML file.
// Invariant: the file alone determines the runs and their order; errors name file:line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "scenes/file/yaml_tree.h"

namespace throng {

struct StudyScene {
  std::string name;            ///< as written in the study
  std::filesystem::path file;  ///< scene file
  YamlNode tree;
};

/// Column of the table that the study sets.
struct StudyParameter {
  std::string name;  ///< an option of a run, or the path of a scene key: "groups.1.count"
  int line = 0;
  bool is_option = false;
};

/// Parameters that change together: one from a list or a range, or all of a hypercube.
struct ParameterBlock {
  std::vector<StudyParameter> parameters;
  std::vector<std::vector<YamlNode>> rows;  ///< one value per parameter
};

struct Study {
  std::filesystem::path file;
  std::vector<StudyScene> scenes;
  std::vector<int64_t> seeds;  ///< empty: the seed of each scene
  YamlNode options;            ///< map of the options of all runs
  std::vector<ParameterBlock> blocks;

  /// Number of combinations of parameter values.
  size_t points() const;
  /// Number of runs: one per scene, point and seed, seeds changing fastest.
  size_t runs() const { return scenes.size() * points() * (seeds.empty() ? 1 : seeds.size()); }
};

/// Maximum number of runs: all are checked before the first one begins.
inline constexpr size_t kMaxStudyRuns = 100'000;

/// Reads a study. Paths of scenes are relative to the study's folder. Throws InputError.
Study read_study(const std::filesystem::path& file);
/// Reads the text of a study; `file` names it in errors. The study may name `scenes` in place of
/// files.
Study parse_study(const std::string& text, const std::filesystem::path& file,
                  const std::vector<StudyScene>& scenes = {});

/// A value as a cell of a table: scalars unchanged, lists and maps as one line of YAML.
std::string text_of(const YamlNode& value);

}  // namespace throng
