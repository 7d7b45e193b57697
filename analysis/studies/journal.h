// What of a study is done, beside its table, so that a study that was killed goes on.
// One rule: a run is in the journal when its whole line is; what a kill left of a line is cut off,
// and nobody else's runs are ever taken for one's own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/studies/study_run.h"

namespace throng {

class Journal {
 public:
  /// Opens the journal, or begins it. `owner` is the study, its part and the program, in words:
  /// a journal that begins otherwise is refused. Throws InputError, EnvironmentError.
  Journal(std::filesystem::path file, const std::string& owner);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// What was there when it was opened, each run once.
  const std::vector<StudyRow>& done() const { return done_; }
  /// Throws EnvironmentError.
  void add(const StudyRow& row);
  /// After the table is written.
  void remove();

 private:
  size_t read(const std::string& text, const std::string& head);

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::vector<StudyRow> done_;
};

std::filesystem::path journal_of(const std::filesystem::path& table);

/// A finished run in one line, with its checksum; also between processes.
std::string line_of(const StudyRow& row);
/// False if the line is no such thing.
bool read_line(const std::string& line, StudyRow& row);

}  // namespace throng
