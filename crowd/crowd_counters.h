// What a run says of its crowd: how steering went, who came and went, who cannot get anywhere.
// One rule: plain numbers, all zero where nobody steers, so that any world of a run can answer.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "base/files/archive.h"

namespace throng {

/// What steering went through.
struct SteeringCounters {
  // Of those who decided in the latest step.
  int sweeps = 0;              ///< of disc relaxation
  double max_overlap_m = 0;    ///< of two discs, where people stand now
  double longest_stall_s = 0;  ///< how long the most stuck walker has not moved kStall_m, the
                               ///< time of queuing taken off
  uint64_t queuing = 0;        ///< of all: held up by others ahead who go the same way
  // So far.
  uint64_t rounds = 0;     ///< times that some decided
  uint64_t decisions = 0;  ///< of all people together
  uint64_t all_sweeps = 0;
  int max_sweeps = 0;
  double turned_rad = 0;  ///< of all headings, to either side
  double walked_s = 0;    ///< of all people together

  double mean_sweeps() const {
    return rounds == 0 ? 0 : static_cast<double>(all_sweeps) / static_cast<double>(rounds);
  }
  double mean_heading_rate_radps() const { return walked_s > 0 ? turned_rad / walked_s : 0; }

  void archive(Archive& a) {
    a(sweeps, max_overlap_m, longest_stall_s, queuing, rounds, decisions, all_sweeps, max_sweeps,
      turned_rad, walked_s);
  }
};

/// Where the people of a run are: entered = present + left, and all = entered + waiting + to come.
struct PopulationCounters {
  uint64_t entered = 0;  ///< those of the start included
  uint64_t present = 0;
  uint64_t left = 0;
  uint64_t waiting_to_enter = 0;  ///< outside, due, without room to enter
  uint64_t scheduled = 0;         ///< not due yet

  void archive(Archive& a) { a(entered, present, left, waiting_to_enter, scheduled); }
};

/// People of one group who cannot reach one of their goals.
struct Stranding {
  uint32_t group = 0;
  uint32_t stop = 0;  ///< index into the route
  int people = 0;
  Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< where one of them stands
  Eigen::Vector2d end_m = Eigen::Vector2d::Zero();    ///< as near as that one could get
};

}  // namespace throng
