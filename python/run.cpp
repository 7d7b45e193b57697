// throng.run(): complete runs.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "analysis/contacts/contact_sink.h"
#include "analysis/separation/separation_sink.h"
#include "analysis/trace.h"
#include "analysis/trajectories/trajectory_sink.h"
#include "base/errors.h"
#include "lcm_io/codec/encoder.h"
#include "lcm_io/log/log_sink.h"
#include "python/bindings.h"
#include "python/interrupts.h"
#include "python/recorder.h"
#include "python/run_request.h"
#include "scenes/file/yaml_tree.h"
#include "scenes/run/runner.h"
#include "scenes/separation/separation_rule.h"
#include "viewer/replay/replay.h"
#include "viewer/server/page.h"

namespace py = pybind11;
namespace fs = std::filesystem;

namespace throng {
namespace {

/// All data of a run. It may outlive the calling function after Ctrl-C.
struct RunWork {
  RunRequest request;
  RunSource source;
  std::unique_ptr<Simulation> simulation;
  std::unique_ptr<RunRecorder> recorder;
  std::unique_ptr<SeparationSink> separation;
  RunSummary summary;
};

/// Throws InputError if an output would replace an input.
void reject_overwritten_inputs(const RunRequest& request, const Scene& scene) {
  std::vector<fs::path> outputs = request.trajectory;
  outputs.push_back(request.log);
  outputs.push_back(request.html);
  outputs.push_back(request.trace_hash);
  for (const fs::path& output : outputs)
    for (const fs::path& input : {fs::path(request.source), scene.file}) {
      std::error_code error;
      if (!output.empty() && fs::equivalent(output, input, error))
        throw InputError(output.string(), "a file other than the input", "the same");
    }
}

bool writes_files(const RunRequest& request) {
  return !(request.log.empty() && request.html.empty() && request.contacts.empty() &&
           request.separation.empty() && request.trace_hash.empty() && request.trajectory.empty());
}

void prepare(RunWork& work) {
  RunRequest& request = work.request;
  for (const fs::path& file : request.trajectory)
    if (!is_trajectory_name(file))
      throw InputError("trajectory", "a name ending in .sqlite or .csv",
                       fmt::format("'{}'", file.string()));
  work.source = open_source(request);
  reject_overwritten_inputs(request, work.source.scene);
  if (!request.separation.empty()) require_separation(work.source.scene, "separation");
  require_trajectory_area(request.trajectory, work.source.scene, request.trajectory_piece,
                          "trajectory_area");
  request.simulation.motion = std::move(work.source.motion);
  work.simulation = std::make_unique<Simulation>(work.source.scene, request.simulation);
  work.recorder = std::make_unique<RunRecorder>(request.trajectory_fps, request.trajectories);
  state_every(request.options, work.source.scene);
  if (!request.log.empty() || !request.html.empty())
    require_encodable(work.simulation->info(), request.options.publish_part_poses);
}

void run_to_end(RunWork& work, WorkState& state) {
  const RunRequest& request = work.request;
  Simulation& simulation = *work.simulation;
  std::vector<std::unique_ptr<Sink>> files;
  for (const fs::path& file : request.trajectory)
    files.push_back(std::make_unique<TrajectorySink>(
        TrajectoryOptions{file, request.trajectory_fps, request.trajectory_piece}));
  if (!request.html.empty())
    files.push_back(std::make_unique<ReplaySink>(request.html, page_html(), kReplayLimitMb));
  if (!request.contacts.empty())
    files.push_back(
        std::make_unique<ContactSink>(request.contacts, BodyMap::is_known(simulation.scene())));
  if (simulation.scene().separation)
    work.separation =
        std::make_unique<SeparationSink>(request.separation, *simulation.scene().separation);
  if (!request.trace_hash.empty()) files.push_back(std::make_unique<TraceSink>(request.trace_hash));
  if (!request.log.empty()) {
    LogOptions options;
    options.threads = request.simulation.threads;
    options.state_every = state_every(request.options, simulation.scene());
    options.part_poses = request.options.publish_part_poses;
    files.push_back(std::make_unique<LogSink>(request.log, options));
  }
  std::vector<Sink*> sinks{work.recorder.get()};
  for (const auto& file : files) sinks.push_back(file.get());
  if (work.separation) sinks.push_back(work.separation.get());
  state.frames = frame_count(simulation.scene().duration_s, simulation.info().step_s);
  work.summary = run(simulation, sinks, [&](const Frame& frame) {
    state.done = frame.number + 1;
    return !state.stop;
  });
}

py::dict dict_of(const RunSummary& summary) {
  py::dict out;
  out["hash"] = hash_text(summary.hash);
  out["frames"] = summary.frames;
  out["unplaced"] = summary.unplaced;
  out["simulated_s"] = summary.simulated_s;
  out["wall_s"] = summary.wall_s;
  out["begins"] = summary.begins;
  out["ends"] = summary.ends;
  out["persists"] = summary.persists;
  out["pairs_peak"] = summary.pairs_peak;
  out["entered"] = summary.population.entered;
  out["left"] = summary.population.left;
  return out;
}

py::dict dict_of(const SeparationTotals& totals) {
  py::dict regions;
  for (size_t i = 0; i < kBodyRegions; ++i) {
    const RegionTotals& region = totals.regions[i];
    if (!region.is_there) continue;
    py::dict of_region;
    of_region["shortfalls"] = region.shortfalls;
    of_region["shortfall_s"] = region.shortfall_s;
    of_region["max_shortfall_m"] = region.max_shortfall_m;
    of_region["min_distance_lo_m"] = region.min_distance_lo_m;
    of_region["min_distance_hi_m"] = region.min_distance_hi_m;
    regions[py::str(std::string(name_of(static_cast<BodyRegion>(i))))] = of_region;
  }
  py::dict out;
  out["robots"] = totals.robots;
  out["shortfalls"] = totals.shortfalls;
  out["pairs"] = totals.pairs;
  out["undetermined"] = totals.undetermined;
  out["beyond_margin"] = totals.beyond_margin;
  out["regions"] = regions;
  return out;
}

py::dict run_scene(const py::dict& options, const py::object& progress) {
  const auto work = std::make_shared<RunWork>();
  work->request = request_of(options);
  run_in_thread([work](WorkState&) { prepare(*work); }, py::none(), AbandonPolicy::kDetach);
  // Files are worth waiting for until they are complete.
  run_in_thread([work](WorkState& state) { run_to_end(*work, state); }, progress,
                writes_files(work->request) ? AbandonPolicy::kStop : AbandonPolicy::kJoinBriefly);
  py::dict out = throng::dict_of(std::move(work->recorder->facts));
  std::vector<std::string> notes = work->source.notes;
  const std::vector<std::string>& more = work->simulation->notes();
  notes.insert(notes.end(), more.begin(), more.end());
  out["notes"] = notes;
  out["summary"] = dict_of(work->summary);
  out["hash"] = hash_text(work->summary.hash);
  out["separation"] =
      work->separation ? py::object(dict_of(*work->separation->totals())) : py::none();
  add_rows(out, *work->recorder, work->simulation->info().step_s);
  return out;
}

py::list scene_list() {
  py::list out;
  for (const SceneEntry& scene : bundled_scenes())
    out.append(py::make_tuple(scene.name, scene.description));
  return out;
}

/// YAML as Python values; a scalar without quotes is a tuple of its text.
py::object value_of(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return py::none();
    case YamlNode::Kind::kScalar:
      if (node.quoted) return py::str(node.scalar);
      return py::make_tuple(node.scalar);
    case YamlNode::Kind::kList: {
      py::list out;
      for (const YamlNode& item : node.items) out.append(value_of(item));
      return out;
    }
    case YamlNode::Kind::kMap: {
      py::dict out;
      for (const YamlEntry& entry : node.entries) out[py::str(entry.key)] = value_of(entry.value);
      return out;
    }
  }
  return py::none();
}

/// Returns the rows of run_options(), for a test of the Python signatures.
py::list option_list() {
  constexpr const char* kKinds[] = {"flag", "whole", "number", "word", "text"};
  py::list out;
  for (const RunOption& row : run_options()) {
    py::dict option;
    option["name"] = row.name;
    option["kind"] = kKinds[static_cast<size_t>(row.kind)];
    option["expected"] = row.expected;
    option["is_of_study"] = row.is_of_study;
    out.append(option);
  }
  return out;
}

}  // namespace

void bind_run(py::module_& module) {
  module.def("run", run_scene, py::arg("options"), py::arg("progress") = py::none());
  module.def("run_options", option_list);
  module.def("scenes", scene_list);
  module.def("parse_yaml", [](const std::string& text, const std::string& name) {
    return value_of(parse_yaml(text, name));
  });
}

}  // namespace throng
