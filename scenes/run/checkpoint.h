// The file that a run goes on from after it was stopped or killed.
// One rule: a file is whole or refused. It takes its name when it is whole and on the disk,
// and a checksum covers every byte; what it holds is only ever used for the run that wrote it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace throng {

class Simulation;

/// A file, little-endian: "THRONGCP" | u32 version | u64 run id | i64 next frame | u64 bytes of
/// state | state | u64 checksum of all before.
struct Checkpoint {
  uint64_t run_id = 0;
  int64_t next_frame = 0;
  std::vector<uint8_t> state;  ///< Simulation::saved()
};

/// Raised with every change of what is saved: an older file is refused by name.
inline constexpr uint32_t kCheckpointVersion = 21;
/// A person takes some 400 bytes; this holds the 16.7 million that ids allow.
inline constexpr uint64_t kMaxCheckpointBytes = uint64_t{8} << 30;

std::vector<uint8_t> format_checkpoint(const Checkpoint& checkpoint);
/// Throws InputError naming `name`.
Checkpoint parse_checkpoint(std::span<const uint8_t> bytes, const std::string& name);

/// Throws EnvironmentError; an older file of that name is then as it was.
void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint);
/// Throws InputError naming the file.
Checkpoint read_checkpoint(const std::filesystem::path& file);

Checkpoint checkpoint_of(Simulation& simulation);
/// Puts a simulation that has not stepped where the checkpoint was taken. Throws InputError naming
/// `name` if it is of another run.
void resume(Simulation& simulation, const Checkpoint& checkpoint, const std::string& name);
/// Reads a file and puts a simulation that has not stepped where it was taken. Throws InputError if
/// it is damaged or of another run.
void resume(Simulation& simulation, const std::filesystem::path& file);

}  // namespace throng
