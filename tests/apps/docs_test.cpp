// The documents show working commands, link to existing files, and their reference pages are
// generated.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/apps/cli.h"
#include "tests/nightly.h"

namespace throng::docs_test {
namespace {

namespace fs = std::filesystem;

/// A fenced block of a document. "```sh run" is run; "```sh recordings" only if THRONG_RECORDINGS
/// names a folder of recordings. "```yaml NAME", "```python NAME" and "```xml NAME" are files for
/// later commands of the document.
struct Block {
  int line = 0;
  std::string info;
  std::string text;
};

std::vector<Block> blocks_of(const std::string& document) {
  std::vector<Block> blocks;
  std::istringstream in(document);
  std::string line;
  bool inside = false;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (inside) blocks.push_back({number, line.substr(3), ""});
    } else if (inside) {
      blocks.back().text += line + "\n";
    }
  }
  return blocks;
}

std::vector<fs::path> documents() {
  const fs::path top(THRONG_SOURCE_DIR);
  std::vector<fs::path> found = {top / "README.md"};
  for (const fs::directory_entry& entry : fs::directory_iterator(top / "docs"))
    if (entry.path().extension() == ".md") found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

/// Runs the blocks of a kind in a folder with the document's files; returns their number.
int run_blocks(const std::string& kind) {
  int commands = 0;
  for (const fs::path& document : documents()) {
    const ScratchFolder folder;
    const fs::path scenes = fs::path(THRONG_SOURCE_DIR) / "docs/recordings";
    if (document.stem() == scenes.filename()) {
      fs::create_directories(folder / "docs/recordings");
      fs::copy(scenes, folder / "docs/recordings");
    }
    for (const Block& block : blocks_of(read_file(document))) {
      for (const std::string file : {"yaml ", "python ", "xml "})
        if (block.info.starts_with(file))
          write_file(folder / block.info.substr(file.size()), block.text);
      if (block.info != kind) continue;
      ++commands;
      const Outcome outcome = shell(block.text, folder);
      EXPECT_EQ(outcome.exit_code, 0) << document.filename().string() << ":" << block.line << ":\n"
                                      << block.text << outcome.err;
    }
  }
  return commands;
}

TEST(Documents, ShowWorkingCommands) {
  if (!test::is_nightly()) GTEST_SKIP() << "takes a minute: set THRONG_NIGHTLY=1";
  EXPECT_GE(run_blocks("sh run"), 3);
}

TEST(Documents, ShowWorkingCommandsForRecordings) {
  if (std::getenv("THRONG_RECORDINGS") == nullptr)
    GTEST_SKIP()
        << "THRONG_RECORDINGS names no folder of recordings; docs/recordings.md lists their "
           "sources";
  EXPECT_GE(run_blocks("sh recordings"), 1);
}

TEST(Documents, ContainTheSchemaThatTheCommandPrints) {
  const ScratchFolder folder;
  const Outcome outcome = shell("throng scenes --schema", folder);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(outcome.out == read_file(fs::path(THRONG_SOURCE_DIR) / "scenes/scene.schema.json"))
      << "scripts/docs.sh --update rewrites scenes/scene.schema.json";
}

/// Anchors that a document's headings have on the usual sites: "## A scene, in short" is
/// "a-scene-in-short".
std::set<std::string> anchors_of(const fs::path& document) {
  std::set<std::string> anchors;
  std::istringstream in(read_file(document));
  bool inside = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) inside = !inside;
    const size_t begin = line.find_first_not_of('#');
    if (inside || begin == 0 || begin == std::string::npos || line[begin] != ' ') continue;
    std::string anchor;
    for (const char c : line.substr(begin + 1))
      if (c == ' ')
        anchor += '-';
      else if (const auto byte = static_cast<unsigned char>(c);
               std::isalnum(byte) != 0 || c == '-' || c == '_' || byte >= 128)
        anchor += static_cast<char>(std::tolower(byte));
    std::string unique = anchor;
    for (int i = 1; !anchors.insert(unique).second; ++i) unique = anchor + "-" + std::to_string(i);
  }
  return anchors;
}

TEST(Documents, LinksLeadToFiles) {
  const fs::path top(THRONG_SOURCE_DIR);
  std::vector<fs::path> linking = documents();
  linking.push_back(top / "CHANGELOG.md");
  for (const fs::directory_entry& entry : fs::directory_iterator(top / "docs/reference"))
    linking.push_back(entry.path());
  int links = 0;
  for (const fs::path& document : linking) {
    const std::string text = read_file(document);
    for (size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at + 1)) {
      const std::string link = text.substr(at + 2, text.find(')', at) - at - 2);
      if (link.starts_with("http")) continue;
      ++links;
      const size_t hash = link.find('#');
      const fs::path file = hash == 0 ? document : document.parent_path() / link.substr(0, hash);
      const bool exists = fs::exists(file);
      EXPECT_TRUE(exists) << document.filename().string() << " points to " << link;
      const bool has_anchor = exists && hash != std::string::npos && file.extension() == ".md";
      EXPECT_TRUE(!has_anchor || anchors_of(file).contains(link.substr(hash + 1)))
          << document.filename().string() << " points to " << link << ", a missing heading";
    }
  }
  EXPECT_GT(links, 100) << "the test no longer finds the links";
}

TEST(Documents, ReferencePagesAreGenerated) {
  const ScratchFolder folder;
  const Outcome outcome =
      shell("PYTHONDONTWRITEBYTECODE=1 python3 " + repository("scripts/reference.py") +
                " --throng \"$(command -v throng)\" --out pages",
            folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / "pages")) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), folder / "pages").string();
    names.insert(name);
    const fs::path page = fs::path(THRONG_SOURCE_DIR) / "docs" / name;
    ASSERT_TRUE(fs::exists(page)) << name;
    EXPECT_TRUE(read_file(entry.path()) == read_file(page))
        << "docs/" << name << " differs; scripts/docs.sh --update rewrites it";
  }
  EXPECT_EQ(names.size(), 8u);
  for (const fs::directory_entry& entry :
       fs::directory_iterator(fs::path(THRONG_SOURCE_DIR) / "docs/reference"))
    EXPECT_TRUE(names.contains("reference/" + entry.path().filename().string())) << entry.path();
}

}  // namespace
}  // namespace throng::docs_test
