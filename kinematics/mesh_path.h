// resolve_mesh() finds the meshes that a URDF names: package://, model://, file:// and plain paths.
// Invariant: it checks only whether folders, package.xml and files exist; their content is checked
// by readers.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace throng {

/// Returns whether resolve_mesh() accepts it: a path, or a URI with one of these schemes.
bool is_mesh_uri(std::string_view uri);

/// Returns the file of a <mesh filename=...>. A package is searched for upwards from the URDF: a
/// folder or subfolder of that name, or one whose package.xml has the name. Then in
/// $ROS_PACKAGE_PATH, then as PREFIX/share/PACKAGE in $AMENT_PREFIX_PATH. After three slashes, the
/// first folder of the path is taken as the package; last, the path is tried from the disk's root.
/// Codes like %20 are decoded, unless a file has that literal name. An unknown package leaves the
/// URI unchanged. Throws InputError for web addresses.
std::filesystem::path resolve_mesh(const std::string& uri, const std::filesystem::path& urdf_file);

}  // namespace throng
