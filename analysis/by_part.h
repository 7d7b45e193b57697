// What culling did, pair of parts by pair of parts: which parts are tested, pass and touch in vain.
// One rule: the sums over all rows of a stage are the counters of the run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/figure.h"
#include "culling/part_tally.h"
#include "scenes/run/sink.h"

namespace throng {

/// Counts by the names of parts, of all kinds of bodies together; obstacles are one part.
struct PartNameTally {
  std::vector<std::string> names;
  std::vector<PartPairCounts> cells;  ///< names x names, the upper triangle
  std::vector<std::string> volumes;   ///< of the part stage, by cell: "ordop26", "sphere+ordop26"
  bool counts_touching = true;

  const PartPairCounts& at(size_t a, size_t b) const { return cells[a * names.size() + b]; }
};
PartNameTally by_name(const PartTally& tally, const RunInfo& run);

/// Boxes, then volumes: what was tested, what passed and, where it is known, what did not touch.
std::vector<Figure> figures_of(const PartNameTally& tally);

/// Writes by_part.csv into a folder, and figures where gnuplot is there. Needs
/// CullerOptions::by_part.
class ByPartSink final : public Sink {
 public:
  /// Creates the folder. Throws EnvironmentError, here and at the end, if it cannot be written.
  explicit ByPartSink(std::filesystem::path folder);

  void begin(const RunInfo&) override {}
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

 private:
  std::filesystem::path folder_;
  StageCounters bodies_, body_boxes_;  // sums
};

/// The names of all files that it writes.
std::vector<std::string> by_part_files();

}  // namespace throng
