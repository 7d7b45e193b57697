#include "apps/output/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "base/errors.h"
#include "base/files/whole_file.h"

namespace throng {

void write_text(const std::filesystem::path& file, const std::string& text) {
  write_whole_file(file, text);
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

}  // namespace throng
