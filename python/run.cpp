// throng.run(): complete runs.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "base/errors.h"
#include "crowd/journeys.h"
#include "python/bindings.h"
#include "python/interrupts.h"
#include "python/recorder.h"
#include "python/run_files.h"
#include "python/run_request.h"
#include "scenes/file/yaml_tree.h"
#include "scenes/run/runner.h"

namespace py = pybind11;

namespace throng {
namespace {

/// All data of a run. It may outlive the calling function after Ctrl-C.
struct RunWork {
  RunRequest request;
  RunSource source;
  std::unique_ptr<Simulation> simulation;
  std::unique_ptr<RunRecorder> recorder;
  std::unique_ptr<RunFiles> files;
  RunSummary summary;
};

void prepare(RunWork& work) {
  RunRequest& request = work.request;
  work.source = open_source(request);
  check_files(request, work.source.scene);
  request.simulation.motion = std::move(work.source.motion);
  work.simulation = std::make_unique<Simulation>(work.source.scene, request.simulation);
  work.recorder = std::make_unique<RunRecorder>(request.trajectory_fps, request.trajectories);
}

void run_to_end(RunWork& work, WorkState& state) {
  Simulation& simulation = *work.simulation;
  work.files = std::make_unique<RunFiles>(work.request, simulation);
  std::vector<Sink*> sinks = work.files->sinks();
  sinks.insert(sinks.begin(), work.recorder.get());
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
  out["stranded"] =
      std::accumulate(summary.strandings.begin(), summary.strandings.end(), 0,
                      [](int sum, const Stranding& stranding) { return sum + stranding.people; });
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
  for (const Stranding& stranding : work->summary.strandings)
    notes.push_back(describe(stranding, work->simulation->scene()));
  out["notes"] = notes;
  out["summary"] = dict_of(work->summary);
  out["hash"] = hash_text(work->summary.hash);
  const SeparationSink* separation = work->files->separation();
  out["separation"] =
      separation != nullptr ? py::object(dict_of(*separation->totals())) : py::none();
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
