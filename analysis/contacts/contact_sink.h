// Writes a run's contact statistics into a folder: CSV files, and figures where gnuplot is there.
// One rule: the list of contacts grows with the run; the rest is written at its end.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "analysis/contacts/body_map.h"
#include "analysis/contacts/contact_statistics.h"
#include "analysis/contacts/near_tables.h"
#include "analysis/contacts/networks.h"
#include "base/figure.h"
#include "scenes/run/sink.h"

namespace throng {

class ContactSink final : public Sink {
 public:
  /// Creates the folder; begin() replaces contacts.csv in it. Throws EnvironmentError, here and in
  /// all calls, if something cannot be written.
  /// `with_points`: of a run that knows where contacts are on the body (see BodyMap::is_known()).
  explicit ContactSink(std::filesystem::path folder, bool with_points = false);

  SinkNeeds needs() const override { return {.postures = with_points_}; }
  void begin(const RunInfo& run) override;
  void frame(const RunInfo& run, const Frame& frame) override;
  void end(const RunInfo& run, const RunEnd& end) override;

  /// Null before begin().
  const ContactStatistics* statistics() const { return statistics_.get(); }
  /// What there is none of, and why; a line each.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  void list_ended();
  void write_pairs() const;
  void draw_figures();

  std::filesystem::path folder_;
  bool with_points_;
  std::unique_ptr<FolderFile> contacts_;
  std::unique_ptr<ContactStatistics> statistics_;
  std::unique_ptr<TouchingNetwork> touching_;
  std::unique_ptr<NearTables> near_;
  std::unique_ptr<BodyMap> body_map_;  ///< null without points
  std::vector<std::string> notes_;
};

/// The names of all files that it writes into the folder.
std::vector<std::string> contact_files();

/// How often people touched, how long, with what, and at which density; a figure that has nothing
/// to show is left out.
std::vector<Figure> figures_of(const ContactStatistics& statistics);

}  // namespace throng
