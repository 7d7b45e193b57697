// WKT plans: a geometry after the other, each on one line or several; all of them are walkable.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "base/errors.h"
#include "base/text.h"
#include "geometry/wkt.h"
#include "recordings/readers/text_lines.h"
#include "scenes/import/plan_readers.h"

namespace throng {
namespace {

const SandboxedParser kWktParser{.library = "the reader of WKT",
                                 .expected = "a plan in WKT",
                                 .remedy = "write the plan as POLYGON or MULTIPOLYGON"};

constexpr std::string_view kWktKinds[] = {
    "POLYGON", "MULTIPOLYGON", "GEOMETRYCOLLECTION", "LINESTRING", "MULTILINESTRING",
    "POINT",   "MULTIPOINT",   "CURVEPOLYGON",       "TRIANGLE",   "MULTISURFACE",
    "SRID"};

bool begins_geometry(std::string_view line) {
  const std::string_view text = trimmed(line);
  const size_t length = static_cast<size_t>(
      std::find_if_not(text.begin(), text.end(),
                       [](char c) { return (c | 32) >= 'a' && (c | 32) <= 'z'; }) -
      text.begin());
  const std::string word = lower(text.substr(0, length));
  return std::any_of(std::begin(kWktKinds), std::end(kWktKinds),
                     [&](std::string_view kind) { return lower(kind) == word; });
}

struct WktGeometry {
  std::string text;
  int line = 0;
};

/// Geometries and their first lines; comments (#) may stand between them.
std::vector<WktGeometry> geometries_of(std::string_view text) {
  std::vector<WktGeometry> out;
  int64_t open_brackets = 0;
  for (int line = 1; !text.empty(); ++line) {
    const size_t end = text.find('\n');
    const std::string_view content = trimmed(text.substr(0, end).substr(0, text.find('\r')));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (content.empty() || content.starts_with('#')) continue;
    // A collection may have its geometries on lines of their own: a new one begins after the last
    // bracket is closed.
    if (out.empty() || (open_brackets <= 0 && begins_geometry(content))) {
      out.push_back({std::string(content), line});
      open_brackets = 0;
    } else {
      out.back().text += ' ';
      out.back().text += content;
    }
    open_brackets += std::count(content.begin(), content.end(), '(');
    open_brackets -= std::count(content.begin(), content.end(), ')');
  }
  return out;
}

/// Without "SRID=25832;" (EWKT).
std::string_view without_reference(std::string_view text, const std::string& where) {
  if (!lower(text.substr(0, 5)).starts_with("srid=")) return text;
  const size_t end = text.find(';');
  if (end == std::string_view::npos)
    throw InputError(where, "SRID=NUMBER;GEOMETRY", in_quotes(text));
  const std::string_view reference = trimmed(text.substr(5, end - 5));
  if (reference == "4326")
    throw InputError(where, "coordinates with a unit of length",
                     "degrees (SRID 4326); project the plan to metres, for example to UTM");
  return text.substr(end + 1);
}

ImportedPlan wkt_plan(const RegularFile& file) {
  const std::string name = file.path().string();
  ImportedPlan out;
  out.kind = "WKT";
  size_t vertices = 0;
  const std::vector<WktGeometry> geometries = geometries_of(plan_text(file, kWktParser.expected));
  for (const WktGeometry& geometry : geometries) {
    const std::string where = at_line(name, geometry.line);
    std::vector<Polygon> areas = parse_wkt(without_reference(geometry.text, where), where);
    vertices += vertex_count(areas);
    if (vertices > kMaxPlanVertices)
      throw InputError(where, fmt::format("at most {} vertices in the file", kMaxPlanVertices),
                       "more; simplify the plan");
    out.walkable.insert(out.walkable.end(), std::make_move_iterator(areas.begin()),
                        std::make_move_iterator(areas.end()));
  }
  out.used.push_back(fmt::format("{} as walkable: {}",
                                 counted(geometries.size(), "geometry", "geometries"),
                                 counted(out.walkable.size(), "area")));
  return out;
}

}  // namespace

bool is_wkt_plan(std::string_view head) {
  if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
  while (!head.empty()) {
    const size_t end = std::min(head.find('\n'), head.size());
    const std::string_view line = trimmed(head.substr(0, end));
    head.remove_prefix(std::min(end + 1, head.size()));
    if (line.empty() || line == "\r" || line.starts_with('#')) continue;
    return begins_geometry(line);
  }
  return false;
}

ImportedPlan read_wkt_plan(const ImportOptions& options) {
  const RegularFile file(options.file, kWktParser.expected, kMaxPlanBytes);
  return read_plan_sandboxed(file, kWktParser, wkt_plan);
}

}  // namespace throng
