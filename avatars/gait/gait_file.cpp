#include "avatars/gait/gait_file.h"

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/errors.h"
#include "base/files/archive.h"
#include "base/files/atomic_file.h"
#include "base/files/regular_file.h"

namespace throng {

/// Hash of all sources that a gait depends on; see cmake/GaitSources.cmake.
extern const char* const gait_sources;

namespace {

constexpr uint64_t kMaxBytes = 1 << 28;

std::vector<uint8_t> with_checksum(std::vector<uint8_t> bytes) {
  uint64_t sum = checksum(bytes);
  Archive tail;
  tail(sum);
  bytes.insert(bytes.end(), tail.bytes().begin(), tail.bytes().end());
  return bytes;
}

}  // namespace

std::filesystem::path gait_file_name(const Model& model, GaitStyle style) {
  const std::string_view style_name = parameters_of(style).name;
  const uint64_t key =
      Hasher().add(model.content_hash).add(style_name).add(std::string_view(gait_sources)).value();
  return fmt::format("{}-{:016x}.gait", style_name, key);
}

void write_gait_file(const Model& model, GaitStyle style, const std::filesystem::path& folder) {
  write_file_atomically(folder / gait_file_name(model, style),
                        with_checksum(Gait(model, style).bytes()), {.what = "a gait"});
}

Gait read_gait_file(const std::filesystem::path& file) {
  const std::vector<uint8_t> bytes = RegularFile(file, "a gait", kMaxBytes).bytes();
  const std::span<const uint8_t> all(bytes);
  uint64_t expected = 0;
  if (all.size() < sizeof expected) throw InputError(file.string(), "a gait", "fewer than 8 bytes");
  const std::span<const uint8_t> archive = all.first(all.size() - sizeof expected);
  Archive tail(all.last(sizeof expected), file.string());
  tail(expected);
  if (checksum(archive) != expected)
    throw InputError(file.string(), "a sound gait", "a wrong checksum: the file is damaged");
  return Gait::from(archive, file.string());
}

Gait gait_of(const Model& model, GaitStyle style) {
  const std::filesystem::path file =
      generated_file(std::filesystem::path("gaits") / gait_file_name(model, style));
  if (!file.empty()) try {
      return read_gait_file(file);
    } catch (const InputError&) {  // a damaged file counts as missing
    }
  return Gait(model, style);
}

}  // namespace throng
