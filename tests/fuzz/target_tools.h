// Tools of fuzz targets: promises, files of any bytes, checks of errors.
// Invariant: files lie in memory if the machine has such a folder, and are removed.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

#include "base/errors.h"
#include "tests/fuzz/targets.h"

namespace throng::fuzz {

inline void promise(bool is_kept, const char* what) {
  if (!is_kept) throw BrokenPromise(what);
}

/// A file of this process, in memory if the machine has such a folder.
inline const std::filesystem::path& scratch(const char* name) {
  static const std::filesystem::path folder = std::filesystem::is_directory("/dev/shm")
                                                  ? std::filesystem::path("/dev/shm")
                                                  : std::filesystem::temp_directory_path();
  static std::filesystem::path file;
  file = folder / ("throng_fuzz_" + std::to_string(::getpid()) + name);
  return file;
}

class File {
 public:
  File(const char* name, std::span<const uint8_t> bytes) : path_(scratch(name)) {
    std::ofstream out(path_, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  }
  explicit File(const char* name) : path_(scratch(name)) {}
  ~File() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string text_of(std::span<const uint8_t> input) { return {input.begin(), input.end()}; }

/// Checks the form "where: expected ..., found ...", on one line.
inline void expect_words(const InputError& error) {
  const std::string_view message = error.what();
  promise(message.find("expected") != message.npos, "an error that states the expectation");
  promise(message.find('\n') == message.npos, "an error on one line");
}

}  // namespace throng::fuzz
