#include "scenes/run/checkpoint.h"

#include <fmt/format.h>

#include <fstream>
#include <string_view>

#include "base/checksum.h"
#include "base/errors.h"
#include "base/files/archive.h"
#include "base/files/atomic_file.h"
#include "scenes/run/simulation.h"

namespace throng {
namespace {

constexpr std::string_view kMagic = "THRONGCP";
constexpr size_t kCheckpointHeaderBytes = 8 + 4 + 8 + 8 + 8;
constexpr size_t kChecksumBytes = 8;

struct CheckpointHeader {
  uint32_t version = kCheckpointVersion;
  uint64_t run_id = 0;
  int64_t next_frame = 0;
  uint64_t state_bytes = 0;
  void archive(Archive& a) { a(version, run_id, next_frame, state_bytes); }
};

/// Checksum of 8-byte words; any changed byte changes it.
uint64_t checksum_of(std::span<const uint8_t> bytes) {
  Hasher hash;
  hash.add(uint64_t{bytes.size()});
  for (size_t i = 0; i < bytes.size(); i += 8) {
    uint64_t word = 0;
    for (size_t k = i; k < std::min(i + 8, bytes.size()); ++k) word = word << 8 | bytes[k];
    hash.add(word);
  }
  return hash.value();
}

}  // namespace

std::vector<uint8_t> format_checkpoint(const Checkpoint& checkpoint) {
  std::vector<uint8_t> bytes(kMagic.begin(), kMagic.end());
  Archive header;
  CheckpointHeader fields{kCheckpointVersion, checkpoint.run_id, checkpoint.next_frame,
                          checkpoint.state.size()};
  header(fields);
  bytes.insert(bytes.end(), header.bytes().begin(), header.bytes().end());
  bytes.insert(bytes.end(), checkpoint.state.begin(), checkpoint.state.end());
  Archive tail;
  uint64_t checksum = checksum_of(bytes);
  tail(checksum);
  bytes.insert(bytes.end(), tail.bytes().begin(), tail.bytes().end());
  return bytes;
}

Checkpoint parse_checkpoint(std::span<const uint8_t> bytes, const std::string& name) {
  const bool is_ours =
      bytes.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin());
  if (!is_ours) throw InputError(name, "a checkpoint of Throng", "something else");
  if (bytes.size() < kCheckpointHeaderBytes + kChecksumBytes)
    throw InputError(name, "a whole checkpoint", fmt::format("{} bytes of one", bytes.size()));
  CheckpointHeader header;
  Archive in(bytes.subspan(kMagic.size(), kCheckpointHeaderBytes - kMagic.size()), name);
  in(header);
  if (header.version != kCheckpointVersion)
    throw InputError(name, fmt::format("a checkpoint of version {}", kCheckpointVersion),
                     fmt::format("version {}; start the run anew", header.version));
  const size_t state_bytes = bytes.size() - kCheckpointHeaderBytes - kChecksumBytes;
  if (header.state_bytes != state_bytes)
    throw InputError(name, fmt::format("{} bytes of state", header.state_bytes),
                     fmt::format("{}", state_bytes));
  uint64_t checksum = 0;
  Archive tail(bytes.last(kChecksumBytes), name);
  tail(checksum);
  if (checksum != checksum_of(bytes.first(bytes.size() - kChecksumBytes)))
    throw InputError(name, "a sound checkpoint", "a wrong checksum: the file is damaged");
  const auto state = bytes.subspan(kCheckpointHeaderBytes, state_bytes);
  return {header.run_id, header.next_frame, {state.begin(), state.end()}};
}

void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint) {
  write_file_atomically(file, format_checkpoint(checkpoint),
                        {.what = "the checkpoint", .to_disk = true});
}

Checkpoint read_checkpoint(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError(file.string(), "a checkpoint",
                     std::filesystem::exists(file, error) ? "no regular file" : "nothing there");
  const uint64_t size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "a readable file", error.message());
  if (size > kMaxCheckpointBytes)
    throw InputError(file.string(), fmt::format("at most {} bytes", kMaxCheckpointBytes),
                     fmt::format("{}", size));
  std::vector<uint8_t> bytes(static_cast<size_t>(size));
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) throw InputError(file.string(), "a readable file", "one that cannot be read");
  return parse_checkpoint(bytes, file.string());
}

Checkpoint checkpoint_of(Simulation& simulation) {
  return {simulation.info().run_id, simulation.next_frame(), simulation.saved()};
}

void resume(Simulation& simulation, const Checkpoint& checkpoint, const std::string& name) {
  const uint64_t run_id = simulation.info().run_id;
  if (checkpoint.run_id != run_id)
    throw InputError(name,
                     fmt::format("a checkpoint of this run ({:016x}): the same scene, seed and "
                                 "options that change results",
                                 run_id),
                     fmt::format("one of run {:016x}", checkpoint.run_id));
  simulation.resume(checkpoint.state, name);
  if (simulation.next_frame() != checkpoint.next_frame)
    throw InputError(name, fmt::format("frame {}", checkpoint.next_frame),
                     fmt::format("frame {}", simulation.next_frame()));
}

void resume(Simulation& simulation, const std::filesystem::path& file) {
  resume(simulation, read_checkpoint(file), file.string());
}

}  // namespace throng
