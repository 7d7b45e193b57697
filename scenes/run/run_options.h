// RunOptions holds the options of a run beyond its scene. The table run_options() defines command
// line, study options and Python arguments.
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

/// Facts about a recording that its file may lack, as text. Rejected for anything but recordings.
struct RecordingFlags {
  std::optional<double> fps;
  std::string unit;  ///< "cm"; "": not given, as in the following members
  std::string heading_unit;
  std::string columns;        ///< "id=pedID,t=time,x=posX,y=posY"
  std::string separator;      ///< one character, or "tab", "blank", "comma" or "semicolon"
  std::string tracked_point;  ///< "head" or "centre"
  bool strict = false;
};

RecordingOptions recording_options(const std::filesystem::path& file, const RecordingFlags& flags);

/// Options that are not given keep the scene's values.
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
  std::string step;  ///< sampling of a recording: "smooth", "recorded"; "": not given
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
  std::vector<Given> given;

  bool is_given(std::string_view name) const;
  /// Place of an option, for messages: "--part-volume", "part_volume", "study.yaml:3".
  std::string where(std::string_view name) const;
};

/// Expectation of studies in place of an option that only shapes outputs.
inline constexpr const char* kShapesNoResult =
    "an option that shapes a result (what a study finds goes to its table)";

struct RunOption {
  enum class Kind : uint8_t { kFlag, kWhole, kNumber, kWord, kText };

  std::string name;   ///< words joined by "_": "part_volume"
  std::string value;  ///< name of the value in the help: "VOLUME"
  std::string meaning;
  std::string expected;  ///< noun phrase for errors: "expected ..."
  Kind kind = Kind::kText;
  std::vector<std::string> words = {};
  bool is_of_recording = false;  ///< rejected for scenes and logs
  bool is_of_study = false;
  /// Replacement in a study, as noun phrase for errors; "": the scene key of the same name.
  std::string study_has = {};
  /// Parses and stores a value. Throws InputError at `where`.
  std::function<void(const std::string& text, std::string_view where, RunOptions&)> read = {};
};

/// Returns "--part-volume" for "part_volume".
std::string argument_of(std::string_view option);

const std::vector<RunOption>& run_options();

/// Names of the options of command and Python that only shape outputs, without "separation", which
/// is also a scene key.
std::span<const std::string_view> output_option_names();

/// Throws InputError if an option of recordings was given; `found` names the input ("a scene").
void require_no_recording_options(const RunOptions& options, std::string_view found);

/// Applies the options to the scene, with notes on consequent changes. Returns the factor of
/// scale_to(). A recording keeps its length. Throws InputError.
double apply(const RunOptions& options, Scene& scene, std::vector<std::string>& notes);

/// Threads and settings of culling. Throws InputError for options that exclude each other,
/// EnvironmentError for a SIMD target that this machine lacks.
SimulationOptions simulation_options(const RunOptions& options);

/// Number of frames per published state, from `states_hz`. Throws InputError for more states than
/// frames.
double state_every(const RunOptions& options, const Scene& scene);

}  // namespace throng
