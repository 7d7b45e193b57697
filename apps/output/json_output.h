// Where results for machines go: --json FILE, or --json - for stdout.
// One rule: JSON on stdout stands there alone; what people read is then not written.
#pragma once

#include <string>

namespace throng {

inline constexpr const char* kJsonHelp = "Writes the results for machines; -: to stdout, alone";

/// Whether `file`, the value of --json, means stdout.
inline bool is_stdout(const std::string& file) { return file == "-"; }

/// Nothing for "". Throws EnvironmentError.
void write_json_output(const std::string& file, const std::string& json);

/// The same results for people, unless stdout is taken.
void show_beside_json(const std::string& file, const std::string& table);

}  // namespace throng
