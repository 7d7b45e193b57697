// Ctrl-C as a wish, not an accident: work ends after the current frame, summary and log complete.
// One rule: from the first line of main() to the last no signal cuts a file; while none is open it
// ends the process at once, and one that comes again, a while later, always does.
#pragma once

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

}  // namespace throng
