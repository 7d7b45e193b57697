#include "apps/process/external_control.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/process/stop_signal.h"
#include "base/console.h"
#include "base/errors.h"

namespace throng {
namespace {

bool has_external(const RunInfo& run) {
  return std::any_of(run.control_channels.begin(), run.control_channels.end(),
                     [](const std::string& channel) { return !channel.empty(); });
}

}  // namespace

void add_external_control_options(CommandOptions& app, ExternalControlOptions& options) {
  Option* lockstep = app.add_flag(
      "--lockstep", options.lockstep,
      "Before each frame, wait for the external controllers' replies to the previous one");
  app.add_option("--lockstep-timeout", options.timeout_s,
                 fmt::format("Maximum wait for a reply, in seconds [{:g}]", options.timeout_s))
      ->check(number_option(0, 1e6, true, "a number of seconds above 0"))
      ->needs(lockstep)
      ->type_name("S");
}

ExternalControl::ExternalControl(const ExternalControlOptions& options, const RunInfo& run,
                                 const std::string& lcm, bool is_paced) {
  if (const std::string& channel = run.scene->change_channel; !channel.empty()) {
    if (lcm == "off")
      print_message("note: no changes of the crowd are received with --lcm off\n");
    else
      changes_ = std::make_unique<CrowdChangeReceiver>(run, lcm);
    if (changes_)
      print_message(
          "note: results depend on when the messages on channel {} arrive, also with --lockstep\n",
          channel);
  }
  if (options.lockstep) {
    if (lcm == "off")
      throw InputError("--lockstep", "LCM for the controllers' replies", "--lcm off");
    lockstep_ = std::make_unique<Lockstep>(run, lcm, options.timeout_s);
    return;
  }
  if (!has_external(run)) return;
  if (lcm == "off") {
    print_message("note: externally controlled groups stand still with --lcm off\n");
    return;
  }
  receiver_ = std::make_unique<PoseCommandReceiver>(run, lcm);
  if (!is_paced)
    print_message(
        "warning: the run does not wait for the controllers of externally controlled groups; add "
        "--lockstep, or --pace 1\n");
}

void ExternalControl::begin(Simulation& simulation) {
  if (lockstep_) lockstep_->begin(simulation);
}

bool ExternalControl::await(Simulation& simulation, const Frame& frame) {
  if (!lockstep_) return true;
  const bool continues = lockstep_->after(simulation, frame, StopSignal::requested);
  if (continues && lockstep_->has_missing_replies())
    print_message(
        "note: no controller replied to frame {}: resuming from its checkpoint is another run\n",
        frame.number);
  return continues;
}

void ExternalControl::take(Simulation& simulation) {
  if (receiver_) receiver_->apply(simulation);
  if (changes_) changes_->apply(simulation);
}

std::shared_ptr<lcm::LCM> ExternalControl::connection() const {
  return lockstep_ ? lockstep_->connection() : nullptr;
}

}  // namespace throng
