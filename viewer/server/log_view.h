// A log behind the page: where its frames lie, and a player for each client.
#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "lcm_io/codec/run_reader.h"
#include "lcm_io/log/log_gaps.h"
#include "viewer/server/frame_message.h"
#include "viewer/server/pair_history.h"
#include "viewer/server/web_server.h"

namespace throng {

/// Where in a log each frame's messages lie, found while the page is already open.
/// Heads are read, states are not decoded; a question is answered with what is known so
/// far.
class LogIndex {
 public:
  /// Reads until the run's description is complete; the rest is read by a thread of its own. Throws
  /// InputError if the file is no log or has no description.
  explicit LogIndex(const std::filesystem::path& log);
  ~LogIndex();

  /// A place in the log: the first message of a frame's states, or of a full list of what touches.
  struct Mark {
    int64_t frame;
    uint64_t offset;
  };
  /// Where to begin to read in order to know frame `frame`.
  struct Start {
    Mark states;    ///< the newest states at or before the frame
    Mark touching;  ///< the newest list at or before the frame
  };
  std::optional<Start> start_of(int64_t frame) const;

  /// The last frame known so far; -1 if none is.
  int64_t last_frame() const { return last_frame_; }
  bool is_complete() const { return complete_; }
  /// What of the run is missing; "" as long as nothing is known to be.
  std::string problem() const;
  /// {"index": {"frames", "complete", "problem", "first_shown", "every", "pairs": [...],
  /// "frame_ms": [...]}}: the run in at most `most` samples, and the first frame that has states.
  std::string to_json(size_t max_samples) const;

  const PairHistory& history() const { return history_; }
  /// The messages of the description, one after the other.
  const std::vector<std::vector<uint8_t>>& description() const { return description_; }
  const std::filesystem::path& log() const { return log_; }

  void wait() const;  ///< until the whole log was read

 private:
  /// Of a frame that the log has: a damaged number may leave out any number of frames before it.
  struct Sample {
    int64_t frame;
    int32_t pairs;
    float frame_ms;
  };
  void read_on();
  void take(const LogEvent& event, Channel channel);

  std::filesystem::path log_;
  LogReader reader_;
  LogGaps gaps_;
  std::vector<std::vector<uint8_t>> description_;
  RunReader run_;  // of the pairs alone: states are not decoded
  PairBegins begins_;
  PairHistory history_;
  mutable std::mutex mutex_;
  std::vector<Mark> states_, touching_;
  std::vector<Sample> samples_;  // in the order of frames
  std::string problem_;
  std::atomic<int64_t> last_frame_{-1};
  std::atomic<bool> complete_{false}, stopping_{false};
  std::thread thread_;
};

/// The run of a log as it was at the end of any frame, for one client that jumps about.
/// Jumping and playing give the same frame.
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

/// A log behind the page: each client plays, steps and scrubs on its own.
/// The client asks for a frame and gets it; no clock runs here.
class LogView {
 public:
  /// Throws InputError if the log cannot be shown, EnvironmentError if the port is taken. Keeps no
  /// reference to `page` but its bytes, which must outlive it.
  LogView(const std::filesystem::path& log, const WebOptions& options, std::string_view page);

  WebServer& server() { return server_; }
  const LogIndex& index() const { return index_; }

 private:
  struct Player;
  void opened(const std::shared_ptr<WebClient>& client);
  void on_text(WebClient& client, std::string_view text);

  LogIndex index_;
  RunReader description_;
  RunGeometry geometry_;
  SharedBytes run_message_;
  WebServer server_;  // last: its threads use the rest
};

}  // namespace throng
