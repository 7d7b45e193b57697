// Ctrl-C as a wish, not an accident: the run ends after the current frame, summary and log
// complete. One rule: the second signal kills, for whoever really means it.
#pragma once

namespace throng {

class StopSignal {
 public:
  /// Catches SIGINT and SIGTERM until destroyed. At most one object at a time.
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  static bool requested();
};

}  // namespace throng
