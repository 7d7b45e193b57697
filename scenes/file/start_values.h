// Start values are the explicit places of a group's agents at the start: lists, or a CSV file.
#pragma once

#include "scenes/file/key.h"

namespace throng {

/// Reads `positions_m` of a group, with the columns of its file if it names one.
void read_positions(ReadContext& context, const Fields& fields, Group& group);
/// Rows of `positions_m`, `headings_rad` and `speeds_mps`. read_positions() comes first.
std::vector<Key<Group>> rows_of_starts();

MapText starts_text();

}  // namespace throng
