// No command overwrites an input or another of its outputs, and none overwrites any file before it
// has checked everything.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/apps/workplace.h"
#include "tests/nightly.h"

namespace throng::output_plan_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct CommandLine {
  std::string command;
  std::string line;  ///< arguments apart from outputs
  std::vector<std::string> outputs;
  std::vector<std::string> inputs;  ///< options of inputs; positional inputs are in `line`
  std::vector<std::string> read{};  ///< files of `line` that an output must not be
};

const std::vector<CommandLine>& commands() {
  static const std::vector<CommandLine> all = {
      {"run",
       "my.yaml --seconds 0.1 --lcm off",
       {"--log", "--json", "--trajectory", "--html", "--contacts", "--part-pairs", "--trace-hash",
        "--checkpoint", "--separation"},
       {"--resume"},
       {"my.yaml", "body.urdf", "body.tri", "rock.tri"}},
      {"check", "a.lcmlog", {"--repair"}, {}, {"a.lcmlog"}},
      {"render", "a.lcmlog --frame 0 --width 64 --height 64", {"--out"}, {}, {"a.lcmlog"}},
      {"view", "a.lcmlog", {"--html"}, {}, {"a.lcmlog"}},
      {"paper", "--frames 10", {"--json", "--out"}, {}},
      // --export and --check replace the measurement.
      {"bench",
       "--avatars 20 --engines none --frames 1",
       {"--json", "--csv"},
       {"--export", "--check"}},
      {"validate", "--only rimea_1", {"--json", "--out"}, {"--recordings"}},
      {"compare", "my.yaml my.yaml --seconds 0.1", {"--json", "--out"}, {}, {"my.yaml"}},
      {"export", "a.lcmlog", {"--mcap"}, {"--out"}, {"a.lcmlog"}},
      {"import", "room.wkt --unit m", {"--out"}, {}, {"room.wkt"}},
      {"study", "", {}, {"--out", "--merge"}},  // its table needs a certain ending
      {"monitor", "a.lcmlog", {}, {}},
      {"info", "my.yaml", {"--plan"}, {}, {"my.yaml"}},
      {"scenes", "", {}, {}},
      {"help", "", {}, {}},
  };
  return all;
}

std::string ending_of(const CommandLine& command, const std::string& option) {
  if (command.command == "render") return ".png";
  return option == "--trajectory" ? ".csv" : "";
}

bool is_always_folder(const std::string& option) {
  return option == "--contacts" || option == "--part-pairs" || option == "--separation";
}

bool is_out_folder(const CommandLine& command, const std::string& option) {
  return option == "--out" && command.command != "render" && command.command != "import";
}

TEST(OutputPlan, CoversEveryOptionThatNamesAFile) {
  const ScratchFolder folder;
  std::vector<std::string> known;
  for (const CommandLine& command : commands()) {
    const std::string help = shell("throng " + command.command + " --help", folder).out;
    std::vector<std::string> listed, expected = command.outputs;
    const std::regex option("^ +(?:-\\w,)?(--[a-z-]+) (?:FILE|DIR)\\b");
    std::istringstream lines(help);
    std::smatch match;
    for (std::string line; std::getline(lines, line);)
      if (std::regex_search(line, match, option)) listed.push_back(match[1]);
    expected.insert(expected.end(), command.inputs.begin(), command.inputs.end());
    EXPECT_THAT(listed, testing::UnorderedElementsAreArray(expected)) << command.command;
    known.push_back(command.command);
  }
  const std::string help = shell("throng --help", folder).out;
  std::istringstream lines(help.substr(help.find("Subcommands:")));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && line.starts_with("  "))
    EXPECT_THAT(known, testing::Contains(line.substr(2, line.find(' ', 2) - 2)));
}

/// Alternatives to name one file twice.
struct Alias {
  const char* how;
  const char* second;  ///< the first name is "x.csv", which --trajectory accepts
  const char* prepare;
};
constexpr Alias kAliases[] = {
    {"the same name", "x.csv", "true"},
    {"the same name of an existing file", "x.csv", "echo old >x.csv"},
    {"a dot", "./x.csv", "true"},
    {"a detour", "sub/../x.csv", "mkdir sub"},
    {"an absolute path", "$PWD/x.csv", "echo old >x.csv"},
    {"a symbolic link", "y.csv", "echo old >x.csv; ln -s x.csv y.csv"},
    {"a symbolic link to a missing file", "y.csv", "ln -s x.csv y.csv"},
    {"a linked folder", "sub/x.csv", "ln -s . sub"},
    {"a hard link", "y.csv", "echo old >x.csv; ln x.csv y.csv"},
    {"a pipe", "x.csv", "mkfifo x.csv"},
};

/// The check of names is the same for all options: with every change each pair of options is tried
/// with a part of the aliases in turn, and each alias with many pairs.
TEST(OutputPlan, RejectsTwoOutputsInOneFile) {
  constexpr size_t kAliasCount = std::size(kAliases);
  size_t tried = 0;
  for (const CommandLine& command : commands())
    for (size_t i = 0; i < command.outputs.size(); ++i)
      for (size_t j = i; j < command.outputs.size(); ++j) {
        const std::string &first = command.outputs[i], &second = command.outputs[j];
        if (i == j && first != "--trajectory") continue;  // the only repeatable one
        const std::string line = "throng " + command.command + " " + command.line;
        for (size_t k = 0; k < test::part_of(kAliasCount); ++k, ++tried) {
          const Alias& alias = kAliases[tried % kAliasCount];
          SCOPED_TRACE(alias.how);
          Workplace place;
          shell(alias.prepare, place.folder());
          expect_rejected(
              place, fmt::format("{} {} x.csv {} {}", line, first, second, alias.second), kTwice);
        }
        Workplace place;
        expect_rejected(place, fmt::format("{} {} x.csv {} x.csv", line, second, first), kTwice);
      }
  EXPECT_GE(tried, test::part_of(250u));
}

TEST(OutputPlan, RejectsOutputsThatAreInputs) {
  for (const CommandLine& command : commands())
    for (const std::string& option : command.outputs)
      for (const std::string& file : command.read) {
        const std::string name = fmt::format("link{}", ending_of(command, option));
        const bool is_folder =
            is_always_folder(option) || (command.command == "compare" && option == "--out");
        const char* said = is_folder ? "a file of that name" : kTwice;
        Workplace place;
        fs::create_symlink(file, place / name);
        expect_rejected(
            place, fmt::format("throng {} {} {} {}", command.command, command.line, option, name),
            said);
        if (ending_of(command, option).empty())
          expect_rejected(
              place, fmt::format("throng {} {} {} {}", command.command, command.line, option, file),
              said);
      }
  // The files of a folder are outputs as well.
  Workplace place;
  shell("mkdir c; ln my.yaml c/part_contacts.csv", place.folder());
  expect_rejected(place, "throng run my.yaml --lcm off --log off --contacts c", "my.yaml");
}

TEST(OutputPlan, LetsOnlyTheSameRunOverwriteItsCheckpoint) {
  Workplace place;
  shell(
      "throng run my.yaml --seconds 0.1 --lcm off --log off --checkpoint c.csv "
      "--checkpoint-every 0.05",
      place.folder());
  const std::string resumed = "throng run my.yaml --seconds 0.2 --lcm off --resume c.csv ";
  for (const std::string& option : commands()[0].outputs) {
    if (option == "--checkpoint") continue;
    expect_rejected(place, fmt::format("{}{} c.csv", resumed, option), kTwice);
    expect_rejected(place, fmt::format("{}--checkpoint c.csv {} c.csv", resumed, option), kTwice);
  }
  EXPECT_EQ(shell(resumed + "--log off --checkpoint c.csv --checkpoint-every 0.05", place.folder())
                .exit_code,
            0);
}

TEST(OutputPlan, DistinguishesFilesAndFolders) {
  for (const CommandLine& command : commands())
    for (const std::string& option : command.outputs) {
      Workplace place;
      const bool is_folder = is_always_folder(option) || is_out_folder(command, option);
      const std::string name = fmt::format("x{}", ending_of(command, option));
      shell(is_folder ? fmt::format("echo old >{}", name)
                      : fmt::format("mkdir {0}; echo old >{0}/old", name),
            place.folder());
      expect_rejected(
          place, fmt::format("throng {} {} {} {}", command.command, command.line, option, name),
          "of that name");
    }
}

TEST(OutputPlan, ReportsAMissingFolderBeforeTheWork) {
  for (const CommandLine& command : commands())
    for (const std::string& option : command.outputs) {
      if (is_always_folder(option) || is_out_folder(command, option)) continue;
      Workplace place;
      expect_rejected(place,
                      fmt::format("throng {} {} {} no/x{}", command.command, command.line, option,
                                  ending_of(command, option)),
                      "the folder no does not exist", 3);
    }
}

TEST(OutputPlan, RejectsOutputsAmongTheFilesOfAFolder) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --log off --contacts c ";
  for (const char* name :
       {"contacts.csv", "part_contacts.csv", "contact_parts.svg", "../c/people.csv"})
    expect_rejected(place, run + "--json c/" + name, kTwice);
  expect_rejected(place, "throng paper --out c --json c/figure_1.svg", kTwice);
  const Outcome separate = shell(run + "--json c/run.json", place.folder());
  EXPECT_EQ(separate.exit_code, 0) << separate.err;
  EXPECT_THAT(read_file(place / "c/run.json"), HasSubstr("\"hash\""));
  expect_rejected(place, run + "--trajectory t.sqlite --json t.sqlite-journal", kTwice);
}

TEST(OutputPlan, RejectsTheFileOfTheStandardOutput) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --log off --json ";
  const Outcome same = shell(run + "x.json >x.json", place.folder());
  EXPECT_EQ(same.exit_code, 2);
  EXPECT_THAT(same.err, HasSubstr("the file of the standard output"));
  EXPECT_EQ(shell(run + "x.json >y.txt", place.folder()).exit_code, 0);
}

TEST(OutputPlan, AllowsSeveralOutputsToTheNullDevice) {
  Workplace place;
  const Outcome outcome = shell(
      "throng run my.yaml --seconds 0.1 --lcm off --log /dev/null --json /dev/null "
      "--trace-hash /dev/null --checkpoint /dev/null --html /dev/null",
      place.folder());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

/// All outputs of a run, in a folder that has all of them.
constexpr const char* kAllOutputs =
    " --log x.lcmlog --json x.json --trajectory x.csv --trajectory x.sqlite --html "
    "x.html "
    "--contacts c --trace-hash x.txt --checkpoint x.checkpoint";

TEST(OutputPlan, LeavesAllFilesUnchangedIfARunIsRejected) {
  Workplace place;
  ASSERT_EQ(
      shell(std::string("throng run my.yaml --lcm off --seconds 0.1 --checkpoint-every 0.05") +
                kAllOutputs,
            place.folder())
          .exit_code,
      0);
  shell("mkdir out; echo old >out/my.lcmlog; echo old >out/my_resumed.lcmlog", place.folder());
  write_file(place / "bad.yaml", "name: bad\nground: 1\n");
  std::string broken = kScene;
  broken.replace(broken.find("body.urdf"), 9, "missing.urdf");
  write_file(place / "no_model.yaml", broken);
  write_file(place / "damaged", "THRONGCP and then nothing");
  const std::pair<const char*, const char*> rejected[] = {
      {"bad.yaml", "bad.yaml:2"},
      {"no_model.yaml", "missing.urdf"},
      {"missing.yaml", "missing.yaml"},
      {"my.yaml --resume missing", "missing: expected a checkpoint"},
      {"my.yaml --resume damaged", "damaged: expected"},
      {"my.yaml --resume my.yaml", "a checkpoint of Throng"},
      {"my.yaml --seed 5 --resume x.checkpoint", "a checkpoint of this run"},
      {"my.yaml --resume x.checkpoint --seconds 0.001", "increase --seconds"},
      {"my.yaml --avatars 0", "--avatars"},
      {"my.yaml --nonsense", "--nonsense"}};
  for (const auto& [line, said] : rejected) {
    expect_rejected(place, std::string("throng run --lcm off ") + line + kAllOutputs, said);
    expect_rejected(place, std::string("throng run --lcm off --json x.json ") + line, said);
  }
  expect_rejected(place, "throng render a.lcmlog --frame 999 --out x.png", "expected frame 999");
  expect_rejected(place, "throng render bad.yaml --frame 0 --out x.png", "bad.yaml");
  expect_rejected(place, "throng view bad.yaml --html x.html", "bad.yaml");
  expect_rejected(place, "throng check bad.yaml --repair x.lcmlog", "bad.yaml");
}

TEST(OutputPlan, LeavesOtherOutputsUnchangedIfOneFails) {
  Workplace place;
  ASSERT_EQ(
      shell(std::string("throng run my.yaml --lcm off --seconds 0.1 --checkpoint-every 0.05") +
                kAllOutputs,
            place.folder())
          .exit_code,
      0);
  // Only opening shows that the name is too long.
  const std::string long_name = std::string(300, 'x');
  for (const std::string& option : commands()[0].outputs) {
    const std::string last = option == "--trajectory" ? long_name + ".csv" : long_name;
    std::string line = std::string("throng run my.yaml --lcm off --seconds 0.1") + kAllOutputs;
    if (option != "--trajectory")
      line = std::regex_replace(line, std::regex(fmt::format("{} \\S+", option)), "");
    expect_rejected(place, fmt::format("{} {} {}", line, option, last), "File name too long", 3);
  }
}

TEST(OutputPlan, KeepsTheOlderLogIfAWriterFails) {
  Workplace place;
  const std::string run = "throng run my.yaml --seconds 0.1 --lcm off --trajectory x.sqlite";
  for (int round = 0; round < 2; ++round)
    ASSERT_EQ(shell(run + " --seed " + std::to_string(round), place.folder()).exit_code, 0);
  place.look();
  // Another program holds a lock on the trajectory.
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

TEST(OutputPlan, SeesThroughFoldersCreatedOnTheWay) {
  Workplace place;
  shell("mkdir c; cp my.yaml body.urdf body.tri rock.tri c; mv c/my.yaml c/contacts.csv",
        place.folder());
  expect_rejected(place, "throng run c/contacts.csv --lcm off --log off --contacts c/new/..",
                  "would overwrite");
  expect_rejected(place,
                  "throng run my.yaml --lcm off --log off --contacts c --json "
                  "c/new/../part_contacts.csv",
                  kTwice);
  expect_rejected(place, "throng run my.yaml --lcm off --log no/../my.yaml", "cannot write it", 3);
}

TEST(OutputPlan, AllowsAPipedStandardOutput) {
  Workplace place;
  place.look();
  const Outcome outcome =
      shell("throng run my.yaml --lcm off --log /dev/stdout | cat >/dev/null", place.folder());
  EXPECT_THAT(outcome.err, HasSubstr("the file of the standard output"));
  place.expect_untouched();
}

TEST(OutputPlan, RejectsARepairWithoutSoundMessages) {
  Workplace place;
  write_file(place / "short", "hi\n");
  write_file(place / "nothing_whole", std::string("\xed\xa1\xda\x01", 4));
  place.look();
  for (const std::string log : {"short", "nothing_whole"}) {
    const Outcome outcome = shell("throng check " + log + " --repair a.lcmlog", place.folder());
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(line_count(outcome.err), 1) << outcome.err;
    place.expect_untouched();
  }
}

TEST(OutputPlan, RejectsEmptyFileNames) {
  Workplace place;
  for (const CommandLine& command : commands())
    for (const std::vector<std::string>& options : {command.outputs, command.inputs})
      for (const std::string& option : options) {
        const std::string line =
            fmt::format("throng {} {} {} ", command.command, command.line, option);
        if (ending_of(command, option).empty()) expect_rejected(place, line + "''", "found none");
        if (option != "--json" && ending_of(command, option).empty())
          expect_rejected(place, line + "-", "only --json writes to stdout");
      }
}

TEST(OutputPlan, RejectsFilesAsLcmUrls) {
  Workplace place;
  expect_rejected(place, "throng run my.yaml --log off --lcm 'file://my.yaml?mode=w'",
                  "--log FILE writes a log");
  expect_rejected(place, "throng monitor --once --lcm 'file://my.yaml?mode=w'", "a network");
  expect_rejected(place, "LCM_DEFAULT_URL='file://my.yaml?mode=w' throng monitor --once --lcm ''",
                  "found ");
}

TEST(OutputPlan, KeepsTheOldResultUntilTheNewOneIsComplete) {
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

TEST(OutputPlan, KeepsModeAndLinkOfAnOutput) {
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

}  // namespace
}  // namespace throng::output_plan_test
