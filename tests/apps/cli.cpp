#include "tests/apps/cli.h"

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace throng {

namespace fs = std::filesystem;
namespace {

/// Folder of the tested command: $THRONG_TESTED of an installed package, otherwise the build.
std::string programs() {
  const char* installed = std::getenv("THRONG_TESTED");
  return installed == nullptr ? THRONG_BINARY_DIR
                              : installed + std::string("':'") + THRONG_BINARY_DIR;
}

}  // namespace

ScratchFolder::ScratchFolder() {
  std::string name = (fs::temp_directory_path() / "throng-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create " + name);
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

Outcome shell(const std::string& line, const ScratchFolder& folder) {
  const ScratchFolder streams;
  write_file(streams / "script", line + "\n");
  const std::string command = "cd '" + folder.path().string() + "' && PATH='" + programs() +
                              "':\"$PATH\" sh -eu '" + (streams / "script").string() + "' >'" +
                              (streams / "out").string() + "' 2>'" + (streams / "err").string() +
                              "' </dev/null";
  const int status = std::system(command.c_str());
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_file(streams / "out");
  outcome.err = read_file(streams / "err");
  return outcome;
}

std::string read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_file(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

std::string repository(const std::string& path) { return "'" THRONG_SOURCE_DIR "/" + path + "'"; }

int line_count(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace throng
