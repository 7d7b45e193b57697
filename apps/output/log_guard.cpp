#include "apps/output/log_guard.h"

#include "base/errors.h"

namespace throng {

template <typename Write>
void LogGuard::guarded(const Write& write) {
  if (failed()) return;
  try {
    write();
  } catch (const EnvironmentError& error) {
    failure_ = error.what();
  }
}

void LogGuard::begin(const RunInfo& run) {
  guarded([&] { log_.begin(run); });
}

void LogGuard::frame(const RunInfo& run, const Frame& frame) {
  guarded([&] { log_.frame(run, frame); });
}

void LogGuard::end(const RunInfo& run, const RunEnd& end) {
  guarded([&] { log_.end(run, end); });
}

}  // namespace throng
