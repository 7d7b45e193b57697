// A study: scenes x seeds x parameters, as its YAML file describes it.
// One rule: the file alone says which runs there are and in which order; every complaint names
// file:line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "scenes/file/yaml_tree.h"

namespace throng {

struct StudyScene {
  std::string name;            ///< as the study says it
  std::filesystem::path file;  ///< of the scene
  YamlNode tree;
};

/// A column of the table that the study sets.
struct StudyParameter {
  std::string name;  ///< an option of a run, or the path of a key in a scene: "groups.1.count"
  int line = 0;
  bool is_option = false;
};

/// Parameters that change together: one from a list or a range, or those of a hypercube.
struct ParameterBlock {
  std::vector<StudyParameter> parameters;
  std::vector<std::vector<YamlNode>> rows;  ///< values, one a parameter
};

struct Study {
  std::filesystem::path file;
  std::vector<StudyScene> scenes;
  std::vector<int64_t> seeds;  ///< none: each scene has its own
  YamlNode options;            ///< a map of those that hold for all runs
  std::vector<ParameterBlock> blocks;

  /// A run for each seed of each point of each scene, seeds changing fastest.
  size_t points() const;
  size_t runs() const { return scenes.size() * points() * (seeds.empty() ? 1 : seeds.size()); }
};

/// Each is looked at before the first one begins.
inline constexpr size_t kMaxStudyRuns = 100'000;

/// Paths of scenes are relative to the study's folder. Throws InputError.
Study read_study(const std::filesystem::path& file);

/// A value as a cell of a table: scalars as they stand, the rest in one line of YAML.
std::string text_of(const YamlNode& value);

}  // namespace throng
