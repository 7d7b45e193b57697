#include "base/files/folder_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace throng {

EnvironmentError cannot_write(const std::filesystem::path& file, int error,
                              std::string_view option) {
  return EnvironmentError(fmt::format("{}: cannot write: {}; choose another folder with {}",
                                      file.string(), std::strerror(error), option));
}

FolderFile::FolderFile(std::filesystem::path file, std::string_view option)
    : file_(std::move(file)), option_(option) {
  errno = 0;
  out_.open(file_, std::ios::trunc | std::ios::binary);
  if (!out_) throw cannot_write(file_, errno, option_);
}

void FolderFile::write(std::string_view text) {
  errno = 0;
  out_.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!out_) throw cannot_write(file_, errno, option_);
}

void FolderFile::close() {
  errno = 0;
  out_.close();
  if (!out_) throw cannot_write(file_, errno, option_);
}

}  // namespace throng
