#include "scenes/motion/crowd_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scenes/motion/external_avatars.h"
#include "scenes/motion/walk.h"
#include "scenes/run/posing.h"
#include "scenes/run/sink.h"

namespace throng {

CrowdMotion::CrowdMotion(const Scene& scene, SimdTarget simd, Workers& workers,
                         std::span<const AgentSpec> external_people)
    : scene_(scene),
      workers_(workers),
      simd_(resolved(simd)),
      kinds_(kinds_of(scene)),
      map_(scene, workers),
      external_count_(static_cast<uint32_t>(external_people.size())),
      spawned_(spawn(scene, map_, external_people)),
      crowd_(map_, spawned_.people, {scene.seed, scene.step_s, scene.steering, simd}, workers) {
  note_external();
}

void CrowdMotion::note_external() {
  const std::vector<AgentSpec>& people = spawned_.people;
  if (std::none_of(people.begin(), people.end(),
                   [&](const AgentSpec& p) { return is_external(p); }))
    return;
  for (const Group& group : scene_.groups)
    if (!group.control_channel.empty())
      spawned_.notes.push_back(fmt::format(
          "group '{}' is controlled through LCM channel {}: the events of this run also depend on "
          "its messages",
          group.name, group.control_channel));
}

void CrowdMotion::place(BodyStates& bodies) {
  for (const AgentSpec& person : std::span(spawned_.people).subspan(external_count_)) {
    const std::shared_ptr<const Model>& body = scene_.groups[person.group].body;
    bodies.types.push_back(kinds_.of_group[person.group]);
    bodies.scales.push_back(static_cast<float>(person.height_m / double{body->height_m}));
    bodies.phases.push_back(static_cast<float>(person.phase));
    bodies.styles.push_back(person.style);
    root_heights_m_.push_back(double{body->root_height_m() * bodies.scales.back()});
  }
  bodies.head_yaws_rad = crowd_.head_yaws_rad();
  blocks_ = blocks_of(bodies.types, external_count_);
}

void CrowdMotion::describe(RunInfo& info) const {
  for (const Group& group : scene_.groups) {
    info.groups.push_back(group.name);
    info.control_channels.push_back(group.control_channel);
  }
  for (const AgentSpec& person : spawned_.people)
    info.group_of_avatar.push_back(static_cast<uint16_t>(person.group));
}

void CrowdMotion::update(const Posing& posing, BodyStates& bodies, std::span<float> speeds_mps) {
  workers_.for_blocks(static_cast<int>(blocks_.size()), [&](int index, int) {
    const BodyBlock& block = blocks_[static_cast<size_t>(index)];
    std::array<WalkInput, WalkBatch::kCapacity> walk;
    const uint32_t end = block.first + block.count;
    if (!scene_.planted_feet) {
      const bool is_moved = is_external(spawned_.people[block.first]);  // all of a block
      for (uint32_t id = block.first; id < end; ++id) {
        const WalkInput one = move_root(id, bodies, speeds_mps[id]);
        if (!one.is_present) continue;
        const double walked_m = is_moved
                                    ? (bodies.roots[id].position_m - one.before.position_m).norm()
                                    : crowd_.displacements_m()[id];
        advance_phase(posing, speeds_mps[id], walked_m, id, bodies);
      }
      return;
    }
    for (uint32_t first = block.first; first < end; first += WalkBatch::kCapacity) {
      const size_t count = std::min<size_t>(WalkBatch::kCapacity, end - first);
      for (size_t i = 0; i < count; ++i) {
        const uint32_t id = first + static_cast<uint32_t>(i);
        walk[i] = move_root(id, bodies, speeds_mps[id]);
      }
      advance_walk(posing, {walk.data(), count}, scene_.step_s, first, simd_, bodies);
    }
  });
}

WalkInput CrowdMotion::move_root(uint32_t id, BodyStates& bodies, float& speed_mps) const {
  RootPose& root = bodies.roots[id];
  const Eigen::Vector2d &position = crowd_.positions_m()[id], &heading = crowd_.headings()[id],
                        &velocity = crowd_.velocities_mps()[id];
  const bool is_present = crowd_.journeys().is_present(id);
  // An agent that has left keeps its root.
  if (!is_present && bodies.gait_mps[id] != kNotEntered)
    return {.before = root, .is_present = false};
  WalkInput walk = {root, static_cast<float>(velocity.dot(heading)), is_present};
  if (!bodies.avoidance.empty()) walk.stride_scale = bodies.avoidance[id].stride_scale;
  // After a jump feet are planted anew, as on entry.
  if ((position - root.position_m.head<2>()).norm() > kMaxExternalSpeed_mps * scene_.step_s)
    bodies.gait_mps[id] = kNotEntered;
  root.position_m = {position.x(), position.y(), root_heights_m_[id - external_count_]};
  root.world_from_root = rotation_to(heading);
  if (!bodies.avoidance.empty())
    root.world_from_root = root.world_from_root * rotation_by(bodies.avoidance[id].hips_rad);
  if (is_present) speed_mps = static_cast<float>(velocity.norm());
  return walk;
}

std::span<const uint8_t> CrowdMotion::present() const {
  if (!crowd_.population().is_open()) return {};
  return crowd_.population().present();
}

void CrowdMotion::add_external(ExternalAvatars& external) const {
  for (uint32_t id = external_count_; id < spawned_.people.size(); ++id) {
    const AgentSpec& person = spawned_.people[id];
    if (!is_external(person)) continue;
    const Eigen::Vector2d& at = person.position_m;
    external.add(
        id, scene_.groups[person.group].body->kinematics,
        {{at.x(), at.y(), root_heights_m_[id - external_count_]}, rotation_to(person.heading)});
  }
}

void CrowdMotion::apply_external(const ExternalAvatars& external) {
  external.apply_external(crowd_);
}

int CrowdMotion::unplaced() const {
  int total = 0;
  for (const int count : spawned_.unplaced) total += count;
  return total;
}

}  // namespace throng
