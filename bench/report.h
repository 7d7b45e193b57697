// to_text(), to_json() and to_csv() format measurements. They compute nothing but ratios of table
// values.
#pragma once

#include <cstdint>
#include <string>

#include "bench/comparison.h"
#include "bench/workbench/volume_trials.h"

namespace throng::bench {

struct MachineLine {
  std::string cpu;
  uint64_t peak_rss_bytes = 0;
};

std::string to_text(const BenchResult& result, const MachineLine& machine);
std::string to_json(const BenchResult& result, const MachineLine& machine);

/// One row per agreeing engine and two for Throng; units are in the header.
std::string csv_header();
std::string to_csv(const BenchResult& result);

std::string to_text(const AgeingResult& result);
std::string to_json(const AgeingResult& result, const BenchOptions& options,
                    const MachineLine& machine);

/// Formats the volumes and then the matrix of one of them.
std::string to_text(const FalsePositives& result);
std::string to_json(const FalsePositives& result, const BenchOptions& options);

}  // namespace throng::bench
