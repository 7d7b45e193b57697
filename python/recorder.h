// RunRecorder keeps a run in memory and returns it as arrays. Like trajectory files it has rows for
// the people in the scene only.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "python/rows.h"
#include "scenes/run/sink.h"

namespace throng {

/// Bodies, groups and models of a run, known before its first frame.
struct RunFacts {
  std::string scene;
  uint64_t seed = 0;
  uint64_t run_id = 0;
  double step_s = 0;
  std::vector<std::string> groups{};
  std::vector<std::string> models{};
  std::vector<bool> is_person{};  ///< by model
  std::vector<std::vector<std::string>> part_names{};
  std::vector<std::string> obstacles{};  ///< bodies after those of people
  std::vector<PersonRow> people{};
};

RunFacts facts_of(const RunInfo& run);

/// Returns the number of frames between recorded positions, for a rate nearest to `fps`; by default
/// that of the recording, or 10 per second.
int64_t position_interval(const Scene& scene, double step_s, std::optional<double> fps);

class RunRecorder final : public Sink {
 public:
  /// `fps`: see position_interval(); `stores_positions`: whether positions are recorded.
  RunRecorder(std::optional<double> fps, bool stores_positions)
      : fps_(fps), stores_positions_(stores_positions) {}

  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  RunFacts facts;
  std::vector<EventRow> events;
  std::vector<PositionRow> positions;
  std::vector<FrameRow> frames;
  std::vector<ProximityRow> proximity, closest_parts;
  std::vector<ContactPointRow> contact_points;
  int64_t end_frame = 0;

 private:
  std::optional<double> fps_;
  bool stores_positions_;
  int64_t every_ = 1;
};

/// Returns the position of a person, from the root of the body.
PositionRow position_row(int64_t frame, double time_s, uint32_t id, const RootPose& root,
                         float speed_mps);
float heading_of(const RootPose& root);

std::string hash_text(uint64_t hash);

pybind11::dict dict_of(RunFacts facts);

/// Adds all rows as arrays; contacts are computed on request.
void add_rows(pybind11::dict& out, RunRecorder& recorder, double step_s);

}  // namespace throng
