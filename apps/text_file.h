// Writing a whole file at once.
// One rule: a file that is not completely written is an EnvironmentError that names it.
#pragma once

#include <filesystem>
#include <string>

namespace throng {

void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace throng
