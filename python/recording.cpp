// throng.Recording and throng.compare().
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>

#include "analysis/measures/comparison.h"
#include "base/errors.h"
#include "base/figure.h"
#include "base/limits.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interrupts.h"
#include "python/run_request.h"
#include "recordings/recording_summary.h"
#include "scenes/run/runner.h"

namespace py = pybind11;
namespace fs = std::filesystem;

namespace throng {
namespace {

struct SampleRow {
  int64_t id;
  double time_s, x_m, y_m;
  float z_m, heading_rad;
};

struct RecordedRow {
  int64_t id, samples;
  double first_s, last_s, height_m;
};

using RecordingPtr = std::shared_ptr<Recording>;

RecordingPtr opened(const py::dict& dict) {
  const RunRequest request = request_of(dict);
  const RecordingOptions options = recording_options(request.source, request.options.recording);
  return std::const_pointer_cast<Recording>(result_from_thread<std::shared_ptr<const Recording>>(
      [options] { return read_recording(options); }));
}

py::array people(const Recording& recording) {
  std::vector<RecordedRow> rows;
  for (const RecordedPerson& person : recording.people())
    rows.push_back({person.id, person.samples, person.first_s, person.last_s,
                    person.height_m.value_or(std::numeric_limits<double>::quiet_NaN())});
  return array_of(std::move(rows));
}

py::array samples(const RecordingPtr& recording) {
  const auto rows = std::make_shared<std::vector<SampleRow>>();
  run_in_thread(
      [rows, recording](WorkState& state) {
        rows->reserve(static_cast<size_t>(recording->facts().samples));
        std::vector<Sample> track;
        for (size_t person = 0; person < recording->people().size() && !state.stop; ++person) {
          recording->read(person, track);
          for (const Sample& sample : track)
            rows->push_back({recording->people()[person].id, sample.time_s, sample.position_m.x(),
                             sample.position_m.y(), sample.z_m, sample.heading_rad});
        }
      },
      py::none(), AbandonPolicy::kStop);
  return array_over(rows);
}

py::dict facts(const Recording& recording) {
  const RecordingFacts& f = recording.facts();
  py::dict out;
  out["kind"] = f.kind;
  out["tracked_point"] = f.tracked_point == TrackedPoint::kHead ? "head" : "centre";
  out["fps"] = f.fps;
  out["frames"] = f.frames;
  out["duration_s"] = f.duration_s;
  out["samples"] = f.samples;
  out["shift_m"] = py::make_tuple(f.shift_m.x(), f.shift_m.y());
  out["wkt"] = f.wkt;
  py::list anomalies;
  for (const Anomaly& anomaly : f.anomalies)
    anomalies.append(py::make_tuple(anomaly.what, anomaly.count, anomaly.first));
  out["anomalies"] = anomalies;
  return out;
}

py::tuple of(const Percentiles& spread) {
  return py::make_tuple(spread.low, spread.median, spread.high);
}

py::dict summary(const RecordingPtr& recording) {
  const auto found =
      result_from_thread<RecordingSummary>([recording] { return summary_of(*recording); });
  py::dict out;
  out["mean_people"] = found.mean_people;
  out["max_people"] = found.max_people;
  out["max_people_at_s"] = found.max_people_at_s;
  out["speed_mps"] = of(found.speed_mps);
  out["density_per_m2"] = of(found.density_per_m2);
  out["height_m"] = of(found.height_m);
  return out;
}

struct Comparison {
  MeasuredRun a, b;
};

struct CompareWork {
  RunRequest a, b;
  std::optional<Passage> line;
  Comparison found;
};

MeasuredRun measured(RunSource source, const CompareWork& work, WorkState& state) {
  SimulationOptions options{.threads = work.a.simulation.threads};
  options.motion = std::move(source.motion);
  Simulation simulation(std::move(source.scene), options);
  CrowdMeasures measures({.line = work.line});
  Sink* const sink = &measures;
  const int64_t before = state.done;
  run(simulation, {&sink, 1}, [&](const Frame& frame) {
    state.done = before + frame.number + 1;
    return !state.stop;
  });
  return {simulation.scene().name, measures.facts(), measures.tables()};
}

void compare_runs(CompareWork& work, WorkState& state) {
  RunSource a = open_source(work.a);
  RunSource b = open_source(work.b);
  const auto frames = [](const Scene& scene) {
    return frame_count(scene.duration_s, scene.step_s);
  };
  state.frames = frames(a.scene) + frames(b.scene);
  work.found.a = measured(std::move(a), work, state);
  if (!state.stop) work.found.b = measured(std::move(b), work, state);
}

Comparison compare(const py::dict& a, const py::dict& b,
                   const std::optional<std::vector<double>>& line, const py::object& progress) {
  const auto work = std::make_shared<CompareWork>();
  work->a = request_of(a);
  work->b = request_of(b);
  if (line) {
    if (line->size() != 4)
      throw InputError("line", "two points: x, y, x, y", fmt::format("{} numbers", line->size()));
    for (const double at_m : *line)
      require_number("line", at_m, -kMaxDescribed, kMaxDescribed, false,
                     fmt::format("two points x, y, x, y of at most {:g} metres", kMaxDescribed));
    const Eigen::Vector2d from((*line)[0], (*line)[1]), to((*line)[2], (*line)[3]);
    if (from == to) throw InputError("line", "two points", "the same point twice");
    work->line = Passage{from, to};
  }
  run_in_thread([work](WorkState& state) { compare_runs(*work, state); }, progress,
                AbandonPolicy::kJoinBriefly);
  return std::move(work->found);
}

py::object or_none(const std::optional<double>& value) {
  return value ? py::object(py::float_(*value)) : py::object(py::none());
}

/// Rows of (at, from, to, which, what, unit, a, b), by measure.
py::dict tables(const Comparison& found) {
  py::dict out;
  for (size_t i = 0; i < found.a.tables.size(); ++i) {
    py::list rows;
    for (const ComparedRow& each : compared_rows(found.a.tables[i], found.b.tables[i]))
      rows.append(py::make_tuple(each.row.at, or_none(each.row.from), or_none(each.row.to),
                                 each.row.which, each.row.what, each.row.unit, each.a, each.b));
    out[py::str(found.a.tables[i].id)] = rows;
  }
  return out;
}

/// Returns (title, SVG) by figure id. Requires gnuplot.
py::dict figures(const std::shared_ptr<Comparison>& found, const fs::path& folder) {
  using Drawn = std::vector<std::tuple<std::string, std::string, std::string>>;
  const auto drawn = std::make_shared<Drawn>();
  run_in_thread(
      [drawn, found, folder](WorkState& state) {
        require_gnuplot();
        for (const Figure& figure : comparison_figures(found->a, found->b)) {
          if (state.stop) return;
          drawn->emplace_back(figure.id, figure.title, draw(figure, folder));
        }
      },
      py::none(), AbandonPolicy::kStop);
  py::dict out;
  for (const auto& [id, title, svg] : *drawn) out[py::str(id)] = py::make_tuple(title, svg);
  return out;
}

py::dict facts_of(const MeasuredRun& run) {
  py::dict out;
  out["name"] = run.name;
  out["people"] = run.facts.people;
  out["seconds"] = run.facts.seconds;
  out["person_s"] = run.facts.person_s;
  return out;
}

}  // namespace

void bind_recording(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(SampleRow, id, time_s, x_m, y_m, z_m, heading_rad);
  PYBIND11_NUMPY_DTYPE(RecordedRow, id, samples, first_s, last_s, height_m);
  py::class_<Recording, RecordingPtr>(module, "Recording")
      .def(py::init(&opened), py::arg("options"))
      .def("people", people)
      .def("samples", samples)
      .def("facts", facts)
      .def("summary", summary);
  py::class_<Comparison, std::shared_ptr<Comparison>>(module, "Comparison")
      .def("tables", tables)
      .def("text", [](const Comparison& found) { return comparison_text(found.a, found.b); })
      .def("figures", figures)
      .def("a", [](const Comparison& found) { return facts_of(found.a); })
      .def("b", [](const Comparison& found) { return facts_of(found.b); });
  module.def("compare", compare, py::arg("a"), py::arg("b"), py::arg("line"), py::arg("progress"));
}

}  // namespace throng
