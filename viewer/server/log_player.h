// The run of a log as it was at the end of any frame, for one client that jumps about.
// One rule: jumping and playing give the same frame.
#pragma once

#include "viewer/server/frame_message.h"
#include "viewer/server/log_index.h"

namespace throng {

class LogPlayer {
 public:
  /// Keeps references.
  LogPlayer(const LogIndex& index, const RunGeometry& geometry);

  /// The frame, or the last one known before it; null while none is known. Where states were
  /// recorded more rarely, people stand where they last were.
  std::shared_ptr<const Bytes> frame(int64_t number);

  RunReader& run() { return run_; }

 private:
  void jump(const LogIndex::Start& start);
  RunReader::Update take(const LogEvent& event);
  void read_to(int64_t frame, const LogIndex::Start& start);

  const LogIndex& index_;
  LogReader reader_;
  RunReader run_;
  FrameMessages messages_;
  PairBegins begins_;
  int64_t frame_ = -1;
  double built_ = 0;
};

}  // namespace throng
