// What a crowd needs to know of the place that it walks in: ground, obstacles, doors, and the
// groups with their areas and goals.
// One rule: data alone; whoever fills it has checked it.
#pragma once

#include <Eigen/Core>
#include <array>
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

namespace throng {

/// People and obstacles together: their ids stay below PairKey::kMaxId.
inline constexpr int64_t kMaxBodies = PairKey::kMaxId;
/// Every obstacle is a body type of its own, and types are 16 bits; the rest is for models.
inline constexpr int64_t kMaxObstacles = 60'000;
/// Everybody who walks near one looks at each.
inline constexpr int64_t kMaxDoors = 1000;
/// A million cells of flow field are then 3 m wide, the coarsest that keep clear of walls.
inline constexpr double kMaxGround_m2 = 1e7;
/// Radii of steering discs. Walls are looked up 2.5 m around a centre (Walkable::kReach_m): the
/// widest disc sees them half a metre before it touches them.
inline constexpr double kMinRadius_m = 0.05;
inline constexpr double kMaxRadius_m = 2.0;
/// Heights that a scene may ask for: of people as far as the gait's curves hold, of robots from a
/// toy to a crane.
inline constexpr double kMinPerson_m = 0.5;
inline constexpr double kMaxPerson_m = 2.5;
inline constexpr double kMinRobot_m = 0.01;
inline constexpr double kMaxRobot_m = 100;

/// How people stand who wait for their turn at a goal.
struct QueueRule {
  double spacing_m = 0.9;  ///< from one to the next, middle to middle
  /// From where the first stands to the last, at least two corners; none: straight back.
  std::vector<Eigen::Vector2d> line_m;

  bool operator==(const QueueRule&) const = default;
};

/// Somewhere to go: into any one of the areas, whichever has the shortest way.
struct Goal {
  Goal() = default;
  Goal(const Rectangle& area) : areas{area} {}

  std::vector<Rectangle> areas;  ///< at least one
  Distribution wait_s{};         ///< how long they stand there before going on
  bool waypoint = false;   ///< reached on entering it; otherwise people walk to a place inside
  int capacity = 0;        ///< of each area: how many are inside at once; 0: any number
  bool has_queue = false;  ///< the file says so; a capacity says so, too
  QueueRule queue{};

  /// People come in one after another, in the order in which they came.
  bool is_limited() const { return capacity > 0 || has_queue; }
  /// Of an area of a limited goal: without a capacity it is a counter, for one at a time.
  int max_inside() const { return capacity > 0 ? capacity : 1; }

  bool contains(const Eigen::Vector2d& point) const {
    for (const Rectangle& area : areas)
      if (area.contains(point)) return true;
    return false;
  }
  bool operator==(const Goal&) const = default;
};

/// A time of a run that is known when it comes: so long after the start, or after everybody of a
/// group has been at a goal. Whoever cannot get there is not waited for.
struct TriggerRule {
  double delay_s = 0;
  std::string group;  ///< its name; empty: after the start of the run
  int goal = 0;       ///< which of the group's, counted from 1; 0: the last

  bool operator==(const TriggerRule&) const = default;
};

/// What people do who reached their last goal.
enum class OnArrival : uint8_t { kLoop, kStay, kLeave };

/// Who of a group walks with whom: in parties of two to four, whose members are companions.
struct SocialGroupRule {
  double share = 0.6;  ///< of the people, how many walk in a party
  /// How many parties of two, of three and of four there are, relative to each other; at least one
  /// is above 0.
  std::array<double, 3> sizes = {0.75, 0.21, 0.04};

  static constexpr int kMaxMembers = 4;  ///< people in a party
};

/// Where people of a group enter while the scene runs.
struct Source {
  Rectangle area;
  int count = 0;                       ///< in all; each has an id from the start
  double rate_per_s = 0;               ///< above 0
  double start_s = 0;                  ///< when the first one comes
  bool is_poisson = false;             ///< a Poisson process; otherwise evenly spaced
  std::optional<double> enters_mps{};  ///< along their way; none: as those ahead let them
};

/// People of one model who start in one area, or enter from sources, and walk to goals.
struct Group {
  std::string name;
  std::filesystem::path model;  ///< a URDF, absolute; "adult" in the file means the bundled one
  std::shared_ptr<const Model> body;        ///< what `model` holds; load_scene() fills it
  int count = 0;                            ///< at the start
  OnArrival on_arrival = OnArrival::kLoop;  ///< after the last goal
  /// How close together they stand then, on the ground that is free to stand on: `count` follows
  /// from it (see count_by_density()), and bodies are placed, not discs. 0: by darts.
  double density_per_m2 = 0;
  Rectangle spawn;                         ///< where they stand then
  std::vector<Source> sources;             ///< of people who enter later
  std::vector<Goal> goals;                 ///< visited in order
  Distribution premovement_s{0, 0, 0, 0};  ///< standing still before setting out
  std::optional<TriggerRule> after;        ///< nobody sets out before; the delay begins with it
  std::optional<SocialGroupRule> social_groups;  ///< none: everybody walks alone
  AgeShares ages = kAdultsOnly;
  std::optional<Distribution> speed_mps;   ///< free speed; none: by age
  std::optional<Distribution> height_m;    ///< none: by age; see keep_own_size()
  std::optional<StyleShares> gait_styles;  ///< of walking; none: by age
  double radius_m = 0;                     ///< of the steering disc; 0: from the height
  std::optional<Eigen::Vector2d>
      look_at_m;  ///< what they look at while they stand; none: their way
  /// The LCM channel whose pose_command_t messages move the group; empty: steering and gait do. It
  /// has one goal, its spawn area, and no sources.
  std::string control_channel;

  int64_t recorded = 0;           ///< people of the scene's recording, who come and go as they did
  int64_t recorded_heights = 0;   ///< of these, how many have a height in the recording
  double tallest_recorded_m = 0;  ///< the largest of these heights

  /// Everybody there may ever be.
  int64_t total() const {
    int64_t sum = count + recorded;
    for (const Source& source : sources) sum += source.count;
    return sum;
  }
};

/// Something solid that stands still.
struct Obstacle {
  enum class Kind { kBox, kCylinder, kMesh };
  std::string name;
  Kind kind = Kind::kBox;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< a mesh: where its origin lies
  double heading_rad = 0;
  Eigen::Vector3d size_m =
      Eigen::Vector3d::Ones();  ///< box edges; cylinder: diameter, diameter, height; mesh: extent
  std::filesystem::path mesh_file;
  Mesh mesh;  ///< the solid in the obstacle's own frame, whatever its kind
};

/// A leaf across a way, which lets people through while it is open: a part of the plan, not a body,
/// so that nobody touches it. It never shuts on anybody.
struct Door {
  std::string name;
  Eigen::Vector2d from_m = Eigen::Vector2d::Zero();  ///< its ends
  Eigen::Vector2d to_m = Eigen::Vector2d::Zero();
  std::vector<TriggerRule> opens;  ///< shut before the first of these; without any, open at first
  std::vector<TriggerRule> closes;

  static constexpr double kThickness_m = 0.1;
};

struct CrowdPlan {
  uint64_t seed = 1;
  Rectangle ground;
  std::vector<Group> groups;
  std::vector<Obstacle> obstacles;
  std::vector<Door> doors;
  /// Of a scene without groups, whose avatars something else has: how tall the tallest is; 0: as
  /// tall as people may be.
  double tallest_m = 0;
};

/// Not robots; a group without a body yet is one of people.
bool has_people(const Group& group);

/// Gives a group whose height nobody says that of its `body`, if it is a robot or driven: these are
/// as large as their model. What the height of people is follows from their ages.
void keep_own_size(Group& group);

/// How tall the tallest avatar may be that the plan has at any time (m): by its own height where
/// that is known, else by the largest that may be drawn.
double tallest_m(const CrowdPlan& plan);

/// What becomes of a group's model: how large, at which scale, where it stands.
std::string describe_size(const Group& group);

}  // namespace throng
