// Keeps a run alive when its log, or another file of it, cannot be written any more: what was
// computed is worth its summary. One rule: the first failure is kept and told at the end; after it
// the log gets nothing.
#pragma once

#include <string>

#include "scenes/run/sink.h"

namespace throng {

class LogGuard final : public Sink {
 public:
  /// Keeps a reference to `log`.
  explicit LogGuard(Sink& log) : log_(log) {}

  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  bool failed() const { return !failure_.empty(); }
  const std::string& failure() const { return failure_; }

 private:
  template <typename Write>
  void guarded(const Write& write);

  Sink& log_;
  std::string failure_;
};

}  // namespace throng
