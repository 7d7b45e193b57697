// Checkpoint is the file from which a stopped run continues.
// Invariant: a file is complete or rejected. It gets its name once it is complete on disk, and a
// checksum covers every byte.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace throng {

class Simulation;

/// File format, little-endian: "THRONGCP", u32 version, u64 run id, i64 next frame, u64 bytes of
/// state, state, u64 checksum of all preceding bytes.
struct Checkpoint {
  uint64_t run_id = 0;
  int64_t next_frame = 0;
  std::vector<uint8_t> state;  ///< Simulation::saved()
};

/// Incremented with every change of the saved state; other versions are rejected.
inline constexpr uint32_t kCheckpointVersion = 22;
/// An avatar takes about 400 bytes; 8 GiB hold the 16.7 million avatars that ids allow.
inline constexpr uint64_t kMaxCheckpointBytes = uint64_t{8} << 30;

std::vector<uint8_t> format_checkpoint(const Checkpoint& checkpoint);
/// Throws InputError naming `name`.
Checkpoint parse_checkpoint(std::span<const uint8_t> bytes, const std::string& name);

/// Throws EnvironmentError and leaves an existing file of that name unchanged.
void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint);
/// Throws InputError naming the file.
Checkpoint read_checkpoint(const std::filesystem::path& file);

Checkpoint checkpoint_of(Simulation& simulation);
/// Sets a simulation that has not stepped to the state of the checkpoint. Throws InputError naming
/// `name` for a checkpoint of another run.
void resume(Simulation& simulation, const Checkpoint& checkpoint, const std::string& name);
/// Reads a file, then as above. Throws InputError for a damaged file or one of another run.
void resume(Simulation& simulation, const std::filesystem::path& file);

}  // namespace throng
