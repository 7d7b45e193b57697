// BodyAvoidanceStage finds each body's neighbours and walls and adapts its posture to them.
// Invariant: decisions depend on the state of the current frame, never on other decisions in it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "avatars/body_avoidance/body_avoidance.h"
#include "avatars/body_avoidance/foot_placement.h"
#include "avatars/body_avoidance/upper_body_bounds.h"
#include "base/files/archive.h"
#include "base/workers.h"
#include "crowd/navigation/walkable.h"
#include "crowd/neighbours/neighbour_grid.h"
#include "scenes/file/scene.h"
#include "scenes/motion/body_blocks.h"
#include "scenes/run/posing.h"

namespace throng {

class BodyAvoidanceStage {
 public:
  /// Keeps references to `posing` and `workers`. The first `avatars` bodies are avatars.
  BodyAvoidanceStage(const Scene& scene, const Posing& posing, const BodyStates& bodies,
                     size_t avatars, SimdTarget simd, Workers& workers);

  /// Sets bodies.avoidance, once per frame after roots and gait. `present`:
  /// MotionSource::expected(). Allocates nothing after warm-up.
  void step(std::span<const uint8_t> present, BodyStates& bodies);
  /// Saves or restores the state of later steps, including bodies.avoidance.
  void archive(Archive& a, BodyStates& bodies);

 private:
  struct Wall {
    float x = 0, y = 0;  ///< unit vector away from the wall
    float offset_m = 0;  ///< offset of the wall's line from the middle of the ground
  };
  /// Neighbours and walls of an avatar, as of the latest search.
  struct Surroundings {
    std::array<uint32_t, NeighbourGrid::kMaxNeighbours> people{};
    std::array<Wall, kMaxAvoidedWalls> walls{};
    uint8_t people_count = 0, wall_count = 0;
    std::span<const uint32_t> neighbours() const { return {people.data(), people_count}; }
  };
  struct FootTargets {
    float stride_scale = 1;
    std::array<float, 4> landing_m{};
  };

  double observe(const BodyStates& bodies, uint32_t first, uint32_t end);
  void search_all();
  void search_fresh();
  void find_neighbours(uint32_t id);
  void find_walls(const Eigen::Vector2d& position_m, Surroundings& surroundings) const;
  void check_read(Archive& a, const BodyStates& bodies) const;
  AvoidanceMotion target_of(uint32_t id) const;
  bool is_turn_of(uint32_t id) const;
  void fetch(uint32_t id) const;
  void adapt_posture(uint32_t id, BodyStates& bodies);
  Eigen::Vector2f velocity_of(uint32_t id) const {
    return {states_[id].vx_mps, states_[id].vy_mps};
  }
  bool has_steps(uint32_t id, const BodyStates& bodies) const;
  RootMotion course_of(uint32_t id, const BodyStates& bodies) const;
  float target_stride_scale(uint32_t id, const BodyStates& bodies) const;
  std::array<float, 4> target_landing_m(uint32_t id, const BodyStates& bodies) const;
  void place_feet(uint32_t id, BodyStates& bodies);
  void extend_bounds(std::span<const uint32_t> ids, int worker, BodyStates& bodies);
  WalkState steps_of(uint32_t id, const BodyStates& bodies,
                     const Eigen::Vector2f& velocity_mps) const;

  struct Scratch {
    std::vector<float> rows;
    std::vector<PartPose> poses;
  };
  static constexpr size_t kBatch = 32;

  const Posing& posing_;
  Workers& workers_;
  SimdTarget simd_;
  std::vector<std::optional<UpperBodyBounds>> upper_bounds_;  ///< per model; empty: does not adapt
  std::vector<Scratch> scratch_;
  float step_s_;
  int64_t steps_per_search_, steps_per_decision_, steps_per_landing_, steps_per_cadence_;
  int64_t steps_ = 0;
  Walkable walkable_;
  Eigen::Vector2d middle_m_;
  NeighbourGrid grid_;
  std::vector<BodyBlock> blocks_;
  // The following are indexed by avatar.
  std::vector<BodyState2d> states_;               ///< relative to the middle of the ground
  std::vector<std::array<float, 4>> landings_m_;  ///< AvoidancePosture::landing_m, last frame
  std::vector<Eigen::Vector2f> mean_velocities_mps_;
  std::vector<Eigen::Vector2d> last_m_;
  std::vector<uint8_t> presence_;
  std::vector<AvoidanceMotion> motions_, targets_;
  std::vector<FootTargets> foot_targets_;
  std::vector<Surroundings> surroundings_;
  std::vector<double> farthest_m_;  ///< per block, largest displacement in the latest step
  // Buffers of a search: neighbours by slot of the grid; avatars that are searched alone.
  std::vector<uint32_t> slots_;
  std::vector<uint32_t> found_;
  std::vector<uint8_t> counts_;
  std::vector<uint32_t> fresh_;
};

}  // namespace throng
