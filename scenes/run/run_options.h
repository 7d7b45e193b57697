// RunOptions hold what is asked of a run beside its scene; run_options() is the table of them, from
// which the command line, the options of studies and the arguments in Python follow.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recordings/recording.h"
#include "scenes/file/scene.h"
#include "scenes/run/simulation.h"

namespace throng {

/// What is said about a recording in words, where its file does not: the same words wherever one is
/// read. They are for recordings only; anything else refuses them.
struct RecordingFlags {
  std::optional<double> fps;
  std::string unit;           ///< "cm", or "" as everywhere where not given
  std::string heading_unit;   ///< "deg"
  std::string columns;        ///< "id=pedID,t=time,x=posX,y=posY"
  std::string separator;      ///< one character, or "tab", "blank", "comma" or "semicolon"
  std::string tracked_point;  ///< "head" or "centre"
  bool strict = false;
};

RecordingOptions recording_options(const std::filesystem::path& file, const RecordingFlags& flags);

/// What is not given stays as the scene has it.
struct RunOptions {
  std::optional<int> avatars;
  std::optional<double> seconds;
  std::optional<uint64_t> seed;
  std::optional<PartVolumes> part_volume;
  std::optional<SteeringKind> steering;
  bool exact = false;
  std::optional<double> proximity_m, closest_parts_m;
  bool contact_points = false;
  std::optional<PairRules> group_filter, part_filter;
  RecordingFlags recording;
  std::string step;  ///< of a recording: "smooth", "recorded", or "" where not given
  std::optional<int> threads;
  std::optional<double> budget_ms;
  std::optional<uint64_t> budget_tests;
  Strategy strategy = Strategy::kPipeline;
  SimdTarget simd = SimdTarget::kBest;
  std::optional<PairSearch> pair_search;
  std::optional<double> states_hz;
  bool publish_part_poses = false;

  struct Given {
    std::string name, where;
  };
  std::vector<Given> given;  ///< what RunOption::read() has taken

  bool is_given(std::string_view name) const;
  /// Where an option was given, for messages: "--part-volume", "part_volume", "study.yaml:3".
  std::string where(std::string_view name) const;
};

/// What studies say of options that only shape what is written.
inline constexpr const char* kShapesNoResult =
    "an option that shapes a result (what a study finds goes to its table)";

/// One row of the table.
struct RunOption {
  /// The type of the values, where a front end has types.
  enum class Kind : uint8_t { kFlag, kWhole, kNumber, kWord, kText };

  std::string name;   ///< with "_" between its words: "part_volume"
  std::string value;  ///< what help calls the value: "VOLUME"
  std::string meaning;
  std::string expected;  ///< what the value has to be, to follow "expected"
  Kind kind = Kind::kText;
  std::vector<std::string> words = {};  ///< of kWord
  bool is_of_recording = false;         ///< refused for a scene and for a log
  bool is_of_study = false;             ///< a study may set and vary it
  /// What a study has instead, to follow "expected"; "" where it is a key of the scene, too.
  std::string study_has = {};
  /// Reads a value. Throws InputError, which begins with `where`.
  std::function<void(const std::string& text, std::string_view where, RunOptions&)> read = {};
};

/// "--part-volume", as command lines have "part_volume".
std::string argument_of(std::string_view option);

/// In the order of the help.
const std::vector<RunOption>& run_options();

/// What the command and Python take besides these: it shapes what is written or sent, and no
/// result. Without "separation", which is a key of scenes, too.
std::span<const std::string_view> output_option_names();

/// Throws InputError where an option of recordings was given: `found` ("a scene") needs none.
void require_no_recording_options(const RunOptions& options, std::string_view found);

/// Changes the scene; says on `notes` what else had to change with it. Returns how many times
/// longer the plan is, see scale_to(). A recording is not made longer than it is. Throws
/// InputError.
double apply(const RunOptions& options, Scene& scene, std::vector<std::string>& notes);

/// Threads, and how contacts are found. Throws InputError where options exclude each other,
/// EnvironmentError for a SIMD target that this machine lacks.
SimulationOptions simulation_options(const RunOptions& options);

/// How many frames lie between two states, as `states_hz` asks for. Throws InputError for more
/// states than frames.
double state_every(const RunOptions& options, const Scene& scene);

}  // namespace throng
