// Nothing that is there is lost: no command writes over what it reads, over another of its outputs,
// or over anything at all before it is certain that it can do its work.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/apps/cli.h"

namespace throng {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A command, its options that name files, and which of them are read.
struct CommandLine {
  std::string command;
  std::string line;  ///< its arguments, but for outputs
  std::vector<std::string> outputs;
  std::vector<std::string> inputs;  ///< options; arguments are in `line`
  std::vector<std::string> read{};  ///< files of `line` that an output must not be
};

const std::vector<CommandLine>& commands() {
  static const std::vector<CommandLine> all = {
      {"run",
       "my.yaml --seconds 0.1 --lcm off",
       {"--log", "--json", "--trajectory", "--html", "--contacts", "--trace-hash", "--checkpoint"},
       {"--resume"},
       {"my.yaml", "body.urdf", "body.tri", "rock.tri"}},
      {"check", "a.lcmlog", {"--repair"}, {}, {"a.lcmlog"}},
      {"render", "a.lcmlog --frame 0 --width 64 --height 64", {"--out"}, {}, {"a.lcmlog"}},
      {"view", "a.lcmlog", {"--html"}, {}, {"a.lcmlog"}},
      {"paper", "--frames 10", {"--json", "--out"}, {}},
      {"bench", "--avatars 20 --engines none --frames 1", {"--json", "--csv"}, {}},
      {"validate", "--only rimea_1", {"--json", "--out"}, {}},
      {"monitor", "a.lcmlog", {}, {}},
      {"info", "a.lcmlog", {}, {}},
      {"scenes", "", {}, {}},
      {"help", "", {}, {}},
  };
  return all;
}

constexpr const char* kScene = R"(
name: my
duration_s: 1
ground: {min_m: [-10, -10], max_m: [10, 10]}
groups:
  - {name: them, model: body.urdf, count: 4, spawn: {min_m: [-8, -8], max_m: [0, 0]}, goals: [{min_m: [2, 2], max_m: [5, 5]}]}
obstacles:
  - {name: rock, kind: mesh, file: rock.tri, position_m: [0, 8]}
)";

/// A tetrahedron.
constexpr const char* kTri = "4 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 2 1\n0 1 3\n0 3 2\n1 2 3\n";

constexpr const char* kUrdf = R"(<robot name="body"><link name="base"><collision><geometry>
<mesh filename="body.tri"/></geometry></collision></link></robot>)";

/// A folder with everything that the commands read, and how all of it was.
class Workplace {
 public:
  Workplace() {
    static const std::string log = [] {
      const ScratchFolder folder;
      shell("throng run corridor --avatars 4 --seconds 0.1 --lcm off --log a.lcmlog", folder);
      return read_file(folder / "a.lcmlog");
    }();
    write_file(folder_ / "a.lcmlog", log);
    write_file(folder_ / "my.yaml", kScene);
    write_file(folder_ / "body.urdf", kUrdf);
    write_file(folder_ / "body.tri", kTri);
    write_file(folder_ / "rock.tri", kTri);
  }

  const ScratchFolder& folder() const { return folder_; }
  fs::path operator/(const std::string& name) const { return folder_ / name; }

  /// Remembers names, contents and times of all that is there.
  void look() { seen_ = state(); }
  void expect_untouched() const { EXPECT_EQ(state(), seen_); }

 private:
  std::map<std::string, std::string> state() const {
    std::map<std::string, std::string> all;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_.path())) {
      struct stat status {};
      ::lstat(entry.path().c_str(), &status);
      std::string text = fmt::format("inode {} mode {:o}", status.st_ino, status.st_mode);
      // Reading changes neither; a folder's time may change when a file is tried out in it.
      if (entry.is_regular_file())
        text += fmt::format(" {}.{:09} {}", status.st_mtim.tv_sec, status.st_mtim.tv_nsec,
                            std::hash<std::string>()(read_file(entry.path())));
      all[entry.path().lexically_relative(folder_.path()).string()] = text;
    }
    return all;
  }

  ScratchFolder folder_;
  std::map<std::string, std::string> seen_;
};

/// What a file's name has to end in.
std::string ending_of(const CommandLine& command, const std::string& option) {
  if (command.command == "render") return ".png";
  return option == "--trajectory" ? ".csv" : "";
}

constexpr const char* kTwice = "of its own, found ";

/// What was said of the scene before the run was refused is no error.
std::string without_notes(const std::string& text) {
  return std::regex_replace(text, std::regex("note: [^\\n]*\\n"), "");
}

/// Refused in one line with these words, before anything has changed.
void expect_refused(Workplace& place, const std::string& line, const std::string& said,
                    int exit_code = 2) {
  SCOPED_TRACE(line);
  place.look();
  const Outcome outcome = shell(line, place.folder());
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_EQ(line_count(without_notes(outcome.err)), 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(said));
  place.expect_untouched();
}

TEST(OutputPlan, KnowsEveryOptionOfEveryCommandThatNamesAFile) {
  const ScratchFolder folder;
  std::vector<std::string> known;
  for (const CommandLine& command : commands()) {
    const std::string help = shell("throng " + command.command + " --help", folder).out;
    std::vector<std::string> told, expected = command.outputs;
    const std::regex option("^ +(?:-\\w,)?(--[a-z-]+) (?:FILE|DIR)\\b");
    std::istringstream lines(help);
    std::smatch match;
    for (std::string line; std::getline(lines, line);)
      if (std::regex_search(line, match, option)) told.push_back(match[1]);
    expected.insert(expected.end(), command.inputs.begin(), command.inputs.end());
    EXPECT_THAT(told, testing::UnorderedElementsAreArray(expected)) << command.command;
    known.push_back(command.command);
  }
  const std::string help = shell("throng --help", folder).out;
  std::istringstream lines(help.substr(help.find("Subcommands:")));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && line.starts_with("  "))
    EXPECT_THAT(known, testing::Contains(line.substr(2, line.find(' ', 2) - 2)));
}

/// What the second of two names may look like while it means the same file.
struct Alias {
  const char* how;
  const char* second;  ///< the first one is "x.csv", which --trajectory takes, too
  const char* prepare;
};
constexpr Alias kAliases[] = {
    {"the same name", "x.csv", "true"},
    {"the same name of a file that is there", "x.csv", "echo old >x.csv"},
    {"a dot", "./x.csv", "true"},
    {"a way round", "sub/../x.csv", "mkdir sub"},
    {"an absolute path", "$PWD/x.csv", "echo old >x.csv"},
    {"a symbolic link", "y.csv", "echo old >x.csv; ln -s x.csv y.csv"},
    {"a symbolic link to what is not there yet", "y.csv", "ln -s x.csv y.csv"},
    {"a linked folder", "sub/x.csv", "ln -s . sub"},
    {"a hard link", "y.csv", "echo old >x.csv; ln x.csv y.csv"},
    {"a pipe", "x.csv", "mkfifo x.csv"},
};

TEST(OutputPlan, NoTwoOutputsAreOneFile) {
  int tried = 0;
  for (const CommandLine& command : commands())
    for (size_t i = 0; i < command.outputs.size(); ++i)
      for (size_t j = i; j < command.outputs.size(); ++j) {
        const std::string &first = command.outputs[i], &second = command.outputs[j];
        if (i == j && first != "--trajectory") continue;  // which alone may come more than once
        for (const Alias& alias : kAliases) {
          SCOPED_TRACE(alias.how);
          Workplace place;
          shell(alias.prepare, place.folder());
          const std::string line = "throng " + command.command + " " + command.line;
          expect_refused(place, fmt::format("{} {} x.csv {} {}", line, first, second, alias.second),
                         kTwice);
          if (&alias == kAliases)
            expect_refused(
                place, fmt::format("{} {} x.csv {} {}", line, second, first, alias.second), kTwice);
          ++tried;
        }
      }
  EXPECT_GE(tried, 250);
}

TEST(OutputPlan, NoOutputIsWhatIsRead) {
  for (const CommandLine& command : commands())
    for (const std::string& option : command.outputs)
      for (const std::string& file : command.read) {
        const std::string name = fmt::format("link{}", ending_of(command, option));
        const char* said = option == "--contacts" ? "a file of that name" : kTwice;
        Workplace place;
        fs::create_symlink(file, place / name);
        expect_refused(
            place, fmt::format("throng {} {} {} {}", command.command, command.line, option, name),
            said);
        if (ending_of(command, option).empty())
          expect_refused(
              place, fmt::format("throng {} {} {} {}", command.command, command.line, option, file),
              said);
      }
  // A folder's files are outputs, too.
  Workplace place;
  shell("mkdir c; ln my.yaml c/pairs.csv", place.folder());
  expect_refused(place, "throng run my.yaml --lcm off --log off --contacts c", "my.yaml");
}

TEST(OutputPlan, TheCheckpointThatIsReadIsWrittenByItsOwnRunOnly) {
  Workplace place;
  shell("throng run my.yaml --seconds 0.1 --lcm off --log off --checkpoint c.csv --every 0.05",
        place.folder());
  const std::string resumed = "throng run my.yaml --seconds 0.2 --lcm off --resume c.csv ";
  for (const std::string& option : commands()[0].outputs) {
    if (option == "--checkpoint") continue;
    expect_refused(place, resumed + option + " c.csv", kTwice);
    expect_refused(place, resumed + "--checkpoint c.csv " + option + " c.csv", kTwice);
  }
  EXPECT_EQ(shell(resumed + "--log off --checkpoint c.csv --every 0.05", place.folder()).exit_code,
            0);
}

TEST(OutputPlan, AFolderIsNoFileAndAFileNoFolder) {
  for (const CommandLine& command : commands())
    for (const std::string& option : command.outputs) {
      Workplace place;
      const bool is_folder =
          option == "--contacts" || (option == "--out" && command.command != "render");
      const std::string name = fmt::format("x{}", ending_of(command, option));
      shell(is_folder ? fmt::format("echo old >{}", name)
                      : fmt::format("mkdir {0}; echo old >{0}/old", name),
            place.folder());
      expect_refused(place,
                     fmt::format("throng {} {} {} {}", command.command, command.line, option, name),
                     "of that name");
    }
}

TEST(OutputPlan, AFolderThatIsMissingIsToldBeforeTheWork) {
  for (const CommandLine& command : commands())
    for (const std::string& option : command.outputs) {
      if (option == "--contacts" || (option == "--out" && command.command != "render")) continue;
      Workplace place;
      expect_refused(place,
                     fmt::format("throng {} {} {} no/x{}", command.command, command.line, option,
                                 ending_of(command, option)),
                     "the folder no does not exist", 3);
    }
}

TEST(OutputPlan, WhatAFolderIsFilledWithIsNoOtherOutput) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --log off --contacts c ";
  for (const char* name : {"contacts.csv", "pairs.csv", "contact_parts.svg", "../c/people.csv"})
    expect_refused(place, run + "--json c/" + name, kTwice);
  expect_refused(place, "throng paper --out c --json c/figure_1.svg", kTwice);
  const Outcome beside = shell(run + "--json c/run.json", place.folder());
  EXPECT_EQ(beside.exit_code, 0) << beside.err;
  EXPECT_THAT(read_file(place / "c/run.json"), HasSubstr("\"hash\""));
  expect_refused(place, run + "--trajectory t.sqlite --json t.sqlite-journal", kTwice);
}

TEST(OutputPlan, TheFileOfTheStandardOutputIsNoOtherOutput) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --log off --json ";
  const Outcome same = shell(run + "x.json >x.json", place.folder());
  EXPECT_EQ(same.exit_code, 2);
  EXPECT_THAT(same.err, HasSubstr("the file of the standard output"));
  EXPECT_EQ(shell(run + "x.json >y.txt", place.folder()).exit_code, 0);
}

TEST(OutputPlan, ManyMayBeThrownAway) {
  Workplace place;
  const Outcome outcome = shell(
      "throng run my.yaml --seconds 0.1 --lcm off --log /dev/null --json /dev/null "
      "--trace-hash /dev/null --checkpoint /dev/null --html /dev/null",
      place.folder());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

/// All outputs of a run, in a folder where all of them are there already.
constexpr const char* kAllOutputs =
    " --log x.lcmlog --json x.json --trajectory x.csv --trajectory x.sqlite --html "
    "x.html "
    "--contacts c --trace-hash x.txt --checkpoint x.checkpoint";

TEST(OutputPlan, ARefusedRunLeavesEverythingAsItWas) {
  Workplace place;
  ASSERT_EQ(
      shell(std::string("throng run my.yaml --lcm off --seconds 0.1 --every 0.05") + kAllOutputs,
            place.folder())
          .exit_code,
      0);
  shell("mkdir out; echo old >out/my.lcmlog; echo old >out/my_resumed.lcmlog", place.folder());
  write_file(place / "bad.yaml", "name: bad\nground: 1\n");
  std::string broken = kScene;
  broken.replace(broken.find("body.urdf"), 9, "missing.urdf");
  write_file(place / "no_model.yaml", broken);
  write_file(place / "damaged", "THRONGCP and then nothing");
  const std::pair<const char*, const char*> refused[] = {
      {"bad.yaml", "bad.yaml:2"},
      {"no_model.yaml", "missing.urdf"},
      {"missing.yaml", "missing.yaml"},
      {"my.yaml --resume missing", "missing: expected a checkpoint"},
      {"my.yaml --resume damaged", "damaged: expected"},
      {"my.yaml --resume my.yaml", "a checkpoint of Throng"},
      {"my.yaml --seed 5 --resume x.checkpoint", "a checkpoint of this run"},
      {"my.yaml --resume x.checkpoint --seconds 0.001", "more --seconds"},
      {"my.yaml --avatars 0", "--avatars"},
      {"my.yaml --nonsense", "--nonsense"}};
  for (const auto& [line, said] : refused) {
    expect_refused(place, std::string("throng run --lcm off ") + line + kAllOutputs, said);
    expect_refused(place, std::string("throng run --lcm off --json x.json ") + line, said);
  }
  expect_refused(place, "throng render a.lcmlog --frame 999 --out x.png", "expected frame 999");
  expect_refused(place, "throng render bad.yaml --frame 0 --out x.png", "bad.yaml");
  expect_refused(place, "throng view bad.yaml --html x.html", "bad.yaml");
  expect_refused(place, "throng check bad.yaml --repair x.lcmlog", "bad.yaml");
}

TEST(OutputPlan, OneOutputThatCannotBeLeavesTheOthersAsTheyWere) {
  Workplace place;
  ASSERT_EQ(
      shell(std::string("throng run my.yaml --lcm off --seconds 0.1 --every 0.05") + kAllOutputs,
            place.folder())
          .exit_code,
      0);
  // Found out by trying only: there is no name as long.
  const std::string long_name = std::string(300, 'x');
  for (const std::string& option : commands()[0].outputs) {
    const std::string last = option == "--trajectory" ? long_name + ".csv" : long_name;
    std::string line = std::string("throng run my.yaml --lcm off --seconds 0.1") + kAllOutputs;
    if (option != "--trajectory") line = std::regex_replace(line, std::regex(option + " \\S+"), "");
    expect_refused(place, line + " " + option + " " + last, "File name too long", 3);
  }
}

TEST(OutputPlan, AWriterThatCannotOpenItsFileLeavesTheOlderLog) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --trajectory x.sqlite";
  for (int round = 0; round < 2; ++round)
    ASSERT_EQ(shell(run + " --seed " + std::to_string(round), place.folder()).exit_code, 0);
  place.look();
  // Another program reads the trajectory, and has it locked.
  const Outcome outcome = shell(
      "python3 -c 'import fcntl, sys, time; f = open(\"x.sqlite\", \"r+b\"); fcntl.lockf(f, "
      "fcntl.LOCK_EX); print(\"locked\", flush=True); time.sleep(60)' >locked & holder=$!\n"
      "while ! [ -s locked ]; do sleep 0.05; done\nrm locked\n" +
          run + " --seed 9; code=$?\nkill $holder\nexit $code",
      place.folder());
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("another program has it open"));
  place.expect_untouched();
}

TEST(OutputPlan, AFolderThatIsMadeOnTheWayHidesNothing) {
  Workplace place;
  shell("mkdir c; cp my.yaml body.urdf body.tri rock.tri c; mv c/my.yaml c/contacts.csv",
        place.folder());
  expect_refused(place, "throng run c/contacts.csv --lcm off --log off --contacts c/new/..",
                 "would be written over");
  expect_refused(place,
                 "throng run my.yaml --lcm off --log off --contacts c --json c/new/../pairs.csv",
                 kTwice);
  expect_refused(place, "throng run my.yaml --lcm off --log no/../my.yaml", kTwice);
}

TEST(OutputPlan, AResultPipedAwayIsNoOtherOutput) {
  Workplace place;
  place.look();
  const Outcome outcome =
      shell("throng run my.yaml --lcm off --log /dev/stdout | cat >/dev/null", place.folder());
  EXPECT_THAT(outcome.err, HasSubstr("the file of the standard output"));
  place.expect_untouched();
}

TEST(OutputPlan, NothingSoundIsNothingToRepair) {
  Workplace place;
  write_file(place / "short", "hi\n");
  write_file(place / "empty_inside", std::string("\xed\xa1\xda\x01", 4));
  for (const char* log : {"short", "empty_inside"})
    expect_refused(place, fmt::format("throng check {} --repair a.lcmlog", log), log);
}

TEST(OutputPlan, AnOptionThatNamesNothingIsRefused) {
  Workplace place;
  for (const CommandLine& command : commands())
    for (const std::vector<std::string>& options : {command.outputs, command.inputs})
      for (const std::string& option : options) {
        const std::string line =
            fmt::format("throng {} {} {} ", command.command, command.line, option);
        if (ending_of(command, option).empty()) expect_refused(place, line + "''", "found none");
        if (option != "--json" && ending_of(command, option).empty())
          expect_refused(place, line + "-", "only --json writes to the standard output");
      }
}

TEST(OutputPlan, TheNetworkIsNoFile) {
  Workplace place;
  expect_refused(place, "throng run my.yaml --log off --lcm 'file://my.yaml?mode=w'",
                 "--log FILE writes a log");
  expect_refused(place, "throng monitor --once --lcm 'file://my.yaml?mode=w'", "a network");
  expect_refused(place, "LCM_DEFAULT_URL='file://my.yaml?mode=w' throng monitor --once --lcm ''",
                 "found ");
}

TEST(OutputPlan, ANewResultThatIsNotWholeLeavesTheOldOne) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --log off ";
  ASSERT_EQ(shell(run + "--json x.json --html x.html", place.folder()).exit_code, 0);
  for (const char* option : {"--json x.json", "--html x.html"}) {
    place.look();
    const Outcome outcome = shell(std::string("ulimit -f 1; ") + run + option, place.folder());
    EXPECT_EQ(outcome.exit_code, 3) << option << outcome.err;
    place.expect_untouched();
  }
}

TEST(OutputPlan, AnOutputKeepsItsModeAndItsLink) {
  Workplace place;
  shell("mkdir far; echo old >far/x.json; chmod 640 far/x.json; ln -s far/x.json x.json",
        place.folder());
  EXPECT_EQ(
      shell("throng run my.yaml --seconds 0.1 --lcm off --log off --json x.json", place.folder())
          .exit_code,
      0);
  EXPECT_TRUE(fs::is_symlink(place / "x.json"));
  EXPECT_THAT(read_file(place / "far/x.json"), HasSubstr("\"hash\""));
  EXPECT_EQ(fs::status(place / "far/x.json").permissions(), static_cast<fs::perms>(0640));
}

TEST(OlderLog, OfANameThatNobodyChoseIsKept) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --seed ";
  const Outcome first = shell(run + "1", place.folder());
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_THAT(first.err, Not(HasSubstr("kept")));
  const std::string one = read_file(place / "out/my.lcmlog");
  const Outcome second = shell(run + "2", place.folder());
  EXPECT_THAT(second.err, testing::ContainsRegex("note: out/my.lcmlog of [-0-9]+ [:0-9]+, [.0-9]+ "
                                                 "[kM]B, is kept as out/my.previous.lcmlog\n"));
  EXPECT_EQ(line_count(second.err), line_count(first.err) + 1) << second.err;
  EXPECT_EQ(read_file(place / "out/my.previous.lcmlog"), one);
  const std::string two = read_file(place / "out/my.lcmlog");
  EXPECT_NE(two, one);
  EXPECT_THAT(shell(run + "3", place.folder()).err, HasSubstr("in place of that of"));
  EXPECT_EQ(read_file(place / "out/my.previous.lcmlog"), two);
  expect_refused(place, run + "4 --json out/my.previous.lcmlog", kTwice);
  expect_refused(place, run + "4 --json out/my.lcmlog", kTwice);
}

TEST(OlderLog, OfANamedFileIsReplacedInSoManyWords) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --log x.lcmlog";
  const Outcome first = shell(run, place.folder());
  EXPECT_THAT(first.err, Not(HasSubstr("replaced")));
  const Outcome second = shell(run, place.folder());
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_THAT(second.err, testing::ContainsRegex(
                              "note: x.lcmlog of [-0-9]+ [:0-9]+, [.0-9]+ [kM]B, is replaced\n"));
}

TEST(TwoRuns, OnOneOutputAreOneAndTheSecondIsRefused) {
  for (const char* outputs :
       {"", "--log x.lcmlog", "--log off --trajectory x.csv", "--log off --trajectory x.sqlite",
        "--log off --contacts c", "--log off --trace-hash x"}) {
    SCOPED_TRACE(outputs);
    Workplace place;
    // The first one waits, after 0.5 s of its time, until the second one has come and gone.
    const Outcome outcome = shell(
        fmt::format("throng run my.yaml --seconds 3 --pace 1 --lcm off {0} >first.txt 2>&1 &\n"
                    "first=$!\nsleep 0.7\n"
                    "throng run my.yaml --seconds 3 --lcm off {0} && second=0 || second=$?\n"
                    "kill -0 $first || echo the first one was over >&2\n"
                    "wait $first\nexit $second",
                    outputs),
        place.folder());
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("another run of throng is writing it; choose another name"));
    EXPECT_EQ(line_count(without_notes(outcome.err)), 1) << outcome.err;
    EXPECT_THAT(read_file(place / "first.txt"), HasSubstr("hash"));
    if (std::string(outputs).find("off") != std::string::npos) continue;
    const std::string log = std::string(outputs).empty() ? "out/my.lcmlog" : "x.lcmlog";
    EXPECT_THAT(shell("throng check " + log, place.folder()).out,
                testing::StartsWith(log + ": sound\n"));
    EXPECT_FALSE(fs::exists(place / "out/my.previous.lcmlog"));
  }
}

}  // namespace
}  // namespace throng
