#include "apps/output/log_guard.h"

#include "base/errors.h"

namespace throng {

template <typename Write>
void FileGuard::guarded(const Write& write) {
  if (failed()) return;
  try {
    write();
  } catch (const EnvironmentError& error) {
    failure_ = error.what();
  }
}

void SinkGuard::begin(const RunInfo& run) {
  guarded([&] { sink_.begin(run); });
}

void SinkGuard::frame(const RunInfo& run, const Frame& frame) {
  guarded([&] { sink_.frame(run, frame); });
}

void SinkGuard::end(const RunInfo& run, const RunEnd& end) {
  guarded([&] { sink_.end(run, end); });
}

void LogGuard::message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) {
  guarded([&] { log_.message(channel, utime_us, bytes); });
}

void LogGuard::after_begin(Outlet& outlet) {
  guarded([&] { log_.after_begin(outlet); });
}

void LogGuard::after_frame(Outlet& outlet) {
  guarded([&] { log_.after_frame(outlet); });
}

void LogGuard::after_end(Outlet& outlet) {
  guarded([&] { log_.after_end(outlet); });
}

}  // namespace throng
