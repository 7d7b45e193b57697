// read_log, check, render and the page of a log.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/cores.h"
#include "base/errors.h"
#include "base/limits.h"
#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/log_check.h"
#include "lcm_io/log/log_gaps.h"
#include "lcm_io/log/log_reader.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interrupts.h"
#include "python/recorder.h"
#include "python/run_request.h"
#include "viewer/picture/picture.h"
#include "viewer/replay/replay.h"
#include "viewer/server/page.h"

namespace py = pybind11;
namespace fs = std::filesystem;

namespace throng {
namespace {

/// Rows of the first run of a log. Invalid messages are left out and
/// counted; `throng check` reports them in full.
struct LogArrays {
  RunFacts facts;
  std::vector<EventRow> events;
  std::vector<PositionRow> positions;
  std::vector<FrameRow> frames;
  std::vector<ProximityRow> proximity, closest_parts;
  std::vector<ContactPointRow> contact_points;
  int64_t end_frame = 0;
  bool finished = false;  ///< the log contains the end of the run
  std::string hash;       ///< at the end; "" if the log is cut off
  int64_t left_out = 0;
  /// Missing or altered parts before the end of the log, one sentence each.
  std::vector<std::string> damage;
};

RunFacts facts_of(const run_description_t& run, int64_t run_id) {
  RunFacts facts{.scene = printable(run.scene, 256),
                 .seed = static_cast<uint64_t>(run.seed),
                 .run_id = static_cast<uint64_t>(run_id),
                 .step_s = run.step_s};
  for (const std::string& group : run.groups) facts.groups.push_back(printable(group));
  for (const model_t& model : run.models) {
    facts.models.push_back(printable(model.name));
    facts.is_person.push_back(to_model(model)->is_person);
    facts.part_names.emplace_back();
    for (const part_t& part : model.parts) facts.part_names.back().push_back(printable(part.name));
  }
  for (const obstacle_t& obstacle : run.obstacles)
    facts.obstacles.push_back(printable(obstacle.name));
  for (size_t i = 0; i < run.model_of_avatar.size(); ++i) {
    const auto model = static_cast<uint16_t>(run.model_of_avatar[i]);
    facts.people.push_back(
        {static_cast<uint32_t>(i), static_cast<uint16_t>(run.group_of_avatar[i]), model,
         run.scale_of_avatar[i],
         run.scale_of_avatar[i] * static_cast<float>(run.models[model].height_m)});
  }
  return facts;
}

class LogRecorder {
 public:
  LogRecorder(LogArrays& out, std::optional<double> fps, bool positions)
      : out_(out), fps_(fps), stores_positions_(positions) {}

  void take(std::string_view name, std::span<const uint8_t> bytes) {
    const std::optional<Channel> channel = channel_of(name);
    MessageHeader header;
    if (!channel) return;
    if (!read_header(*channel, bytes, header).empty()) {
      ++out_.left_out;
      return;
    }
    const std::pair id(header.run_id, header.instance);
    if (!id_) id_ = id;
    if (id != *id_) return;
    if (!take(*channel, header, bytes)) ++out_.left_out;
  }

  /// Description of the run; null until the log contains it.
  const run_description_t* run() const { return reader_.run(); }
  int64_t run_id() const { return id_ ? id_->first : 0; }

 private:
  bool take(Channel channel, const MessageHeader& header, std::span<const uint8_t> bytes) {
    switch (channel) {
      case Channel::kEvents:
        return decode(bytes, events_).empty() && store_events();
      case Channel::kRun:
        return reader_.take(name_of(channel), bytes) != RunReader::Update::kRejected;
      case Channel::kStates:
        return store_positions(header, bytes);
      case Channel::kFrameStats:
        return decode(bytes, frame_stats_).empty() && store_frame_stats();
      case Channel::kProximity:
      case Channel::kContactPoints:
        return store_distances(channel, header, bytes);
      case Channel::kEnd:
        return decode(bytes, end_).empty() && store_end();
      default:
        return true;
    }
  }

  bool store_events() {
    const size_t before = out_.events.size();
    for (size_t i = 0; i < events_.a.size(); ++i) {
      const auto a = static_cast<uint32_t>(events_.a[i]), b = static_cast<uint32_t>(events_.b[i]);
      const auto kind = static_cast<uint8_t>(events_.kind[i]),
                 level = static_cast<uint8_t>(events_.level[i]);
      if (a >= b || b > PairKey::kMaxId || kind > 1 || level >= kPairLevels) {
        out_.events.resize(before);
        return false;
      }
      out_.events.push_back({events_.frame, a, b, static_cast<uint8_t>(events_.part_a[i]),
                             static_cast<uint8_t>(events_.part_b[i]), kind, level});
    }
    out_.end_frame = std::max(out_.end_frame, events_.frame);
    return true;
  }

  bool store_positions(const MessageHeader& header, std::span<const uint8_t> bytes) {
    if (!stores_positions_ || (reader_.run() != nullptr && header.frame % every() != 0))
      return true;
    const RunReader::Update update = reader_.take(name_of(Channel::kStates), bytes);
    if (update == RunReader::Update::kState) {
      const CrowdState& crowd = reader_.state();
      for (size_t i = 0; i < crowd.roots.size(); ++i)
        if (crowd.present[i] != 0)
          out_.positions.push_back(
              position_row(crowd.frame, static_cast<double>(crowd.utime_us) * 1e-6,
                           static_cast<uint32_t>(i), crowd.roots[i], crowd.speeds_mps[i]));
    }
    return update != RunReader::Update::kRejected;
  }
  int64_t every() const {
    return fps_ ? std::max<int64_t>(1, std::llround(1 / (*fps_ * reader_.run()->step_s))) : 1;
  }

  bool store_frame_stats() {
    FrameRow row{};
    row.frame = frame_stats_.frame;
    row.time_s = static_cast<double>(frame_stats_.utime) * 1e-6;
    row.touching = frame_stats_.touching;
    row.begins = frame_stats_.begins;
    row.ends = frame_stats_.ends;
    row.persisting = frame_stats_.persisting;
    row.posed_bodies = frame_stats_.posed_bodies;
    row.frame_ms = frame_stats_.frame_ns * 1e-6;
    int64_t* const to[][3] = {
        {&row.body_sphere_updates, &row.body_sphere_tests, &row.body_sphere_passed},
        {&row.body_box_updates, &row.body_box_tests, &row.body_box_passed},
        {&row.part_box_updates, &row.part_box_tests, &row.part_box_passed},
        {&row.part_volume_updates, &row.part_volume_tests, &row.part_volume_passed},
        {&row.triangles_updates, &row.triangles_tests, &row.triangles_passed}};
    static_assert(std::size(to) == kCullingStageCount);
    for (size_t i = 0; i < kCullingStageCount; ++i) {
      *to[i][0] = frame_stats_.updates[i];
      *to[i][1] = frame_stats_.tests[i];
      *to[i][2] = frame_stats_.passed[i];
    }
    out_.frames.push_back(row);
    out_.end_frame = std::max(out_.end_frame, frame_stats_.frame + 1);
    return true;
  }

  /// A frame may consist of several messages; the last of them completes its rows.
  bool store_distances(Channel channel, const MessageHeader& header,
                       std::span<const uint8_t> bytes) {
    const RunReader::Update update = reader_.take(name_of(channel), bytes);
    if (update == RunReader::Update::kProximity) {
      add_proximity(header.frame, reader_.proximity_pairs(), out_.proximity);
      add_proximity(header.frame, reader_.closest_parts(), out_.closest_parts);
    } else if (update == RunReader::Update::kContactPoints) {
      add_contact_points(header.frame, reader_.contact_points(), out_.contact_points);
    }
    return update != RunReader::Update::kRejected;
  }

  bool store_end() {
    out_.finished = true;
    out_.end_frame = end_.frames;
    out_.hash = hash_text(static_cast<uint64_t>(end_.hash));
    return true;
  }

  LogArrays& out_;
  std::optional<double> fps_;
  bool stores_positions_;
  std::optional<std::pair<int64_t, int64_t>> id_;
  RunReader reader_;
  events_t events_{};
  frame_stats_t frame_stats_{};
  end_t end_{};
};

/// Throws InputError if the file is not a log or contains no run. `fps`: see position_interval();
/// without it, all states.
LogArrays read_log(const std::filesystem::path& file, std::optional<double> fps, bool positions,
                   WorkState& state) {
  LogArrays out;
  LogReader log(file);
  LogRecorder recorder(out, fps, positions);
  state.frames = static_cast<int64_t>(log.size());
  LogEvent event;
  LogGaps gaps;
  while (!state.stop && gaps.next(log, event)) {
    recorder.take(event.channel, event.data);
    state.done = static_cast<int64_t>(event.offset + event.bytes);
  }
  if (recorder.run() == nullptr)
    throw InputError(file.string(), "a run's description", gaps.found_no_description());
  out.left_out += gaps.damaged_places();
  out.damage = gaps.describe_damage();
  out.facts = facts_of(*recorder.run(), recorder.run_id());
  return out;
}

py::dict read(const fs::path& file, std::optional<double> fps, bool positions,
              const py::object& progress) {
  if (fps)
    require_number("trajectory_fps", *fps, 0, 1e4, true, "a number of frames per second above 0");
  const auto log = std::make_shared<LogArrays>();
  run_in_thread([log, file, fps,
                 positions](WorkState& state) { *log = read_log(file, fps, positions, state); },
                progress, AbandonPolicy::kStop);
  RunRecorder recorder(fps, positions);
  recorder.events = std::move(log->events);
  recorder.positions = std::move(log->positions);
  recorder.frames = std::move(log->frames);
  recorder.proximity = std::move(log->proximity);
  recorder.closest_parts = std::move(log->closest_parts);
  recorder.contact_points = std::move(log->contact_points);
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
  const auto report = result_from_thread<LogReport>([file] { return check_log(file); });
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
  const PictureOptions options{.width = width,
                               .height = height,
                               .target_m = point_of("target_m", target_m),
                               .eye_m = point_of("eye_m", eye_m)};
  if (options.eye_m && options.eye_m == options.target_m)
    throw InputError("eye_m", "another point than target_m", "the same");
  auto image = result_from_thread<Image>([=] {
    RecordedFrame frame(log, number);
    return CrowdPainter(frame, options, core_count()).paint();
  });
  return array_of(std::move(image.rgb), {image.height, image.width, 3});
}

void write_page(const fs::path& log, const fs::path& html, double limit_mb) {
  result_from_thread<int>([=] {
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
