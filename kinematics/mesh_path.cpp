#include "kinematics/mesh_path.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>

#include "base/errors.h"
#include "base/text.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

/// Returns the text between <name> and </name> of a package.xml, or "".
std::string name_in_package_xml(const fs::path& file) {
  std::ifstream in(file);
  constexpr size_t kMaxManifestBytes =
      65536;  // a manifest is one page; limits the read for any other file
  std::string text(kMaxManifestBytes, '\0');
  in.read(text.data(), static_cast<std::streamsize>(kMaxManifestBytes));
  text.resize(static_cast<size_t>(in.gcount()));
  const size_t start = text.find("<name>");
  const size_t end = text.find("</name>");
  if (start == std::string::npos || end == std::string::npos || end < start) return "";
  std::istringstream inner(text.substr(start + 6, end - start - 6));
  std::string name;
  inner >> name;
  return name;
}

/// Returns the folder of `package` as seen from `folder`: itself, or its subfolder of that name.
std::optional<fs::path> package_at(const fs::path& folder, const std::string& package) {
  std::error_code ignored;
  if (fs::is_directory(folder / package, ignored)) return folder / package;
  if (folder.filename() == package) return folder;
  if (name_in_package_xml(folder / "package.xml") == package) return folder;
  return std::nullopt;
}

/// Decodes %20 and other codes; anything else remains.
std::string decoded(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    unsigned code = 0;
    const char* const digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2 && code != 0) {
      out.push_back(static_cast<char>(code));
      i += 2;
    } else {
      out.push_back(text[i]);
    }
  }
  return out;
}

/// Scheme in lower case, empty for a plain path; the rest includes the slashes after the colon.
struct Uri {
  std::string scheme;
  std::string rest;
};

Uri split(std::string_view uri) {
  const size_t colon = uri.find(':');
  if (colon == std::string_view::npos || uri.substr(colon + 1, 1) != "/")
    return {"", std::string(uri)};
  std::string scheme(uri.substr(0, colon));
  for (char& c : scheme)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + ('a' - 'A'));
  const bool is_scheme = !scheme.empty() && std::all_of(scheme.begin(), scheme.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
  });
  const bool has_authority = uri.substr(colon + 1, 2) == "//";
  // "C:/robot" of Windows is no valid path here, but no address either.
  if (!is_scheme ||
      (!has_authority && scheme != "file" && scheme != "package" && scheme != "model"))
    return {"", std::string(uri)};
  return {scheme, std::string(uri.substr(colon + 1))};
}

std::string without_slashes(std::string_view text) {
  return std::string(text.substr(std::min(text.find_first_not_of('/'), text.size())));
}

/// Resolves PACKAGE/PATH, in the first matching package if none has the file.
std::optional<fs::path> in_package(const std::string& rest, const fs::path& urdf_file) {
  const size_t slash = rest.find('/');
  const std::string package = rest.substr(0, slash);
  if (slash == std::string::npos || package.empty()) return std::nullopt;
  const fs::path inside = without_slashes(rest.substr(slash));
  std::error_code ignored;
  std::optional<fs::path> first_found;
  // A folder with the file takes precedence over one with only the right name.
  const auto holds_file = [&](const fs::path& folder) {
    const auto found = package_at(folder, package);
    if (found && !first_found) first_found = *found / inside;
    if (!found || !fs::exists(*found / inside, ignored)) return false;
    first_found = *found / inside;
    return true;
  };
  fs::path folder = fs::absolute(urdf_file, ignored).lexically_normal().parent_path();
  for (;; folder = folder.parent_path()) {
    if (holds_file(folder)) return first_found;
    if (!folder.has_relative_path()) break;
  }
  if (const char* paths = std::getenv("ROS_PACKAGE_PATH")) {
    std::istringstream list(paths);
    for (std::string entry; std::getline(list, entry, ':');)
      if (!entry.empty() && holds_file(entry)) return first_found;
  }
  // ROS 2 installs a package to PREFIX/share/PACKAGE.
  if (const char* prefixes = std::getenv("AMENT_PREFIX_PATH")) {
    std::istringstream list(prefixes);
    for (std::string entry; std::getline(list, entry, ':');)
      if (const fs::path share = fs::path(entry) / "share" / package;
          !entry.empty() && fs::is_directory(share, ignored) && holds_file(share))
        return first_found;
  }
  return first_found;
}

/// Resolves file:///PATH, file:/PATH, file://localhost/PATH, and file://PATH relative to the URDF.
fs::path of_file(std::string rest, const fs::path& urdf_file) {
  constexpr std::string_view kHere = "//localhost/";
  if (rest.starts_with(kHere)) rest.erase(0, kHere.size() - 1);
  if (rest.starts_with("//")) rest.erase(0, 2);
  return (urdf_file.parent_path() / rest).lexically_normal();
}

fs::path resolved(const Uri& uri, const fs::path& urdf_file) {
  if (uri.scheme.empty()) return (urdf_file.parent_path() / uri.rest).lexically_normal();
  if (uri.scheme == "file") return of_file(uri.rest, urdf_file);
  const std::string path = without_slashes(uri.rest);
  const auto found = in_package(path, urdf_file);
  const bool names_package = uri.rest.starts_with("//") && !uri.rest.starts_with("///");
  if (names_package) return found.value_or(fs::path(uri.scheme + "://" + path));
  std::error_code ignored;
  if (found && fs::exists(*found, ignored)) return *found;
  fs::path folder = fs::absolute(urdf_file, ignored).lexically_normal();
  while (folder.has_relative_path()) {
    folder = folder.parent_path();
    if (fs::exists(folder / path, ignored)) return folder / path;  // ends at the disk's root
  }
  return found.value_or(fs::path(uri.scheme + ":///" + path));
}

}  // namespace

bool is_mesh_uri(std::string_view uri) {
  const std::string scheme = split(uri).scheme;
  return scheme.empty() || scheme == "file" || scheme == "package" || scheme == "model";
}

fs::path resolve_mesh(const std::string& uri, const fs::path& urdf_file) {
  if (!is_mesh_uri(uri))
    throw InputError(urdf_file.string(), "a mesh path, file://, package:// or model://",
                     in_quotes(uri));
  const Uri as_written = split(uri);
  const Uri in_characters{as_written.scheme, decoded(as_written.rest)};
  // A URI is percent-encoded and a path is not, but some files confuse the two.
  const bool is_path = as_written.scheme.empty();
  const fs::path first = resolved(is_path ? as_written : in_characters, urdf_file);
  if (as_written.rest == in_characters.rest) return first;
  std::error_code ignored;
  if (fs::exists(first, ignored)) return first;
  const fs::path second = resolved(is_path ? in_characters : as_written, urdf_file);
  return fs::exists(second, ignored) ? second : first;
}

}  // namespace throng
