#include "kinematics/mesh_path.h"

#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>

#include "base/errors.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

/// The text between <name> and </name> of a package.xml, or "".
std::string name_in_package_xml(const fs::path& file) {
  std::ifstream in(file);
  constexpr size_t kEnough = 65536;  // a manifest is a page; do not read a disguised disk image
  std::string text(kEnough, '\0');
  in.read(text.data(), static_cast<std::streamsize>(kEnough));
  text.resize(static_cast<size_t>(in.gcount()));
  const size_t start = text.find("<name>");
  const size_t end = text.find("</name>");
  if (start == std::string::npos || end == std::string::npos || end < start) return "";
  std::istringstream inner(text.substr(start + 6, end - start - 6));
  std::string name;
  inner >> name;
  return name;
}

/// The folder of `package` as seen from `folder`: itself, or the one of that name inside.
std::optional<fs::path> package_at(const fs::path& folder, const std::string& package) {
  std::error_code ignored;
  if (fs::is_directory(folder / package, ignored)) return folder / package;
  if (folder.filename() == package) return folder;
  if (name_in_package_xml(folder / "package.xml") == package) return folder;
  return std::nullopt;
}

fs::path in_package(const std::string& uri, const std::string& rest, const fs::path& urdf_file) {
  const size_t slash = rest.find('/');
  const std::string package = rest.substr(0, slash);
  if (slash == std::string::npos || package.empty()) return uri;
  const fs::path inside = rest.substr(slash + 1);
  std::error_code ignored;
  std::optional<fs::path> first_found;
  // A folder that holds the file wins over a folder that has the right name only.
  const auto holds_file = [&](const fs::path& folder) {
    const auto found = package_at(folder, package);
    if (found && !first_found) first_found = *found / inside;
    if (!found || !fs::exists(*found / inside, ignored)) return false;
    first_found = *found / inside;
    return true;
  };
  fs::path folder = fs::absolute(urdf_file, ignored).lexically_normal().parent_path();
  for (;; folder = folder.parent_path()) {
    if (holds_file(folder)) return *first_found;
    if (!folder.has_relative_path()) break;
  }
  if (const char* paths = std::getenv("ROS_PACKAGE_PATH")) {
    std::istringstream list(paths);
    for (std::string entry; std::getline(list, entry, ':');)
      if (!entry.empty() && holds_file(entry)) return *first_found;
  }
  // What ROS 2 installs of a package lies in PREFIX/share/PACKAGE.
  if (const char* prefixes = std::getenv("AMENT_PREFIX_PATH")) {
    std::istringstream list(prefixes);
    for (std::string entry; std::getline(list, entry, ':');)
      if (const fs::path share = fs::path(entry) / "share" / package;
          !entry.empty() && fs::is_directory(share, ignored) && holds_file(share))
        return *first_found;
  }
  return first_found.value_or(fs::path(uri));
}

}  // namespace

fs::path resolve_mesh(const std::string& uri, const fs::path& urdf_file) {
  const size_t scheme_end = uri.find("://");
  if (scheme_end == std::string::npos) return (urdf_file.parent_path() / uri).lexically_normal();
  const std::string scheme = uri.substr(0, scheme_end);
  const std::string rest = uri.substr(scheme_end + 3);
  if (scheme == "package" || scheme == "model") return in_package(uri, rest, urdf_file);
  if (scheme == "file") return (urdf_file.parent_path() / rest).lexically_normal();
  throw InputError(urdf_file.string(), "a mesh path, file://, package:// or model://",
                   "'" + uri + "'");
}

}  // namespace throng
