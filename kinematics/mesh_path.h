// Where the meshes lie that a URDF names: package://, model://, file:// and plain paths.
// One rule: looks at the disk only for folders and package.xml; whether the mesh exists is the
// reader's question.
#pragma once

#include <filesystem>
#include <string>

namespace throng {

/// The file a <mesh filename=...> means. A package is searched upwards from the URDF (the folder of
/// that name, a folder inside it of that name, or one whose package.xml has the name), then in
/// $ROS_PACKAGE_PATH, then as PREFIX/share/PACKAGE in $AMENT_PREFIX_PATH. An unknown package leaves
/// the URI as it is. Throws InputError for web addresses.
std::filesystem::path resolve_mesh(const std::string& uri, const std::filesystem::path& urdf_file);

}  // namespace throng
