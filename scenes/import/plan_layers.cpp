#include "scenes/import/plan_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/text_lines.h"

namespace throng {
namespace {

using Line = std::vector<Eigen::Vector2d>;

struct UseWord {
  std::string_view word;
  PlanUse use;
};
constexpr UseWord kUseWords[] = {{"obstacle", PlanUse::kObstacles}, {"column", PlanUse::kObstacles},
                                 {"wall", PlanUse::kWalls},         {"start", PlanUse::kStarts},
                                 {"source", PlanUse::kStarts},      {"spawn", PlanUse::kStarts},
                                 {"goal", PlanUse::kGoals},         {"exit", PlanUse::kGoals},
                                 {"target", PlanUse::kGoals}};
constexpr std::string_view kWalkableWords[] = {"walkable", "floor", "ground"};

bool has_word(std::string_view name, std::string_view word) {
  return name.find(word) != std::string_view::npos;
}

struct JoinedEdge {
  size_t from = 0, to = 0;  ///< nodes
  Line line;
  bool is_used = false;
};

/// Edges between the nodes, each once.
std::vector<JoinedEdge> distinct_edges(std::vector<Line>& lines, EndNodes& nodes) {
  std::vector<JoinedEdge> edges;
  std::set<std::vector<std::pair<double, double>>> seen;
  for (Line& line : lines) {
    if (line.size() < 2) continue;
    JoinedEdge edge;
    edge.from = nodes.number_of(line.front());
    edge.to = nodes.number_of(line.back());
    line.front() = nodes.point(edge.from);
    line.back() = nodes.point(edge.to);
    if (edge.from == edge.to && line.size() < 3) continue;
    std::vector<std::pair<double, double>> key;
    for (const Eigen::Vector2d& point : line) key.emplace_back(point.x(), point.y());
    if (std::lexicographical_compare(key.rbegin(), key.rend(), key.begin(), key.end()))
      std::reverse(key.begin(), key.end());
    if (!seen.insert(std::move(key)).second) continue;
    edge.line = std::move(line);
    edges.push_back(std::move(edge));
  }
  return edges;
}

class LineJoiner {
 public:
  LineJoiner(std::vector<JoinedEdge> edges, size_t nodes)
      : edges_(std::move(edges)), edges_at_(nodes) {
    for (size_t i = 0; i < edges_.size(); ++i) {
      edges_at_[edges_[i].from].push_back(i);
      edges_at_[edges_[i].to].push_back(i);
    }
  }

  void join(LayerShapes& shapes) {
    // First from ends and junctions; what remains are closed lines without a junction.
    for (const bool is_loop : {false, true})
      for (size_t i = 0; i < edges_.size(); ++i)
        for (const size_t node : {edges_[i].from, edges_[i].to})
          if (!edges_[i].is_used && (is_loop || edges_at_[node].size() != 2))
            add_chain(i, node, shapes);
  }

 private:
  void add_chain(size_t edge, size_t from, LayerShapes& shapes) {
    Line chain;
    size_t node = from;
    while (true) {
      JoinedEdge& next = edges_[edge];
      next.is_used = true;
      if (next.from != node) std::reverse(next.line.begin(), next.line.end());
      chain.insert(chain.end(), next.line.begin() + (chain.empty() ? 0 : 1), next.line.end());
      node = next.from == node ? next.to : next.from;
      if (edges_at_[node].size() != 2 || node == from) break;
      const size_t other = edges_at_[node][0] == edge ? edges_at_[node][1] : edges_at_[node][0];
      if (edges_[other].is_used) break;
      edge = other;
    }
    if (node != from) {
      shapes.lines.push_back(std::move(chain));
      return;
    }
    chain.pop_back();
    if (chain.size() >= 3) shapes.rings.push_back(std::move(chain));
  }

  std::vector<JoinedEdge> edges_;
  std::vector<std::vector<size_t>> edges_at_;
};

struct RingBox {
  Eigen::Vector2d min, max;
  bool contains(const RingBox& other) const {
    return (min.array() <= other.min.array()).all() && (max.array() >= other.max.array()).all();
  }
};

RingBox box_of(const Polygon::Ring& ring) {
  RingBox box{ring.front(), ring.front()};
  for (const Eigen::Vector2d& point : ring) {
    box.min = box.min.cwiseMin(point);
    box.max = box.max.cwiseMax(point);
  }
  return box;
}

enum class Side { kInside, kBoundary, kOutside };

Side side_of(const Eigen::Vector2d& point, const Polygon::Ring& ring, double rounding) {
  bool is_inside = false;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    const Eigen::Vector2d edge = b - a;
    const double length2 = edge.squaredNorm();
    const double share = length2 > 0 ? std::clamp((point - a).dot(edge) / length2, 0.0, 1.0) : 0;
    if ((a + share * edge - point).norm() <= rounding) return Side::kBoundary;
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < a.x() + (point.y() - a.y()) / edge.y() * edge.x())
      is_inside = !is_inside;
  }
  return is_inside ? Side::kInside : Side::kOutside;
}

/// Whether a ring lies inside another; it may touch it. Rings that cross are not inside.
bool is_inside(const Polygon::Ring& inner, const Polygon::Ring& outer, double rounding) {
  for (size_t i = 0; i < inner.size(); ++i) {
    const Eigen::Vector2d& corner = inner[i];
    const Eigen::Vector2d middle = (corner + inner[(i + 1) % inner.size()]) / 2;
    if (side_of(corner, outer, rounding) == Side::kOutside ||
        side_of(middle, outer, rounding) == Side::kOutside)
      return false;
  }
  return true;
}

std::string layer_text(const std::string& layer) {
  return layer.empty() ? "features without a layer" : "layer " + in_quotes(layer);
}

struct NestedRing {
  Polygon::Ring ring;
  double area = 0;
  RingBox box;
  size_t depth = 0;
  size_t parent = std::numeric_limits<size_t>::max();
  size_t polygon = 0;
  bool is_repeated = false;
};

}  // namespace

std::optional<PlanUse> stated_use(std::string_view layer) {
  const std::string name = lower(layer);
  std::optional<PlanUse> use;
  for (const UseWord& each : kUseWords) {
    if (!has_word(name, each.word)) continue;
    if (use && *use != each.use) return std::nullopt;
    use = each.use;
  }
  if (use) return use;
  for (const std::string_view word : kWalkableWords)
    if (has_word(name, word)) return PlanUse::kWalkable;
  return std::nullopt;
}

LayerChoice::LayerChoice(const ImportOptions& options) {
  for (const auto& [use_name, layers] : options.layers) {
    const auto* const found = std::find(kPlanUses.begin(), kPlanUses.end(), use_name);
    if (found == kPlanUses.end())
      throw InputError("--layer",
                       "USE=NAME with walkable, obstacles, walls, starts or goals as USE",
                       in_quotes(use_name));
    const auto use = static_cast<PlanUse>(found - kPlanUses.begin());
    for (const std::string& layer : layers) {
      const auto [at, is_new] = uses_.insert({lower(layer), {layer, use}});
      if (!is_new && at->second.use != use)
        throw InputError(
            "--layer", fmt::format("one use of {}", in_quotes(layer)),
            fmt::format("{} and {}", kPlanUses[static_cast<size_t>(at->second.use)], use_name));
    }
  }
}

std::optional<PlanUse> LayerChoice::use_of(std::string_view layer) const {
  const auto found = uses_.find(lower(layer));
  return found == uses_.end() ? std::nullopt : std::optional(found->second.use);
}

void LayerChoice::require(const std::vector<std::string>& layers, std::string_view what) const {
  for (const auto& [name, chosen] : uses_) {
    const auto is_this = [&folded_name = name](const std::string& layer) {
      return lower(layer) == folded_name;
    };
    if (std::any_of(layers.begin(), layers.end(), is_this)) continue;
    throw InputError("--layer", fmt::format("{}: {}", what, quoted_names(layers)),
                     in_quotes(chosen.name) + did_you_mean(chosen.name, layers));
  }
}

std::string quoted_names(const std::vector<std::string>& names) {
  constexpr size_t kMaxBytes = 300;
  if (names.empty()) return "none";
  std::string out;
  for (size_t i = 0; i < names.size(); ++i) {
    if (out.size() > kMaxBytes) return out + fmt::format(" and {} more", names.size() - i);
    out += (i == 0 ? "" : ", ") + in_quotes(names[i]);
  }
  return out;
}

void join_lines(LayerShapes& shapes, double tolerance) {
  EndNodes nodes(tolerance);
  std::vector<JoinedEdge> edges = distinct_edges(shapes.lines, nodes);
  shapes.lines.clear();
  LineJoiner(std::move(edges), nodes.count()).join(shapes);
}

std::vector<Polygon> nested_areas(std::vector<Polygon::Ring> rings) {
  std::vector<NestedRing> nested;
  for (Polygon::Ring& ring : rings) {
    if (ring.size() < 3) continue;
    const double area = std::abs(doubled_area(ring));
    const RingBox box = box_of(ring);
    NestedRing each;
    each.ring = std::move(ring);
    each.area = area;
    each.box = box;
    nested.push_back(std::move(each));
  }
  std::stable_sort(nested.begin(), nested.end(),
                   [](const NestedRing& a, const NestedRing& b) { return a.area > b.area; });
  std::vector<Polygon> out;
  for (size_t i = 0; i < nested.size(); ++i) {
    NestedRing& each = nested[i];
    const double rounding =
        1e-9 * std::max(each.box.min.cwiseAbs().maxCoeff(), each.box.max.cwiseAbs().maxCoeff());
    for (size_t outer = 0; outer < i && !each.is_repeated; ++outer) {
      if (nested[outer].is_repeated || !nested[outer].box.contains(each.box) ||
          !is_inside(each.ring, nested[outer].ring, rounding))
        continue;
      each.is_repeated = is_inside(nested[outer].ring, each.ring, rounding);
      ++each.depth;
      each.parent = outer;  // the smallest so far
    }
    if (each.is_repeated) continue;
    if (each.depth % 2 == 0) {
      each.polygon = out.size();
      out.push_back({each.ring, {}});
    } else {
      each.polygon = nested[each.parent].polygon;
      out[each.polygon].holes.push_back(each.ring);
    }
  }
  return out;
}

void UseTally::require_shapes(const ImportedPlan& plan, const std::string& file) const {
  if (!plan.walkable.empty() || !plan.obstacles.empty() || !plan.walls.empty() ||
      !plan.starts.empty() || !plan.goals.empty())
    return;
  size_t lines = 0, layers = 0;
  std::string where, first;
  for (const auto& [key, counts] : counts_) {
    if (counts.open_lines == 0) continue;
    if (layers++ == 0) {
      first = key.first;
      where = fmt::format("{} ({})", layer_text(first), kPlanUses[static_cast<size_t>(key.second)]);
    }
    lines += counts.open_lines;
  }
  if (lines == 0) return;
  if (layers > 1) where += " and " + counted(layers - 1, "more layer");
  const bool has_blank = first.find(' ') != std::string::npos;
  const std::string option =
      first.empty() ? ""
                    : fmt::format(" (--layer walls={})", has_blank ? '"' + first + '"' : first);
  throw InputError(
      file, "closed lines, or walls",
      fmt::format("{} no area on {}; draw closed polylines, or use the lines as walls{}",
                  counted(lines, "line that encloses", "lines that enclose"), where, option));
}

void UseTally::add_to(ImportedPlan& plan, const std::string& file) const {
  require_shapes(plan, file);
  for (const auto& [key, counts] : counts_) {
    const auto& [layer, use] = key;
    const std::string label = layer_text(layer);
    std::string parts;
    if (counts.areas > 0) parts = counted(counts.areas, "area");
    if (counts.holes > 0) parts += fmt::format(" with {}", counted(counts.holes, "hole"));
    if (counts.lines > 0) parts += (parts.empty() ? "" : " and ") + counted(counts.lines, "line");
    if (!parts.empty())
      plan.used.push_back(
          fmt::format("{} as {}: {}", label, kPlanUses[static_cast<size_t>(use)], parts));
    if (counts.open_lines > 0)
      plan.left_out.push_back(
          fmt::format("{}: {}", label,
                      counted(counts.open_lines, "open line that encloses no area",
                              "open lines that enclose no area")));
  }
}

void add_shapes(ImportedPlan& plan, PlanUse use, LayerShapes shapes, const std::string& name,
                UseTally::Counts& counts) {
  if (use == PlanUse::kWalls) {
    for (Polygon::Ring& ring : shapes.rings) {
      ring.push_back(ring.front());
      shapes.lines.push_back(std::move(ring));
    }
    counts.lines += shapes.lines.size();
    for (std::vector<Eigen::Vector2d>& line : shapes.lines)
      plan.walls.push_back({name_after(name), std::move(line)});
    shapes.rings.clear();
    shapes.lines.clear();
  }
  counts.open_lines += shapes.lines.size();
  for (Polygon& area : nested_areas(std::move(shapes.rings)))
    shapes.areas.push_back(std::move(area));
  counts.areas += shapes.areas.size();
  for (Polygon& area : shapes.areas) {
    counts.holes += area.holes.size();
    if (use == PlanUse::kWalkable)
      plan.walkable.push_back(std::move(area));
    else if (use == PlanUse::kStarts)
      plan.starts.push_back({name_after(name), std::move(area)});
    else if (use == PlanUse::kGoals)
      plan.goals.push_back({name_after(name), std::move(area)});
    else
      plan.obstacles.push_back({name_after(name), std::move(area)});  // a filled wall too
  }
}

}  // namespace throng
