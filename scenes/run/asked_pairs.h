// The filter of a run: who and what is meant by the names of its rules.
// One rule: a name that means nobody is an error, never an empty answer.
#pragma once

#include <string>
#include <vector>

#include "culling/pair_filter.h"
#include "scenes/run/sink.h"

namespace throng {

/// Of bodies by id, avatars first, and of parts by type, models first. Throws InputError, also
/// where pairs are left out that the scene's separation is judged by.
PairFilter filter_of(const Scene& scene, const RunInfo& info);

/// A line for each word of the scene's `between` that a group or an obstacle is called, too.
std::vector<std::string> filter_notes(const Scene& scene, const RunInfo& info);

}  // namespace throng
