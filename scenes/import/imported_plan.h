// ImportedPlan is a floor plan read from a file of another program, before it becomes a scene.
// Invariant: coordinates are in metres once import_plan() has returned it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/rectangle.h"
#include "crowd/people.h"
#include "geometry/polygon.h"

namespace throng {

/// Agents that enter at a start, as the file states them.
struct PlanArrivals {
  int64_t count = 0;
  double start_s = 0;
  double rate_per_s = 0;    ///< 0: all at start_s
  bool is_poisson = false;  ///< random intervals; otherwise even ones
};

struct NamedPolygon {
  std::string name;
  Polygon polygon;
  /// Only for a start: names of its goals, in the order of visits. Goals of the same name are
  /// alternatives. Empty: any goal of the plan.
  std::vector<std::string> goals = {};
  std::optional<PlanArrivals> arrivals = {};   ///< only for a start; none: the area decides
  std::optional<Distribution> speed_mps = {};  ///< only for a start; none: that of the plan
  bool stays = false;  ///< only for a start: its agents stay at their last goal
  std::optional<Distribution> wait_s = {};  ///< only for a goal; none: agents do not wait
};

/// A wall along a polyline; a closed wall repeats its first corner.
struct PlanWall {
  std::string name;
  std::vector<Eigen::Vector2d> line_m;
  double thickness_m = 0;  ///< 0: the file states none
};

struct ImportedPlan {
  std::string kind;               ///< for people: "DXF drawing"
  std::vector<Polygon> walkable;  ///< may overlap and touch; empty: the file states none
  std::vector<NamedPolygon> obstacles;
  std::vector<PlanWall> walls;
  std::vector<NamedPolygon> starts;       ///< areas where agents start or enter
  std::vector<NamedPolygon> goals;        ///< areas where agents go to or leave
  std::optional<Distribution> speed_mps;  ///< desired speed; none: the file states none
  std::optional<double> duration_s;       ///< duration of a run; none: the file states none
  std::optional<double> unit_m;           ///< length of the file's unit; none: the file states none
  /// Lower left corner of the plan in the file, in metres, if it lies far from the origin and was
  /// moved there; otherwise zero.
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  std::vector<std::string> used;      ///< what was used, a line each: "layer 'WALLS': 12 lines"
  std::vector<std::string> left_out;  ///< what was left out and why, a line each
};

struct ImportOptions {
  std::filesystem::path file;
  /// Layer of a drawing by its use: `walkable`, `obstacles`, `walls`, `starts` or `goals`.
  std::map<std::string, std::vector<std::string>> layers;
  std::optional<double> unit_m;  ///< overrides the unit of the file
};

/// Reads a plan; its kind is detected by content. Throws InputError with file, line, expectation,
/// finding and remedy.
ImportedPlan import_plan(const ImportOptions& options);

/// Smallest rectangle that contains the plan; none for an empty plan.
std::optional<Rectangle> plan_bounds(const ImportedPlan& plan);

/// Words about starts and goals that scene_text_of() adds; "" if the plan has both.
std::string added_group_note(const ImportedPlan& plan);

/// Returns the plan as a scene file. Groups walk from the starts to the nearest goals; without
/// starts or goals they use the largest walkable area once touching ones are joined. The first line
/// names `source`. If `wkt_file` is not empty, the ground is in that file, with the text of
/// ground_wkt_of(). Throws InputError if the areas cannot be joined.
std::string scene_text_of(const ImportedPlan& plan, const std::string& source,
                          const std::string& wkt_file = "");

/// Returns the walkable areas as well-known text.
std::string ground_wkt_of(const ImportedPlan& plan);

}  // namespace throng
