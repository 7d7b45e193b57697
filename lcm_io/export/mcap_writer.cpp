#include "lcm_io/export/mcap_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/errors.h"
#include "base/version.h"

#ifdef THRONG_HAS_ZSTD
#include <zstd.h>
#endif

namespace throng {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr size_t kChunkBytes = 4 << 20;

enum Opcode : uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f,
};

template <typename Whole>
void put(std::string& out, Whole value) {
  for (size_t i = 0; i < sizeof value; ++i)
    out += static_cast<char>(static_cast<uint64_t>(value) >> (8 * i));
}

void put_text(std::string& out, std::string_view text) {
  put(out, static_cast<uint32_t>(text.size()));
  out += text;
}

#ifdef THRONG_HAS_ZSTD
constexpr std::string_view kCompression = "zstd";

std::string compressed(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1);
  if (ZSTD_isError(size) != 0) throw EnvironmentError("zstd: cannot compress: no memory");
  out.resize(size);
  return out;
}
#else
constexpr std::string_view kCompression = "";

const std::string& compressed(const std::string& bytes) { return bytes; }
#endif

std::string record(Opcode opcode, std::string_view content) {
  std::string out(1, static_cast<char>(opcode));
  put(out, uint64_t{content.size()});
  out += content;
  return out;
}

}  // namespace

uint32_t crc32_of(uint32_t crc, std::string_view bytes) {
  static const std::array<uint32_t, 256> table = [] {
    std::array<uint32_t, 256> out{};
    for (uint32_t i = 0; i < out.size(); ++i) {
      uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1) * 0xedb88320u);
      out[i] = value;
    }
    return out;
  }();
  crc = ~crc;
  for (const char c : bytes) crc = table[(crc ^ static_cast<uint8_t>(c)) & 0xff] ^ (crc >> 8);
  return ~crc;
}

McapWriter::McapWriter(const std::filesystem::path& file) : file_(file) {
  write(kMagic);
  std::string header;
  put_text(header, "");
  put_text(header, fmt::format("throng {}", version()));
  write(record(kHeader, header));
}

void McapWriter::write(std::string_view bytes) {
  file_.write(bytes);
  crc_ = crc32_of(crc_, bytes);
  offset_ += bytes.size();
}

uint16_t McapWriter::add_topic(const std::string& topic, const std::string& schema_name,
                               const std::string& schema) {
  const auto id = static_cast<uint16_t>(topics_.size() + 1);
  std::string described, channel;
  put(described, id);
  put_text(described, schema_name);
  put_text(described, "jsonschema");
  put_text(described, schema);
  put(channel, id);
  put(channel, id);
  put_text(channel, topic);
  put_text(channel, "json");
  put(channel, uint32_t{0});  // no metadata
  topics_.push_back({record(kSchema, described), record(kChannel, channel), 0, {}});
  chunk_ += topics_.back().schema_record + topics_.back().channel_record;
  return id;
}

void McapWriter::add(uint16_t topic, uint64_t time_ns, std::string_view message) {
  Topic& to = topics_[topic - 1u];
  const bool is_first = std::all_of(topics_.begin(), topics_.end(),
                                    [](const Topic& each) { return each.index.empty(); });
  chunk_begin_ns_ = is_first ? time_ns : std::min(chunk_begin_ns_, time_ns);
  chunk_end_ns_ = is_first ? time_ns : std::max(chunk_end_ns_, time_ns);
  to.index.emplace_back(time_ns, chunk_.size());
  std::string content;
  content.reserve(message.size() + 22);
  put(content, topic);
  put(content, static_cast<uint32_t>(to.messages++));
  put(content, time_ns);
  put(content, time_ns);
  content += message;
  chunk_ += record(kMessage, content);
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  const std::string packed = compressed(chunk_);
  Chunk chunk{chunk_begin_ns_, chunk_end_ns_, offset_, 0, 0, chunk_.size(), packed.size(), {}};
  std::string content;
  content.reserve(packed.size() + 64);
  put(content, chunk.begin_ns);
  put(content, chunk.end_ns);
  put(content, uint64_t{chunk_.size()});
  put(content, crc32_of(0, chunk_));
  put_text(content, kCompression);
  put(content, uint64_t{packed.size()});
  content += packed;
  write(record(kChunk, content));
  chunk.bytes = offset_ - chunk.at;
  const uint64_t indices_at = offset_;
  for (size_t i = 0; i < topics_.size(); ++i) {
    if (topics_[i].index.empty()) continue;
    const auto id = static_cast<uint16_t>(i + 1);
    chunk.indices[id] = offset_;
    std::string index, entries;
    for (const auto& [time_ns, at] : topics_[i].index) {
      put(entries, time_ns);
      put(entries, at);
    }
    put(index, id);
    put_text(index, entries);
    write(record(kMessageIndex, index));
    topics_[i].index.clear();
  }
  chunk.index_bytes = offset_ - indices_at;
  chunks_.push_back(std::move(chunk));
  chunk_.clear();
}

std::string McapWriter::statistics() const {
  std::string content, counts;
  uint64_t messages = 0, begin_ns = 0, end_ns = 0;
  for (size_t i = 0; i < topics_.size(); ++i) {
    put(counts, static_cast<uint16_t>(i + 1));
    put(counts, topics_[i].messages);
    messages += topics_[i].messages;
  }
  for (const Chunk& chunk : chunks_) {
    begin_ns = &chunk == chunks_.data() ? chunk.begin_ns : std::min(begin_ns, chunk.begin_ns);
    end_ns = std::max(end_ns, chunk.end_ns);
  }
  put(content, messages);
  put(content, static_cast<uint16_t>(topics_.size()));
  put(content, static_cast<uint32_t>(topics_.size()));
  put(content, uint32_t{0});  // attachments
  put(content, uint32_t{0});  // metadata
  put(content, static_cast<uint32_t>(chunks_.size()));
  put(content, begin_ns);
  put(content, end_ns);
  put_text(content, counts);
  return record(kStatistics, content);
}

std::string McapWriter::chunk_indices() const {
  std::string out;
  for (const Chunk& chunk : chunks_) {
    std::string content, indices;
    put(content, chunk.begin_ns);
    put(content, chunk.end_ns);
    put(content, chunk.at);
    put(content, chunk.bytes);
    for (const auto& [topic, at] : chunk.indices) {
      put(indices, topic);
      put(indices, at);
    }
    put_text(content, indices);
    put(content, chunk.index_bytes);
    put_text(content, kCompression);
    put(content, chunk.packed);
    put(content, chunk.size);
    out += record(kChunkIndex, content);
  }
  return out;
}

void McapWriter::finish() {
  end_chunk();
  std::string data_end;
  put(data_end, crc_);
  write(record(kDataEnd, data_end));
  const uint64_t summary_at = offset_;
  crc_ = 0;
  std::string schemas, channels, offsets;
  for (const Topic& topic : topics_) {
    schemas += topic.schema_record;
    channels += topic.channel_record;
  }
  for (const auto& [opcode, group] :
       {std::pair<Opcode, std::string>(kSchema, schemas),
        std::pair<Opcode, std::string>(kChannel, channels),
        std::pair<Opcode, std::string>(kStatistics, statistics()),
        std::pair<Opcode, std::string>(kChunkIndex, chunk_indices())}) {
    if (group.empty()) continue;
    std::string content(1, static_cast<char>(opcode));
    put(content, offset_);
    put(content, uint64_t{group.size()});
    offsets += record(kSummaryOffset, content);
    write(group);
  }
  std::string footer;
  put(footer, summary_at);
  put(footer, offset_);
  write(offsets);
  // The checksum covers the footer up to this field.
  std::string head(1, static_cast<char>(kFooter));
  put(head, uint64_t{footer.size() + sizeof crc_});
  put(footer, crc32_of(crc_, head + footer));
  write(record(kFooter, footer));
  write(kMagic);
  file_.finish();
}

}  // namespace throng
