// Writing a whole file at once.
// One rule: a file of that name is what it was or what was asked for, never a part of it. The new
// one is written without a name, or beside the old one, and then takes its name. Pipes and devices,
// and files that have a second name or whose folder takes no files, are written in place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace throng {

struct WholeFileOptions {
  std::string_view what{};  ///< completes "cannot write", as in "the checkpoint"
  bool to_disk = false;     ///< not even a power cut leaves half a file; costs some milliseconds
};

/// Throws EnvironmentError naming the file; an older one, unless it is written in place, is then as
/// it was.
void write_whole_file(const std::filesystem::path& file, std::span<const uint8_t> bytes,
                      const WholeFileOptions& options = {});
void write_whole_file(const std::filesystem::path& file, std::string_view text,
                      const WholeFileOptions& options = {});

/// Where opening the path for writing ends up: symbolic links are followed, also one whose target
/// is not there yet.
std::filesystem::path links_followed(std::filesystem::path path);

}  // namespace throng
