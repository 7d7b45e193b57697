#include "base/files/anonymous_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "base/errors.h"

namespace throng {
namespace {

std::string folder() {
  const char* named = std::getenv("TMPDIR");
  return named != nullptr && *named != 0 ? named : "/tmp";
}

[[noreturn]] void fail(const char* what, int error) {
  throw EnvironmentError(
      fmt::format("{}: cannot {} a temporary file: {}; set TMPDIR to a folder with room", folder(),
                  what, std::strerror(error)));
}

}  // namespace

AnonymousFile::AnonymousFile() {
  const std::string in = folder();
  descriptor_ = ::open(in.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor_ >= 0) return;
  // For file systems without O_TMPFILE: the file loses its name at once.
  std::string name = in + "/throng-XXXXXX";
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) fail("make", errno);
  ::unlink(name.c_str());
}

AnonymousFile::~AnonymousFile() { ::close(descriptor_); }

void AnonymousFile::write(int64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(descriptor_, bytes.data(), bytes.size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail("write", count < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<size_t>(count));
    offset += count;
  }
}

void AnonymousFile::read(int64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(descriptor_, bytes.data(), bytes.size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail("read", count < 0 ? errno : EIO);
    bytes = bytes.subspan(static_cast<size_t>(count));
    offset += count;
  }
}

}  // namespace throng
