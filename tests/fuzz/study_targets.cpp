// Fuzz targets for studies: their files, tables and journals.
#include <string>

#include "analysis/studies/journal.h"
#include "analysis/studies/study_plan.h"
#include "analysis/studies/study_table.h"
#include "base/errors.h"
#include "tests/fuzz/target_tools.h"

namespace throng::fuzz {

bool study(std::span<const uint8_t> input) {
  const File file("study.yaml", input);
  try {
    Study read = read_study(file.path());
    promise(read.runs() >= 1 && read.runs() <= kMaxStudyRuns, "runs within the limit");
    if (read.runs() > 50) return true;  // each loads a scene
    const StudyPlan plan(std::move(read));
    for (size_t run = 0; run < plan.runs(); ++run) {
      promise(plan.cells(run).size() == plan.columns().size(), "a cell per column");
      promise(plan.planned(run).scene.duration_s > 0, "a positive duration");
    }
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

bool study_table(std::span<const uint8_t> input) {
  const std::string text = text_of(input);
  for (size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
    StudyRow row;
    try {
      if (read_line(text.substr(at, end - at), row))
        promise(line_of(row) == text.substr(at, end + 1 - at), "an unchanged line");
    } catch (const InputError& error) {
      expect_words(error);
    }
  }
  try {
    const StudyTable table = parse_csv(text, "fuzz.csv");
    const std::string written = csv_text(table);
    promise(csv_text(parse_csv(written, "again.csv")) == written, "an unchanged table");
    const StudyTable whole = merged({{"fuzz.csv", table}, {"fuzz.csv", table}});
    promise(whole.rows.size() <= table.rows.size(), "no additional runs");
    return true;
  } catch (const InputError& error) {
    expect_words(error);
    return false;
  }
}

}  // namespace throng::fuzz
