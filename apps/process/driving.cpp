#include "apps/process/driving.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/process/stop_signal.h"
#include "base/errors.h"
#include "base/say.h"

namespace throng {
namespace {

bool has_driven(const RunInfo& run) {
  return std::any_of(run.drive_channels.begin(), run.drive_channels.end(),
                     [](const std::string& channel) { return !channel.empty(); });
}

}  // namespace

void add_driving_options(CommandOptions& app, DrivingOptions& options) {
  Option* lockstep = app.add_flag(
      "--lockstep", options.lockstep,
      "Each frame waits for the answers of the driven groups' controllers to the last");
  app.add_option("--lockstep-timeout", options.timeout_s,
                 fmt::format("The longest wait for an answer [{:g}]", options.timeout_s))
      ->check(number_option(0, 1e6, true, "a number of seconds above 0"))
      ->needs(lockstep)
      ->type_name("S");
}

Driving::Driving(const DrivingOptions& options, const RunInfo& run, const std::string& lcm,
                 bool is_paced) {
  if (options.lockstep) {
    if (lcm == "off")
      throw InputError("--lockstep", "LCM, over which controllers answer", "--lcm off");
    lockstep_ = std::make_unique<Lockstep>(run, lcm, options.timeout_s);
    return;
  }
  if (!has_driven(run)) return;
  if (lcm == "off") {
    say("note: with --lcm off nothing drives the driven groups: they stand\n");
    return;
  }
  receiver_ = std::make_unique<DriveReceiver>(run, lcm);
  if (!is_paced)
    say("warning: a driven group without --lockstep and without --pace: the run is as fast as it "
        "can be and waits for no controller\n");
}

void Driving::begin(Simulation& simulation) {
  if (lockstep_) lockstep_->begin(simulation);
}

bool Driving::await(Simulation& simulation, const Frame& frame) {
  if (!lockstep_) return true;
  const bool goes_on = lockstep_->after(simulation, frame, StopSignal::requested);
  if (goes_on && lockstep_->is_unanswered())
    say("note: nobody answered frame {} any more: going on from its checkpoint is another run\n",
        frame.number);
  return goes_on;
}

void Driving::take(Simulation& simulation) {
  if (receiver_) receiver_->apply(simulation);
}

std::shared_ptr<lcm::LCM> Driving::connection() const {
  return lockstep_ ? lockstep_->connection() : nullptr;
}

}  // namespace throng
