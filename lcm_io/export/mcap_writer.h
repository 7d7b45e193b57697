// McapWriter writes MCAP files (https://mcap.dev/spec): messages with their schemas, in indexed
// chunks, for Foxglove and other viewers. Chunks are compressed if Throng was built with zstd.
// Invariant: the file takes its name in finish(), once it is complete.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/files/atomic_file.h"

namespace throng {

/// CRC-32 of zlib, required by MCAP. `crc` is that of the bytes before, 0 at first.
uint32_t crc32_of(uint32_t crc, std::string_view bytes);

class McapWriter {
 public:
  /// Throws EnvironmentError, like the functions below, if the file cannot be written.
  explicit McapWriter(const std::filesystem::path& file);

  /// Adds a topic of JSON messages with a JSON schema; returns its number.
  uint16_t add_topic(const std::string& topic, const std::string& schema_name,
                     const std::string& schema);
  void add(uint16_t topic, uint64_t time_ns, std::string_view message);
  /// Writes the index and replaces an existing file of the name.
  void finish();

  uint64_t messages(uint16_t topic) const { return topics_[topic - 1u].messages; }
  uint64_t bytes() const { return offset_; }

 private:
  struct Topic {
    std::string schema_record, channel_record;
    uint64_t messages = 0;
    std::vector<std::pair<uint64_t, uint64_t>> index;  ///< of the chunk: time, offset
  };
  struct Chunk {
    uint64_t begin_ns = 0, end_ns = 0, at = 0, bytes = 0, index_bytes = 0, size = 0, packed = 0;
    std::map<uint16_t, uint64_t> indices;
  };

  void write(std::string_view bytes);
  void end_chunk();
  std::string statistics() const;
  std::string chunk_indices() const;

  AtomicFile file_;
  uint64_t offset_ = 0;
  uint32_t crc_ = 0;
  std::vector<Topic> topics_;
  std::vector<Chunk> chunks_;
  std::string chunk_;
  uint64_t chunk_begin_ns_ = 0, chunk_end_ns_ = 0;
};

}  // namespace throng
