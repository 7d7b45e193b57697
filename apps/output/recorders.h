// The files besides the log that a run writes on request: trajectories, contact statistics, traces.
// One rule: a file that cannot be written ends the run, keeps what it has, and is reported; the
// run's summary is printed all the same.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/contacts/contact_sink.h"
#include "analysis/separation/separation_sink.h"
#include "analysis/trajectories/trajectory_sink.h"
#include "apps/options/command_line.h"
#include "apps/output/output_plan.h"
#include "lcm_io/codec/message_target.h"
#include "scenes/run/sink.h"

namespace throng {

struct RecorderOptions {
  std::vector<std::string> trajectories;
  std::optional<double> trajectory_fps;
  std::string trajectory_area;  ///< a word of trajectory_piece(), or ""
  std::string contacts;         ///< a folder, or ""
  std::string separation;       ///< a folder, or ""; needs a scene with a separation
  std::string trace;            ///< a hash a stage and frame, or ""
  std::string by_part;          ///< a folder, or ""; needs CullerOptions::by_part
  std::string html;             ///< the page with the run in it, or ""
};

void add_recorder_options(CommandOptions& app, RecorderOptions& options);
void plan_recorders(const RecorderOptions& options, OutputPlan& plan);
/// Throws InputError for what the scene gives no occasion to.
void require_recordable(const RecorderOptions& options, const Scene& scene);
/// The same for what the run turns out to be.
void require_recordable(const RecorderOptions& options, const RunInfo& run);

/// Keeps a run alive when a file of it cannot be written any more: what was computed is worth its
/// summary. The first failure is kept; after it the file gets nothing.
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
  void after_begin(TargetState& target_state) override;
  void after_frame(TargetState& target_state) override;
  void after_end(TargetState& target_state) override;

 private:
  MessageTarget& log_;
};

class Recorders {
 public:
  /// Opens the files, which are emptied when the run begins. Throws InputError or EnvironmentError.
  Recorders(const RecorderOptions& options, const Scene& scene);

  std::vector<Sink*> sinks() const;
  bool failed() const;
  /// Null without --contacts.
  const ContactSink* contacts() const { return contacts_; }
  /// Null where the scene has no separation.
  const SeparationSink* separation() const { return separation_; }
  /// What of their files there is none of, and why; a line each.
  std::vector<std::string> notes() const;
  /// One line a failure.
  std::string failures() const;

 private:
  template <typename Recorder>
  void add(std::unique_ptr<Recorder> recorder);

  std::vector<std::unique_ptr<Sink>> recorders_;
  const ContactSink* contacts_ = nullptr;
  const SeparationSink* separation_ = nullptr;
  std::vector<std::unique_ptr<SinkGuard>> guards_;
};

}  // namespace throng
