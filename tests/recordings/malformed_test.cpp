// Malformed files are rejected in one line with file, line, expectation, finding and remedy.
#include <gmock/gmock.h>

#include "tests/recordings/binary_files.h"
#include "tests/recordings/recording_folder.h"

namespace throng::malformed_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct Malformed {
  std::string name;
  std::string text;
  std::vector<std::string> words;  ///< expected in the error, the first one at its start
  RecordingOptions options{};
};

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest's name
void PrintTo(const Malformed& malformed, std::ostream* out) { *out << malformed.name; }

class MalformedText : public RecordingTest, public testing::WithParamInterface<Malformed> {};

TEST_P(MalformedText, IsRejectedInOneLine) {
  const Malformed& malformed = GetParam();
  const std::string error = rejection(malformed.text, malformed.options);
  EXPECT_THAT(error, StartsWith(malformed.words.front()));
  for (const std::string& words : malformed.words) EXPECT_THAT(error, HasSubstr(words));
  EXPECT_THAT(error, HasSubstr("expected "));
  EXPECT_THAT(error, HasSubstr(", found "));
  EXPECT_THAT(error, Not(HasSubstr("\n")));
  EXPECT_LT(error.size(), 500u);
}

const std::string kArchive = "# framerate: 25 fps\n# id frame x/m y/m z/m\n";
const std::string kTable = "time,pedID,posX,posY\n0.0,1,2,3\n";
const std::string kSteps =
    "pedestrianId simTime endTime-PID1 startX-PID1 startY-PID1 endX-PID1 endY-PID1\n";

INSTANTIATE_TEST_SUITE_P(
    Archive, MalformedText,
    testing::Values(
        Malformed{"ShortLine",
                  kArchive + "1 0 2 3 1.7\n1 1 2\n",
                  {"recording:4: ", "5 columns", "found 3"}},
        Malformed{"LongLine",
                  kArchive + "1 0 2 3 1.7\n1 1 2 3 1.72 1 2 3 1.7\n",
                  {"recording:4: ", "5 columns", "found 9"}},
        Malformed{"ThreeColumns",
                  "1 0 2\n",
                  {"recording:1: ", "id, frame, x, y", "'1 0 2'"},
                  {.fps = 25, .unit_m = 1}},
        Malformed{
            "GapsAlone", kArchive + "1 0 nan 3 1.7\n", {"recording: ", "only 1 missing ones"}},
        Malformed{"InfinityAsY", kArchive + "1 0 2 inf 1.7\n", {"recording:3: ", "inf"}},
        Malformed{"InfinityAsZ", kArchive + "1 0 2 3 inf\n", {"recording:3: ", "expected z"}},
        Malformed{"WordAsX",
                  kArchive + "1 0 2 3 1\n1 1 two 3 1\n",
                  {"recording:4: ", "x that is a number", "'two'"}},
        Malformed{
            "CommasForPoints", kArchive + "1 0 2 3 1\n1 1 2,5 3 1\n", {"recording:4: ", "'2,5'"}},
        Malformed{
            "NegativeId", kArchive + "-1 0 2 3 1.7\n", {"recording:3: ", "id of 0 or more", "-1"}},
        Malformed{"HalfAnId",
                  kArchive + "1 0 2 3 1\n1.5 0 2 3 1\n",
                  {"recording:4: ", "an id that is a whole number", "'1.5'"}},
        Malformed{"HalfAFrame",
                  kArchive + "1 0 2 3 1\n1 0.5 2 3 1\n",
                  {"recording:4: ", "a frame that is a whole number", "'0.5'"}},
        Malformed{"FrameBeyondInt64",
                  kArchive + "1 0 2 3 1\n1 99999999999999999999 2 3 1\n",
                  {"recording:4: ", "which is too large"}},
        Malformed{"FrameBeyondDoubles",
                  kArchive + "1 9223372036854775807 2 3 1\n",
                  {"recording:3: ", "a frame within 9e15"}},
        Malformed{"HugeX", kArchive + "1 0 1e300 3 1.7\n", {"recording:3: ", "within 1e8 m"}},
        Malformed{"WrongUnit",
                  "# framerate: 25\n# id frame x/m y/m\n1 0 2 3\n2 0 99000 3\n",
                  {"recording:4: ", "within 10 km", "--unit"}},
        Malformed{"ElevenMillionSeconds",
                  kArchive + "1 0 2 3 1\n1 275000000 2 3 1\n",
                  {"recording: ", "at most 1e7 s", "1.1e+07 s"}},
        Malformed{"RateOfZero",
                  "# framerate: 0\n# id frame x/m y/m\n1 0 2 3\n",
                  {"recording:3: ", "a frame rate above 0", "--fps 25"}},
        Malformed{"RateOfAMillion",
                  "# framerate: 1e6\n# id frame x/m y/m\n1 0 2 3\n",
                  {"recording:3: ", "up to 10000"}},
        Malformed{"NoRate", "# id frame x/m y/m\n1 0 2 3\n", {"recording: ", "--fps 25"}},
        Malformed{"NoUnit", "# framerate: 25\n1 0 2 3\n", {"recording: ", "--unit cm"}},
        Malformed{"NoRateAndUnit", "1 0 2 3 1.7\n", {"recording: ", "--fps 16 --unit cm"}},
        Malformed{"TwoHeaders",
                  kArchive + "1 0 2 3 1\n# framerate: 16 fps\n# id frame x/m y/m z/m\n1 1 2 3 1\n",
                  {"recording:4: ", "one frame rate, 25", "split the file there"}},
        Malformed{"TwoUnits",
                  kArchive + "1 0 2 3 1\n# framerate: 25 fps\n# id frame x/cm y/cm z/cm\n",
                  {"recording:5: ", "one unit of length"}},
        Malformed{"CommentsAlone", kArchive, {"recording: ", "position of a person", "none"}},
        Malformed{"EndlessLine",
                  kArchive + "1 0 2 3 1\n" + std::string(100'000, '1'),
                  {"recording:4: ", "lines of at most 64 KiB"}},
        Malformed{"Jump",
                  kArchive + "1 0 2 3 1\n1 1 6 3 1\n",
                  {"recording: ", "--strict", "jumps of more than 3 m", "id 1 at frame 1"},
                  {.strict = true}}),
    [](const auto& each) { return each.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Others, MalformedText,
    testing::Values(
        Malformed{"Empty", "", {"recording: ", "a recording", "an empty file"}},
        Malformed{"Blank", "\n\n   \n", {"recording: ", "a recording"}},
        Malformed{"Prose", "People walk.\nThey do not touch.\n", {"recording: ", "'People walk.'"}},
        Malformed{"Binary",
                  std::string("\x01\x02\0\xff\xfe\x80", 6) + std::string(500, '\x07'),
                  {"recording: ", "\\x01\\x02"}},
        Malformed{"Utf16", std::string("\xff\xfei\0d\0,\0x\0", 10), {"recording: ", "\\xff\\xfe"}},
        Malformed{"TableWithoutRows", "time,pedID,posX,posY\n", {"recording: ", "none"}},
        Malformed{"TableWithoutX", "time,pedID,posY\n0,1,2\n", {"recording: ", "--columns"}},
        Malformed{"TableWithoutNames", "0.5,1,2.5,3\n", {"recording: ", "--columns"}},
        Malformed{"MissingColumn",
                  kTable,
                  {"recording:1: ", "'who'", "--columns"},
                  {.columns = "id=who"}},
        Malformed{"UnknownRole",
                  kTable,
                  {"--columns: ", "id, frame, t, x, y, z", "'who=pedID'"},
                  {.columns = "who=pedID"}},
        Malformed{"WrongSeparator",
                  kTable,
                  {"recording:1: ", "a column 'time', because of --columns"},
                  {.columns = "t=time", .separator = ';'}},
        Malformed{"ShortRow", kTable + "0.5,1,2\n", {"recording:3: ", "4 columns", "found 3"}},
        Malformed{"EmptyTime",
                  kTable + ",1,2,3\n",
                  {"recording:3: ", "a number in the column 'time'", "nothing"}},
        Malformed{"NanAsTime", kTable + "NaN,1,2,3\n", {"recording:3: ", "'time'", "'NaN'"}},
        Malformed{"OpenQuote", kTable + "0.5,1,\"2,3\n", {"recording:3: ", "a second quote"}},
        Malformed{"NameAsId",
                  kTable + "0.5,anna,2,3\n",
                  {"recording:3: ", "a whole number in the column 'pedID'", "'anna'"}},
        Malformed{
            "DecimalCommas", "t;id;x;y\n0;1;2,5;3\n", {"recording:2: ", "'2,5'", "with a point"}},
        Malformed{"TimeBeyondAll", kTable + "1e300,1,2,3\n", {"recording:3: ", "within 1e12 s"}},
        Malformed{"FramesWithoutRate", "id,frame,x,y\n1,0,2,3\n", {"recording: ", "--fps 25"}},
        Malformed{"RateThatIsNotThere",
                  kTable + "0.5,1,2,3\n1.0,1,2,3\n",
                  {"recording: ", "(--fps)"},
                  {.fps = 3}},
        Malformed{"StepBackwards",
                  kSteps + "1 2.0 1.0 0 0 1 1\n",
                  {"recording:2: ", "ends after it has begun"}},
        Malformed{"StepWithoutEnd", kSteps + "1 2.0 3.0 0 0 1\n", {"recording:2: ", "7 columns"}},
        Malformed{"StepOfWords",
                  kSteps + "1 2.0 soon 0 0 1 1\n",
                  {"recording:2: ", "endTime that is a number", "'soon'"}},
        Malformed{"HeadOfGzip", "\x1f\x8b", {"recording: ", "a gzip file"}},
        Malformed{"GzipOfNoise", "\x1f\x8b\x08" + std::string(400, 'U'), {"recording: ", "gzip"}},
        Malformed{"HeadOfSqlite", std::string("SQLite format 3\0", 16), {"recording: ", "SQLite"}},
        Malformed{"HeadOfHdf5", "\x89HDF\r\n\x1a\n", {"recording: ", "HDF5"}},
        Malformed{"NobodyInThePart",
                  kTable,
                  {"recording: ", "a person between 5 s"},
                  {.start_s = 5, .end_s = 6}}),
    [](const auto& each) { return each.param.name; });

class MalformedBinary : public RecordingTest {
 protected:
  std::string rejection_of(const std::filesystem::path& file, RecordingOptions options = {}) const {
    options.file = file;
    try {
      read_recording(options);
      return "";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), StartsWith(file.string()));
      EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
      return error.what();
    }
  }
  std::string sqlite_rejection(const std::string& sql) const {
    make_sqlite(path("a.sqlite"), sql);
    return rejection_of(path("a.sqlite"));
  }
  std::string hdf5_rejection(const Hdf5Plan& plan) const {
    make_hdf5(path("a.h5"), plan);
    return rejection_of(path("a.h5"));
  }
  static std::string content(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(MalformedBinary, RejectsSqliteInOneLine) {
  EXPECT_THAT(sqlite_rejection("CREATE TABLE people(id)"),
              HasSubstr("the tables trajectory_data and metadata, as JuPedSim writes them, found "
                        "'people' alone"));
  EXPECT_THAT(sqlite_rejection("VACUUM"), HasSubstr("expected"));
  const auto with = [&](const std::string& more) { return sqlite_rejection(jupedsim_2() + more); };
  EXPECT_THAT(with("UPDATE trajectory_data SET pos_x = 'far' WHERE frame = 1 AND id = 5"),
              HasSubstr("a number as pos_x in row 4 of trajectory_data, found 'far'"));
  EXPECT_THAT(with("UPDATE trajectory_data SET id = 1.5 WHERE frame = 1 AND id = 5"),
              HasSubstr("a whole number as id in row 4"));
  EXPECT_THAT(with("UPDATE trajectory_data SET pos_y = 9e999"),
              HasSubstr("row 1: expected x and y"));
  EXPECT_THAT(with("UPDATE trajectory_data SET id = -3"), HasSubstr("row 1: expected an id of 0"));
  EXPECT_THAT(with("UPDATE trajectory_data SET frame = 9223372036854775807"),
              HasSubstr("row 1: expected a frame within 9e15"));
  EXPECT_THAT(with("DELETE FROM trajectory_data"), HasSubstr("position of a person"));
  EXPECT_THAT(with("DELETE FROM metadata"), HasSubstr("--fps 25"));
  EXPECT_THAT(with("UPDATE metadata SET value = 'fast' WHERE key = 'fps'"),
              HasSubstr("a frame rate as in 25"));
  EXPECT_THAT(with("UPDATE metadata SET value = 'new' WHERE key = 'version'"),
              HasSubstr("a number as version"));
  EXPECT_THAT(with("UPDATE metadata SET value = '-25'"), HasSubstr("an fps above 0"));
  EXPECT_THAT(with("UPDATE geometry SET wkt = 'CIRCLE (1 1 1)'"), HasSubstr("POLYGON"));
  EXPECT_THAT(with("DROP TABLE trajectory_data; CREATE VIEW trajectory_data AS SELECT 1 AS frame"),
              HasSubstr("a column id in trajectory_data"));
  EXPECT_THAT(with("DROP TABLE trajectory_data; CREATE VIEW trajectory_data(frame, id, pos_x, "
                   "pos_y) AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) "
                   "SELECT 1, 1, i, -1e9 FROM n"),
              HasSubstr("row 1: expected x and y within 1e8 m"));
  make_sqlite(path("a.sqlite"), jupedsim_2());
  const std::string whole = content(path("a.sqlite"));
  EXPECT_THAT(rejection_of(write("cut.sqlite", whole.substr(0, whole.size() / 2))),
              HasSubstr("a SQLite database"));
  EXPECT_THAT([&] { read_recording({.file = path("a.sqlite"), .columns = "id=id"}); },
              testing::ThrowsMessage<InputError>(StartsWith("--columns: expected a table")));
}

TEST_F(MalformedBinary, RejectsHdf5InOneLine) {
  EXPECT_THAT(hdf5_rejection({.dataset = "paths"}), HasSubstr("one without such a dataset"));
  EXPECT_THAT(hdf5_rejection({.x_name = "breadth"}), HasSubstr("one without the column x"));
  EXPECT_THAT(hdf5_rejection({.fps = 0}), HasSubstr("--fps 25"));
  EXPECT_THAT(hdf5_rejection({.fps = -1}), HasSubstr("an fps above 0"));
  EXPECT_THAT(hdf5_rejection({.fps = std::nan("")}), HasSubstr("--fps 25"));
  EXPECT_THAT(hdf5_rejection({.id_is_real = true}), HasSubstr("whole numbers in the column id"));
  EXPECT_THAT(hdf5_rejection({.rows = {}}), HasSubstr("position of a person"));
  EXPECT_THAT(hdf5_rejection({.rows = {{-1, 0, 0, 0, 0}}}), HasSubstr("row 1: expected an id"));
  EXPECT_THAT(hdf5_rejection({.rows = {{1, 0, 0, 0, 0}, {1, 1, INFINITY, 0, 0}}}),
              HasSubstr("row 2: expected x and y"));
  EXPECT_THAT(hdf5_rejection({.wkt = "POLYGON (("}), HasSubstr("walkable area (WKT)"));
  make_hdf5(path("a.h5"), {});
  const std::string whole = content(path("a.h5"));
  EXPECT_THAT(rejection_of(write("cut.h5", whole.substr(0, whole.size() / 2))),
              HasSubstr("damaged or cut short"));
}

TEST_F(MalformedBinary, RejectsMissingFilesAndFolders) {
  EXPECT_THAT(rejection_of(path("none.txt")), HasSubstr("found no such file"));
  EXPECT_THAT(rejection_of(path("")), HasSubstr("found a directory"));
}

}  // namespace
}  // namespace throng::malformed_test
