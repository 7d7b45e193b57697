// Who is near whom, for bodies that give way: neighbours and walls, and how everybody's body
// follows what it wants to do about them.
// One rule: everybody decides by the places and ways of all as of this frame, and by nothing of
// what others decide in it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "avatars/yielding/footing.h"
#include "avatars/yielding/upper_room.h"
#include "avatars/yielding/yielding.h"
#include "base/files/archive.h"
#include "base/workers.h"
#include "crowd/navigation/walkable.h"
#include "crowd/neighbours/neighbour_grid.h"
#include "scenes/file/scene.h"
#include "scenes/motion/body_blocks.h"
#include "scenes/run/posing.h"

namespace throng {

class YieldingStage {
 public:
  /// Keeps references to posing and workers. `avatars` of the bodies are avatars.
  YieldingStage(const Scene& scene, const Posing& posing, const BodyStates& bodies, size_t avatars,
                SimdTarget simd, Workers& workers);

  /// Once a frame, when roots and gait are where they should be: sets bodies.yields. `present`:
  /// World::expected(). Allocates nothing when warm.
  void step(std::span<const uint8_t> present, BodyStates& bodies);
  /// All that later steps depend on, bodies.yields included.
  void archive(Archive& a, BodyStates& bodies);

 private:
  struct Wall {
    float x = 0, y = 0;  ///< away from it
    float offset_m = 0;  ///< of its line, from the middle of the ground
  };
  /// Who and what is near somebody, as of the latest search.
  struct Around {
    std::array<uint32_t, NeighbourGrid::kMost> people{};  ///< the nearest first
    std::array<Wall, kMostNearWalls> walls{};
    uint8_t people_count = 0, wall_count = 0;
    std::span<const uint32_t> near() const { return {people.data(), people_count}; }
  };
  /// What is wanted of somebody's steps.
  struct Footing {
    float stretch = 1;
    std::array<float, 4> landing_m{};
  };

  void see(const BodyStates& bodies, uint32_t first, uint32_t end);
  void search(std::span<const uint32_t> slots, const BodyStates& bodies);
  void search_all(std::span<const uint8_t> present, const BodyStates& bodies);
  void search_fresh(std::span<const uint8_t> present, const BodyStates& bodies);
  void find_walls(const Eigen::Vector2d& position_m, Around& around) const;
  void check_read(Archive& a, const BodyStates& bodies) const;
  YieldMotion wanted_of(uint32_t id) const;
  bool is_turn_of(uint32_t id) const;
  void fetch(uint32_t id) const;
  void give_way(uint32_t id, BodyStates& bodies);
  Eigen::Vector2f velocity_of(uint32_t id) const { return {seen_[id].vx_mps, seen_[id].vy_mps}; }
  bool has_steps(uint32_t id, const BodyStates& bodies) const;
  Course course_of(uint32_t id, const BodyStates& bodies) const;
  float wanted_stretch(uint32_t id, const BodyStates& bodies) const;
  std::array<float, 4> wanted_landing_m(uint32_t id, const BodyStates& bodies) const;
  void place_feet(uint32_t id, BodyStates& bodies);
  void make_room(std::span<const uint32_t> ids, int worker, BodyStates& bodies);
  Steps steps_of(uint32_t id, const BodyStates& bodies, const Eigen::Vector2f& velocity_mps) const;

  /// For the postures of some of a model, one a worker.
  struct Scratch {
    std::vector<float> rows;
    std::vector<PartPose> poses;
  };
  static constexpr size_t kBatch = 32;

  const Posing& posing_;
  Workers& workers_;
  SimdTarget simd_;
  std::vector<std::optional<UpperRoom>> rooms_;  ///< by model; none: its bodies do not give way
  std::vector<Scratch> scratch_;
  float step_s_;
  int64_t steps_a_search_, steps_a_decision_, steps_a_landing_, steps_a_rhythm_;
  int64_t steps_ = 0;
  Walkable walkable_;
  Eigen::Vector2d middle_m_;
  NeighbourGrid grid_;
  std::vector<BodyBlock> blocks_;
  std::vector<SeenBody> seen_;  ///< by avatar, as all that follows; from the middle of the ground
  std::vector<std::array<float, 4>> landings_m_;  ///< Yield::landing_m of the frame before
  std::vector<Eigen::Vector2f> long_ways_mps_;
  std::vector<Eigen::Vector2d> last_m_;
  std::vector<uint8_t> was_there_;
  std::vector<YieldMotion> motions_, wanted_;
  std::vector<Footing> footings_;  ///< wanted
  std::vector<Around> around_;
  // Of a search: whose, and by slot of the grid.
  std::vector<uint32_t> slots_;
  std::vector<uint32_t> found_;
  std::vector<uint8_t> counts_;
};

}  // namespace throng
