#include "lcm_io/export/exported_log.h"

#include <algorithm>

#include "base/errors.h"

namespace throng {

ExportedLog::ExportedLog(const std::filesystem::path& file, const std::function<bool()>& keep_going)
    : file_(file), reader_(file) {
  LogGaps gaps;
  RunReader run;
  LogEvent event;
  while (run.run() == nullptr && !is_stopped_ && gaps.next(reader_, event)) {
    run.take(event.channel, event.data);
    is_stopped_ = !keep_going();
  }
  if (is_stopped_) return;
  if (run.run() == nullptr)
    throw InputError(file.string(), "a run's description", gaps.found_no_description());
  step_s_ = run.run()->step_s;
  reader_ = LogReader(file);
}

bool ExportedLog::next() {
  if (!gaps_.next(reader_, event_)) return false;
  update_ = run_.take(event_.channel, event_.data);
  if (!has_run_ && run_.run() != nullptr) {
    has_run_ = true;
    first_ = id();
  }
  return true;
}

void ExportedLog::require_one_run() const {
  if (has_run_ && id() != first_)
    throw InputError(file_.string(), "one run", "several; `throng check` lists them");
}

double ExportedLog::share_read() const {
  return static_cast<double>(reader_.offset()) /
         static_cast<double>(std::max<uint64_t>(reader_.size(), 1));
}

}  // namespace throng
