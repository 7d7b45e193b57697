// Processor time of this thread, for what runs on one thread: on a machine that does nothing else
// it is the wall clock's, on a busy one it leaves out the time in which others ran. One rule: for
// runs of microseconds and more; reading it costs half of one.
#pragma once

#include <ctime>

namespace throng::bench {

class ThreadClock {
 public:
  /// Nanoseconds since construction or the last lap.
  double lap_ns() {
    const double now_ns = read_ns();
    const double ns = now_ns - start_ns_;
    start_ns_ = now_ns;
    return ns;
  }

 private:
  static double read_ns() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
  }
  double start_ns_ = read_ns();
};

}  // namespace throng::bench
