// How ways bend round where a crowd is slow. On cells of two metres or more: how densely people
// stand and where to they get on, and with that by how much longer each way takes than through an
// empty scene. People follow the way of the flow field less the slope of that delay.
// One rule: a bent way never leads away from the goal, so that nobody goes to and fro.
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

/// Ways bend round where a crowd is slow: where it is denser than the first, and all the more up to
/// the second, a metre counts longer by the share of the free speed at which people get on along
/// the way, but none is taken for slower than the third. Who stands in such a crowd bends less and
/// less: at full density people follow the way as it is, or they would swing before a door and mix
/// two streams. What is seen once a second counts by so much, the rest is what was seen before.
/// People mind the delay by a factor of their own between the last two. Only where there is room
/// beside somebody does a way bend: all of it where walls are as far as the second of these,
/// nothing nearer than the first, or people would walk along the walls.
inline constexpr double kSlowFrom_per_m2 = 0.7;
inline constexpr double kSlowTo_per_m2 = 1.5;
inline constexpr double kMinRelativeSpeed = 0.15;
inline constexpr double kDensityUpdateShare = 0.3;
inline constexpr double kMinDelayWeight = 0.5;
inline constexpr double kMaxDelayWeight = 1.5;
inline constexpr double kDetourClearanceFrom_m = 0.5, kDetourClearanceTo_m = 1.2;
/// Among people of two ways those who come towards one are passed up to the first density, and in
/// the way like those who stand from the second on.
inline constexpr double kBlockedFrom_per_m2 = 1.3, kBlockedTo_per_m2 = 2.0;

}  // namespace tuning

class Detours {
 public:
  /// Keeps a reference to `map`.
  Detours(const NavigationMap& map, Workers& workers);

  /// Everything that update() may have changed.
  void archive(Archive& a);

  /// Somebody who is there.
  struct AgentSample {
    Eigen::Vector2d place_m = Eigen::Vector2d::Zero();
    Eigen::Vector2d relative_velocity =
        Eigen::Vector2d::Zero();  ///< velocity as a share of the free speed
  };
  /// Once a decision of everybody: the crowd is looked at at the first of kRound of them, and each
  /// way at one of them. Allocates nothing, unless doors have moved.
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

  /// The unit direction `along` a way (of NavigationMap::field()) as somebody takes it from a place
  /// who minds delays so much: 1 for whoever minds a second here as much as a second there.
  Eigen::Vector2d detoured_direction(size_t number, const Eigen::Vector2d& place_m,
                                     const Eigen::Vector2d& along, double delay_weight) const;
  /// bend() of the same is asked for soon.
  void prefetch(size_t number, const Eigen::Vector2d& place_m) const;
  /// False where a way is as in an empty scene.
  bool is_detoured(size_t number) const { return fields_[number].is_detoured; }

 private:
  /// The cells that a way leads through, and what it leads round.
  struct DetourField {
    std::vector<uint8_t> links;  ///< by cell, a bit for each of left, right, below and above
    std::vector<uint32_t> ends;  ///< cells of the goal
    std::vector<float> free_m;   ///< to the goal, as if nobody were there; negative: no way
    std::vector<Eigen::Vector2f> along;   ///< unit vectors: where it leads, or zero
    std::vector<Eigen::Vector2f> slopes;  ///< of the delay
    bool is_detoured = false;
  };
  /// People near a cell: those who walk, by an eighth of the circle, and last those who stand.
  struct DirectionBin {
    float people = 0;
    Eigen::Vector2f velocity_sum = Eigen::Vector2f::Zero();  ///< their sum

    void archive(Archive& a) { a(people, velocity_sum); }
  };
  using CellDensity = std::array<DirectionBin, 9>;
  /// What a worker marches with.
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
  int merge_factor_ = 1;  ///< cells of the flow fields along a side of one of ours
  int columns_ = 0, rows_ = 0;
  double cell_m_ = 1, cells_per_m_ = 1;
  uint64_t revision_ = 0;            ///< of the ways, when cells were found
  std::vector<float> free_area_m2_;  ///< by cell, where people can be
  std::vector<DetourField> fields_;
  std::vector<MarchBuffers> marches_;  ///< by worker
  // By cell: as counted now, and smoothed over time.
  std::vector<CellDensity> counted_, present_;
  std::vector<float> per_m2_;
  std::vector<float> dense_;  ///< 0 to 1
  bool is_dense_ = false;     ///< somewhere
};

}  // namespace throng
