// Which of the paper's orders our numbers support, and where one strategy overtakes another.
// One rule: every statement is listed with its two numbers, also where it fails.
#pragma once

#include <span>
#include <vector>

#include "bench/paper/experiment.h"

namespace throng::paper {

/// Table 2's order for each k and update rule, Table 3's cheapest volumes, and Fig. 13's in counted
/// work and in frame rates.
std::vector<Claim> judge(const PaperResult& result, std::span<const CensusTable> censuses);

/// The cheapest strategy by size, three ways; one entry wherever it changes.
std::vector<Winner> find_winners(std::span<const Scale> scales);

}  // namespace throng::paper
