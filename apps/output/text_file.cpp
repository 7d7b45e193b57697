#include "apps/output/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/console.h"
#include "base/errors.h"
#include "base/files/atomic_file.h"

namespace throng {

void write_text(const std::filesystem::path& file, const std::string& text) {
  write_file_atomically(file, text);
}

void append_text(const std::filesystem::path& file, const std::string& text) {
  errno = 0;
  std::ofstream out(file, std::ios::app | std::ios::binary);
  out << text;
  out.close();
  if (!out)
    throw EnvironmentError(
        fmt::format("{}: cannot write: {}", file.string(), std::strerror(errno)));
}

void write_json_output(const std::string& file, const std::string& json) {
  if (file.empty()) return;
  if (is_stdout(file))
    print_result_text(json);
  else
    write_text(file, json);
}

void print_unless_json(const std::string& file, const std::string& table) {
  if (!is_stdout(file)) print_result_text(table);
}

}  // namespace throng
