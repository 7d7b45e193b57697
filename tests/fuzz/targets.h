// Fuzz targets: each takes any bytes and either rejects them with an error or uses what it
// accepted.
// Invariant: a target returns or throws BrokenPromise; sanitizers detect crashes, hangs and leaks.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace throng::fuzz {

/// An accepted input violates a promise of its reader.
struct BrokenPromise : std::logic_error {
  using std::logic_error::logic_error;
};

using Bytes = std::vector<uint8_t>;

/// Each returns true if the input was accepted.
bool tri(std::span<const uint8_t> input);
bool urdf(std::span<const uint8_t> input);
bool scene(std::span<const uint8_t> input);
/// A CSV file of starts, read by a small scene.
bool starts(std::span<const uint8_t> input);
/// A study of a small scene in the same folder.
bool study(std::span<const uint8_t> input);
/// A study's table and journal.
bool study_table(std::span<const uint8_t> input);
/// A sequence of messages: channel byte | u16 length, big-endian | bytes.
bool messages(std::span<const uint8_t> input);
bool log(std::span<const uint8_t> input);
/// A log, culled again.
bool culled_log(std::span<const uint8_t> input);
bool checkpoint(std::span<const uint8_t> input);
/// A file after a byte that selects options.
bool recording(std::span<const uint8_t> input);
/// A walkable area.
bool wkt(std::span<const uint8_t> input);
/// A floor plan after a byte that selects options.
bool plan(std::span<const uint8_t> input);
/// A mesh file after a byte that selects one of kMeshExtensions.
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
                                      {"starts", starts},
                                      {"study", study},
                                      {"study_table", study_table},
                                      {"messages", messages},
                                      {"log", log},
                                      {"culled_log", culled_log},
                                      {"checkpoint", checkpoint},
                                      {"recording", recording},
                                      {"wkt", wkt},
                                      {"plan", plan},
                                      {"mesh", mesh}};

/// Initial inputs: fixtures, files written by Throng, and known crashers of the libraries. The same
/// on every machine.
std::vector<Bytes> seeds_of(std::string_view target);

/// Messages packed for messages().
Bytes packed(std::span<const std::pair<uint8_t, Bytes>> messages);

}  // namespace throng::fuzz
