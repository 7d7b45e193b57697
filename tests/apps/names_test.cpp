// Names and paths with unusual bytes are rejected while loading, or written in readable form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/cli.h"

namespace throng::names_test {
namespace {

using testing::HasSubstr;

std::string scene_named(const std::string& name) {
  return "name: " + name +
         "\nground: {min_m: [-5, -5], max_m: [5, 5]}\n"
         "groups: [{count: 3, spawn: {min_m: [-4, -4], max_m: [0, 4]}, goals: [{min_m: [1, -4], "
         "max_m: [4, 4]}]}]\n";
}

TEST(Names, OfFilesMayBeAnyBytes) {
  const ScratchFolder folder;
  const std::string text = scene_named("x");
  write_file(folder / "odd\xff\x1b[31m.yaml", text.substr(text.find('\n') + 1));
  const Outcome run = shell(
      "throng run odd*.yaml --seconds 0.1 --lcm off --log \"$(printf 'log\\376.lcmlog')\" --json "
      "\"$(printf 'out\\377.json')\" --contacts \"$(printf 'c\\375')\" --trajectory t.sqlite",
      folder);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(read_file(folder / "out\xff.json"));
  EXPECT_EQ(json["scene"], "odd\\xff\\x1b[31m");
  const Outcome check = shell("throng check log*.lcmlog", folder);
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
}

TEST(Names, AreRejectedWithTheirLineIfUnprintable) {
  const ScratchFolder folder;
  const std::pair<const char*, const char*> cases[] = {
      {"\"a\\0b\"", "s.yaml:1: expected text without control characters, found 'a\\x00b'"},
      {"\"\\e[31m\"", "s.yaml:1: expected text without control characters, found '\\x1b[31m'"},
      {"\"a\\nb\"",
       "s.yaml:1: expected a name of 1 to 120 printable bytes for 'name', found one "
       "with a control character: 'a\\x0ab'"},
      {"a\xff", "s.yaml:1: expected text in UTF-8, found '\\xff'"}};
  for (const auto& [name, rejection] : cases) {
    write_file(folder / "s.yaml", scene_named(name));
    const Outcome run =
        shell("throng run s.yaml --seconds 0.1 --lcm off --log s.lcmlog --json s.json", folder);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr(rejection));
    EXPECT_FALSE(std::filesystem::exists(folder / "s.lcmlog"));
  }
  const std::string text = scene_named("x");
  write_file(folder / "s.yaml", scene_named("\"caf\xc3\xa9 \\\" \\\\ \xe6\x97\xa5\""));
  const Outcome run =
      shell("throng run s.yaml --seconds 0.1 --lcm off --log s.lcmlog --json s.json", folder);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(read_file(folder / "s.json"))["scene"],
            "caf\xc3\xa9 \" \\ \xe6\x97\xa5");
}

}  // namespace
}  // namespace throng::names_test
