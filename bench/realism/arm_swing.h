// How far arms swing, of what the style of walking has them swing at that speed, by density.
// One rule: each whole cycle of each shoulder counts by its time, beside the gait's own posture in
// the same frames.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "analysis/contacts/local_density.h"
#include "avatars/gait/gait.h"
#include "scenes/run/postures.h"
#include "scenes/run/simulation.h"
#include "scenes/run/sink.h"

namespace throng::realism {

struct SwingAt {
  double time_s = 0;  ///< of cycles, of persons
  double swing_rad_s = 0;
  double own_rad_s = 0;  ///< the style's

  double mean_deg() const;
  double share() const { return swing_rad_s / own_rad_s; }
};

class ArmSwing final : public Sink {
 public:
  /// People per m2 within 2 m.
  static constexpr std::array<double, 5> kBounds_per_m2 = {0.5, 1, 2, 3.57, 5};
  static constexpr size_t kLevels = kBounds_per_m2.size() + 1;
  /// Slower, or slower at any time of a cycle, nobody is said to walk.
  static constexpr float kWalking_mps = 0.3f;

  /// The simulation whose frames come; it knows phases and styles.
  explicit ArmSwing(const Simulation& simulation);

  SinkNeeds needs() const override { return {.postures = true}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo&, const RunEnd&) override {}

  const std::array<SwingAt, kLevels>& levels() const { return levels_; }

 private:
  struct Range {
    float least = 0, most = 0;
    void begin(float value) { least = most = value; }
    void add(float value);
    double width() const { return static_cast<double>(most - least); }
  };
  /// Of somebody, since the phase was 0 last.
  struct Cycle {
    bool is_whole = false;  ///< began at phase 0, and walked since
    int frames = 0;
    float last_phase = -1;  ///< below 0: was not there
    std::array<Range, 2> swing, own;
  };
  struct Kind {
    std::array<int, 2> shoulders{-1, -1};  ///< columns, right and left
    size_t columns = 0;
    std::vector<std::unique_ptr<Gait>> gaits;  ///< by style; of others, null
  };

  void finish(const RunInfo& run, const Frame& frame, size_t id);

  const Simulation& simulation_;
  std::vector<Kind> kinds_;  ///< by model
  std::vector<Cycle> cycles_;
  std::vector<float> row_;
  std::unique_ptr<LocalDensity> density_;
  std::vector<Eigen::Vector2d> positions_m_;
  bool is_placed_ = false;
  std::array<SwingAt, kLevels> levels_{};
};

}  // namespace throng::realism
