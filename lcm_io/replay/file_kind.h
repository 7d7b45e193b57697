// What a file is by its first bytes, for whoever hands a command the wrong one.
// One rule: only what is certain is named; everything else is left to the reader that was asked.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace throng {

struct FileKind {
  std::string what;     ///< "a log of a run"
  std::string readers;  ///< "`throng view`, ... read it"; may be empty
  bool is_recording = false;
};

/// Nothing for a scene, for what nobody knows, and for what is not a regular file.
std::optional<FileKind> known_kind(const std::filesystem::path& file);

/// Whether it begins like a log of a run, or of anything else that LCM recorded.
bool is_log(const std::filesystem::path& file);

/// Throws InputError if `name` is a file of a known kind that is no scene.
void require_no_other_kind(const std::string& name);

}  // namespace throng
