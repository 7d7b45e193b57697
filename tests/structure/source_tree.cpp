#include "tests/structure/source_tree.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRoots[] = {
    "base",   "kinematics", "culling",  "avatars",  "geometry", "recordings", "crowd",
    "scenes", "lcm_io",     "lcmtypes", "analysis", "apps",     "viewer",     "python",
    "bench",  "examples",   "tests",    "scripts",  "docs",     "cmake",      ".ci"};
const std::set<std::string_view> kTextExtensions = {
    ".cpp", ".h",  ".lcm",  ".cmake", ".txt",  ".sh", ".yaml", ".yml", ".urdf", ".md",
    ".js",  ".ts", ".html", ".css",   ".json", ".py", ".pyi",  ".gp",  ""};

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool is_text(const fs::path& file) {
  // Fixtures are test inputs, valid and invalid.
  for (const fs::path& part : file)
    if (part == "fixtures" || part == "node_modules") return false;
  return kTextExtensions.contains(file.extension().string());
}

}  // namespace

std::string SourceFile::folder() const {
  const size_t begin = is_test() ? std::string("tests/").size() : 0;
  const size_t end = path.find('/', begin);
  return end == std::string::npos ? "" : path.substr(begin, end - begin);
}

bool SourceFile::has_extension(const std::set<std::string_view>& extensions) const {
  return extensions.contains(fs::path(path).extension().string());
}

std::vector<SourceFile> read_source_tree() {
  const fs::path top(THRONG_SOURCE_DIR);
  std::vector<SourceFile> files;
  for (const std::string_view root : kRoots) {
    if (!fs::is_directory(top / root)) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(top / root)) {
      const fs::path path = fs::relative(entry.path(), top);
      if (entry.is_regular_file() && is_text(path))
        files.push_back({path.generic_string(), read(entry.path())});
    }
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(top))
    // In a git worktree .git is a file.
    if (entry.is_regular_file() && is_text(entry.path().filename()) &&
        entry.path().filename() != ".git")
      files.push_back({entry.path().filename().string(), read(entry.path())});
  std::sort(files.begin(), files.end(),
            [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
  if (files.empty()) throw std::runtime_error("no sources under " THRONG_SOURCE_DIR);
  return files;
}

std::vector<Line> lines_of(const SourceFile& file) {
  std::vector<Line> lines;
  const std::string_view text = file.text;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back({static_cast<int>(lines.size()) + 1, text.substr(begin, end - begin)});
    begin = end + 1;
  }
  return lines;
}

std::vector<Include> includes_of(const SourceFile& file) {
  constexpr std::string_view kDirective = "#include ";
  std::vector<Include> includes;
  for (const Line& line : lines_of(file)) {
    if (!line.text.starts_with(kDirective)) continue;
    const std::string_view rest = line.text.substr(kDirective.size());
    const bool angled = rest.starts_with('<');
    const size_t end = rest.find(angled ? '>' : '"', 1);
    if (end == std::string_view::npos) continue;  // included by a macro
    includes.push_back({line.number, std::string(rest.substr(1, end - 1)), angled});
  }
  return includes;
}

}  // namespace throng
