#include "scenes/retargeting/recorded_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/portable_math.h"
#include "scenes/motion/walk.h"
#include "scenes/run/posing.h"
#include "scenes/run/sink.h"

namespace throng {
namespace {

/// Limits of stride scales: beyond them feet would be out of reach.
constexpr float kMinStrideScale = 0.65f;
constexpr float kMaxStrideScale = 1.5f;
/// Time constant in seconds with which the gait phase approaches the seen one; a quarter stride.
constexpr float kCatchUp_s = 0.25f;

/// Stride scale that moves the gait phase towards the seen one. Without a correction the phase
/// advances by `nominal` per step.
float stride_scale_to(float seen_phase, float phase, float nominal, double step_s) {
  if (std::isnan(seen_phase) || !(nominal > 0)) return 1;
  const float behind = std::remainder(seen_phase - (phase + nominal), 1.0f);
  const float share = std::min(static_cast<float>(step_s) / kCatchUp_s, 1.0f);
  const float target = nominal + share * behind;
  return target > 0 ? std::clamp(nominal / target, kMinStrideScale, kMaxStrideScale)
                    : kMaxStrideScale;
}

}  // namespace

RecordedMotion::RecordedMotion(const Scene& scene, SimdTarget simd, Workers& workers)
    : scene_(scene),
      workers_(workers),
      simd_(resolved(simd)),
      kinds_(kinds_of(scene)),
      type_(kinds_.of_group.back()),
      root_height_m_(static_cast<double>(kinds_.models[type_]->root_height_m())) {
  find_people();
  note_anomalies();
  if (scene.groups.size() == 1) return;
  others_ = std::make_unique<CrowdMotion>(scene, simd, workers, people_);
  notes_.insert(notes_.end(), others_->notes().begin(), others_->notes().end());
}

/// Draws people like agents of their group, but with recorded heights and start positions.
void RecordedMotion::find_people() {
  const size_t group = scene_.groups.size() - 1;
  const bool has_heights = !scene_.groups[group].height_m && has_people(scene_.groups[group]);
  std::vector<Sample> samples;
  for (size_t id = 0; id < recording().people().size(); ++id) {
    const RecordedPerson& recorded = recording().people()[id];
    AgentSpec person = make_agent(scene_, group, id);
    if (has_heights && recorded.height_m) {
      person.height_m = *recorded.height_m;
      person.radius_m = disc_radius_m(person.height_m);
    }
    person.is_external = true;
    person.entrance = 0;
    if (scene_.groups.size() > 1 && recorded.first_s == 0) {
      recording().read(id, samples);
      person.position_m = samples.front().position_m;
      person.entrance = AgentSpec::kFromTheStart;
    }
    people_.push_back(person);
  }
}

void RecordedMotion::note_anomalies() {
  const Eigen::Vector2d& shift_m = recording().facts().shift_m;
  if (!shift_m.isZero())
    notes_.push_back(fmt::format("{}: coordinates of the file are larger by ({:.0f}, {:.0f}) m",
                                 scene_.recorded->options.file.filename().string(), shift_m.x(),
                                 shift_m.y()));
  for (const Anomaly& anomaly : recording().facts().anomalies)
    notes_.push_back(fmt::format(
        "{}: {}, {} {}", scene_.recorded->options.file.filename().string(), anomaly.what,
        anomaly.count,
        anomaly.count == 1 ? "time: " + anomaly.first : "times, the first: " + anomaly.first));
}

void RecordedMotion::place(BodyStates& bodies) {
  const auto own_m = static_cast<double>(scene_.groups.back().body->height_m);
  for (const AgentSpec& person : people_) {
    bodies.types.push_back(type_);
    bodies.scales.push_back(static_cast<float>(person.height_m / own_m));
    bodies.phases.push_back(static_cast<float>(person.phase));
    bodies.styles.push_back(person.style);
  }
  blocks_ = blocks_of(bodies.types);
  if (others_) others_->place(bodies);
  present_.assign(bodies.types.size(), 0);
  expected_ = present_;
  bodies.next_mps.assign(bodies.types.size(), kUnknownVelocity);
}

void RecordedMotion::describe(RunInfo& info) const {
  if (others_) return others_->describe(info);
  info.groups = {scene_.groups.back().name};
  info.control_channels.resize(1);
  info.group_of_avatar.assign(people_.size(), 0);
}

void RecordedMotion::add_external(ExternalAvatars& external) const {
  if (others_) others_->add_external(external);
}

void RecordedMotion::apply_external(const ExternalAvatars& external) {
  if (others_) others_->apply_external(external);
}

const SteeringCounters& RecordedMotion::steering() const {
  return others_ ? others_->steering() : MotionSource::steering();
}

const PopulationCounters& RecordedMotion::population() const {
  return others_ ? others_->population() : MotionSource::population();
}

std::vector<Stranding> RecordedMotion::strandings() const {
  return others_ ? others_->strandings() : MotionSource::strandings();
}

void RecordedMotion::step() {
  ++frame_;
  if (others_) others_->step();
}

const HeadOffset& RecordedMotion::head_of(const BodyStates& bodies, uint32_t id) const {
  return head_offsets_[static_cast<size_t>(bodies.styles[id])];
}

void RecordedMotion::prepare(const Posing& posing, const BodyStates& bodies) {
  head_offsets_.resize(kGaitStyleCount);
  std::array<bool, kGaitStyleCount> is_there{};
  for (uint32_t id = 0; id < people_.size() && tracks_heads(); ++id) {
    bool& is_made = is_there[static_cast<size_t>(bodies.styles[id])];
    if (is_made) continue;
    head_offsets_[static_cast<size_t>(bodies.styles[id])] =
        HeadOffset(posing.model(type_), posing.gait_of(id));
    is_made = true;
  }
  const auto retarget_person = [&](size_t person) {
    std::vector<Sample> samples;
    recording().read(person, samples);
    const auto id = static_cast<uint32_t>(person);
    return retarget(samples, {recording().facts().tracked_point, &posing.gait_of(id),
                              &head_of(bodies, id), bodies.scales[id]});
  };
  tracks_ = std::make_unique<Tracks>(people_.size(), retarget_person, workers_);
}

void RecordedMotion::archive(Archive& a) {
  a(frame_);
  // The first step of an entering person depends on its presence in the previous frame.
  a(present_, expected_);
  if (others_) others_->archive(a);
}

void RecordedMotion::update(const Posing& posing, BodyStates& bodies, std::span<float> speeds_mps) {
  const double now_s = static_cast<double>(frame_) * scene_.step_s;
  workers_.for_blocks(static_cast<int>(blocks_.size()), [&](int index, int) {
    const BodyBlock& block = blocks_[static_cast<size_t>(index)];
    std::array<WalkInput, WalkBatch::kCapacity> walk;
    const uint32_t end = block.first + block.count;
    for (uint32_t first = block.first; first < end; first += WalkBatch::kCapacity) {
      const size_t count = std::min<size_t>(WalkBatch::kCapacity, end - first);
      for (size_t i = 0; i < count; ++i) {
        const uint32_t id = first + static_cast<uint32_t>(i);
        walk[i] = walk_to(tracks_->at(id, now_s), id, posing, bodies, speeds_mps[id]);
        if (!scene_.planted_feet && walk[i].is_present)
          advance_phase(posing, speeds_mps[id],
                        (bodies.roots[id].position_m - walk[i].before.position_m).norm(), id,
                        bodies);
      }
      if (scene_.planted_feet)
        advance_walk(posing, {walk.data(), count}, scene_.step_s, first, simd_, bodies);
    }
  });
  if (!others_) return;
  others_->update(posing, bodies, speeds_mps);
  std::span<const uint8_t> there = others_->present();
  std::copy(there.begin() + static_cast<ptrdiff_t>(people_.size()), there.end(),
            present_.begin() + static_cast<ptrdiff_t>(people_.size()));
  std::copy(present_.begin() + static_cast<ptrdiff_t>(people_.size()), present_.end(),
            expected_.begin() + static_cast<ptrdiff_t>(people_.size()));
  move_recorded(bodies, speeds_mps);
}

void RecordedMotion::move_recorded(const BodyStates& bodies, std::span<const float> speeds_mps) {
  Crowd& crowd = *others_->crowd();
  for (uint32_t id = 0; id < people_.size(); ++id) {
    crowd.set_present(id, present_[id] != 0);
    if (present_[id] == 0) continue;
    const Eigen::Vector3f ahead = bodies.roots[id].world_from_root * Eigen::Vector3f::UnitX();
    const Eigen::Vector2d heading = ahead.head<2>().cast<double>().normalized();
    crowd.override_motion(id, bodies.roots[id].position_m.head<2>(), heading,
                          static_cast<double>(speeds_mps[id]) * heading);
  }
}

WalkInput RecordedMotion::walk_to(const TrackState& now, uint32_t id, const Posing& posing,
                                  BodyStates& bodies, float& speed_mps) {
  RootPose& root = bodies.roots[id];
  const bool was_there = expected_[id] != 0;
  present_[id] = now.is_present ? 1 : 0;
  expected_[id] = now.is_present || (now.enters_in_s > 0 && !bodies.avoidance.empty()) ? 1 : 0;
  if (expected_[id] == 0) {
    bodies.gait_mps[id] = kNotEntered;
    return {.before = root, .is_present = false};
  }
  bodies.next_mps[id] = now.next_mps;
  float& phase = bodies.phases[id];
  const float scale = bodies.scales[id];
  const float ahead_mps = std::max(now.ahead_mps, 0.0f);
  const float gait_mps = was_there ? bodies.gait_mps[id] : ahead_mps;
  const float stride_m = posing.gait_of(id).stride_length_m(gait_mps, scale);
  const float nominal = ahead_mps * static_cast<float>(scene_.step_s) / stride_m;
  const float seen_phase =
      phase_of(now.phase - ahead_mps * static_cast<float>(now.enters_in_s) / stride_m);
  if (!was_there && !std::isnan(seen_phase)) phase = seen_phase;
  float stride_scale = was_there ? stride_scale_to(seen_phase, phase, nominal, scene_.step_s) : 1;
  if (std::isnan(now.phase) && !bodies.avoidance.empty())
    stride_scale = bodies.avoidance[id].stride_scale;
  const float hips_rad = bodies.avoidance.empty() ? 0 : bodies.avoidance[id].hips_rad;
  const SinCos turn = sin_cos(static_cast<double>(now.heading_rad + hips_rad));
  Eigen::Vector2d at = now.position_m;
  if (tracks_heads()) {
    const float next = was_there ? phase + nominal / stride_scale : phase;
    const Eigen::Vector2d head =
        head_of(bodies, id).offset_m(next - std::floor(next), gait_mps, scale).cast<double>();
    at.x() -= turn.cos * head.x() - turn.sin * head.y();
    at.y() -= turn.sin * head.x() + turn.cos * head.y();
  }
  const RootPose before = root;
  root.position_m = {at.x(), at.y(), static_cast<double>(scale) * root_height_m_};
  root.world_from_root = rotation_to({turn.cos, turn.sin});
  speed_mps = std::abs(now.ahead_mps);
  return {was_there ? before : root, now.ahead_mps, true, stride_scale, false};
}

}  // namespace throng
