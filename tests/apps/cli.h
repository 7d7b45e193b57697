// shell() runs the built programs as a user does: a command, a folder, its output.
// Invariant: nothing is linked from the programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace throng {

/// A temporary folder, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

struct Outcome {
  int exit_code = -1;  ///< 128 + signal if one ended it
  std::string out;
  std::string err;
};

/// Runs a line of POSIX sh in a folder, without a terminal or input; PATH holds `throng` and
/// `hello`.
Outcome shell(const std::string& line, const ScratchFolder& folder);

/// Returns the whole file; throws if it cannot be read.
std::string read_file(const std::filesystem::path& file);
void write_file(const std::filesystem::path& file, const std::string& text);

/// A path inside the repository, quoted for sh.
std::string repository(const std::string& path);

int line_count(const std::string& text);

}  // namespace throng
