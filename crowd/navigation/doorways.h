// The doorways before a goal: where people come to it by several, each of them is an exit.
// One rule: found on the cells of the flow field alone, once a goal, with all doors open.
#pragma once

#include <cstddef>
#include <vector>

#include "crowd/navigation/flow_field.h"

namespace throng {

struct Doorway {
  /// Nobody gets from behind it to the goal who does not step on one. Ascending.
  std::vector<size_t> cells;
  double width_m = 0;  ///< about
};

/// The ways into a goal that part within kReach_m before it and meet kApart_m farther on at the
/// earliest, one of them through a door: narrower than kNarrow_m and than the ground behind it. Of
/// each piece of ground behind them all or none; none if there is but one. `field` is the goal's.
/// In the order of their first cells.
std::vector<Doorway> doorways_before(const FlowGrid& grid, const FlowField& field);

}  // namespace throng
