// JuPedSim's plans: the area in its databases of trajectories, and its XML geometries before
// version 1. Walls of a room of an XML geometry are lines; its doors close them.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "base/errors.h"
#include "base/text.h"
#include "geometry/wkt.h"
#include "kinematics/xml_scan.h"
#include "recordings/jupedsim_area.h"
#include "recordings/units.h"
#include "scenes/import/plan_layers.h"
#include "scenes/import/plan_readers.h"

namespace throng {
namespace {

constexpr const char* kExpectedArea = "a database of JuPedSim with a walkable area";
constexpr const char* kExpectedGeometry = "a geometry of JuPedSim";
/// Ends of walls and doors that are this close meet.
constexpr double kSameEnd = 0.01;
/// Depth of the area in front of an exit, where agents leave.
constexpr double kExitDepth = 0.5;
constexpr double kMaxGeometryNumber = 1e12;
constexpr XmlLimits kGeometryLimits{.bytes = kMaxPlanBytes,
                                    .depth = 32,
                                    .elements = 1'000'000,
                                    .value_bytes = 4096,
                                    .attributes = 32,
                                    .name_bytes = 120};

double metres_of_unit(const std::string& unit, const std::string& where) {
  const std::optional<Unit> known = unit_named(unit);
  if (!known || known->quantity != Quantity::kLength || known->in_si == 0)
    throw InputError(where, "a unit of length, such as m or cm", in_quotes(unit));
  return known->in_si;
}

ImportedPlan database_plan(const RegularFile& file) {
  const StatedArea area = parse_stated_area(file);
  if (area.wkt.empty())
    throw ParseFailure(kExpectedArea, "one without an area in the table geometry");
  ImportedPlan plan;
  plan.kind = "JuPedSim database";
  plan.walkable = parse_wkt(area.wkt, file.path().string());
  // JuPedSim computes in metres.
  plan.unit_m = area.unit.empty() ? 1 : metres_of_unit(area.unit, file.path().string());
  plan.used.push_back("walkable area: " + counted(plan.walkable.size(), "polygon"));
  if (area.areas > 1)
    plan.left_out.push_back(fmt::format("{} of later frames", counted(area.areas - 1, "area")));
  plan.left_out.emplace_back("trajectories");
  return plan;
}

// ---- XML geometries

using JupedsimLine = std::vector<Eigen::Vector2d>;

/// Joins walls and doors to rings.
class RoomOutline {
 public:
  void add(const JupedsimLine& line) {
    for (size_t i = 0; i + 1 < line.size(); ++i) connect(node_at(line[i]), node_at(line[i + 1]));
  }

  /// Length of a gap between the only two loose ends, which is closed; 0 if there is none.
  double close_gap() {
    std::vector<uint32_t> loose;
    for (uint32_t i = 0; i < next_.size(); ++i)
      if (next_[i].size() == 1) loose.push_back(i);
    if (loose.size() != 2) return 0;
    connect(loose[0], loose[1]);
    return (ends_.point(loose[0]) - ends_.point(loose[1])).norm();
  }

  /// Outer borders of closed lines, counter-clockwise, the largest first. Others inside are holes.
  std::vector<Polygon> areas() {
    remove_loose_ends();
    std::vector<Polygon::Ring> rings;
    std::vector<uint8_t> is_seen(next_.size(), 0);
    std::vector<uint32_t> order(next_.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      const Eigen::Vector2d &p = ends_.point(a), &q = ends_.point(b);
      return std::pair(p.x(), p.y()) < std::pair(q.x(), q.y());
    });
    for (const uint32_t leftmost : order) {
      if (is_seen[leftmost] != 0 || next_[leftmost].empty()) continue;
      mark(leftmost, is_seen);
      Polygon::Ring ring = outer_border(leftmost);
      if (ring.size() >= 3 && doubled_area(ring) > 0) rings.push_back(std::move(ring));
    }
    std::stable_sort(rings.begin(), rings.end(), [](const auto& a, const auto& b) {
      return doubled_area(a) > doubled_area(b);
    });
    std::vector<Polygon> out;
    for (Polygon::Ring& ring : rings) {
      const auto around = std::find_if(out.begin(), out.end(), [&](const Polygon& polygon) {
        return PolygonLocator({Polygon{polygon.outline, {}}}).contains(ring.front());
      });
      if (around != out.end())
        around->holes.push_back(std::move(ring));
      else
        out.push_back({std::move(ring), {}});
    }
    return out;
  }

 private:
  uint32_t node_at(const Eigen::Vector2d& p) {
    const auto node = static_cast<uint32_t>(ends_.number_of(p));
    next_.resize(ends_.count());
    return node;
  }

  void connect(uint32_t a, uint32_t b) {
    if (a == b) return;
    next_[a].insert(b);
    next_[b].insert(a);
  }

  void remove_loose_ends() {
    for (uint32_t i = 0; i < next_.size(); ++i)
      for (uint32_t end = i; next_[end].size() == 1;) {
        const uint32_t neighbour = *next_[end].begin();
        next_[end].clear();
        next_[neighbour].erase(end);
        end = neighbour;
      }
  }

  void mark(uint32_t begin, std::vector<uint8_t>& is_seen) const {
    std::vector<uint32_t> open = {begin};
    is_seen[begin] = 1;
    while (!open.empty()) {
      const uint32_t node = open.back();
      open.pop_back();
      for (const uint32_t next : next_[node])
        if (is_seen[next] == 0) {
          is_seen[next] = 1;
          open.push_back(next);
        }
    }
  }

  /// Next node with the outside on the right: the first one counter-clockwise from `back`.
  uint32_t next_outside(uint32_t node, const Eigen::Vector2d& back) const {
    uint32_t best = node;
    double best_turn = 10;
    for (const uint32_t next : next_[node]) {
      const Eigen::Vector2d to = ends_.point(next) - ends_.point(node);
      double turn = std::atan2(back.x() * to.y() - back.y() * to.x(), back.dot(to));
      if (turn <= 1e-12) turn += 2 * M_PI;
      if (turn < best_turn) {
        best_turn = turn;
        best = next;
      }
    }
    return best;
  }

  Polygon::Ring outer_border(uint32_t begin) const {
    Polygon::Ring ring;
    size_t edges = 0;
    for (const std::set<uint32_t>& next : next_) edges += next.size();
    const uint32_t second = next_outside(begin, Eigen::Vector2d(-1, 0));
    uint32_t from = begin, to = second;
    do {
      ring.push_back(ends_.point(from));
      const uint32_t next = next_outside(to, ends_.point(from) - ends_.point(to));
      from = to;
      to = next;
    } while (!(from == begin && to == second) && ring.size() <= edges);
    return ring;
  }

  EndNodes ends_{kSameEnd};
  std::vector<std::set<uint32_t>> next_;  ///< neighbours of each node
};

struct SubroomKey {
  std::string room, subroom;
  auto operator<=>(const SubroomKey&) const = default;
};

struct Subroom {
  std::string name;
  std::vector<JupedsimLine> walls, doors;
};

class JupedsimGeometry {
 public:
  explicit JupedsimGeometry(const std::string& file) : file_(file) {}

  ImportedPlan read(std::string_view text) {
    reject_document_type(text);
    elements_ = scan_xml(text, file_, kGeometryLimits);
    const XmlElement& root = elements_.front();
    if (root.name != "geometry")
      throw InputError(at_line(file_, root.line), "the element geometry of JuPedSim",
                       in_quotes(root.name));
    plan_.kind = "JuPedSim geometry";
    const std::string* const unit = root.attribute("unit");
    plan_.unit_m = unit == nullptr ? 1 : metres_of_unit(*unit, at_line(file_, root.line));
    same_end_ = kSameEnd / *plan_.unit_m;
    for (const XmlElement& part : children(root)) {
      if (part.name == "rooms")
        for (const XmlElement& room : children(part)) read_subrooms_of(room);
      else if (part.name == "transitions")
        read_doors(part, "transition");
      else if (part.name == "goals")
        read_goals(part);
      else
        ++left_out_[std::string(part.name)];
    }
    close_subrooms();
    add_inner_walls();
    add_exits();
    summarise();
    return std::move(plan_);
  }

 private:
  struct Door {
    JupedsimLine line;
    std::string name;
    bool is_exit;
  };

  /// Children of an element, for a loop.
  class Children {
   public:
    class Iterator {
     public:
      Iterator(const std::vector<XmlElement>& all, int at) : all_(all), at_(at) {}
      const XmlElement& operator*() const { return all_[static_cast<size_t>(at_)]; }
      Iterator& operator++() {
        at_ = all_[static_cast<size_t>(at_)].next_sibling;
        return *this;
      }
      bool operator!=(const Iterator& other) const { return at_ != other.at_; }

     private:
      const std::vector<XmlElement>& all_;
      int at_;
    };
    Children(const std::vector<XmlElement>& all, int first) : all_(all), first_(first) {}
    Iterator begin() const { return {all_, first_}; }
    Iterator end() const { return {all_, -1}; }

   private:
    const std::vector<XmlElement>& all_;
    int first_;
  };
  Children children(const XmlElement& element) const { return {elements_, element.first_child}; }

  /// A document type can define entities, which the scanner does not know.
  void reject_document_type(std::string_view text) const {
    const size_t at = std::min(text.find("<!DOCTYPE"), text.find("<!ENTITY"));
    if (at == text.npos) return;
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<ptrdiff_t>(at), '\n');
    throw InputError(at_line(file_, static_cast<int>(line)), "XML without a document type",
                     in_quotes(text.substr(at, 10)) + "; remove the declaration");
  }

  [[noreturn]] void reject(const XmlElement& element, const std::string& expected,
                           const std::string& found) const {
    throw InputError(at_line(file_, element.line), expected, found);
  }

  static std::string text_of(const XmlElement& element, std::string_view key) {
    const std::string* const value = element.attribute(key);
    return value != nullptr ? *value : "";
  }

  /// Name by a caption, if there is one, or the element and its id.
  static std::string name_of(const XmlElement& element) {
    const std::string caption = text_of(element, "caption");
    return name_after(stripped(caption).empty()
                          ? fmt::format("{} {}", element.name, text_of(element, "id"))
                          : caption);
  }

  double coordinate(const XmlElement& vertex, const char* key) const {
    const std::string* const text = vertex.attribute(key);
    if (text == nullptr)
      reject(vertex, fmt::format("px and py of a {}", vertex.name), "no " + std::string(key));
    std::string_view number = stripped(*text);
    if (number.starts_with('+')) number.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error != std::errc() || number.empty() || end != number.data() + number.size() ||
        !(std::abs(value) <= kMaxGeometryNumber))
      reject(vertex, fmt::format("a number as {}", key), in_quotes(*text));
    return value;
  }

  JupedsimLine line_of(const XmlElement& parent) {
    JupedsimLine line;
    for (const XmlElement& vertex : children(parent)) {
      if (vertex.name != "vertex") continue;
      if (++vertices_ > kMaxPlanVertices)
        reject(vertex, fmt::format("at most {} vertices", kMaxPlanVertices), "more");
      line.emplace_back(coordinate(vertex, "px"), coordinate(vertex, "py"));
    }
    return line;
  }

  void read_subrooms_of(const XmlElement& room) {
    if (room.name != "room") {
      ++left_out_[std::string(room.name)];
      return;
    }
    levels_.insert(text_of(room, "zpos").empty() ? 0 : coordinate(room, "zpos"));
    for (const XmlElement& part : children(room)) {
      if (part.name == "subroom")
        read_subroom(room, part);
      else if (part.name == "crossings")
        read_doors(part, "crossing", text_of(room, "id"));
      else if (part.name == "obstacle")
        read_obstacle(part);
      else
        ++left_out_[std::string(part.name)];
    }
  }

  void read_subroom(const XmlElement& room, const XmlElement& element) {
    const SubroomKey key{text_of(room, "id"), text_of(element, "id")};
    if (subrooms_.contains(key))
      reject(
          element, "every subroom once",
          fmt::format("subroom {} of room {} again", in_quotes(key.subroom), in_quotes(key.room)));
    Subroom& subroom = subrooms_[key];
    subroom.name = name_after(fmt::format("{}, subroom {}", name_of(room), key.subroom));
    if (text_of(element, "class").find("stair") != std::string::npos ||
        text_of(element, "class").find("escalator") != std::string::npos)
      ++stairs_;
    for (const XmlElement& part : children(element)) {
      if (part.name == "polygon")
        subroom.walls.push_back(line_of(part));
      else if (part.name == "obstacle")
        read_obstacle(part);
      else if (part.name != "up" && part.name != "down")
        ++left_out_[std::string(part.name)];
    }
  }

  void read_obstacle(const XmlElement& element) {
    RoomOutline outline;
    for (const XmlElement& part : children(element))
      if (part.name == "polygon") {
        JupedsimLine line = line_of(part);
        if (!line.empty()) line.push_back(line.front());
        outline.add(in_metres(line));
      }
    const std::vector<Polygon> areas = outline.areas();
    if (areas.empty()) ++left_out_["obstacle without an area"];
    for (const Polygon& area : areas) plan_.obstacles.push_back({name_of(element), in_units(area)});
  }

  void read_doors(const XmlElement& parent, std::string_view name, const std::string& room = "") {
    for (const XmlElement& element : children(parent)) {
      if (element.name != name) {
        ++left_out_[element.name == "file" ? "file with more transitions"
                                           : std::string(element.name)];
        continue;
      }
      Door door{line_of(element), name_of(element), false};
      if (door.line.size() < 2)
        reject(element, fmt::format("two vertices of a {}", name),
               counted(door.line.size(), "vertex", "vertices"));
      int sides = 0;
      for (const char side : {'1', '2'}) {
        const std::string own =
            name == "crossing" ? room : text_of(element, fmt::format("room{}_id", side));
        const auto found =
            subrooms_.find({own, text_of(element, fmt::format("subroom{}_id", side))});
        if (found == subrooms_.end()) continue;
        found->second.doors.push_back(door.line);
        ++sides;
      }
      door.is_exit = sides == 1;
      doors_.push_back(std::move(door));
    }
  }

  void read_goals(const XmlElement& goals) {
    for (const XmlElement& goal : children(goals))
      for (const XmlElement& part : children(goal)) {
        if (part.name != "polygon") continue;
        JupedsimLine line = line_of(part);
        if (line.size() > 1 && line.front() == line.back()) line.pop_back();
        if (line.size() < 3)
          reject(part, "three vertices of a goal", counted(line.size(), "vertex", "vertices"));
        plan_.goals.push_back({name_of(goal), {line, {}}});
      }
  }

  /// RoomOutline joins ends by their distance in metres.
  JupedsimLine in_metres(const JupedsimLine& line) const {
    JupedsimLine out;
    for (const Eigen::Vector2d& p : line) out.push_back(p * *plan_.unit_m);
    return out;
  }
  Polygon in_units(Polygon area) const {
    for (Eigen::Vector2d& p : area.outline) p /= *plan_.unit_m;
    for (Polygon::Ring& hole : area.holes)
      for (Eigen::Vector2d& p : hole) p /= *plan_.unit_m;
    return area;
  }

  void close_subrooms() {
    size_t closed = 0;
    for (auto& [key, subroom] : subrooms_) {
      RoomOutline outline;
      for (const auto* lines : {&subroom.walls, &subroom.doors})
        for (const JupedsimLine& line : *lines) outline.add(in_metres(line));
      const double gap_m = outline.close_gap();
      std::vector<Polygon> areas = outline.areas();
      if (areas.empty()) {
        for (const JupedsimLine& wall : subroom.walls)
          if (wall.size() >= 2) plan_.walls.push_back({subroom.name, wall, 0});
        plan_.left_out.push_back(fmt::format(
            "area of {}: its walls do not close; they are walls alone", in_quotes(subroom.name)));
        continue;
      }
      ++closed;
      if (gap_m > kSameEnd)
        plan_.left_out.push_back(
            fmt::format("a gap of {:.3g} m in {}, which has no door, is closed", gap_m,
                        in_quotes(subroom.name)));
      for (const Polygon& area : areas) plan_.walkable.push_back(in_units(area));
    }
    if (closed > 0) plan_.used.push_back(counted(closed, "subroom"));
  }

  /// Walls with walkable ground on both sides vanish when rooms are joined: they stay as walls.
  void add_inner_walls() {
    const PolygonLocator ground(plan_.walkable);
    std::vector<Eigen::Vector2d> corners;
    for (const Polygon& polygon : plan_.walkable)
      corners.insert(corners.end(), polygon.outline.begin(), polygon.outline.end());
    std::sort(corners.begin(), corners.end(),
              [](const auto& a, const auto& b) { return a.x() < b.x(); });
    std::set<std::array<int64_t, 4>> seen;
    size_t inner = 0;
    for (const auto& [key, subroom] : subrooms_)
      for (const JupedsimLine& wall : subroom.walls)
        for (size_t i = 0; i + 1 < wall.size(); ++i)
          inner += add_inner_pieces({wall[i], wall[i + 1]}, subroom.name, ground, corners, seen);
    if (inner > 0) plan_.used.push_back(counted(inner, "wall") + " between walkable areas");
  }

  size_t add_inner_pieces(const JupedsimLine& wall, const std::string& name,
                          const PolygonLocator& ground, const std::vector<Eigen::Vector2d>& corners,
                          std::set<std::array<int64_t, 4>>& seen) {
    const Eigen::Vector2d along = wall[1] - wall[0];
    const double length = along.norm();
    if (!(length > same_end_)) return 0;
    const Eigen::Vector2d unit = along / length, side(-unit.y(), unit.x());
    // Ends of pieces: corners of rooms on the wall.
    std::vector<double> ends = {0, length};
    const double low = std::min(wall[0].x(), wall[1].x()) - same_end_,
                 high = std::max(wall[0].x(), wall[1].x()) + same_end_;
    auto corner = std::lower_bound(corners.begin(), corners.end(), low,
                                   [](const auto& p, double x) { return p.x() < x; });
    for (; corner != corners.end() && corner->x() <= high; ++corner) {
      const Eigen::Vector2d from = *corner - wall[0];
      const double t = from.dot(unit);
      if (std::abs(from.dot(side)) <= same_end_ && t > same_end_ && t < length - same_end_)
        ends.push_back(t);
    }
    std::sort(ends.begin(), ends.end());
    size_t added = 0;
    for (size_t i = 0; i + 1 < ends.size(); ++i) {
      if (ends[i + 1] - ends[i] <= same_end_) continue;
      const Eigen::Vector2d middle = wall[0] + 0.5 * (ends[i] + ends[i + 1]) * unit;
      if (!ground.contains(middle + 2 * same_end_ * side) ||
          !ground.contains(middle - 2 * same_end_ * side))
        continue;
      Eigen::Vector2d from = wall[0] + ends[i] * unit, to = wall[0] + ends[i + 1] * unit;
      if (std::pair(to.x(), to.y()) < std::pair(from.x(), from.y())) std::swap(from, to);
      const auto key = [&](double value) { return std::llround(value / same_end_); };
      if (!seen.insert({key(from.x()), key(from.y()), key(to.x()), key(to.y())}).second) continue;
      plan_.walls.push_back({name, {from, to}, 0});
      ++added;
    }
    return added;
  }

  void add_exits() {
    const PolygonLocator ground(plan_.walkable);
    const double depth = kExitDepth / *plan_.unit_m;
    size_t exits = 0;
    for (const Door& door : doors_) {
      if (!door.is_exit) continue;
      const Eigen::Vector2d from = door.line.front(), to = door.line.back();
      if (!((to - from).norm() > same_end_)) continue;
      const Eigen::Vector2d unit = (to - from).normalized(), side(-unit.y(), unit.x());
      const Eigen::Vector2d middle = 0.5 * (from + to);
      const bool is_left = ground.contains(middle + 2 * same_end_ * side);
      if (is_left == ground.contains(middle - 2 * same_end_ * side)) continue;
      const Eigen::Vector2d in = (is_left ? depth : -depth) * side;
      plan_.goals.push_back({door.name, {{from, to, to + in, from + in}, {}}});
      ++exits;
    }
    if (exits > 0)
      plan_.used.push_back(
          fmt::format("{} as goals, {} m deep", counted(exits, "exit"), kExitDepth));
  }

  void summarise() {
    if (!plan_.obstacles.empty()) plan_.used.push_back(counted(plan_.obstacles.size(), "obstacle"));
    if (stairs_ > 0)
      plan_.left_out.push_back(
          fmt::format("slope of {}, which are level ground", counted(stairs_, "stair")));
    if (levels_.size() > 1)
      plan_.left_out.push_back(fmt::format("heights: {} levels lie on one ground", levels_.size()));
    for (const auto& [what, count] : left_out_)
      plan_.left_out.push_back(fmt::format("{}: {}", escaped(what).substr(0, 60), count));
  }

  const std::string& file_;
  std::vector<XmlElement> elements_;
  ImportedPlan plan_;
  double same_end_ = kSameEnd;
  std::map<SubroomKey, Subroom> subrooms_;
  std::vector<Door> doors_;
  std::set<double> levels_;
  std::map<std::string, size_t> left_out_;
  size_t vertices_ = 0, stairs_ = 0;
};

}  // namespace

bool is_jupedsim_database(std::string_view head) { return is_sqlite(head); }

ImportedPlan read_jupedsim_database(const ImportOptions& options) {
  const RegularFile file(options.file, kExpectedArea, kMaxPlanDatabaseBytes);
  reject_unfinished_database(options.file);
  const SandboxedParser parser{
      .library = "SQLite", .expected = kExpectedArea, .remedy = "try `sqlite3 FILE .recover`"};
  return read_plan_sandboxed(file, parser, database_plan, kMaxPlanDatabaseBytes);
}

bool is_jupedsim_geometry(std::string_view head) { return root_tag_of(head) == "geometry"; }

ImportedPlan read_jupedsim_geometry(const ImportOptions& options) {
  const RegularFile file(options.file, kExpectedGeometry, kMaxPlanBytes);
  const SandboxedParser parser{.library = "the reader of geometries",
                               .expected = kExpectedGeometry,
                               .remedy = "save it again with JPSeditor"};
  const std::string name = options.file.string();
  return read_plan_sandboxed(file, parser, [&](const RegularFile& opened) {
    return JupedsimGeometry(name).read(plan_text(opened, kExpectedGeometry));
  });
}

}  // namespace throng
