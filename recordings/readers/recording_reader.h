// RecordingReader reads one kind of recording file.
// Invariant: a reader is chosen by the content of a file, never by its name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/files/regular_file.h"
#include "recordings/readers/text_lines.h"
#include "recordings/recording_builder.h"

namespace throng {

class RecordingSource {
 public:
  static constexpr size_t kHeadBytes = 64 << 10;

  /// Throws InputError if there is no such file.
  explicit RecordingSource(const std::filesystem::path& path);

  const RegularFile& file() const { return file_; }
  /// First bytes, after decompression of gzip files.
  std::string_view head() const { return head_; }
  bool is_packed() const { return is_packed_; }
  bool is_text() const { return head_.find('\0') == std::string::npos; }
  /// Passes all lines to the handler, after decompression.
  void lines(LineHandler& handler) const;

 private:
  RegularFile file_;
  bool is_packed_ = false;
  std::string head_;
};

class RecordingReader {
 public:
  virtual ~RecordingReader() = default;
  virtual std::string_view kind() const = 0;
  virtual bool knows(std::string_view head) const = 0;
  /// Feeds the builder; its options supplement the file.
  virtual void read(const RecordingSource& source, RecordingBuilder& builder) const = 0;
};

/// All readers in the order in which they are tried.
std::span<const RecordingReader* const> recording_readers();

const RecordingReader& archive_hdf5_reader();
const RecordingReader& archive_text_reader();
const RecordingReader& eth_text_reader();
const RecordingReader& jupedsim_sqlite_reader();
const RecordingReader& table_text_reader();
const RecordingReader& vadere_reader();

/// Throws InputError for compressed binary files; only text may be compressed.
void reject_packed(const RecordingSource& source, const RecordingReader& reader);

/// Throws an InputError that names the missing facts and their options: "expected --fps 16 and
/// --unit cm ...".
[[noreturn]] void throw_missing(const RecordingBuilder& builder, bool rate, bool unit,
                                std::string_view found);

}  // namespace throng
