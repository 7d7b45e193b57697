// throng.study() and throng.export(): tables of many runs, and of logs.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/studies/study_job.h"
#include "base/cores.h"
#include "base/errors.h"
#include "lcm_io/export/csv_export.h"
#include "lcm_io/export/mcap_export.h"
#include "lcm_io/replay/file_kind.h"
#include "python/bindings.h"
#include "python/interrupts.h"
#include "scenes/file/scene_fields.h"

namespace py = pybind11;
namespace fs = std::filesystem;

namespace throng {
namespace {

/// All data of a study. It may outlive the calling function after Ctrl-C.
struct StudyRun {
  std::optional<StudyPlan> plan;
  std::optional<StudyJob> job;
};

struct SceneSource {
  std::string name, file, text;
};

Study study_of(const fs::path& file, const std::optional<std::string>& text,
               const std::vector<SceneSource>& sources) {
  if (!text) return read_study(file);
  std::vector<StudyScene> scenes;
  for (const SceneSource& source : sources)
    scenes.push_back({source.name, source.file, parse_yaml(source.text, source.file)});
  return parse_study(*text, file, scenes);
}

const char* kind_name(StudyMeasure::Kind kind) {
  constexpr const char* kKinds[] = {"integer", "number", "text"};
  return kKinds[static_cast<size_t>(kind)];
}

/// Kinds of the columns of a table; "" for options and parameters, which have any.
std::vector<std::string> kinds_of(const StudyTable& table,
                                  const std::vector<StudyMeasure>& measures) {
  std::vector<std::string> kinds(table.columns.size() - measures.size());
  constexpr const char* kFirst[] = {"integer", "integer", "text", "text", "integer"};
  for (size_t i = 0; i < std::min(kinds.size(), std::size(kFirst)); ++i) kinds[i] = kFirst[i];
  for (const StudyMeasure& measure : measures) kinds.emplace_back(kind_name(measure.kind));
  return kinds;
}

py::dict dict_of(const StudyTable& table, const std::vector<StudyMeasure>& measures) {
  py::dict out;
  out["columns"] = table.columns;
  out["kinds"] = kinds_of(table, measures);
  out["rows"] = table.rows;
  return out;
}

py::dict run_study(const fs::path& file, const std::optional<std::string>& text,
                   const std::vector<std::tuple<std::string, std::string, std::string>>& scenes,
                   const fs::path& out, std::optional<int> threads, const py::object& progress) {
  if (!out.empty()) table_kind(out);
  std::vector<SceneSource> sources;
  for (const auto& [name, scene_file, scene_text] : scenes)
    sources.push_back({name, scene_file, scene_text});
  const auto study = std::make_shared<StudyRun>();
  run_in_thread([study, file, text,
                 sources](WorkState&) { study->plan.emplace(study_of(file, text, sources)); },
                py::none(), AbandonPolicy::kDetach);
  study->job.emplace(*study->plan, StudyShard{}, out);
  const int used = threads.value_or(core_count());
  run_in_thread(
      [study, out, used](WorkState& state) {
        state.frames = static_cast<int64_t>(study->job->left());
        run_job(
            *study->job, used, [&](size_t done) { state.done = static_cast<int64_t>(done); },
            [&] { return !state.stop; });
        if (study->job->is_complete() && !out.empty()) study->job->write();
      },
      progress, out.empty() ? AbandonPolicy::kJoinBriefly : AbandonPolicy::kStop);
  py::dict result;
  result["table"] = dict_of(study->job->table(), study_measures());
  result["times"] = dict_of(study->job->times(), study_times());
  result["notes"] = study->plan->notes();
  return result;
}

/// Whether a file holds a study, not a scene. Throws InputError for invalid YAML.
bool is_study(const fs::path& file) {
  const YamlNode root = parse_yaml(read_text_file(file, kMaxYamlBytes), file.string());
  return std::any_of(root.entries.begin(), root.entries.end(),
                     [](const YamlEntry& entry) { return entry.key == "scenes"; });
}

/// What an export writes; `file` is empty for text that is returned.
struct Export {
  fs::path log, file;
  std::string channel;  ///< empty: an MCAP file
  McapExportOptions mcap;
  std::string text, missing;
};

void export_log(Export& work, WorkState& state) {
  constexpr double kShares = 1000;
  state.frames = static_cast<int64_t>(kShares);
  const auto report = [&](double share) {
    state.done = static_cast<int64_t>(share * kShares);
    return !state.stop;
  };
  ExportedLog log(work.log, [&] { return !state.stop; });
  if (work.channel.empty()) {
    work.missing = export_mcap(log, work.file, work.mcap, report).missing;
    return;
  }
  std::ofstream out;
  if (!work.file.empty()) out.open(work.file, std::ios::binary);
  const auto write = [&](std::string_view text) {
    if (work.file.empty())
      work.text += text;
    else
      out << text;
  };
  work.missing = export_csv(log, work.channel, write, [&] { return report(log.share_read()); });
  out.close();
  if (!work.file.empty() && !out)
    throw EnvironmentError(fmt::format("{}: cannot write", work.file.string()));
}

/// Returns the text of a CSV table unless it is written to a file, and what the log lacks.
py::tuple exported(const fs::path& log, const std::string& channel, const fs::path& file,
                   std::optional<double> poses_hz, const py::object& progress) {
  const auto work = std::make_shared<Export>();
  work->log = log;
  work->file = file;
  work->channel = csv_channel(channel);
  if (!channel.empty() && work->channel.empty())
    throw InputError("channel", "a channel: " + list_of(csv_channels(), " or "),
                     fmt::format("'{}'", channel));
  if (!is_log(log)) throw InputError(log.string(), "a log of a run", "another file, or none");
  std::error_code ignored;
  if (fs::equivalent(log, file, ignored))
    throw InputError(file.string(), "a file other than the input", "the same");
  if (poses_hz) work->mcap.poses_hz = *poses_hz;
  run_in_thread([work](WorkState& state) { export_log(*work, state); }, progress,
                AbandonPolicy::kStop);
  return py::make_tuple(work->text, work->missing);
}

}  // namespace

void bind_study(py::module_& module) {
  module.def("study", run_study, py::arg("file"), py::arg("text"), py::arg("scenes"),
             py::arg("out"), py::arg("threads"), py::arg("progress"));
  module.def("is_study", is_study);
  module.def("export", exported, py::arg("log"), py::arg("channel"), py::arg("file"),
             py::arg("poses_hz"), py::arg("progress"));
  module.def("write_table", [](const fs::path& file, const std::vector<std::string>& columns,
                               const std::vector<std::vector<std::string>>& rows) {
    table_kind(file);
    write_table(file, {columns, rows});
  });
}

}  // namespace throng
