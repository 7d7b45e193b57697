#include "apps/process/pacer.h"

#include <algorithm>
#include <thread>

namespace throng {

void Pacer::wait_for(int64_t utime_us, const std::function<bool()>& stopped) {
  if (pace_ <= 0) return;
  if (!is_running_) {
    is_running_ = true;
    start_ = Clock::now();
  }
  // A frame of a slow motion may be minutes away: look up now and then.
  constexpr std::chrono::milliseconds kLook{50};
  const std::chrono::duration<double> since_start(static_cast<double>(utime_us) * 1e-6 / pace_);
  const auto due = start_ + std::chrono::duration_cast<Clock::duration>(since_start);
  auto now = Clock::now();
  behind_s_ = std::max(0.0, std::chrono::duration<double>(now - due).count());
  worst_s_ = std::max(worst_s_, behind_s_);
  late_frames_ += behind_s_ > kTolerance_s ? 1 : 0;
  for (; now < due && !stopped(); now = Clock::now())
    std::this_thread::sleep_until(std::min<Clock::time_point>(due, now + kLook));
}

}  // namespace throng
