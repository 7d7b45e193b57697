// CrowdMeasures computes all measures of `throng compare` as a sink.
// Invariant: recordings, logs and simulations are measured alike: 10 times per second, or at every
// frame if frames are rarer.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "analysis/measures/measure_table.h"
#include "crowd/navigation/walkable.h"
#include "scenes/run/sink.h"

namespace throng {

struct MeasureOptions {
  std::optional<Passage> line;  ///< line for the flow; none: see FlowLines
};

/// Memory grows with the number of people and the area of the ground, not with the number of
/// frames.
class CrowdMeasures final : public Sink {
 public:
  explicit CrowdMeasures(const MeasureOptions& options = {});
  ~CrowdMeasures() override;

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// All tables, including empty ones: speed_density, spacing, flow, width_use, sway,
  /// accelerations, contacts, depth. Requires end().
  std::vector<MeasureTable> tables() const;

  struct Facts {
    size_t people = 0;      ///< present at one or more samples
    double seconds = 0;     ///< duration of the run
    double sample_s = 0;    ///< time between samples
    double person_s = 0;    ///< sampled time of people
    uint64_t off_area = 0;  ///< number of samples with the head off the walkable area
  };
  Facts facts() const;

 private:
  struct State;
  MeasureOptions options_;
  std::unique_ptr<State> state_;
};

}  // namespace throng
