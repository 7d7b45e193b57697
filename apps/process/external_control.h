// ExternalControl moves the externally controlled groups of a run, by messages or in lockstep, and
// changes its crowd by messages.
// Invariant: a run whose results depend on message timing warns once before it begins.
#pragma once

#include <memory>
#include <string>

#include "apps/options/command_line.h"
#include "lcm_io/wire/crowd_change_receiver.h"
#include "lcm_io/wire/lockstep.h"
#include "lcm_io/wire/pose_command_receiver.h"

namespace throng {

struct ExternalControlOptions {
  bool lockstep = false;
  double timeout_s = Lockstep::kDefaultTimeout_s;
};

void add_external_control_options(CommandOptions& app, ExternalControlOptions& options);

class ExternalControl {
 public:
  /// `lcm`: a URL, or "off". Throws InputError for lockstep without a controller to wait for,
  /// EnvironmentError if LCM cannot listen.
  ExternalControl(const ExternalControlOptions& options, const RunInfo& run, const std::string& lcm,
                  bool is_paced);

  /// In lockstep: waits for the controllers before any file changes. Throws EnvironmentError.
  void begin(Simulation& simulation);
  /// In lockstep, after a frame was sent. False if the run must end, see failure().
  bool await(Simulation& simulation, const Frame& frame);
  /// When the next frame is due: applies received messages; in lockstep, changes of the crowd
  /// alone.
  void take(Simulation& simulation);

  /// In lockstep, the connection that the run must publish over; otherwise null.
  std::shared_ptr<lcm::LCM> connection() const;
  std::string failure() const { return lockstep_ ? lockstep_->failure() : ""; }
  const PoseCommandReceiver* receiver() const { return receiver_.get(); }
  const CrowdChangeReceiver* changes() const { return changes_.get(); }
  const Lockstep* lockstep() const { return lockstep_.get(); }

 private:
  std::unique_ptr<PoseCommandReceiver> receiver_;
  std::unique_ptr<CrowdChangeReceiver> changes_;
  std::unique_ptr<Lockstep> lockstep_;
};

}  // namespace throng
