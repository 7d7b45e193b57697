// Detours turns directions of flow fields away from slow crowds. On cells of 2 m or more it
// measures density and velocity, and computes the delay of each path compared with an empty scene.
// Agents follow the flow field's direction minus the slope of that delay.
// Invariant: a detoured direction never leads away from the goal; agents do not oscillate.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/files/archive.h"
#include "base/workers.h"
#include "crowd/navigation/navigation_map.h"

namespace throng {
namespace tuning {

/// Congestion cost. Cells denser than kSlowFrom count, fully from kSlowTo on. A metre there costs
/// more by the agents' relative speed along it, which is at least kMinRelativeSpeed. An agent
/// inside such a crowd deviates less. At full density it follows the plain path, or it would swing
/// before a door and mix two streams. kDensityUpdateShare smooths densities, once per second.
///
/// Agents weight the delay by an individual factor between the two weights. The detour is full at
/// the second clearance to walls and none at the first, or agents would walk along walls.
inline constexpr double kSlowFrom_per_m2 = 0.7;
inline constexpr double kSlowTo_per_m2 = 1.5;
inline constexpr double kMinRelativeSpeed = 0.15;
inline constexpr double kDensityUpdateShare = 0.3;
inline constexpr double kMinDelayWeight = 0.5;
inline constexpr double kMaxDelayWeight = 1.5;
inline constexpr double kDetourClearanceFrom_m = 0.5, kDetourClearanceTo_m = 1.2;
/// Oncoming agents in mixed streams do not block up to the first density, fully from the second on.
inline constexpr double kBlockedFrom_per_m2 = 1.3, kBlockedTo_per_m2 = 2.0;

}  // namespace tuning

class Detours {
 public:
  /// Keeps a reference to `map`.
  Detours(const NavigationMap& map, Workers& workers);

  void archive(Archive& a);

  struct AgentSample {
    Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d relative_velocity = Eigen::Vector2d::Zero();  ///< velocity over desired speed
  };
  /// To be called once per period: measures the crowd in the first of kRound calls and updates each
  /// field in one of them. Allocates only after doors have moved.
  template <typename WalkerAt>
  void update(uint64_t period, size_t agents, const WalkerAt& agent_at, Workers& workers) {
    if (period % kRound == 0) {
      clear_counts();
      for (size_t i = 0; i < agents; ++i) count(agent_at(i));
      smooth_counts();
    }
    update_fields(period % kRound, workers);
  }
  static constexpr uint64_t kRound = 10;

  /// Returns the unit direction of an agent at `place_m` whose field (NavigationMap::field()) leads
  /// `along`. With delay_weight 1 a second of delay costs a second of walking.
  Eigen::Vector2d detoured_direction(size_t number, const Eigen::Vector2d& place_m,
                                     const Eigen::Vector2d& along, double delay_weight) const;
  /// Prefetches what detoured_direction() of the same arguments reads.
  void prefetch(size_t number, const Eigen::Vector2d& place_m) const;
  /// Returns false where the field is as in an empty scene.
  bool is_detoured(size_t number) const { return fields_[number].is_detoured; }

 private:
  /// A flow field on coarse cells with congestion cost.
  struct DetourField {
    std::vector<uint8_t> links;  ///< per cell, a bit for each of left, right, below and above
    std::vector<uint32_t> ends;  ///< cells of the goal
    std::vector<float> free_m;   ///< distance to the goal in an empty scene; negative: no path
    std::vector<Eigen::Vector2f> along;   ///< unit directions of the paths, or zero
    std::vector<Eigen::Vector2f> slopes;  ///< slopes of the delay
    bool is_detoured = false;
  };
  /// Agents near a cell: walking ones by eighth of the circle, standing ones last.
  struct DirectionBin {
    float people = 0;
    Eigen::Vector2f velocity_sum = Eigen::Vector2f::Zero();  ///< sum of relative velocities

    void archive(Archive& a) { a(people, velocity_sum); }
  };
  using CellDensity = std::array<DirectionBin, 9>;
  struct MarchBuffers {
    std::vector<float> distance_m;
    std::vector<std::pair<float, uint32_t>> queue;
  };

  size_t cell_count() const { return free_area_m2_.size(); }
  size_t coarse_of(size_t cell) const;
  CellPatch patch_at(const Eigen::Vector2d& place_m) const;
  void clear_counts();
  void count(const AgentSample& agent);
  void smooth_counts();
  void find_dense();
  void update_fields(uint64_t turn, Workers& workers);
  void find_cells(Workers& workers);
  static bool is_linked(const FlowField& field, size_t from, ptrdiff_t to);
  std::vector<uint8_t> parts_of(const FlowField& field) const;
  void link(const FlowField& field, DetourField& detour) const;
  void march(const DetourField& detour, bool is_empty, MarchBuffers& march) const;
  float slowness(const DetourField& detour, size_t cell) const;
  float relative_speed_along(const Eigen::Vector2f& direction, size_t cell) const;
  void find_slopes(size_t index, MarchBuffers& march);
  Eigen::Vector2f slope(const DetourField& detour, std::span<const float> height_m,
                        size_t cell) const;

  const NavigationMap& map_;
  int merge_factor_ = 1;  ///< flow field cells along a side of a coarse cell
  int columns_ = 0, rows_ = 0;
  double cell_m_ = 1, cells_per_m_ = 1;
  uint64_t revision_ = 0;            ///< map revision when cells were found
  std::vector<float> free_area_m2_;  ///< per cell, where agents can be
  std::vector<DetourField> fields_;
  std::vector<MarchBuffers> marches_;  ///< per worker
  // By cell: current counts, and counts smoothed over time.
  std::vector<CellDensity> counted_, present_;
  std::vector<float> per_m2_;
  std::vector<float> dense_;  ///< 0 to 1
  bool is_dense_ = false;     ///< any cell is dense
};

}  // namespace throng
