// Study tables have equal bytes for any order of work, and a journal survives interruption.
#include "analysis/studies/study_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "analysis/studies/journal.h"
#include "base/errors.h"

namespace throng::study_table_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class StudyFiles : public testing::Test {
 protected:
  StudyFiles() {
    std::string pattern = (fs::temp_directory_path() / "tableXXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~StudyFiles() override { fs::remove_all(folder_); }
  std::string bytes(const fs::path& file) const {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  fs::path folder_;
};

/// Every `every`-th run of a study of 20, from `first` on.
StudyTable rows(size_t first, size_t every) {
  StudyTable table{{"run", "runs", "study", "scene", "seed", "a, \"b\"", "mean_speed_mps", "hash"},
                   {}};
  for (size_t run = first; run <= 20; run += every)
    table.rows.push_back({std::to_string(run), "20", "00000000000000aa", "1e3", "7",
                          run % 2 == 0 ? "1" : "1.5", run == 3 ? "" : "1.25", "0000000000000012"});
  return table;
}

TEST_F(StudyFiles, MergeShardsToTheSameBytes) {
  for (const char* ending : {".csv", ".sqlite"}) {
    const fs::path whole = folder_ / (std::string("whole") + ending);
    write_table(whole, rows(1, 1));
    EXPECT_EQ(read_table(whole).rows.size(), 20u) << ending;
    std::vector<std::pair<std::string, StudyTable>> parts;
    for (size_t part = 7; part >= 1; --part) {
      const fs::path file = folder_ / ("part" + std::to_string(part) + ending);
      write_table(file, rows(part, 7));
      parts.emplace_back(file.string(), read_table(file));
    }
    const fs::path joined = folder_ / (std::string("joined") + ending);
    write_table(joined, merged(parts));
    EXPECT_EQ(bytes(joined), bytes(whole)) << ending;
    EXPECT_GT(bytes(whole).size(), 100u);
  }
}

TEST_F(StudyFiles, RejectIncompleteOrInconsistentShards) {
  const auto error = [](const std::vector<std::pair<std::string, StudyTable>>& tables) {
    try {
      merged(tables);
    } catch (const InputError& rejected) {
      return std::string(rejected.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(error({{"a", rows(1, 2)}}), HasSubstr("10 missing, the first is run 2"));
  StudyTable other = rows(2, 2);
  for (auto& row : other.rows) row[2] = "00000000000000bb";
  EXPECT_THAT(error({{"a", rows(1, 2)}, {"b", other}}), HasSubstr("b: expected runs of study"));
  StudyTable wrong = rows(1, 2);
  wrong.rows[0][6] = "9";
  EXPECT_THAT(error({{"a", rows(1, 1)}, {"b", wrong}}), HasSubstr("another result"));
  EXPECT_THAT(error({{"a", StudyTable{{"x"}, {{"1"}}}}}), HasSubstr("a: expected a table that"));
  StudyTable huge = rows(1, 20);
  huge.rows[0][1] = "77777777";
  EXPECT_THAT(error({{"a", huge}}), HasSubstr("a: expected a number of runs from 1 to 100000"));
  EXPECT_EQ(error({{"a", rows(1, 1)}, {"b", rows(1, 2)}}), "none") << "equal duplicates are "
                                                                      "accepted";
}

StudyRow row_of(size_t run) {
  StudyRow row{run, {}, {}};
  row.measures.assign(study_measures().size(), std::to_string(run) + ".5");
  row.times.assign(study_times().size(), "1");
  return row;
}

TEST_F(StudyFiles, KeepWholeLinesOfATruncatedJournal) {
  const fs::path file = folder_ / "t.csv.journal";
  size_t head = 0;
  {
    Journal journal(file, "one");
    head = fs::file_size(file);
    for (size_t run = 0; run < 3; ++run) journal.add(row_of(run));
  }
  const std::string whole = bytes(file);
  const size_t line = (whole.size() - head) / 3;
  for (size_t cut = 0; cut <= whole.size(); cut += 7) {
    std::ofstream(file, std::ios::binary) << whole.substr(0, cut);
    {
      Journal journal(file, "one");
      EXPECT_EQ(journal.done().size(), cut < head ? 0 : (cut - head) / line) << cut;
      for (const StudyRow& row : journal.done()) EXPECT_EQ(row.measures, row_of(row.run).measures);
      journal.add(row_of(9));
    }
    Journal again(file, "one");
    ASSERT_FALSE(again.done().empty());
    EXPECT_EQ(again.done().back().run, 9u) << cut;
  }
}

TEST_F(StudyFiles, RejectAnotherStudysJournalAndDropDamagedLines) {
  const fs::path file = folder_ / "t.csv.journal";
  {
    Journal journal(file, "one");
    for (size_t run = 0; run < 3; ++run) journal.add(row_of(run));
  }
  EXPECT_THROW(Journal(file, "another"), InputError);
  std::string text = bytes(file);
  text[text.find("1.5")] = '8';
  std::ofstream(file, std::ios::binary) << text;
  const Journal journal(file, "one");
  ASSERT_EQ(journal.done().size(), 2u);
  EXPECT_EQ(journal.done()[1].run, 2u);
}

TEST_F(StudyFiles, DrawOnlyColumnsThatVary) {
  StudyTable table{{"run", "runs", "study", "scene", "seed", "avatars", "simulated_s", "people"},
                   {}};
  for (const char* people : {"5", "6"})
    table.rows.push_back({"1", "2", "aa", "it's", "1", people, "10", people});
  const std::vector<Figure> figures = study_figures(table);
  ASSERT_EQ(figures.size(), 1u);
  EXPECT_EQ(figures[0].id, "people_by_avatars");
  if (!has_gnuplot()) GTEST_SKIP() << "no gnuplot";
  EXPECT_THAT(draw(figures[0], folder_), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace throng::study_table_test
