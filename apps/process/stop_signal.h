// Ctrl-C as a wish, not an accident: work ends after the current frame, summary and log complete.
// One rule: from the first line of main() to the last no signal cuts a file; while none is open it
// ends the process at once, and one that comes again, a while later, always does.
#pragma once

#include <chrono>
#include <functional>
#include <string_view>

namespace throng {

class StopSignal {
 public:
  /// While an object lives, the first SIGINT, SIGTERM or SIGHUP is a wish that requested() tells.
  /// At most one object at a time.
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Once, at the start of main(). A SIGHUP that is ignored (nohup) stays ignored.
  static void install();

  static bool requested();
  /// 130, 143 or 129, as a shell tells of SIGINT, SIGTERM and SIGHUP; 0 if there was none.
  static int exit_code();
  /// "SIGINT"; "" if there was none.
  static std::string_view name();
};

/// Runs `work` on a thread of its own and waits for it, or for a signal (a StopSignal lives). True:
/// it is done; what it threw is thrown here. False: a signal came first, and `work` goes on until
/// the process ends, so that it must own, or share, all that it uses.
///
/// `patience`: for work that looks for the signal itself and ends soon after it.
bool finishes_before_signal(std::function<void()> work, std::chrono::milliseconds patience = {});

/// At the very end of main(): ends the process here if work was left.
void abandon_unfinished_work(int exit_code);

}  // namespace throng
