// Functions that write results: whole files, appended text, and JSON for --json (FILE or - for
// stdout, which then holds nothing else).
// Invariant: an incomplete file is an EnvironmentError that names it.
#pragma once

#include <filesystem>
#include <string>

namespace throng {

/// Replaces the file when the text is complete.
void write_text(const std::filesystem::path& file, const std::string& text);
void append_text(const std::filesystem::path& file, const std::string& text);

inline constexpr const char* kJsonHelp =
    "Write results as JSON; '-' prints them, and nothing else, to stdout";

/// Whether the value of --json means stdout.
inline bool is_stdout(const std::string& file) { return file == "-"; }

/// Writes nothing for "". Throws EnvironmentError.
void write_json_output(const std::string& file, const std::string& json);

/// Prints the table, unless JSON goes to stdout.
void print_unless_json(const std::string& file, const std::string& table);

}  // namespace throng
