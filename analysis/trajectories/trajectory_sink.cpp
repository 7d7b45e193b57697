#include "analysis/trajectories/trajectory_sink.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/trajectories/walkable_area.h"
#include "base/errors.h"
#include "base/version.h"

namespace throng {
namespace {

std::unique_ptr<TrajectoryWriter> open_trajectory(const std::filesystem::path& file) {
  if (!is_trajectory_name(file))
    throw InputError("--trajectory", "a name that ends in .sqlite or .csv",
                     fmt::format("'{}'", file.string()));
  return file.extension() == ".csv" ? open_csv_trajectory(file) : open_sqlite_trajectory(file);
}

bool has_area(const std::filesystem::path& file) { return file.extension() == ".sqlite"; }

double heading_rad(const Eigen::Quaternionf& turn) {
  return 2 * std::atan2(static_cast<double>(turn.z()), static_cast<double>(turn.w()));
}

double usual_fps(const Scene& scene) {
  const double recorded_fps = scene.recorded ? scene.recorded->recording->facts().fps : 0;
  return recorded_fps > 0 ? recorded_fps : 10;
}

/// "walkers 7"; of those who were recorded the number is the file's.
std::string name_of(const RunInfo& run, size_t id) {
  const std::string& group = run.groups[run.group_of_avatar[id]];
  if (!run.scene->recorded) return fmt::format("{} {}", group, id);
  const std::vector<RecordedPerson>& people = run.scene->recorded->recording->people();
  return fmt::format("{} {}", group, id < people.size() ? people[id].id : static_cast<int64_t>(id));
}

}  // namespace

bool is_trajectory_name(const std::filesystem::path& file) {
  return file.extension() == ".sqlite" || file.extension() == ".csv";
}

void require_trajectory_area(std::span<const std::filesystem::path> files, const Scene& scene,
                             std::optional<int64_t> piece, std::string_view option) {
  if (std::any_of(files.begin(), files.end(), has_area)) trajectory_area(scene, piece, option);
}

TrajectorySink::TrajectorySink(const TrajectoryOptions& options)
    : options_(options), writer_(open_trajectory(options.file)) {}

void TrajectorySink::begin(const RunInfo& run) {
  const Scene& scene = *run.scene;
  every_ = std::max<int64_t>(
      1, std::llround(1 / (options_.fps.value_or(usual_fps(scene)) * run.step_s)));
  TrajectoryHead head;
  head.fps = 1 / (static_cast<double>(every_) * run.step_s);
  head.bounds = scene.ground;
  head.facts = {{"version", std::string(version())},
                {"commit", std::string(commit())},
                {"scene", scene.name},
                {"seed", fmt::format("{}", scene.seed)},
                {"run_id", fmt::format("{:016x}", run.run_id)},
                {"step_s", fmt::format("{}", run.step_s)}};
  if (has_area(options_.file)) {
    TrajectoryArea area = trajectory_area(scene, options_.piece);
    head.wkt = std::move(area.wkt);
    if (area.pieces > 1)
      head.facts.emplace_back("area", fmt::format("{} of {}", area.piece, area.pieces));
  }
  if (scene.recorded) {
    const RecordingFacts& recorded = scene.recorded->recording->facts();
    head.facts.emplace_back("recording", recorded.kind);
    head.facts.emplace_back("shift_x_m", fmt::format("{}", recorded.shift_m.x()));
    head.facts.emplace_back("shift_y_m", fmt::format("{}", recorded.shift_m.y()));
  }
  for (size_t id = 0; id < run.group_of_avatar.size(); ++id)
    head.people.push_back(name_of(run, id));
  writer_->begin(head);
}

void TrajectorySink::frame(const RunInfo&, const Frame& frame) {
  if (frame.number % every_ != 0) return;
  rows_.clear();
  for (uint32_t id = 0; id < frame.roots.size(); ++id) {
    if (!frame.present.empty() && frame.present[id] == 0) continue;
    const RootPose& root = frame.roots[id];
    rows_.push_back({id, root.position_m.x(), root.position_m.y(),
                     heading_rad(root.world_from_root), static_cast<double>(frame.speeds_mps[id])});
  }
  writer_->frame(frames_++, rows_);
  rows_total_ += static_cast<int64_t>(rows_.size());
}

void TrajectorySink::end(const RunInfo&, const RunEnd&) { writer_->end(); }

}  // namespace throng
