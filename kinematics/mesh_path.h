// Where the meshes lie that a URDF names: package://, model://, file:// and plain paths.
// One rule: looks at the disk only for folders, package.xml and whether a file is there; what is in
// it is the reader's question.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace throng {

/// Whether resolve_mesh() takes it: a path, or a URI of a scheme above.
bool is_mesh_uri(std::string_view uri);

/// The file a <mesh filename=...> means. A package is searched upwards from the URDF (the folder of
/// that name, a folder inside it of that name, or one whose package.xml has the name), then in
/// $ROS_PACKAGE_PATH, then as PREFIX/share/PACKAGE in $AMENT_PREFIX_PATH. With three slashes the
/// first folder of the path is taken for the package, and a path from the root of the disk is tried
/// last. %20 and its like stand for characters, unless a file is called so. An unknown package
/// leaves the URI as it is. Throws InputError for web addresses.
std::filesystem::path resolve_mesh(const std::string& uri, const std::filesystem::path& urdf_file);

}  // namespace throng
