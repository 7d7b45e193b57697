#include "base/files/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "base/errors.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

/// The kernel's own limit.
constexpr int kMaxSymlinks = 40;

/// Default mode of created files, before the umask.
constexpr mode_t kMode = 0666;

}  // namespace

AtomicFile::AtomicFile(const fs::path& file, const AtomicFileOptions& options)
    : file_(file), real_(resolve_links(file)), options_(options) {
  struct stat old {};
  const bool is_there = ::stat(real_.c_str(), &old) == 0;
  const bool in_place = is_there && (!S_ISREG(old.st_mode) || old.st_nlink > 1);
  if (!in_place) open_temporary();
  if (descriptor_ < 0) {
    open_in_place();
  } else if (is_there) {
    // The new file keeps the permissions of the old one.
    [[maybe_unused]] const int changed = ::fchmod(descriptor_, old.st_mode & 07777);
  }
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_path_.empty()) ::unlink(temporary_path_.c_str());
}

void AtomicFile::write(std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(errno);
    bytes = bytes.subspan(static_cast<size_t>(n));
  }
}

void AtomicFile::write(std::string_view text) {
  write({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

void AtomicFile::finish() {
  // On the disk before it has the name. EINVAL, EROFS: a pipe has no disk.
  if (options_.to_disk && ::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS)
    fail(errno);
  if (is_anonymous_) publish();
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);
  if (temporary_path_.empty()) return;
  if (::rename(temporary_path_.c_str(), real_.c_str()) != 0) fail(errno);
  temporary_path_.clear();
}

void AtomicFile::fail(int error) const {
  throw EnvironmentError(fmt::format("{}: cannot write{}{}: {}", file_.string(),
                                     options_.what.empty() ? "" : " ", options_.what,
                                     std::strerror(error)));
}

fs::path AtomicFile::temporary_name() const {
  static std::atomic<uint64_t> count{0};
  fs::path name = real_;
  name += fmt::format(".new-{}-{}", ::getpid(), count++);
  return name;
}

void AtomicFile::open_temporary() {
  const fs::path folder = real_.has_parent_path() ? real_.parent_path() : fs::path(".");
  // Without a name; a killed run leaves nothing behind.
  descriptor_ = ::open(folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, kMode);
  is_anonymous_ = descriptor_ >= 0;
  if (is_anonymous_) return;
  const fs::path name = temporary_name();  // for file systems without O_TMPFILE
  descriptor_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (descriptor_ >= 0) temporary_path_ = name;
}

void AtomicFile::publish() {
  const fs::path name = temporary_name();
  const std::string nameless = fmt::format("/proc/self/fd/{}", descriptor_);
  if (::linkat(AT_FDCWD, nameless.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0)
    fail(errno);
  temporary_path_ = name;
}

void AtomicFile::open_in_place() {
  descriptor_ = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
  if (descriptor_ < 0) fail(errno);
}

fs::path resolve_links(fs::path path) {
  std::error_code error;
  for (int i = 0; i < kMaxSymlinks && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    const fs::path target = fs::read_symlink(path, error);
    if (error) return path;
    // A link in /proc may lead to a pipe, which has no path.
    if (fs::exists(path, error) && !fs::exists(path.parent_path() / target, error)) return path;
    path = path.parent_path() / target;  // an absolute target replaces the folder
  }
  return path;
}

void write_file_atomically(const fs::path& file, std::span<const uint8_t> bytes,
                           const AtomicFileOptions& options) {
  AtomicFile whole(file, options);
  whole.write(bytes);
  whole.finish();
}

void write_file_atomically(const fs::path& file, std::string_view text,
                           const AtomicFileOptions& options) {
  write_file_atomically(file, {reinterpret_cast<const uint8_t*>(text.data()), text.size()},
                        options);
}

EnvironmentError write_error(const fs::path& file, int error, std::string_view option) {
  return EnvironmentError(fmt::format("{}: cannot write: {}; choose another folder with {}",
                                      file.string(), std::strerror(error), option));
}

OutputFile::OutputFile(fs::path file, std::string_view option)
    : file_(std::move(file)), option_(option) {
  errno = 0;
  out_.open(file_, std::ios::trunc | std::ios::binary);
  if (!out_) throw write_error(file_, errno, option_);
}

void OutputFile::write(std::string_view text) {
  errno = 0;
  out_.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out_) throw write_error(file_, errno, option_);
}

void OutputFile::close() {
  errno = 0;
  out_.close();
  if (!out_) throw write_error(file_, errno, option_);
}

}  // namespace throng
