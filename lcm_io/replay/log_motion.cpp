#include "lcm_io/replay/log_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.h"
#include "base/limits.h"
#include "base/text.h"
#include "crowd/crowd_plan.h"
#include "crowd/navigation/footprints.h"
#include "lcm_io/codec/description.h"
#include "lcm_io/replay/log_states.h"
#include "lcm_io/replay/log_survey.h"
#include "scenes/run/posing.h"

namespace throng {
namespace {

[[noreturn]] void reject(const std::filesystem::path& file, const std::string& expected,
                         const std::string& found) {
  throw InputError(file.string(), expected, found);
}

void require_name(const std::filesystem::path& file, const std::string& what,
                  const std::string& name) {
  if (const std::string defect = defect_of_name(name); !defect.empty())
    reject(file, fmt::format("a name of {}", what), defect);
}

void require_few(const std::filesystem::path& file, const char* what, size_t found, int64_t max) {
  if (static_cast<int64_t>(found) > max)
    reject(file, fmt::format("at most {} {}", max, what), fmt::format("{}", found));
}

/// Throws InputError for descriptions that no scene file could produce.
void require_runnable(const std::filesystem::path& file, const run_description_t& run) {
  require_few(file, "models", run.models.size(), kMaxModels);
  require_few(file, "obstacles", run.obstacles.size(), kMaxObstacles);
  require_few(file, "groups", run.groups.size(), kMaxGroups);
  require_few(file, "people and obstacles", run.model_of_avatar.size() + run.obstacles.size(),
              kMaxBodies);
  require_name(file, "a scene", run.scene);
  for (const std::string& name : run.groups) require_name(file, "a group", name);
  for (const obstacle_t& obstacle : run.obstacles) require_name(file, "an obstacle", obstacle.name);
  for (const model_t& model : run.models) {
    require_name(file, "a model", model.name);
    for (const part_t& part : model.parts) require_name(file, "a part", part.name);
    for (const joint_t& joint : model.joints) require_name(file, "a joint", joint.name);
    if (model.parts.empty()) reject(file, fmt::format("parts of model '{}'", model.name), "none");
  }
}

Polygon to_polygon(const polygon_t& polygon) {
  Polygon out;
  size_t next = 0;
  for (size_t ring = 0; ring < polygon.corners_of_ring.size(); ++ring) {
    Polygon::Ring& corners = ring == 0 ? out.outline : out.holes.emplace_back();
    for (int32_t i = 0; i < polygon.corners_of_ring[ring]; ++i, next += 2)
      corners.emplace_back(&polygon.coordinates_m[next]);
  }
  return out;
}

Mesh to_mesh(const mesh_t& mesh) {
  Mesh out;
  for (size_t i = 0; i + 2 < mesh.coordinates_m.size(); i += 3)
    out.vertices.emplace_back(&mesh.coordinates_m[i]);
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    out.triangles.emplace_back(&mesh.indices[i]);
  return out;
}

Obstacle to_obstacle(const std::filesystem::path& file, const obstacle_t& described) {
  Obstacle out;
  out.name = described.name;
  out.kind = static_cast<Obstacle::Kind>(described.kind);
  out.centre_m = Eigen::Vector3d(described.centre_m);
  out.heading_rad = described.heading_rad;
  out.size_m = Eigen::Vector3d(described.size_m);
  out.mesh = to_mesh(described.mesh);
  float reach_m = 0;
  for (const Eigen::Vector3f& vertex : out.mesh.vertices)
    reach_m = std::max(reach_m, vertex.cwiseAbs().maxCoeff());
  const auto is_within = [](const Eigen::Vector3d& v, double max) {
    return v.cwiseAbs().maxCoeff() <= max;
  };
  if (!is_within(out.centre_m, kMaxCoordinate_m) || !is_within(out.size_m, kMaxReach_m) ||
      !(static_cast<double>(reach_m) <= kMaxReach_m) || footprint_of(out).size() < 3)
    reject(file,
           fmt::format("obstacle '{}' to cover some ground, at most {:g} m wide", out.name,
                       kMaxReach_m),
           "another");
  return out;
}

Scene scene_of(const LogSurvey& survey) {
  const run_description_t& run = survey.description;
  require_runnable(survey.file, run);
  Scene scene;
  scene.name = run.scene;
  scene.file = survey.file;
  scene.seed = static_cast<uint64_t>(run.seed);
  scene.step_s = survey.step_s;
  scene.duration_s = static_cast<double>(survey.steps) * survey.step_s;
  scene.ground = {Eigen::Vector2d(run.ground_min_m), Eigen::Vector2d(run.ground_max_m)};
  const double max_distance_m =
      std::max(scene.ground.min_m.cwiseAbs().maxCoeff(), scene.ground.max_m.cwiseAbs().maxCoeff());
  if (!(max_distance_m <= kMaxCoordinate_m) || !(scene.ground.size_m().minCoeff() > 0))
    reject(survey.file,
           fmt::format("a ground within {:g} km of the origin", kMaxCoordinate_m / 1e3), "another");
  for (const polygon_t& polygon : run.floor) {
    scene.floor.push_back(to_polygon(polygon));
    if (const std::optional<PolygonFault> fault = fault_of(scene.floor.back()))
      reject(survey.file, fault->expected + " in the floor", fault->found);
  }
  for (const obstacle_t& obstacle : run.obstacles)
    scene.obstacles.push_back(to_obstacle(survey.file, obstacle));
  for (size_t id = 0; id < run.model_of_avatar.size(); ++id)
    scene.tallest_m = std::max(
        scene.tallest_m, static_cast<double>(run.scale_of_avatar[id]) *
                             run.models[static_cast<size_t>(run.model_of_avatar[id])].height_m);
  try {
    scene.part_volume = part_volumes_of(run.part_volume, survey.file.string());
  } catch (const InputError&) {  // unknown to this version: culled with defaults
  }
  scene.exact = run.exact != 0;
  scene.planted_feet = false;
  return scene;
}

class LogMotion final : public MotionSource {
 public:
  explicit LogMotion(std::shared_ptr<const LogSurvey> survey);

  const std::vector<std::shared_ptr<const Model>>& models() const override { return models_; }
  void place(BodyStates& bodies) override;
  std::optional<RootSphere> external_rows_sphere(size_t model) const override {
    return spheres_[model];
  }
  void describe(RunInfo& info) const override;
  void step() override;
  void update(const Posing& posing, BodyStates& bodies, std::span<float> speeds_mps) override;
  void archive(Archive& a) override;
  uint64_t content_hash() const override { return survey_->hash; }
  std::span<const uint8_t> present() const override;
  const std::vector<std::string>& notes() const override { return survey_->notes; }

 private:
  /// Copies into vectors of equal length, because rows point into them.
  void show() { shown_ = states_.state(); }
  const run_description_t& run() const { return survey_->description; }
  void require_reach(size_t model) const;

  std::shared_ptr<const LogSurvey> survey_;
  LogStates states_;
  std::vector<std::shared_ptr<const Model>> models_;
  std::vector<std::optional<RootSphere>> spheres_;
  CrowdState shown_;  ///< a copy, because the log is read ahead across a gap
  int64_t step_ = 0;
  int64_t next_shown_ = 0;  ///< the step from which the latest states apply
};

LogMotion::LogMotion(std::shared_ptr<const LogSurvey> survey)
    : survey_(std::move(survey)), states_(survey_->file, survey_->damage) {
  if (!states_.next())
    throw EnvironmentError(survey_->file.string() + ": changed while it was read");
  show();
  for (size_t i = 0; i < run().models.size(); ++i) {
    models_.push_back(states_.run().model(i));
    const std::vector<ColumnSpan>& spans = survey_->spans[i];
    const bool is_seen = std::all_of(spans.begin(), spans.end(),
                                     [](const ColumnSpan& span) { return span.low <= span.high; });
    spheres_.push_back(is_seen ? std::optional(sphere_around(*models_[i], spans)) : std::nullopt);
    require_reach(i);
  }
}

void LogMotion::require_reach(size_t model) const {
  float scale = 0;
  for (size_t i = 0; i < run().scale_of_avatar.size(); ++i)
    if (static_cast<size_t>(run().model_of_avatar[i]) == model)
      scale = std::max(scale, run().scale_of_avatar[i]);
  const RootSphere sphere =
      spheres_[model] ? *spheres_[model] : any_posture_sphere(*models_[model]);
  const double reach_m =
      static_cast<double>(scale) * static_cast<double>(sphere.centre_m.norm() + sphere.radius_m);
  if (!(reach_m <= kMaxReach_m))
    reject(survey_->file, fmt::format("all parts within {:g} m of their root", kMaxReach_m),
           fmt::format("model '{}', which reaches {:g} m", models_[model]->name, reach_m));
}

void LogMotion::place(BodyStates& bodies) {
  const std::vector<size_t>& offsets = states_.run().posture_offsets();
  for (size_t i = 0; i < run().model_of_avatar.size(); ++i) {
    bodies.types.push_back(static_cast<uint16_t>(run().model_of_avatar[i]));
    bodies.scales.push_back(run().scale_of_avatar[i]);
    bodies.phases.push_back(0);
    bodies.external_rows.push_back(shown_.postures.data() + offsets[i]);
  }
}

void LogMotion::describe(RunInfo& info) const {
  info.groups = run().groups;
  info.control_channels.resize(info.groups.size());  // poses come from the log
  info.group_of_avatar.assign(run().group_of_avatar.begin(), run().group_of_avatar.end());
}

void LogMotion::step() {
  // After the last states the avatars keep their poses.
  if (++step_ >= survey_->steps) return;
  if (step_ > next_shown_) {
    if (!states_.next())
      throw EnvironmentError(survey_->file.string() + ": changed while it was read");
    next_shown_ += steps_between(states_.frames_since(), states_.is_behind_gap(), survey_->every);
  }
  if (step_ == next_shown_) show();
}

void LogMotion::update(const Posing&, BodyStates& bodies, std::span<float> speeds_mps) {
  std::copy(shown_.roots.begin(), shown_.roots.end(), bodies.roots.begin());
  std::transform(shown_.speeds_mps.begin(), shown_.speeds_mps.end(), speeds_mps.begin(),
                 [](float speed) { return std::isfinite(speed) ? speed : 0; });
}

std::span<const uint8_t> LogMotion::present() const {
  if (!survey_->is_open) return {};
  return shown_.present;
}

/// Saves how far the log was read; loading reads it again up to there.
void LogMotion::archive(Archive& a) {
  int64_t step = step_, frame = shown_.frame;
  a(step, frame);
  if (!a.is_reading()) return;
  if (!(step >= 0 && step < survey_->steps))
    a.reject(fmt::format("a step up to {}", survey_->steps), std::to_string(step));
  while (step_ < step) this->step();
  if (frame != shown_.frame)
    a.reject(fmt::format("frame {} of the log", shown_.frame), std::to_string(frame));
}

}  // namespace

LogRun read_log_run(const std::filesystem::path& file) {
  const auto survey = std::make_shared<const LogSurvey>(survey_log(file));
  LogRun out;
  out.scene = scene_of(*survey);
  out.motion = [survey](const Scene&, SimdTarget, Workers&) {
    return std::make_unique<LogMotion>(survey);
  };
  out.people = survey->description.avatar_count;
  out.facts.kind = "throng log";
  out.facts.fps = 1 / survey->step_s;
  out.facts.first_frame = survey->first_frame;
  out.facts.frames = survey->steps;
  out.facts.duration_s = static_cast<double>(survey->steps - 1) * survey->step_s;
  out.facts.samples = survey->states * out.people;
  out.facts.bounds = out.scene.ground;
  out.facts.anomalies = survey->anomalies;
  return out;
}

}  // namespace throng
