// What was measured, as text for people and as JSON for machines.
// One rule: nothing is computed here but ratios of what the tables show.
#pragma once

#include <cstdint>
#include <string>

#include "bench/comparison.h"
#include "bench/workbench/volume_trials.h"

namespace throng::bench {

/// What a result says about where it was measured.
struct MachineLine {
  std::string cpu;
  uint64_t peak_rss_bytes = 0;
};

std::string to_text(const BenchResult& result, const MachineLine& machine);
std::string to_json(const BenchResult& result, const MachineLine& machine);

/// One row an engine that agrees, and two of ours; the header names the units.
std::string csv_header();
std::string to_csv(const BenchResult& result);

std::string to_text(const AgeingResult& result);
std::string to_json(const AgeingResult& result, const BenchOptions& options,
                    const MachineLine& machine);

/// The volumes side by side, then the matrix of one of them.
std::string to_text(const FalsePositives& result);
std::string to_json(const FalsePositives& result, const BenchOptions& options);

}  // namespace throng::bench
