// Whether what a run is about to say can be read by those whom it tells.
// One rule: the judge is the reader's own check, applied before the first byte is written.
#pragma once

#include <cstdint>
#include <vector>

#include "scenes/run/sink.h"

namespace throng {

/// The description of a run, encoded. Throws InputError naming the scene's file if it is longer
/// than a reader takes, or has what defect_of() refuses.
std::vector<uint8_t> readable_description(const RunInfo& run);

/// Throws InputError if what the run is about to send could not be read: what begin() of its
/// encoder would throw, to be known before anything is opened.
void require_readable(const RunInfo& run, bool part_poses);

}  // namespace throng
