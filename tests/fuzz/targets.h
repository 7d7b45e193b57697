// What the fuzzers feed: each target takes any bytes and either refuses them in words or uses what
// it accepted.
// One rule: a target returns or throws BrokenPromise; crashing, hanging and leaking are for the
// sanitizers to see.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace throng::fuzz {

/// What was accepted does not keep what its reader promises.
struct BrokenPromise : std::logic_error {
  using std::logic_error::logic_error;
};

using Bytes = std::vector<uint8_t>;

/// Each returns true if the input was accepted.
bool tri(std::span<const uint8_t> input);
bool urdf(std::span<const uint8_t> input);
bool scene(std::span<const uint8_t> input);
/// A study of a small scene that lies beside it.
bool study(std::span<const uint8_t> input);
/// A table of a study, and its journal.
bool study_table(std::span<const uint8_t> input);
/// A row of messages: channel byte | u16 length, big-endian | bytes.
bool messages(std::span<const uint8_t> input);
bool log(std::span<const uint8_t> input);
/// A log that is culled again.
bool culled_log(std::span<const uint8_t> input);
bool checkpoint(std::span<const uint8_t> input);
/// A file behind a byte that says which options are given.
bool recording(std::span<const uint8_t> input);
/// A walkable area.
bool wkt(std::span<const uint8_t> input);
/// A mesh file behind a byte that says which of kMeshExtensions it has.
bool mesh(std::span<const uint8_t> input);
inline constexpr std::string_view kMeshExtensions[] = {
    ".ply", ".stl", ".obj", ".off", ".dae",     ".gltf", ".glb", ".3mf", ".x",   ".3ds",
    ".nff", ".smd", ".ac",  ".amf", ".md5mesh", ".raw",  ".dxf", ".x3d", ".fbx", ".assbin"};

struct Target {
  std::string_view name;
  bool (*run)(std::span<const uint8_t> input);
};
inline constexpr Target kTargets[] = {{"tri", tri},
                                      {"urdf", urdf},
                                      {"scene", scene},
                                      {"study", study},
                                      {"study_table", study_table},
                                      {"messages", messages},
                                      {"log", log},
                                      {"culled_log", culled_log},
                                      {"checkpoint", checkpoint},
                                      {"recording", recording},
                                      {"wkt", wkt},
                                      {"mesh", mesh}};

/// Inputs to start from: fixtures, what Throng writes itself, and what is known to have crashed the
/// libraries underneath. The same on every machine.
std::vector<Bytes> seeds_of(std::string_view target);

/// Messages packed for messages().
Bytes packed(std::span<const std::pair<uint8_t, Bytes>> messages);

}  // namespace throng::fuzz
