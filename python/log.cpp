// What a log says: read_log, check, render, the page.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <memory>

#include "base/errors.h"
#include "base/limits.h"
#include "lcm_io/log/log_check.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/facts_dict.h"
#include "python/interrupts.h"
#include "python/log_arrays.h"
#include "python/run_request.h"
#include "viewer/picture/picture.h"
#include "viewer/replay/replay.h"
#include "viewer/server/page.h"

namespace py = pybind11;
namespace fs = std::filesystem;

namespace throng {
namespace {

py::dict read(const fs::path& file, std::optional<double> fps, bool places,
              const py::object& progress) {
  if (fps)
    require_number("trajectory_fps", *fps, 0, 1e4, true, "a number of frames a second above 0");
  const auto log = std::make_shared<LogArrays>();
  run_apart(
      [log, file, fps, places](WorkSigns& signs) { *log = read_log(file, fps, places, signs); },
      progress, Unwanted::kStops);
  RunRecorder recorder(fps, places);
  recorder.events = std::move(log->events);
  recorder.places = std::move(log->places);
  recorder.frames = std::move(log->frames);
  recorder.end_frame = log->end_frame;
  const double step_s = log->facts.step_s;
  py::dict out = dict_of(std::move(log->facts));
  py::dict summary;
  summary["frames"] = recorder.frames.size();
  summary["finished"] = log->finished;
  summary["left_out"] = log->left_out;
  summary["damage"] = log->damage;
  out["summary"] = summary;
  out["notes"] = py::list();
  out["hash"] = log->finished ? py::object(py::str(log->hash)) : py::object(py::none());
  add_rows(out, recorder, step_s);
  return out;
}

py::dict check(const fs::path& file) {
  const auto report = result_apart<LogReport>([file] { return check_log(file); });
  py::dict out;
  out["sound"] = report.is_sound();
  out["finished"] = report.finished;
  out["cut_off"] = report.cut_off;
  out["problems"] = report.problems;
  out["problem_count"] = report.problem_count;
  out["messages"] = report.log_events - report.foreign_messages;
  out["foreign_messages"] = report.foreign_messages;
  out["bytes"] = report.bytes;
  out["sound_bytes"] = report.sound_bytes;
  out["begins"] = report.begins;
  out["ends"] = report.ends;
  out["open_pairs"] = report.open_pairs;
  out["frames"] = report.last_frame + 1;
  out["seconds"] = static_cast<double>(report.last_utime_us) * 1e-6;
  out["torn"] = report.torn;
  out["damaged"] = report.damaged;
  out["repaired"] = report.repaired;
  out["coverage"] = describe_coverage(report);
  out["version"] = report.version;
  out["commit"] = report.commit;
  return out;
}

std::optional<Eigen::Vector3f> point_of(const char* name,
                                        const std::optional<std::vector<float>>& xyz) {
  if (!xyz) return {};
  if (xyz->size() != 3)
    throw InputError(name, "three numbers x, y, z in metres", fmt::format("{}", xyz->size()));
  for (const float at_m : *xyz)
    if (!(std::abs(static_cast<double>(at_m)) <= kMaxDescribed))
      throw InputError(
          name, fmt::format("three numbers x, y, z of at most {:g} metres each", kMaxDescribed),
          fmt::format("{:g}", at_m));
  return Eigen::Vector3f((*xyz)[0], (*xyz)[1], (*xyz)[2]);
}

py::array render_frame(const fs::path& log, int64_t number, int width, int height,
                       const std::optional<std::vector<float>>& eye_m,
                       const std::optional<std::vector<float>>& target_m) {
  const PictureOptions options{width, height, point_of("target_m", target_m),
                               point_of("eye_m", eye_m)};
  if (options.eye_m && options.eye_m == options.target_m)
    throw InputError("eye_m", "another point than target_m", "the same");
  auto image = result_apart<Image>([=] {
    RecordedFrame frame(log, number);
    return picture_of(frame, options);
  });
  return array_of(std::move(image.rgb), {image.height, image.width, 3});
}

void write_page(const fs::path& log, const fs::path& html, double limit_mb) {
  result_apart<int>([=] {
    write_replay(log, html, page_html(), limit_mb);
    return 0;
  });
}

}  // namespace

void bind_log(py::module_& module) {
  module.def("read_log", read, py::arg("file"), py::arg("trajectory_fps"), py::arg("trajectories"),
             py::arg("progress"));
  module.def("check", check, py::arg("file"));
  module.def("render", render_frame, py::arg("log"), py::arg("frame"), py::arg("width"),
             py::arg("height"), py::arg("eye_m"), py::arg("target_m"));
  module.def("write_page", write_page, py::arg("log"), py::arg("html"), py::arg("limit_mb"));
}

}  // namespace throng
