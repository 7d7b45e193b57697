// Writing a whole file, at once or piece by piece, and files of a folder that grow with a run.
// One rule: a whole file of that name is what it was or what was asked for, never a part of it. The
// new one is written without a name, or beside the old one, and then takes its name. Pipes and
// devices, and files that have a second name or whose folder takes no files, are written in place.
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
  bool to_disk = false;     ///< not even a power cut leaves half a file; costs some milliseconds
};

/// A file that is written piece by piece and takes its name by finish(); without that an older one
/// stays, unless it is written in place. All throw EnvironmentError naming the file.
class AtomicFile {
 public:
  /// What `options` refers to outlives the file.
  explicit AtomicFile(const std::filesystem::path& file, const AtomicFileOptions& options = {});
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const uint8_t> bytes);
  void write(std::string_view text);
  void finish();

 private:
  [[noreturn]] void fail(int error) const;
  /// A name that nobody else has: another run may write the same file at this moment.
  std::filesystem::path temporary_name() const;
  /// Leaves descriptor_ at -1 where the folder takes no files; the old one may still be writable.
  void open_temporary();
  void publish();
  void open_in_place();

  std::filesystem::path file_, real_;
  AtomicFileOptions options_;
  int descriptor_ = -1;
  bool is_anonymous_ = false;
  std::filesystem::path temporary_path_;  ///< until it has the right name
};

/// Throws EnvironmentError naming the file; an older one, unless it is written in place, is then as
/// it was.
void write_file_atomically(const std::filesystem::path& file, std::span<const uint8_t> bytes,
                           const AtomicFileOptions& options = {});
void write_file_atomically(const std::filesystem::path& file, std::string_view text,
                           const AtomicFileOptions& options = {});

/// Where opening the path for writing ends up: symbolic links are followed, also one whose target
/// is not there yet.
std::filesystem::path resolve_links(std::filesystem::path path);

/// What cannot be written of a folder that `option` names; `error`: of errno.
EnvironmentError write_error(const std::filesystem::path& file, int error, std::string_view option);

/// A text file of a folder that an option names, which grows as it is written. All throw
/// EnvironmentError, see write_error().
class OutputFile {
 public:
  /// Begins the file anew. `option`: "--contacts"; must outlive this.
  OutputFile(std::filesystem::path file, std::string_view option);

  void write(std::string_view text);
  void close();

 private:
  std::filesystem::path file_;
  std::string_view option_;
  std::ofstream out_;
};

}  // namespace throng
