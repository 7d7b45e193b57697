// Every command that the documents mark as runnable works.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
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

TEST(Documents, LinkToExistingFiles) {
  const fs::path top(THRONG_SOURCE_DIR);
  for (const fs::path& document : documents()) {
    const std::string text = read_file(document);
    for (size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at + 1)) {
      const std::string link = text.substr(at + 2, text.find(')', at) - at - 2);
      if (link.starts_with("http")) continue;
      const std::string file = link.substr(0, link.find('#'));
      EXPECT_TRUE(fs::exists(document.parent_path() / file))
          << document.filename().string() << " points to " << link;
    }
  }
}

}  // namespace
}  // namespace throng::docs_test
