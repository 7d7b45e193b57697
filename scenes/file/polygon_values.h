// Polygon values are areas and the ground of a scene file: rectangles, polygons with holes, or
// well-known text.
// Invariant: polygons are joined and without faults; errors name the place of a fault.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "geometry/area.h"
#include "scenes/file/key.h"

namespace throng {

/// Maximum number of vertices of an area: each agent and step may test all of its edges.
inline constexpr size_t kMaxAreaVertices = 10'000;

/// Reads a rectangle or polygons within the ground, with some of them on the floor. `what` names
/// the area in messages: "spawn".
Area read_area(ReadContext& context, const std::string& file, const YamlNode& node,
               const std::string& what);
/// The same from the keys of a map that also has others.
Area read_area(ReadContext& context, const Fields& fields, const std::string& what);

/// Reads the ground: sets `ground` and `floor`, and adds walls with `wall_height_m`.
void read_ground_value(ReadContext& context, const YamlNode& node, const std::string& file,
                       Scene& scene);

/// Reads `polygon` and `holes` of a map, see mended(); throws InputError for a fault.
std::vector<Polygon> read_polygon(ReadContext& context, const Fields& fields,
                                  const std::string& what);

/// Adds walls of this height along the edges of the floor, or of the ground without one. Throws
/// InputError at `where` if they are too many.
void add_walls(Scene& scene, double height_m, const std::string& where);

/// Solid between two heights over a convex ring. A concave obstacle consists of several.
Obstacle prism_obstacle(std::string name, const Polygon::Ring& ring, double bottom_m, double top_m);

/// Ground that holds the floor, with a margin for bodies that lean over its edges.
Rectangle ground_around(const std::vector<Polygon>& floor);

MapText area_text();
MapText ground_text();
/// Keys of an area, for maps that also have others.
std::vector<KeyText> area_key_texts();

}  // namespace throng
