// AtomicFile writes whole files, at once or piece by piece; OutputFile writes growing files of an
// output folder.
// Invariant: a file written atomically has its old or its new content, never a part. The new one is
// written without a name or next to the old one, then renamed. Pipes, devices, hard-linked files
// and files in read-only folders are written in place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>

#include "base/errors.h"

namespace throng {

struct AtomicFileOptions {
  std::string_view what{};  ///< completes "cannot write", as in "the checkpoint"
  bool to_disk = false;     ///< survives a power cut; costs some milliseconds
};

/// A file written piece by piece that takes its name in finish(). Without finish() the older file
/// stays, unless it is written in place. All members throw EnvironmentError naming the file.
class AtomicFile {
 public:
  /// References in `options` must outlive the file.
  explicit AtomicFile(const std::filesystem::path& file, const AtomicFileOptions& options = {});
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const uint8_t> bytes);
  void write(std::string_view text);
  void finish();

 private:
  [[noreturn]] void fail(int error) const;
  /// A unique name: another run may write the same file at this moment.
  std::filesystem::path temporary_name() const;
  /// Leaves descriptor_ at -1 if the folder takes no files; the old file may still be writable.
  void open_temporary();
  void publish();
  void open_in_place();

  std::filesystem::path file_, real_;
  AtomicFileOptions options_;
  int descriptor_ = -1;
  bool is_anonymous_ = false;
  std::filesystem::path temporary_path_;  ///< until finish() renames it
};

/// Throws EnvironmentError naming the file. The older file is then unchanged, unless it is written
/// in place.
void write_file_atomically(const std::filesystem::path& file, std::span<const uint8_t> bytes,
                           const AtomicFileOptions& options = {});
void write_file_atomically(const std::filesystem::path& file, std::string_view text,
                           const AtomicFileOptions& options = {});

/// Returns the path that opening for writing reaches. Follows symbolic links, dangling ones
/// included.
std::filesystem::path resolve_links(std::filesystem::path path);

/// Error for a file that cannot be written in the folder of `option`; `error` is an errno.
EnvironmentError write_error(const std::filesystem::path& file, int error, std::string_view option);

/// A growing text file in a folder that an option names. Members throw EnvironmentError, see
/// write_error().
class OutputFile {
 public:
  /// Creates or empties the file. `option`: "--contacts"; must outlive this.
  OutputFile(std::filesystem::path file, std::string_view option);

  void write(std::string_view text);
  void close();

 private:
  std::filesystem::path file_;
  std::string_view option_;
  std::ofstream out_;
};

}  // namespace throng
