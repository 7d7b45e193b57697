// Writing a whole file at once, and adding to one.
// One rule: a file that is not completely written is an EnvironmentError that names it.
#pragma once

#include <filesystem>
#include <string>

namespace throng {

/// What stood there before is there until all of the text is.
void write_text(const std::filesystem::path& file, const std::string& text);
void append_text(const std::filesystem::path& file, const std::string& text);

}  // namespace throng
