#include "lcm_io/replay/run_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "base/errors.h"
#include "crowd/steering/steering.h"
#include "culling/culler.h"
#include "lcm_io/replay/file_kind.h"
#include "lcm_io/replay/log_world.h"
#include "scenes/file/recorded_scene.h"
#include "scenes/run/run_choices.h"
#include "scenes/separation/separation_rule.h"

namespace throng {
namespace {

/// Options that ask for other people than a file has.
void refuse_other_people(const RunSourceOptions& options, bool has_seed, const char* expected) {
  const std::pair<bool, const char*> asked[] = {{options.avatars.has_value(), "--avatars"},
                                                {options.seed && !has_seed, "--seed"},
                                                {!options.steering.empty(), "--steering"}};
  for (const auto& [is_asked, option] : asked)
    if (is_asked) throw InputError(option, expected, fmt::format("'{}'", options.name));
}

/// A file has an end.
void cut(const RunSourceOptions& options, RunSource& source) {
  if (!options.seconds) return;
  if (*options.seconds > source.scene.duration_s)
    source.notes.push_back(
        fmt::format("{} is over after {:.6g} s", options.name, source.scene.duration_s));
  else
    source.scene.duration_s = *options.seconds;
}

void refuse_recording_options(const RunSourceOptions& options, const std::string& what) {
  require_no_recording_options(options.recording, what);
  if (!options.step.empty()) throw InputError("--step", "a recording", what);
}

RunSource log_source(const RunSourceOptions& options) {
  refuse_recording_options(options, "a log, which says all of this itself");
  refuse_other_people(options, false, "a scene: whoever is in a log is as the log has it");
  LogRun log = read_log_run(options.name);
  RunSource out{std::move(log.scene), std::move(log.world),
                RunSource::Recording{std::move(log.facts), log.people}};
  cut(options, out);
  return out;
}

RunSource::Recording report_of(const Recording& recording) {
  return {recording.facts(), static_cast<int64_t>(recording.people().size())};
}

RunSource recording_source(const RunSourceOptions& options) {
  refuse_other_people(options, true, "a scene: whoever is in a recording goes as recorded");
  RunSource out{recorded_scene(recording_options(options.name, options.recording),
                               options.step == "recorded")};
  if (options.seed) out.scene.seed = *options.seed;
  cut(options, out);
  return out;
}

RunSource scene_source(const RunSourceOptions& options) {
  refuse_recording_options(options, "a scene; in a scene file these are keys of 'recording'");
  require_no_other_kind(options.name);
  RunSource out{load_scene(options.name)};
  RunChoices choices;
  choices.avatars = options.avatars;
  choices.seconds = options.seconds;
  choices.seed = options.seed;
  choices.steering = steering_kind_of(options.steering);
  out.plan_factor = apply(choices, out.scene, out.notes);
  return out;
}

/// Not by what it holds, as a table of other columns: then by its options.
bool is_meant_as_recording(const RunSourceOptions& options) {
  std::error_code error;
  const std::filesystem::path file(options.name);
  return !options.recording.given().empty() && std::filesystem::is_regular_file(file, error) &&
         !known_kind(file) && file.extension() != ".yaml" && file.extension() != ".yml";
}

/// A name that scenes hardly have.
bool is_named_as_recording(const std::string& name) {
  constexpr std::string_view kEndings[] = {".csv", ".txt", ".tsv",  ".dat", ".gz",
                                           ".pp",  ".h5",  ".hdf5", ".traj"};
  const std::string ending = std::filesystem::path(name).extension().string();
  std::error_code error;
  return std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings) &&
         std::filesystem::is_regular_file(name, error) && !known_kind(name);
}

/// Of what is neither, the error says what recordings hold if the name is that of one.
RunSource scene_or_recording(const RunSourceOptions& options) {
  if (!is_named_as_recording(options.name)) return scene_source(options);
  try {
    return scene_source(options);
  } catch (const InputError&) {
    return recording_source(options);
  }
}

/// Names that somebody may have typed wherever they come from.
void require_known(const RunSourceOptions& options) {
  const auto require = [](const char* option, const std::string& name,
                          const std::vector<std::string>& names) {
    if (name.empty() || std::find(names.begin(), names.end(), name) != names.end()) return;
    throw InputError(option, fmt::format("one of {}", fmt::join(names, ", ")),
                     fmt::format("'{}'{}", name, did_you_mean(name, names)));
  };
  if (!options.part_volume.empty()) part_volumes_of(options.part_volume, "--part-volume");
  if (!options.between.empty()) pair_rules_of(options.between, "--between");
  if (!options.parts.empty()) part_rules_of(options.parts, "--parts");
  require("--steering", options.steering, steering_names());
  require("--step", options.step, step_names());
  require("--unit", options.recording.unit, unit_names());
  require("--heading-unit", options.recording.heading_unit, heading_unit_names());
  require("--tracks", options.recording.tracks, tracks_names());
}

}  // namespace

std::vector<std::string> step_names() { return {"smooth", "recorded"}; }

RunSource open_run_source(const RunSourceOptions& options) {
  require_known(options);
  const bool is_recorded = is_recording(options.name) || is_meant_as_recording(options);
  RunSource out = is_log(options.name) ? log_source(options)
                  : is_recorded        ? recording_source(options)
                                       : scene_or_recording(options);
  if (out.scene.recorded) out.recording = report_of(*out.scene.recorded->recording);
  if (!options.part_volume.empty())
    out.scene.part_volume = part_volumes_of(options.part_volume, "--part-volume");
  if (options.exact) out.scene.exact = true;
  if (options.near_m) out.scene.near_m = *options.near_m;
  if (options.person_near_m) out.scene.person_near_m = *options.person_near_m;
  if (options.contact_points) out.scene.contact_points = true;
  if (!options.between.empty()) out.scene.between = pair_rules_of(options.between, "--between");
  if (!options.parts.empty()) out.scene.parts = part_rules_of(options.parts, "--parts");
  out.notes.insert(out.notes.begin(), out.scene.notes.begin(), out.scene.notes.end());
  for (std::string& note : separation_notes(out.scene)) out.notes.push_back(std::move(note));
  return out;
}

}  // namespace throng
