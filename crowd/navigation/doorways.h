// Doorways finds the doorways before a goal; a goal with several has one exit per doorway.
// Invariant: depends on the cells of the flow field alone, with all doors open.
#pragma once

#include <cstddef>
#include <vector>

#include "crowd/navigation/flow_field.h"

namespace throng {

struct Doorway {
  /// Cells that every path to the goal crosses; ascending.
  std::vector<size_t> cells;
  double width_m = 0;  ///< approximate
};

/// Returns the doorways of a goal with flow field `field`, in the order of their first cells. Paths
/// into the goal separate within kReach_m before it and meet kApart_m farther on at the earliest.
/// At least one path leads through a door: narrower than kNarrow_m and than the ground behind it.
/// Each piece of ground behind has all of its doorways or none. Empty if there is only one.
std::vector<Doorway> doorways_before(const FlowGrid& grid, const FlowField& field);

}  // namespace throng
