// ByPartSink counts tests, passed pairs and false positives per pair of parts.
// Invariant: the sums over all rows of a stage equal the counters of the run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/figure.h"
#include "culling/part_tally.h"
#include "scenes/run/sink.h"

namespace throng {

/// Counts by part name over all kinds of bodies; all obstacles together count as one part.
struct PartNameTally {
  std::vector<std::string> names;
  std::vector<PartPairCounts> cells;  ///< names x names, upper triangle only
  std::vector<std::string> volumes;   ///< volume of each cell: "ordop26", "sphere+ordop26"
  bool counts_touching = true;

  const PartPairCounts& at(size_t a, size_t b) const { return cells[a * names.size() + b]; }
};
PartNameTally by_name(const PartTally& tally, const RunInfo& run);

/// Figures of the box and volume stages: tested, passed and, where known, false positives.
std::vector<Figure> figures_of(const PartNameTally& tally);

/// Writes part_pairs.csv into a folder, and figures if gnuplot is installed. Requires
/// CullerOptions::by_part.
class ByPartSink final : public Sink {
 public:
  /// Creates the folder. Throws EnvironmentError, also in end(), if it cannot be written.
  explicit ByPartSink(std::filesystem::path folder);

  void begin(const RunInfo&) override {}
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

 private:
  std::filesystem::path folder_;
  StageCounters bodies_, body_boxes_;  // sums over all frames
};

/// Names of all files that the sink can write.
std::vector<std::string> by_part_files();

}  // namespace throng
