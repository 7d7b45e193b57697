// StopSignal turns Ctrl-C into a request: work ends after the current frame with a complete summary
// and log.
// Invariant: no signal cuts a file. Without open files a signal ends the process at once; a second
// signal, half a second later or more, always does.
#pragma once

#include <chrono>
#include <functional>
#include <string_view>

namespace throng {

class StopSignal {
 public:
  /// While an object lives, the first SIGINT, SIGTERM or SIGHUP only sets requested(). At most one
  /// object at a time.
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Call once, at the start of main(). An ignored SIGHUP (nohup) stays ignored.
  static void install();

  /// `restore` is called in the signal handler before a signal ends the process; null: nothing is.
  static void before_exit(void (*restore)());

  static bool requested();
  /// 130, 143 or 129 for SIGINT, SIGTERM and SIGHUP, as shells report them; 0 without a signal.
  static int exit_code();
  /// "SIGINT"; "" without a signal.
  static std::string_view name();
};

/// Runs `work` on a separate thread and waits for it or for a signal (a StopSignal must live).
/// Returns true if the work is done, and rethrows its exception. Returns false after a signal; the
/// work then continues until the process ends, and must own or share all that it uses.
///
/// `patience`: extra time for work that checks the signal itself.
bool finishes_before_signal(std::function<void()> work, std::chrono::milliseconds patience = {});

/// Call at the very end of main(): ends the process here if work was abandoned.
void abandon_unfinished_work(int exit_code);

}  // namespace throng
