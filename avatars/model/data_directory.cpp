#include <fmt/format.h>

#include <cstdlib>
#include <system_error>
#include <vector>

#include "avatars/model/model.h"
#include "base/errors.h"

namespace throng {
namespace {

/// Every data directory has the bundled models at the same place.
const std::filesystem::path kModels = std::filesystem::path("avatars") / "models";

bool holds_data(const std::filesystem::path& directory) {
  std::error_code ignored;
  return std::filesystem::is_directory(directory / kModels, ignored);
}

}  // namespace

std::filesystem::path data_directory() {
  if (const char* chosen = std::getenv("THRONG_DATA")) {
    if (holds_data(chosen)) return chosen;
    throw EnvironmentError(
        fmt::format("THRONG_DATA is '{}', but there is no {} in it", chosen, kModels.string()));
  }
  std::vector<std::filesystem::path> candidates;
  std::error_code error;
  const auto binary = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) candidates.push_back(binary.parent_path().parent_path() / "share" / "throng");
  candidates.emplace_back(THRONG_SOURCE_DIR);
  for (const auto& candidate : candidates)
    if (holds_data(candidate)) return candidate;
  throw EnvironmentError(fmt::format(
      "the bundled models are neither in '{}' nor in '{}'; set THRONG_DATA to the folder "
      "that holds {}",
      candidates.front().string(), candidates.back().string(), kModels.string()));
}

std::filesystem::path adult_urdf() { return data_directory() / kModels / "adult" / "adult.urdf"; }

}  // namespace throng
