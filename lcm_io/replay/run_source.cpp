#include "lcm_io/replay/run_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "base/errors.h"
#include "lcm_io/replay/file_kind.h"
#include "lcm_io/replay/log_motion.h"
#include "scenes/file/recorded_scene.h"
#include "scenes/separation/separation_rule.h"

namespace throng {
namespace {

void reject_other_people(const std::string& name, const RunOptions& options, bool has_seed,
                         const char* expected) {
  const std::pair<bool, const char*> people_options[] = {
      {options.avatars.has_value(), "avatars"},
      {options.seed && !has_seed, "seed"},
      {options.steering.has_value(), "steering"}};
  for (const auto& [is_enabled, option] : people_options)
    if (is_enabled) throw InputError(options.where(option), expected, fmt::format("'{}'", name));
}

/// Applies all options but those on people; a file has an end.
void apply_to_file(const std::string& name, RunOptions options, RunSource& source) {
  if (options.seconds && *options.seconds > source.scene.duration_s) {
    source.notes.push_back(fmt::format("{} ends after {:.6g} s", name, source.scene.duration_s));
    options.seconds.reset();
  }
  apply(options, source.scene, source.notes);
}

RunSource log_source(const std::string& name, const RunOptions& options) {
  require_no_recording_options(options, "a recording; a log contains these properties");
  reject_other_people(name, options, false, "a scene; a log contains its people");
  LogRun log = read_log_run(name);
  RunSource out{std::move(log.scene), std::move(log.motion),
                RunSource::Recording{std::move(log.facts), log.people}};
  apply_to_file(name, options, out);
  return out;
}

RunSource::Recording report_of(const Recording& recording) {
  return {recording.facts(), static_cast<int64_t>(recording.people().size())};
}

RunSource recording_source(const std::string& name, const RunOptions& options) {
  reject_other_people(name, options, true, "a scene; a recording contains its people");
  RunSource out{
      recorded_scene(recording_options(name, options.recording), options.step == "recorded")};
  apply_to_file(name, options, out);
  return out;
}

template <typename Load>
RunSource scene_source(const RunOptions& options, const Load& load) {
  require_no_recording_options(options, "a scene; in a scene file these are keys of 'recording'");
  RunSource out{load()};
  out.scale_factor = apply(options, out.scene, out.notes);
  return out;
}

RunSource scene_source(const std::string& name, const RunOptions& options) {
  return scene_source(options, [&] {
    require_no_other_kind(name);
    return load_scene(name);
  });
}

/// Decides by options if the content is not recognised, as for a table with other columns.
bool is_meant_as_recording(const std::string& name, const RunOptions& options) {
  const std::vector<RunOption>& all = run_options();
  const auto is_enabled = [&](const RunOption& option) {
    return option.is_of_recording && option.name != "step" && options.is_given(option.name);
  };
  std::error_code error;
  const std::filesystem::path file(name);
  return std::any_of(all.begin(), all.end(), is_enabled) &&
         std::filesystem::is_regular_file(file, error) && !known_kind(file) &&
         file.extension() != ".yaml" && file.extension() != ".yml";
}

bool is_named_as_recording(const std::string& name) {
  constexpr std::string_view kEndings[] = {".csv", ".txt", ".tsv",  ".dat", ".gz",
                                           ".pp",  ".h5",  ".hdf5", ".traj"};
  const std::string ending = std::filesystem::path(name).extension().string();
  std::error_code error;
  return std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings) &&
         std::filesystem::is_regular_file(name, error) && !known_kind(name);
}

/// For a file of neither kind, the error lists recording formats if the name suggests a recording.
RunSource scene_or_recording(const std::string& name, const RunOptions& options) {
  if (!is_named_as_recording(name)) return scene_source(name, options);
  try {
    return scene_source(name, options);
  } catch (const InputError&) {
    return recording_source(name, options);
  }
}

void describe(RunSource& source) {
  if (source.scene.recorded) source.recording = report_of(*source.scene.recorded->recording);
  const std::vector<std::string>& notes = source.scene.notes;
  source.notes.insert(source.notes.begin(), notes.begin(), notes.end());
  for (std::string& note : separation_notes(source.scene)) source.notes.push_back(std::move(note));
}

}  // namespace

RunSource open_run_source(const std::string& name, const RunOptions& options) {
  const bool is_recorded = is_recording(name) || is_meant_as_recording(name, options);
  RunSource out = is_log(name)  ? log_source(name, options)
                  : is_recorded ? recording_source(name, options)
                                : scene_or_recording(name, options);
  describe(out);
  return out;
}

RunSource open_scene_text(const std::string& text, const std::string& name,
                          const RunOptions& options) {
  RunSource out = scene_source(options, [&] { return read_scene_text(text, name); });
  describe(out);
  return out;
}

}  // namespace throng
