// An atomically written file has its old or its new content, even if an operation fails.
#include "base/files/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "base/errors.h"

namespace throng::atomic_file_test {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  AtomicFile() {
    std::string name = (fs::temp_directory_path() / "throng-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create " + name);
    folder_ = name;
    write("old");
  }
  ~AtomicFile() override { fs::remove_all(folder_); }

  void write(const std::string& text) const { std::ofstream(file()) << text; }
  fs::path file() const { return folder_ / "file"; }
  static std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::ptrdiff_t file_count() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }

  fs::path folder_;
};

/// Limits the size of files, as on a full disk.
class Limit {
 public:
  explicit Limit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit most{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &most);
  }
  ~Limit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  Limit(const Limit&) = delete;
  Limit& operator=(const Limit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(AtomicFile, ReplacesAFileWithoutLeftovers) {
  write_file_atomically(file(), "new and longer");
  EXPECT_EQ(text_of(file()), "new and longer");
  write_file_atomically(file(), "");
  EXPECT_EQ(text_of(file()), "");
  write_file_atomically(folder_ / "another", "first");
  EXPECT_EQ(text_of(folder_ / "another"), "first");
  EXPECT_EQ(file_count(), 2);
}

TEST_F(AtomicFile, KeepsTheOldFileIfTheNewOneDoesNotFit) {
  {
    const Limit limit(10);
    EXPECT_THROW(
        write_file_atomically(file(), "this is more than ten bytes", {.what = "the thing"}),
        EnvironmentError);
  }
  EXPECT_EQ(text_of(file()), "old");
  EXPECT_EQ(file_count(), 1);
}

TEST_F(AtomicFile, KeepsModeLinksAndOtherNames) {
  fs::permissions(file(), static_cast<fs::perms>(0640));
  fs::create_symlink("file", folder_ / "link");
  write_file_atomically(folder_ / "link", "through the link");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(text_of(file()), "through the link");
  EXPECT_EQ(fs::status(file()).permissions(), static_cast<fs::perms>(0640));
  fs::create_hard_link(file(), folder_ / "other");
  write_file_atomically(file(), "under both names");
  EXPECT_EQ(text_of(folder_ / "other"), "under both names");
  fs::create_symlink("missing", folder_ / "dangling");
  write_file_atomically(folder_ / "dangling", "now");
  EXPECT_EQ(text_of(folder_ / "missing"), "now");
}

TEST_F(AtomicFile, WritesDevicesInPlace) {
  write_file_atomically("/dev/null", "swallowed", {.to_disk = true});
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  try {
    write_file_atomically("/dev/full", "no room", {.what = "the thing"});
    FAIL() << "writing to a full device succeeded";
  } catch (const EnvironmentError& error) {
    EXPECT_STREQ(error.what(), "/dev/full: cannot write the thing: No space left on device");
  }
  EXPECT_THROW(write_file_atomically(folder_, "a folder"), EnvironmentError);
  EXPECT_THROW(write_file_atomically(folder_ / "no/file", "nowhere"), EnvironmentError);
}

}  // namespace
}  // namespace throng::atomic_file_test
