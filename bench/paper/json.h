// The result for machines.
// One rule: keys carry their units; what is not a number is absent, never null.
#pragma once

#include <string>

#include "bench/paper/experiment.h"

namespace throng::paper {

/// Indented JSON with a final newline. `cpu` names the machine that the times belong to.
std::string to_json(const PaperResult& result, const std::string& cpu);

}  // namespace throng::paper
