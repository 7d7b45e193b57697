// Keeps a run in memory, to be handed over as arrays.
// One rule: a row for everybody who is there, none for anybody who is not, as in trajectory files.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "python/rows.h"
#include "scenes/run/sink.h"

namespace throng {

/// Who is who: what a run says of itself before its first frame.
struct RunFacts {
  std::string scene;
  uint64_t seed = 0;
  uint64_t run_id = 0;
  double step_s = 0;
  std::vector<std::string> groups{};
  std::vector<std::string> models{};
  std::vector<std::vector<std::string>> part_names{};  ///< by model
  std::vector<std::string> obstacles{};                ///< bodies that follow those of people
  std::vector<PersonRow> people{};
};

RunFacts facts_of(const RunInfo& run);

/// Frames from one recorded place to the next: those that come nearest to `fps`; without, as a
/// recording has it, else ten a second.
int64_t position_interval(const Scene& scene, double step_s, std::optional<double> fps);

class RunRecorder final : public Sink {
 public:
  /// `fps`: see position_interval(); `stores_positions`: whether any are kept.
  RunRecorder(std::optional<double> fps, bool stores_positions)
      : fps_(fps), stores_positions_(stores_positions) {}

  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  RunFacts facts;
  std::vector<EventRow> events;
  std::vector<PositionRow> positions;
  std::vector<FrameRow> frames;
  int64_t end_frame = 0;

 private:
  std::optional<double> fps_;
  bool stores_positions_;
  int64_t every_ = 1;
};

/// Where somebody is, from the root of the body.
PositionRow position_row(int64_t frame, double time_s, uint32_t id, const RootPose& root,
                         float speed_mps);
float heading_of(const RootPose& root);

/// As `throng run` prints hashes.
std::string hash_text(uint64_t hash);

pybind11::dict dict_of(RunFacts facts);

/// events, trajectories and counters as arrays, contacts when they are asked for.
void add_rows(pybind11::dict& out, RunRecorder& recorder, double step_s);

}  // namespace throng
