#include "python/recorder.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "python/arrays.h"

namespace py = pybind11;

namespace throng {
namespace {

void add_stage(const StageCounters& stage, int64_t& updates, int64_t& tests, int64_t& passed) {
  updates = static_cast<int64_t>(stage.updates);
  tests = static_cast<int64_t>(stage.tests);
  passed = static_cast<int64_t>(stage.passed);
}

FrameRow row_of(const Frame& frame) {
  FrameRow row{};
  row.frame = frame.number;
  row.time_s = static_cast<double>(frame.utime_us) * 1e-6;
  row.touching = static_cast<int64_t>(frame.pairs.size());
  row.persisting = static_cast<int64_t>(frame.persisting);
  for (const PairEvent& event : frame.events)
    ++(event.kind == EventKind::kBegin ? row.begins : row.ends);
  const CullingCounters& c = *frame.counters;
  add_stage(c.body_sphere, row.body_sphere_updates, row.body_sphere_tests, row.body_sphere_passed);
  add_stage(c.body_box, row.body_box_updates, row.body_box_tests, row.body_box_passed);
  add_stage(c.part_box, row.part_box_updates, row.part_box_tests, row.part_box_passed);
  add_stage(c.part_volume, row.part_volume_updates, row.part_volume_tests, row.part_volume_passed);
  add_stage(c.triangles, row.triangles_updates, row.triangles_tests, row.triangles_passed);
  row.posed_bodies = static_cast<int64_t>(c.posed_bodies);
  row.cull_ms = (c.wall_ns - c.events_ns) * 1e-6;
  for (const double stage_ns : frame.times->stage_ns) row.frame_ms += stage_ns * 1e-6;
  return row;
}

}  // namespace

RunFacts facts_of(const RunInfo& run) {
  RunFacts facts{.scene = run.scene->name,
                 .seed = run.scene->seed,
                 .run_id = run.run_id,
                 .step_s = run.step_s,
                 .groups = run.groups};
  for (const auto& model : run.models) {
    facts.models.push_back(model->name);
    facts.is_person.push_back(model->is_person);
    facts.part_names.emplace_back();
    for (const Part& part : model->parts) facts.part_names.back().push_back(part.name);
  }
  for (const Obstacle& obstacle : run.scene->obstacles) facts.obstacles.push_back(obstacle.name);
  facts.people.reserve(run.model_of_avatar.size());
  for (size_t i = 0; i < run.model_of_avatar.size(); ++i)
    facts.people.push_back({static_cast<uint32_t>(i),
                            run.group_of_avatar.empty() ? uint16_t{0} : run.group_of_avatar[i],
                            run.model_of_avatar[i], run.scale_of_avatar[i],
                            run.scale_of_avatar[i] * run.models[run.model_of_avatar[i]]->height_m});
  return facts;
}

int64_t position_interval(const Scene& scene, double step_s, std::optional<double> fps) {
  const double recorded = scene.recorded ? scene.recorded->recording->facts().fps : 0;
  const double rate = fps.value_or(recorded > 0 ? recorded : 10);
  return std::max<int64_t>(1, std::llround(1 / (rate * step_s)));
}

float heading_of(const RootPose& root) {
  const Eigen::Quaternionf& q = root.world_from_root;
  return std::atan2(2 * (q.w() * q.z() + q.x() * q.y()), 1 - 2 * (q.y() * q.y() + q.z() * q.z()));
}

PositionRow position_row(int64_t frame, double time_s, uint32_t id, const RootPose& root,
                         float speed_mps) {
  return {frame,
          time_s,
          id,
          root.position_m.x(),
          root.position_m.y(),
          root.position_m.z(),
          heading_of(root),
          speed_mps};
}

void RunRecorder::begin(const RunInfo& run) {
  facts = facts_of(run);
  every_ = position_interval(*run.scene, run.step_s, fps_);
}

void RunRecorder::frame(const RunInfo&, const Frame& frame) {
  for (const PairEvent& event : frame.events) events.push_back(event_row(frame.number, event));
  frames.push_back(row_of(frame));
  add_proximity(frame.number, frame.proximity_pairs, proximity);
  add_proximity(frame.number, frame.closest_parts, closest_parts);
  add_contact_points(frame.number, frame.contact_points, contact_points);
  if (!stores_positions_ || frame.number % every_ != 0) return;
  const double time_s = static_cast<double>(frame.utime_us) * 1e-6;
  for (size_t i = 0; i < frame.roots.size(); ++i)
    if (frame.present.empty() || frame.present[i] != 0)
      positions.push_back(position_row(frame.number, time_s, static_cast<uint32_t>(i),
                                       frame.roots[i], frame.speeds_mps[i]));
}

void RunRecorder::end(const RunInfo&, const RunEnd& end) {
  for (const PairEvent& event : end.events) events.push_back(event_row(end.frames, event));
  end_frame = end.frames;
}

std::string hash_text(uint64_t hash) { return fmt::format("{:016x}", hash); }

py::dict dict_of(RunFacts facts) {
  py::dict out;
  out["scene"] = facts.scene;
  out["seed"] = facts.seed;
  out["run_id"] = hash_text(facts.run_id);
  out["step_s"] = facts.step_s;
  out["groups"] = facts.groups;
  out["models"] = facts.models;
  out["is_person"] = facts.is_person;
  out["part_names"] = facts.part_names;
  out["obstacles"] = facts.obstacles;
  out["people"] = array_of(std::move(facts.people));
  return out;
}

void add_rows(py::dict& out, RunRecorder& recorder, double step_s) {
  const auto events = std::make_shared<std::vector<EventRow>>(std::move(recorder.events));
  const int64_t end = recorder.end_frame;
  out["events"] = array_over(events);
  out["find_contacts"] = py::cpp_function([events, step_s, end] {
    std::vector<ContactRow> contacts;
    {
      const py::gil_scoped_release others;
      contacts = contacts_of(*events, step_s, end);
    }
    return array_of(std::move(contacts));
  });
  out["trajectories"] = array_of(std::move(recorder.positions));
  out["counters"] = array_of(std::move(recorder.frames));
  out["proximity"] = array_of(std::move(recorder.proximity));
  out["closest_parts"] = array_of(std::move(recorder.closest_parts));
  out["contact_points"] = array_of(std::move(recorder.contact_points));
}

}  // namespace throng
