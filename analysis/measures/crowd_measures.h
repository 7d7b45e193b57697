// Everything that `throng compare` measures of a run, as a sink.
// One rule: ten times a second, or at every frame where these are fewer, and the same way for
// recordings, logs and simulations; memory grows with people and ground, not with the frames.
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
  std::optional<Passage> line;  ///< over which the flow is measured; none: see motion_measures.h
};

class CrowdMeasures final : public Sink {
 public:
  explicit CrowdMeasures(const MeasureOptions& options = {});
  ~CrowdMeasures() override;

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// After end(): speed_density, spacing, flow, width_use, sway, accelerations, contacts, depth;
  /// all of them, empty ones included.
  std::vector<MeasureTable> tables() const;

  struct Facts {
    size_t people = 0;      ///< seen at any sampled instant
    double seconds = 0;     ///< of the run
    double sample_s = 0;    ///< between sampled instants
    double person_s = 0;    ///< sampled
    uint64_t off_area = 0;  ///< person-instants with the head off the area
  };
  Facts facts() const;

 private:
  struct State;
  MeasureOptions options_;
  std::unique_ptr<State> state_;
};

}  // namespace throng
