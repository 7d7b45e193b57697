// Keeps a run alive when its log, or another file of it, cannot be written any more: what was
// computed is worth its summary. One rule: the first failure is kept and reported at the end; after
// it the file gets nothing.
#pragma once

#include <string>

#include "lcm_io/codec/message_target.h"
#include "scenes/run/sink.h"

namespace throng {

class FileGuard {
 public:
  bool failed() const { return !failure_.empty(); }
  const std::string& failure() const { return failure_; }

 protected:
  template <typename Write>
  void guarded(const Write& write);

 private:
  std::string failure_;
};

/// Of a sink that writes a file.
class SinkGuard final : public FileGuard, public Sink {
 public:
  /// Keeps a reference to `sink`.
  explicit SinkGuard(Sink& sink) : sink_(sink) {}

  SinkNeeds needs() const override { return sink_.needs(); }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

 private:
  Sink& sink_;
};

/// Of a log, which shares its encoder with others: they get their messages all the same.
class LogGuard final : public FileGuard, public MessageTarget {
 public:
  /// Keeps a reference to `log`.
  explicit LogGuard(MessageTarget& log) : log_(log) {}

  bool wants_messages() const override { return !failed() && log_.wants_messages(); }
  void message(Channel channel, int64_t utime_us, std::span<const uint8_t> bytes) override;
  void after_begin(Outlet& outlet) override;
  void after_frame(Outlet& outlet) override;
  void after_end(Outlet& outlet) override;

 private:
  MessageTarget& log_;
};

}  // namespace throng
