// WKT parsing reads polygons from well-known text. Other geometries are rejected.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "geometry/polygon.h"

namespace throng {

/// Parses POLYGON, MULTIPOLYGON and GEOMETRYCOLLECTION of these, in their own units; z is ignored.
/// Throws InputError at `where`.
std::vector<Polygon> parse_wkt(std::string_view wkt, const std::string& where);

}  // namespace throng
