#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include <cstdlib>
#include <sstream>
#include <system_error>
#include <vector>

#include "avatars/model/model.h"
#include "base/errors.h"

// Directory of an installed package, compiled into programs (cmake/package/data_place.cpp.in). The
// library contains no path; hence it can be moved.
extern "C" __attribute__((weak)) const char throng_data_place[];

namespace throng {
namespace {

namespace fs = std::filesystem;

const fs::path kModels = fs::path("avatars") / "models";

bool holds_data(const fs::path& directory) {
  std::error_code ignored;
  return fs::is_directory(directory / kModels, ignored);
}

/// Returns the program, shared library or Python module that contains this code.
fs::path own_file() {
  static const char here = 0;
  Dl_info info;
  void* map = nullptr;
  std::error_code failed;
  if (dladdr1(&here, &info, &map, RTLD_DL_LINKMAP) != 0 && map != nullptr) {
    const char* name = static_cast<const link_map*>(map)->l_name;
    if (name != nullptr && *name != '\0') return fs::canonical(name, failed);
  }
  return fs::read_symlink("/proc/self/exe", failed);  // dladdr() does not name programs
}

/// Returns the directories to search, the most specific first.
std::vector<fs::path> candidates() {
  const fs::path data = fs::path("share") / "throng";
  std::vector<fs::path> found;
  // A folder above bin/throng and *.so files contains share; a build folder links to the sources.
  const fs::path file = own_file();
  for (fs::path above = file.parent_path(); above.has_relative_path(); above = above.parent_path())
    found.push_back(above / data);
  if (throng_data_place != nullptr) found.emplace_back(throng_data_place);
  // XDG base directories: finds Debian packages without settings.
  const char* shares = std::getenv("XDG_DATA_DIRS");
  std::istringstream list(shares != nullptr && *shares != '\0' ? shares
                                                               : "/usr/local/share:/usr/share");
  for (std::string share; std::getline(list, share, ':');)
    if (fs::path(share).is_absolute()) found.push_back(fs::path(share) / "throng");
#ifdef THRONG_SOURCE_DIR
  found.emplace_back(THRONG_SOURCE_DIR);
#endif
  return found;
}

}  // namespace

fs::path data_directory() {
  if (const char* chosen = std::getenv("THRONG_DATA")) {
    if (holds_data(chosen)) return chosen;
    throw EnvironmentError(
        fmt::format("THRONG_DATA is '{}', which does not contain {}", chosen, kModels.string()));
  }
  const std::vector<fs::path> places = candidates();
  for (const fs::path& place : places)
    if (holds_data(place)) return fs::canonical(place);
  std::string searched;
  for (const fs::path& place : places) searched += fmt::format("\n  {}", place.string());
  throw EnvironmentError(fmt::format(
      "the bundled models are in none of the folders below; set THRONG_DATA to the folder "
      "that contains {}{}",
      kModels.string(), searched));
}

fs::path generated_file(const fs::path& name) {
  std::error_code ignored;
  for (const fs::path& data : candidates()) {
    const fs::path prefix = data.parent_path().parent_path();
    fs::path file = prefix / "lib" / "throng" / name;
    if (fs::is_regular_file(file, ignored)) return file;
  }
  return {};
}

fs::path adult_urdf() { return data_directory() / kModels / "adult" / "adult.urdf"; }

}  // namespace throng
