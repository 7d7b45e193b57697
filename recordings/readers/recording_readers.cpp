// The list of readers, and the choice of a reader by content.
#include <fmt/format.h>

#include <array>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/recording_reader.h"

namespace throng {

std::span<const RecordingReader* const> recording_readers() {
  static const std::array readers = {&jupedsim_sqlite_reader(), &archive_hdf5_reader(),
                                     &vadere_reader(),          &table_text_reader(),
                                     &eth_text_reader(),        &archive_text_reader()};
  return readers;
}

void throw_missing(const RecordingBuilder& builder, bool rate, bool unit, std::string_view found) {
  const char* const what = rate && unit
                               ? "a frame rate and a unit of length, as in --fps 16 --unit cm"
                           : rate ? "a frame rate, as in --fps 25"
                                  : "a unit of length, as in --unit cm";
  throw InputError(builder.options().file.string(), what, found);
}

void reject_packed(const RecordingSource& source, const RecordingReader& reader) {
  if (source.is_packed())
    throw InputError(source.file().path().string(), "a compressed text file",
                     fmt::format("compressed {}; decompress it first", reader.kind()));
}

namespace {

std::string first_line(std::string_view head) {
  while (!head.empty() && (head[0] == '\n' || head[0] == '\r')) head.remove_prefix(1);
  return in_quotes(head.substr(0, head.find_first_of("\r\n")));
}

const RecordingReader* reader_of(const RecordingSource& source, const RecordingOptions& options) {
  // Users who name columns know that it is a table.
  if (!options.columns.empty() && source.is_text()) return &table_text_reader();
  for (const RecordingReader* reader : recording_readers())
    if (reader->knows(source.head())) return reader;
  return nullptr;
}

}  // namespace

std::shared_ptr<const Recording> read_recording(const RecordingOptions& options) {
  const RecordingSource source(options.file);
  const RecordingReader* const reader = reader_of(source, options);
  if (reader == nullptr)
    throw InputError(
        options.file.string(),
        "a recording: archive text, SQLite, HDF5, or a table with known column names or "
        "--columns id=pedID,t=time,x=posX,y=posY",
        source.head().empty() ? "an empty file" : first_line(source.head()));
  if (options.heading_unit_rad && reader != &table_text_reader())
    throw InputError("--heading-unit", "a table with a column of headings", reader->kind());
  RecordingBuilder builder(options);
  reader->read(source, builder);
  return builder.finish();
}

bool is_recording(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  try {
    return reader_of(RecordingSource(file), {}) != nullptr;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace throng
