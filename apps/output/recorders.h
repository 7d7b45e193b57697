// Recorders write a run's optional files: trajectories, contact statistics, traces.
// Invariant: a file that cannot be written ends the run, keeps its contents and is reported; the
// summary is still printed.
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
  std::string contacts;         ///< folder, or ""
  std::string separation;       ///< folder, or ""; needs a scene with a separation
  std::string trace;            ///< file of hashes per stage and frame, or ""
  std::string by_part;          ///< folder, or ""; needs CullerOptions::by_part
  std::string html;             ///< file with the 3-D page and the run, or ""
};

void add_recorder_options(CommandOptions& app, RecorderOptions& options);
void plan_recorders(const RecorderOptions& options, OutputPlan& plan);
/// Throws InputError for an option that does not apply to the scene.
void require_recordable(const RecorderOptions& options, const Scene& scene);
/// As above, for options that depend on the prepared run.
void require_recordable(const RecorderOptions& options, const RunInfo& run);

/// Lets a run continue to its summary when a file cannot be written. Stores the first failure and
/// stops writing.
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

/// Guard of a sink that writes a file.
class SinkGuard final : public FileGuard, public Sink {
 public:
  /// `sink` must outlive this.
  explicit SinkGuard(Sink& sink) : sink_(sink) {}

  SinkNeeds needs() const override { return sink_.needs(); }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

 private:
  Sink& sink_;
};

/// Guard of a log. Other targets of the shared encoder still get their messages.
class LogGuard final : public FileGuard, public MessageTarget {
 public:
  /// `log` must outlive this.
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
  /// Opens the files; they are emptied when the run begins. Throws InputError or EnvironmentError.
  Recorders(const RecorderOptions& options, const Scene& scene);

  std::vector<Sink*> sinks() const;
  bool failed() const;
  /// Null without --contacts.
  const ContactSink* contacts() const { return contacts_; }
  /// Null if the scene has no separation.
  const SeparationSink* separation() const { return separation_; }
  /// Files that were not written, and why; one line each.
  std::vector<std::string> notes() const;
  /// One line per failure.
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
