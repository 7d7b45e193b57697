// Ties a run to the clock, for whoever watches it live.
// One rule: it only ever waits; no result depends on it, and being late is reported, not hidden.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

namespace throng {

class Pacer {
 public:
  /// `pace`: simulated seconds a second of wall time; 1 is real time, 0 never waits.
  explicit Pacer(double pace) : pace_(pace) {}

  /// Waits until the frame at this simulation time is due; frame 0 starts the clock. Gives up when
  /// `stopped` says so.
  void wait_for(int64_t utime_us, const std::function<bool()>& stopped);

  double pace() const { return pace_; }
  int64_t late_frames() const { return late_frames_; }  ///< that came more than kTolerance late
  double worst_s() const { return worst_s_; }           ///< how late the latest was
  double behind_s() const { return behind_s_; }         ///< how late the last frame was

  /// A scheduler's tick and a wake-up are not lateness that anybody could see.
  static constexpr double kTolerance_s = 0.005;

 private:
  using Clock = std::chrono::steady_clock;
  double pace_;
  bool is_running_ = false;
  Clock::time_point start_{};
  int64_t late_frames_ = 0;
  double worst_s_ = 0;
  double behind_s_ = 0;
};

}  // namespace throng
