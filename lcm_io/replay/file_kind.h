// file_kind recognises the kind of a file by its first bytes, for errors about unsuitable files.
// Invariant: it names only certain kinds; other files are left to the reader of the command.
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

/// Returns nothing for a scene, an unknown kind, or anything but a regular file.
std::optional<FileKind> known_kind(const std::filesystem::path& file);

/// Returns whether the file begins like an LCM log.
bool is_log(const std::filesystem::path& file);

/// Throws InputError if `name` is a file of a known kind other than a scene.
void require_no_other_kind(const std::string& name);

}  // namespace throng
