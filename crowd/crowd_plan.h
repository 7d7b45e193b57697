// CrowdPlan describes the place of a crowd: ground, obstacles, doors, and groups with their areas
// and goals.
// Invariant: plain data that its creator has validated.
#pragma once

#include <Eigen/Core>
#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "avatars/model/model.h"
#include "base/rectangle.h"
#include "crowd/people.h"
#include "culling/pair.h"
#include "geometry/area.h"
#include "geometry/polygon.h"

namespace throng {

/// Agents and obstacles together: their ids stay below PairKey::kMaxId.
inline constexpr int64_t kMaxBodies = PairKey::kMaxId;
/// Each obstacle is a body type, and types have 16 bits; the remaining types are for models.
inline constexpr int64_t kMaxObstacles = 60'000;
/// Each agent near a door tests all doors.
inline constexpr int64_t kMaxDoors = 1000;
/// A million cells of flow field are then 3 m wide, the coarsest that keep clear of walls.
inline constexpr double kMaxGround_m2 = 1e7;
/// Radii of steering discs. Walls are searched within 2.5 m of a centre (Walkable::kReach_m), so
/// the widest disc detects them half a metre before contact.
inline constexpr double kMinRadius_m = 0.05;
inline constexpr double kMaxRadius_m = 2.0;
inline constexpr double kMinDesiredSpeed_mps = 0.1;
inline constexpr double kMaxDesiredSpeed_mps = 4.0;
/// Maximum speed of agents when they enter.
inline constexpr double kMaxEntrySpeed_mps = 4.0;
/// Headings: a turn either way, with the rounding of its digits. Degrees are a mistake.
inline constexpr double kMaxHeading_rad = 7;
/// Heights in scenes. People: the range of the gait's curves; robots: from a toy to a crane.
inline constexpr double kMinPerson_m = 0.5;
inline constexpr double kMaxPerson_m = 2.5;
inline constexpr double kMinRobot_m = 0.01;
inline constexpr double kMaxRobot_m = 100;

struct QueueRule {
  double spacing_m = 0.9;  ///< distance between queue positions
  /// Corners of the line, first queue position first, at least two; empty: straight back.
  std::vector<Eigen::Vector2d> line_m;

  bool operator==(const QueueRule&) const = default;
};

/// A goal: any of its areas, by default the one with the shortest path.
struct Goal {
  Goal() = default;
  Goal(const Area& area) : areas{area} {}
  template <std::same_as<Rectangle> R>  // braces mean an Area
  Goal(const R& area) : areas{Area(area)} {}

  std::vector<Area> areas;  ///< one or more
  Distribution wait_s{};    ///< waiting time at the goal
  bool waypoint = false;    ///< reached on entry; otherwise agents walk to a place inside
  int capacity = 0;         ///< maximum number of agents inside each area; 0: unlimited
  bool has_queue = false;   ///< requested in the scene file; a capacity also implies a queue
  QueueRule queue{};

  /// Returns whether agents enter one after another, in the order of arrival.
  bool is_limited() const { return capacity > 0 || has_queue; }
  /// Capacity of an area of a limited goal: 1 without a capacity, as at a counter.
  int max_inside() const { return capacity > 0 ? capacity : 1; }

  bool contains(const Eigen::Vector2d& point) const {
    for (const Area& area : areas)
      if (area.contains(point)) return true;
    return false;
  }
  bool operator==(const Goal&) const = default;
};

/// An event that starts a group or moves a door. Its delay begins with the run, or once all agents
/// of a group have visited a goal. Stranded agents are not waited for.
struct TriggerRule {
  double delay_s = 0;
  std::string group;  ///< name; empty: the start of the run
  int goal = 0;       ///< number of the group's goal, counted from 1; 0: the last

  bool operator==(const TriggerRule&) const = default;
};

enum class OnArrival : uint8_t { kLoop, kStay, kLeave };

/// How a group is split into social groups of two to four members.
struct SocialGroupRule {
  double share = 0.6;  ///< fraction of agents that belong to a social group
  /// Relative frequencies of social groups of two, three and four; at least one is above 0.
  std::array<double, 3> sizes = {0.75, 0.21, 0.04};

  static constexpr int kMaxMembers = 4;  ///< members per social group
};

/// An area where agents of a group enter during the run.
struct Source {
  Area area;
  int count = 0;            ///< total number of agents; each has an id from the start
  double rate_per_s = 0;    ///< positive
  double start_s = 0;       ///< time of the first entry
  bool is_poisson = false;  ///< Poisson arrivals; otherwise evenly spaced
  /// speed along the path on entry; none: as agents ahead allow
  std::optional<double> enters_mps{};
};

/// Explicit places at the start, one per agent.
struct Starts {
  std::vector<Eigen::Vector2d> positions_m;
  std::vector<double> headings_rad;  ///< empty: towards the goal
  std::vector<double> speeds_mps;    ///< along the heading; empty: as agents ahead allow
  std::string file;                  ///< name of the file with the positions, for errors
  std::vector<int> lines;            ///< line of each position in that file
};

/// Agents of one body model that start in one area, or enter from sources, and walk to goals.
struct Group {
  std::string name;
  std::filesystem::path model;  ///< absolute path of a URDF; "adult" in the file is the bundled one
  std::shared_ptr<const Model> body;  ///< body model loaded from `model`; load_scene() sets it
  int count = 0;                      ///< number at the start
  int spare = 0;                      ///< number that the run may add, see Simulation::add()
  OnArrival on_arrival = OnArrival::kLoop;  ///< after the last goal
  /// Density on the free ground of the spawn area at the start (per m2), places bodies instead of
  /// discs. It determines `count`, see count_by_density(). 0: random placement of discs.
  double density_per_m2 = 0;
  Area spawn;                              ///< start area
  Starts starts;                           ///< without positions: random places in `spawn`
  std::vector<Source> sources;             ///< areas where agents enter later
  std::vector<Goal> goals;                 ///< visited in order
  Distribution premovement_s{0, 0, 0, 0};  ///< standing time before setting out
  std::optional<TriggerRule> after;        ///< no agent sets out before; the delay begins with it
  std::optional<SocialGroupRule> social_groups;  ///< none: all agents walk alone
  AgeShares ages = kAdultsOnly;
  std::optional<Distribution> speed_mps;   ///< desired speed; none: by age
  std::optional<Distribution> height_m;    ///< none: by age; see keep_own_size()
  std::optional<StyleShares> gait_styles;  ///< none: by age
  double radius_m = 0;                     ///< steering disc; 0: from the height
  std::optional<Eigen::Vector2d>
      look_at_m;  ///< point that standing agents look at; none: along their path
  /// Moved by Simulation::set_pose() instead of steering and gait. Such a group has one goal, its
  /// spawn area, and no sources.
  bool externally_controlled = false;
  /// LCM channel with the pose_command_t messages that also move such a group; empty: none.
  std::string control_channel;

  int64_t recorded = 0;           ///< number of agents from the scene's recording
  int64_t recorded_heights = 0;   ///< how many of these have a recorded height
  double tallest_recorded_m = 0;  ///< largest of these heights

  /// A channel implies external control.
  bool is_external() const { return externally_controlled || !control_channel.empty(); }
  /// Maximum number of agents.
  int64_t total() const {
    int64_t sum = count + recorded + spare;
    for (const Source& source : sources) sum += source.count;
    return sum;
  }
};

struct Obstacle {
  enum class Kind { kBox, kCylinder, kMesh, kPolygon };
  std::string name;
  Kind kind = Kind::kBox;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< a mesh: its origin
  double heading_rad = 0;
  Eigen::Vector3d size_m =
      Eigen::Vector3d::Ones();  ///< box: edges; cylinder: diameter, diameter, height; mesh: extent
  std::filesystem::path mesh_file;
  Mesh mesh;  ///< solid in the obstacle frame, for every kind
  /// Number shared by the pieces of a polygon or wall, from 1; 0: no other piece.
  uint32_t surface = 0;
  /// Wall along an edge of the floor, which stops agents with or without it.
  bool lines_floor = false;
};

/// A door leaf that agents pass while it is open. It is no body and never shuts on an agent.
struct Door {
  std::string name;
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero();  ///< ends of the leaf
  Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
  std::vector<TriggerRule> opens;  ///< shut before the first of these; without any, open at first
  std::vector<TriggerRule> closes;
  double thickness_m = kThickness_m;

  static constexpr double kThickness_m = 0.1;
};

struct CrowdPlan {
  uint64_t seed = 1;
  Rectangle ground;  ///< holds everything
  /// Walkable part of the ground; polygons do not overlap. Empty: all of the ground.
  std::vector<Polygon> floor;
  std::vector<Group> groups;
  std::vector<Obstacle> obstacles;
  std::vector<Door> doors;
  /// Height of the tallest avatar in a scene without groups; 0: kMaxPerson_m.
  double tallest_m = 0;
};

/// Area of the ground, or of its floor.
double ground_area_m2(const CrowdPlan& plan);

/// Returns whether a group has people; a group without a body counts as people.
bool has_people(const Group& group);

/// Sets the height of a robot or externally controlled group to its model's height unless the scene
/// specifies one. The height of people follows from their ages.
void keep_own_size(Group& group);

/// Returns the largest possible height of an avatar at any time (m): its own height if known,
/// otherwise the upper bound of the distribution.
double tallest_m(const CrowdPlan& plan);

/// Describes the size of a group's model, its scale and its place, as text for the user.
std::string describe_size(const Group& group);

}  // namespace throng
