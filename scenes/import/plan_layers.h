// Plan layers decide what the layers of a drawing are used for, and turn their shapes into areas
// and walls.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/import/imported_plan.h"

namespace throng {

enum class PlanUse : uint8_t { kWalkable, kObstacles, kWalls, kStarts, kGoals };

/// In the order of PlanUse, as --layer names them.
inline constexpr std::array<std::string_view, 5> kPlanUses = {"walkable", "obstacles", "walls",
                                                              "starts", "goals"};

/// Use that the words of a layer's name state; none for no use and for several. Walkable names are
/// weak: "ground floor walls" is a layer of walls.
std::optional<PlanUse> stated_use(std::string_view layer);

/// LayerChoice holds the layers of --layer.
class LayerChoice {
 public:
  /// Throws InputError for an unknown use and for a layer with two uses.
  explicit LayerChoice(const ImportOptions& options);

  bool is_empty() const { return uses_.empty(); }
  /// Use that the user has chosen, regardless of case.
  std::optional<PlanUse> use_of(std::string_view layer) const;
  /// Throws InputError for a chosen layer that is not among those of the file.
  void require(const std::vector<std::string>& layers, std::string_view what) const;

 private:
  struct Chosen {
    std::string name;  ///< name as the user wrote it
    PlanUse use;
  };
  std::map<std::string, Chosen> uses_;  ///< keys: names in lower case
};

/// EndNodes numbers the ends of lines; ends within the tolerance share a number.
class EndNodes {
 public:
  explicit EndNodes(double tolerance) : tolerance_(tolerance) {}

  size_t number_of(const Eigen::Vector2d& point) {
    const Cell cell{cell_of(point.x()), cell_of(point.y())};
    for (int64_t x = -1; x <= 1; ++x)
      for (int64_t y = -1; y <= 1; ++y) {
        const auto found = cells_.find({cell.first + x, cell.second + y});
        if (found == cells_.end()) continue;
        for (const size_t node : found->second)
          if ((points_[node] - point).norm() <= tolerance_) return node;
      }
    cells_[cell].push_back(points_.size());
    points_.push_back(point);
    return points_.size() - 1;
  }
  const Eigen::Vector2d& point(size_t node) const { return points_[node]; }
  size_t count() const { return points_.size(); }

 private:
  using Cell = std::pair<int64_t, int64_t>;
  int64_t cell_of(double x) const {
    constexpr double kMaxCell = 4e18;
    return static_cast<int64_t>(std::clamp(std::floor(x / tolerance_), -kMaxCell, kMaxCell));
  }

  double tolerance_;
  std::map<Cell, std::vector<size_t>> cells_;
  std::vector<Eigen::Vector2d> points_;
};

/// Names in quotes, joined by commas, cut after some: for errors.
std::string quoted_names(const std::vector<std::string>& names);

/// Shapes of one layer, in units of the file.
struct LayerShapes {
  std::vector<Polygon> areas;                       ///< filled
  std::vector<Polygon::Ring> rings;                 ///< closed lines
  std::vector<std::vector<Eigen::Vector2d>> lines;  ///< open lines

  bool is_empty() const { return areas.empty() && rings.empty() && lines.empty(); }
};

/// Joins lines whose ends meet within `tolerance`, where no third line ends. Lines that become
/// closed move to `rings`; repeated lines are dropped.
void join_lines(LayerShapes& shapes, double tolerance);

/// Polygons of closed lines: lines inside others are holes, and lines inside holes are areas again.
std::vector<Polygon> nested_areas(std::vector<Polygon::Ring> rings);

/// UseTally counts the shapes of each layer that are used, for plan.used and plan.left_out.
class UseTally {
 public:
  struct Counts {
    size_t areas = 0, holes = 0, lines = 0;
    size_t open_lines = 0;  ///< that enclose no area
  };
  /// An empty name stands for features without a layer.
  Counts& of(const std::string& layer, PlanUse use) { return counts_[{layer, use}]; }
  /// Adds the lines of text. Throws InputError if all shapes are lines that enclose no area.
  void add_to(ImportedPlan& plan, const std::string& file) const;

 private:
  void require_shapes(const ImportedPlan& plan, const std::string& file) const;

  std::map<std::pair<std::string, PlanUse>, Counts> counts_;
};

/// Adds shapes to the plan, after join_lines(). `name` names obstacles, walls, starts and goals.
void add_shapes(ImportedPlan& plan, PlanUse use, LayerShapes shapes, const std::string& name,
                UseTally::Counts& counts);

}  // namespace throng
