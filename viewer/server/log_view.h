// LogIndex locates the frames of a log; LogView serves the log, with a LogPlayer per client.
#pragma once

#include <atomic>
#include <chrono>
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
#include "viewer/server/proximity_message.h"
#include "viewer/server/shortfall_list.h"
#include "viewer/server/web_server.h"

namespace throng {

/// LogIndex finds the messages of each frame while the page is already open.
/// Answers cover the part of the log that has been read so far. Thread-safe.
class LogIndex {
 public:
  /// Reads the run's description; a separate thread reads the rest. Throws InputError if the file
  /// is no log or has no description.
  explicit LogIndex(const std::filesystem::path& log);
  ~LogIndex();

  /// Offset of the first message of a frame's states, or of a full list of touching pairs.
  struct Mark {
    int64_t frame;
    uint64_t offset;
  };
  /// Where to start reading to reconstruct a frame.
  struct Start {
    Mark states;    ///< newest states at or before the frame
    Mark touching;  ///< newest list at or before the frame
  };
  std::optional<Start> start_of(int64_t frame) const;

  /// Returns up to `max` frames with states, from `first` to `last` and at least `every` apart.
  std::vector<Mark> states_marks(int64_t first, int64_t last, int64_t every, size_t max) const;
  /// Returns up to `max` frames with proximity rows, from `first` to `last`.
  std::vector<Mark> proximity_marks(int64_t first, int64_t last, size_t max) const;
  bool has_proximity() const;

  /// The last frame known so far; -1: none.
  int64_t last_frame() const { return last_frame_; }
  bool is_complete() const { return complete_; }
  /// Returns the missing parts of the run; empty: none known.
  std::string problem() const;
  /// Returns {"index": {"frames", "complete", "problem", "first_shown", "every", "pairs": [...],
  /// "frame_ms": [...], "shortfalls": [...]}} with at most `max_samples` samples and the first
  /// frame that has states.
  std::string to_json(size_t max_samples) const;

  const PairHistory& history() const { return history_; }
  /// Gives the description to a reader of the same log.
  void describe(RunReader& run) const;
  const std::filesystem::path& log() const { return log_; }

  void wait() const;  ///< blocks until the whole log has been read

 private:
  /// One per frame in the log. A damaged number may skip any number of frames.
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
  RunReader run_;
  PairBegins begins_;
  PairHistory history_;
  mutable std::mutex mutex_;
  std::vector<Mark> states_, touching_, proximity_;
  std::vector<Sample> samples_;  // in frame order
  ShortfallList shortfalls_;
  std::string problem_;
  std::atomic<int64_t> last_frame_{-1};
  std::atomic<bool> complete_{false}, stopping_{false};
  std::thread thread_;
};

/// LogPlayer reconstructs any frame of a log for one client.
/// Invariant: jumping and playing give the same frame.
class LogPlayer {
 public:
  /// Keeps references.
  LogPlayer(const LogIndex& index, const RunGeometry& geometry);

  /// Returns the frame or the last known one before it; null if none is known. Between recorded
  /// states people keep their last state.
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

/// Start of a positions message: head | f32 x, y of each avatar for each sample; NaN: not present.
struct PositionsHead {
  uint32_t kind = kPositionsMessage;
  uint32_t samples = 0;
  uint32_t avatars = 0;
  uint32_t zero = 0;
  double from = 0, to = 0;  ///< the samples are those of from <= frame < to
};
static_assert(sizeof(PositionsHead) == 32);

/// LogSampler answers from single frames of a log, some frames at a time, so that a client's other
/// requests do not wait.
class LogSampler {
 public:
  /// Keeps a reference.
  explicit LogSampler(const LogIndex& index);

  /// Returns a proximity message of the nearest others of a body, from a frame on. It ends where
  /// `limit` or the known log ends.
  Bytes proximity(uint32_t body, int64_t since, std::chrono::milliseconds limit);

  /// Returns a positions message. It ends where `limit`, its size or the known log ends.
  Bytes positions(int64_t first, int64_t last, int64_t every, std::chrono::milliseconds limit);

 private:
  bool read(const LogIndex::Mark& mark, Channel channel, RunReader::Update whole);

  const LogIndex& index_;
  LogReader reader_;
  RunReader run_;
};

/// LogView serves a log: each client plays, steps and scrubs independently. The client requests
/// every frame; the server has no clock.
class LogView {
 public:
  /// Throws InputError if the log cannot be shown, EnvironmentError if the port is taken. The bytes
  /// of `page` must outlive the view.
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
  WebServer server_;  // last: its threads use all members above
};

}  // namespace throng
