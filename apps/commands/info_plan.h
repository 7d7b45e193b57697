// draw_plan() draws a scene from above before it runs, as an SVG.
#pragma once

#include <optional>
#include <string>

#include "crowd/navigation/nav_mesh.h"
#include "scenes/file/scene.h"

namespace throng {

/// Returns an SVG with walkable ground, obstacles, doors, and start areas, goals and paths of each
/// group on `mesh`. Text has one size for every scene; a name without a place becomes a tooltip.
/// Throws InputError.
std::string draw_plan(const Scene& scene, const std::optional<NavMesh>& mesh);

}  // namespace throng
