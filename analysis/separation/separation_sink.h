// Writes how near robots came to which region of people: CSV files, and a figure where gnuplot is
// there.
// One rule: rows are written as the run goes; the figure at its end.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "analysis/separation/separation_figure.h"
#include "base/files/folder_file.h"
#include "scenes/run/sink.h"
#include "scenes/separation/separation_monitor.h"

namespace throng {

class SeparationSink final : public Sink {
 public:
  /// Of a run of a scene with this rule. Creates the folder; begin() replaces the files in it.
  /// Empty: only the totals are of interest. Throws EnvironmentError, here and in all calls, if
  /// something cannot be written.
  SeparationSink(std::filesystem::path folder, const SeparationRule& rule);

  SinkNeeds needs() const override { return {.postures = is_measured_}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// Null before begin().
  const SeparationTotals* totals() const { return monitor_ ? &monitor_->totals() : nullptr; }
  const std::filesystem::path& folder() const { return folder_; }
  /// Why there is no figure, or "".
  const std::string& note() const { return note_; }

 private:
  void list_ended(const RunInfo& run);
  void draw_figure(const RunInfo& run);

  std::filesystem::path folder_;
  bool is_measured_;
  std::unique_ptr<FolderFile> rows_, shortfalls_;
  std::unique_ptr<SeparationMonitor> monitor_;
  std::unique_ptr<SeparationHistory> history_;
  std::string text_, note_;
};

/// The names of all files that it writes into the folder.
std::vector<std::string> separation_files();

}  // namespace throng
