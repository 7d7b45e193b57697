// docs/reference/lcm.md lists every message type with every field.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "synthetic_run.h"

namespace throng::docs_test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  const auto bytes = bytes_of(file);
  return {bytes.begin(), bytes.end()};
}

std::vector<std::string> fields_of(const fs::path& file) {
  static const std::regex field(R"(^\s+\w+\s+(\w+)(\[\w+\])?;)");
  std::vector<std::string> fields;
  std::istringstream in(text_of(file));
  std::smatch match;
  for (std::string line; std::getline(in, line);)
    if (std::regex_search(line, match, field)) fields.push_back(match[1]);
  return fields;
}

std::string section(const std::string& document, const std::string& heading) {
  const size_t start = document.find("\n" + heading + "\n");
  if (start == std::string::npos) return "";
  const size_t end = document.find("\n#", start + heading.size() + 2);
  return document.substr(start, end - start);
}

TEST(Documentation, ListsEveryTypeWithEveryField) {
  const fs::path top(THRONG_SOURCE_DIR);
  const std::string document = text_of(top / "docs/reference/lcm.md");
  const std::string common = section(document, "## Common fields");
  ASSERT_FALSE(common.empty());
  int types = 0, fields = 0;
  for (const auto& entry : fs::directory_iterator(top / "lcmtypes")) {
    if (entry.path().extension() != ".lcm") continue;
    ++types;
    const std::string name = entry.path().stem().string();
    const std::string own = section(document, "### " + name);
    EXPECT_FALSE(own.empty()) << "no section '### " << name << "'";
    const bool is_message = text_of(entry.path()).find("int64_t instance;") != std::string::npos;
    for (const std::string& field : fields_of(entry.path())) {
      ++fields;
      const bool is_listed = own.find("`" + field + "`") != std::string::npos ||
                             (is_message && common.find("`" + field + "`") != std::string::npos);
      EXPECT_TRUE(is_listed) << name << ": field '" << field
                             << "' is missing in docs/reference/lcm.md";
    }
  }
  EXPECT_GT(types, 15);
  EXPECT_GT(fields, 150);
}

}  // namespace
}  // namespace throng::docs_test
