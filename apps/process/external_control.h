// What moves the driven groups of a run: messages as they come, or answers in lockstep.
// One rule: a run never depends in silence on when a message came; it is told once, before it
// begins.
#pragma once

#include <memory>
#include <string>

#include "apps/options/command_line.h"
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
  /// `lcm`: a URL, or "off". Throws InputError where lockstep is asked for and there is nobody to
  /// wait for, EnvironmentError where LCM cannot listen.
  ExternalControl(const ExternalControlOptions& options, const RunInfo& run, const std::string& lcm,
                  bool is_paced);

  /// In lockstep, before any file is touched: waits for the controllers. Throws EnvironmentError.
  void begin(Simulation& simulation);
  /// In lockstep, after a frame was sent. False if the run has to end, see failure().
  bool await(Simulation& simulation, const Frame& frame);
  /// Otherwise, when the next frame is due: takes what has come.
  void take(Simulation& simulation);

  /// In lockstep, the connection that the run has to publish over; else null.
  std::shared_ptr<lcm::LCM> connection() const;
  std::string failure() const { return lockstep_ ? lockstep_->failure() : ""; }
  const PoseCommandReceiver* receiver() const { return receiver_.get(); }
  const Lockstep* lockstep() const { return lockstep_.get(); }

 private:
  std::unique_ptr<PoseCommandReceiver> receiver_;
  std::unique_ptr<Lockstep> lockstep_;
};

}  // namespace throng
