#include "base/files/regular_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/errors.h"

namespace throng {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  int release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

const char* kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISFIFO(mode)) return "a named pipe, not a regular file";
  if (S_ISSOCK(mode)) return "a socket, not a regular file";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device, not a regular file";
  return "something that is not a regular file";
}

std::string reason(int error) {
  return error == ENOENT ? "no such file" : std::string(std::strerror(error));
}

std::string in_words(uint64_t bytes) {
  return bytes >> 20 > 0 ? fmt::format("{} MiB", bytes >> 20) : fmt::format("{} bytes", bytes);
}

/// Opens the file behind an O_PATH descriptor; opening by name could meet another file. Without
/// /proc it opens by name, with O_NONBLOCK, because a pipe would block.
int open_named(int named, const std::filesystem::path& path) {
  constexpr int kFlags = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;
  const int opened = ::open(fmt::format("/proc/self/fd/{}", named).c_str(), kFlags);
  if (opened >= 0 || (errno != ENOENT && errno != ENOTDIR)) return opened;
  return ::open(path.c_str(), kFlags);
}

}  // namespace

RegularFile::RegularFile(const std::filesystem::path& path, std::string_view expected,
                         uint64_t max_bytes)
    : path_(path), expected_(expected) {
  const auto reject = [&](const std::string& found) {
    throw InputError(path.string(), expected, found);
  };
  if (path.native().find('\0') != std::string::npos) reject("a name with a NUL in it");
  const Descriptor named(::open(path.c_str(), O_PATH | O_CLOEXEC));
  struct stat status = {};
  if (named.number() < 0 || ::fstat(named.number(), &status) != 0) reject(reason(errno));
  if (!S_ISREG(status.st_mode)) reject(kind_of(status.st_mode));
  Descriptor opened(open_named(named.number(), path));
  if (opened.number() < 0 || ::fstat(opened.number(), &status) != 0) reject(reason(errno));
  if (!S_ISREG(status.st_mode)) reject(kind_of(status.st_mode));
  size_ = static_cast<uint64_t>(status.st_size);
  if (size_ > max_bytes)
    throw InputError(path.string(), fmt::format("{} of at most {}", expected, in_words(max_bytes)),
                     in_words(size_));
  // Keep 0 to 2 free: standard input may be closed, and this file must not take its place.
  if (opened.number() > STDERR_FILENO) {
    descriptor_ = opened.release();
  } else {
    descriptor_ = ::fcntl(opened.number(), F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (descriptor_ < 0) reject(reason(errno));
  }
}

RegularFile::~RegularFile() { ::close(descriptor_); }

void RegularFile::read(std::span<std::byte> out) const {
  size_t done = 0;
  while (done < out.size()) {
    const ssize_t count =
        ::pread(descriptor_, out.data() + done, out.size() - done, static_cast<off_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw InputError(path_.string(), expected_, reason(errno));
    if (count == 0) throw InputError(path_.string(), expected_, "a file that is being shortened");
    done += static_cast<size_t>(count);
  }
}

std::vector<uint8_t> RegularFile::bytes() const {
  std::vector<uint8_t> out(static_cast<size_t>(size_));
  read(std::as_writable_bytes(std::span(out)));
  return out;
}

}  // namespace throng
