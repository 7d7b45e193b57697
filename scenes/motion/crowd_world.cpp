#include "scenes/motion/crowd_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scenes/motion/drive.h"
#include "scenes/motion/walk.h"
#include "scenes/run/posing.h"
#include "scenes/run/sink.h"

namespace throng {

CrowdWorld::CrowdWorld(const Scene& scene, SimdTarget simd, Workers& workers,
                       std::span<const Person> led)
    : scene_(scene),
      workers_(workers),
      simd_(resolved(simd)),
      kinds_(kinds_of(scene)),
      ways_(scene, workers),
      led_(static_cast<uint32_t>(led.size())),
      spawned_(spawn(scene, ways_, led)),
      crowd_(ways_, spawned_.people, {scene.seed, scene.step_s, scene.steering, simd}, workers) {
  note_driven();
}

void CrowdWorld::note_driven() {
  const std::vector<Person>& people = spawned_.people;
  if (std::none_of(people.begin(), people.end(), [&](const Person& p) { return is_driven(p); }))
    return;
  for (const Group& group : scene_.groups)
    if (!group.driven.empty())
      spawned_.notes.push_back(fmt::format(
          "group '{}' is driven by what comes on LCM channel {}: the events of this run "
          "depend on that, too",
          group.name, group.driven));
}

void CrowdWorld::place(BodyStates& bodies) {
  for (const Person& person : std::span(spawned_.people).subspan(led_)) {
    const std::shared_ptr<const Model>& body = scene_.groups[person.group].body;
    bodies.types.push_back(kinds_.of_group[person.group]);
    bodies.scales.push_back(static_cast<float>(person.height_m / double{body->height_m}));
    bodies.phases.push_back(static_cast<float>(person.phase));
    bodies.styles.push_back(person.style);
    rises_m_.push_back(double{body->root_above_ground_m() * bodies.scales.back()});
  }
  bodies.looks_rad = crowd_.looks_rad();
  blocks_ = blocks_of(bodies.types, led_);
}

void CrowdWorld::describe(RunInfo& info) const {
  for (const Group& group : scene_.groups) {
    info.groups.push_back(group.name);
    info.drive_channels.push_back(group.driven);
  }
  for (const Person& person : spawned_.people)
    info.group_of_avatar.push_back(static_cast<uint16_t>(person.group));
}

void CrowdWorld::update(const Posing& posing, BodyStates& bodies, std::span<float> speeds_mps) {
  workers_.for_blocks(static_cast<int>(blocks_.size()), [&](int index, int) {
    const BodyBlock& block = blocks_[static_cast<size_t>(index)];
    std::array<WalkNow, WalkChunk::kRoom> walk;
    const uint32_t end = block.first + block.count;
    if (!scene_.planted_feet) {
      for (uint32_t id = block.first; id < end; ++id)
        if (move_root(id, bodies, speeds_mps[id]).is_present)
          glide_on(posing, speeds_mps[id], crowd_.walked_m()[id], id, bodies);
      return;
    }
    for (uint32_t first = block.first; first < end; first += WalkChunk::kRoom) {
      const size_t count = std::min<size_t>(WalkChunk::kRoom, end - first);
      for (size_t i = 0; i < count; ++i) {
        const uint32_t id = first + static_cast<uint32_t>(i);
        walk[i] = move_root(id, bodies, speeds_mps[id]);
      }
      walk_on(posing, {walk.data(), count}, scene_.step_s, first, simd_, bodies);
    }
  });
}

/// The root to where steering has the person.
WalkNow CrowdWorld::move_root(uint32_t id, BodyStates& bodies, float& speed_mps) const {
  RootPose& root = bodies.roots[id];
  const Eigen::Vector2d &position = crowd_.positions_m()[id], &heading = crowd_.headings()[id],
                        &velocity = crowd_.velocities_mps()[id];
  // Whoever has left keeps the last place and posture.
  const bool is_present = crowd_.journeys().is_present(id);
  WalkNow walk = {root, static_cast<float>(velocity.dot(heading)), is_present};
  if (!bodies.yields.empty()) walk.stretch = bodies.yields[id].stretch;
  root.position_m = {position.x(), position.y(), rises_m_[id - led_]};
  root.world_from_root = turned_to(heading);
  if (!bodies.yields.empty())
    root.world_from_root = root.world_from_root * turned_by(bodies.yields[id].hips_rad);
  if (is_present) speed_mps = static_cast<float>(velocity.norm());
  return walk;
}

std::span<const uint8_t> CrowdWorld::present() const {
  if (!crowd_.traffic().is_open()) return {};
  return crowd_.traffic().present();
}

void CrowdWorld::add_driven(DrivenAvatars& driven) const {
  for (uint32_t id = led_; id < spawned_.people.size(); ++id) {
    const Person& person = spawned_.people[id];
    if (!is_driven(person)) continue;
    const Eigen::Vector2d& at = person.position_m;
    driven.add(id, scene_.groups[person.group].body->kinematics,
               {{at.x(), at.y(), rises_m_[id - led_]}, turned_to(person.heading)});
  }
}

void CrowdWorld::lead(const DrivenAvatars& driven) { driven.lead(crowd_); }

int CrowdWorld::unplaced() const {
  int total = 0;
  for (const int count : spawned_.unplaced) total += count;
  return total;
}

}  // namespace throng
