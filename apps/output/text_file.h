// Functions that write results: whole files, additions to one, and JSON for machines (--json FILE,
// or
// --json - for stdout, where it then stands alone).
// Invariant: a file that is not completely written is an EnvironmentError that names it.
#pragma once

#include <filesystem>
#include <string>

namespace throng {

/// What stood there before is there until all of the text is.
void write_text(const std::filesystem::path& file, const std::string& text);
void append_text(const std::filesystem::path& file, const std::string& text);

inline constexpr const char* kJsonHelp = "Writes the results for machines; -: to stdout, alone";

/// Whether `file`, the value of --json, means stdout.
inline bool is_stdout(const std::string& file) { return file == "-"; }

/// Nothing for "". Throws EnvironmentError.
void write_json_output(const std::string& file, const std::string& json);

/// The same results for people, unless stdout is taken.
void print_beside_json(const std::string& file, const std::string& table);

}  // namespace throng
