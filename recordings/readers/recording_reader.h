// The kinds of files that recordings come in, each with one reader, in one list.
// One rule: a reader is chosen by what a file holds, never by its name.
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

/// A file, opened, and what it begins with.
class RecordingSource {
 public:
  /// Enough to tell kinds apart.
  static constexpr size_t kHeadBytes = 64 << 10;

  /// Throws InputError if there is no such file.
  explicit RecordingSource(const std::filesystem::path& path);

  const RegularFile& file() const { return file_; }
  /// The first bytes; of what a gzip file holds its first ones.
  std::string_view head() const { return head_; }
  bool is_packed() const { return is_packed_; }
  /// Not one of the binary kinds.
  bool is_text() const { return head_.find('\0') == std::string::npos; }
  /// Gives all lines, unpacked.
  void lines(LineHandler& handler) const;

 private:
  RegularFile file_;
  bool is_packed_ = false;
  std::string head_;
};

class RecordingReader {
 public:
  virtual ~RecordingReader() = default;
  /// What it reads: "archive text".
  virtual std::string_view kind() const = 0;
  virtual bool knows(std::string_view head) const = 0;
  /// Feeds the builder, options of which say what the file does not.
  virtual void read(const RecordingSource& source, RecordingBuilder& builder) const = 0;
};

/// In the order in which they are asked.
std::span<const RecordingReader* const> recording_readers();

const RecordingReader& archive_hdf5_reader();
const RecordingReader& archive_text_reader();
const RecordingReader& eth_text_reader();
const RecordingReader& jupedsim_sqlite_reader();
const RecordingReader& table_text_reader();
const RecordingReader& vadere_reader();

/// Text alone is read packed. Throws InputError.
void refuse_packed(const RecordingSource& source, const RecordingReader& reader);

/// What is missing, and the options that give it, as one error: "expected --fps 16 and --unit cm
/// ...".
[[noreturn]] void ask_for(const RecordingBuilder& builder, bool rate, bool unit,
                          std::string_view found);

}  // namespace throng
