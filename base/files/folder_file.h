// A text file of a folder that an option names, written piece by piece.
// One rule: what cannot be written is an EnvironmentError that names the file and the option.
#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

#include "base/errors.h"

namespace throng {

/// `error`: of errno.
EnvironmentError cannot_write(const std::filesystem::path& file, int error,
                              std::string_view option);

class FolderFile {
 public:
  /// Begins the file anew. `option`: "--contacts"; must outlive this.
  FolderFile(std::filesystem::path file, std::string_view option);

  void write(std::string_view text);
  void close();

 private:
  std::filesystem::path file_;
  std::string_view option_;
  std::ofstream out_;
};

}  // namespace throng
