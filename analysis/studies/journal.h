// Journal stores the finished runs of a study next to its table, to resume an interrupted study.
// Invariant: a run is in the journal if its whole line is; partial lines are cut off, and a journal
// of another study is rejected.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/studies/study_run.h"

namespace throng {

class Journal {
 public:
  /// Opens or creates the journal. `owner` identifies the study, its shard and the program. Throws
  /// InputError if the journal has another owner, EnvironmentError if it cannot be written.
  Journal(std::filesystem::path file, const std::string& owner);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Runs in the journal when it was opened, each once.
  const std::vector<StudyRow>& done() const { return done_; }
  /// Appends a run. Throws EnvironmentError.
  void add(const StudyRow& row);
  /// Deletes the journal; called after the table is written.
  void remove();

 private:
  size_t read(const std::string& text, const std::string& head);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::vector<StudyRow> done_;
};

/// File name of the journal of a table.
std::filesystem::path journal_of(const std::filesystem::path& table);

/// A finished run as one line with a checksum; also the message between MPI ranks.
std::string line_of(const StudyRow& row);
/// Returns false if the line is not a valid one.
bool read_line(const std::string& line, StudyRow& row);

}  // namespace throng
