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
#include "apps/output/log_guard.h"
#include "apps/output/output_plan.h"

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
