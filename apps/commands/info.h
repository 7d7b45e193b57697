// What `throng info` prints of a scene and of a recording, and the plan that it draws.
// Invariant: the library's reader reads the whole file first; there are no partial descriptions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crowd/navigation/nav_mesh.h"
#include "recordings/recording.h"
#include "scenes/file/scene.h"

namespace throng {

/// An obstacle as the scene file states it: one body, or the pieces of a polygon or wall.
struct StatedObstacle {
  std::string name;
  std::vector<const Obstacle*> pieces;
};

/// Obstacles in the order of their first pieces. Keeps pointers into the scene.
std::vector<StatedObstacle> stated_obstacles(const Scene& scene);

/// The mesh on which agents find their paths while all doors are open; none if no agent steers.
std::optional<NavMesh> navigation_mesh_of(const Scene& scene);

/// Describes a scene with its navigation_mesh_of(). Lines end in a line feed. Throws InputError.
std::string describe_scene(const Scene& scene, const std::optional<NavMesh>& mesh);

/// `file` is the name as the user gave it.
std::string describe_recording(const Recording& recording, const std::string& file);

/// Returns an SVG with walkable ground, obstacles, doors, and start areas, goals and paths of each
/// group on `mesh`. Text has one size for every scene; a name without a place becomes a tooltip.
/// Throws InputError.
std::string draw_plan(const Scene& scene, const std::optional<NavMesh>& mesh);

}  // namespace throng
