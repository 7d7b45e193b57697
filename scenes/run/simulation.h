// Simulation runs a scene: it places agents, then steps through steering, gait and culling.
// Invariant: equal scene, seed and options give equal frames for any number of threads.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/workers.h"
#include "crowd/crowd_counters.h"
#include "culling/part_distance.h"
#include "scenes/file/part_words.h"
#include "scenes/file/scene.h"
#include "scenes/motion/external_avatars.h"
#include "scenes/motion/motion_source.h"
#include "scenes/run/sink.h"

namespace throng {

struct AgentEntry;   // crowd/crowd.h
struct BodyStates;   // scenes/run/postures.h
class BodyTables;    // scenes/run/body_tables.h
struct CrowdChange;  // scenes/run/crowd_change.h

struct SimulationOptions {
  int threads = 1;
  /// Contact detection. Volumes and `exact` are taken from the scene. The SIMD target also applies
  /// to steering. A budget changes the events, a wall-clock budget not repeatably.
  CullerOptions culler{};
  /// Strategies other than kPipeline are those of the paper, see PaperCuller. They change the
  /// events, because spheres and boxes decide.
  Strategy strategy = Strategy::kPipeline;
  /// Whether to fill Frame::postures, see serve(). If false, only avatars in surviving pairs get
  /// joint positions. Never changes the events.
  bool postures = true;
  /// Whether to detect contacts. If false, there are no pairs and no events, and the hash is 0.
  bool culling = true;
  /// Source of the avatars' motion; empty: make_motion(). With another source the scene needs no
  /// groups.
  MotionFactory motion{};
  /// Tables shared by runs of the same bodies; null: tables of this run. Never change a result.
  std::shared_ptr<BodyTables> tables{};
};

class Simulation {
 public:
  /// Loads the models, places the agents, fits the volumes. Throws InputError.
  Simulation(Scene scene, const SimulationOptions& options);
  ~Simulation();

  const RunInfo& info() const;
  const Scene& scene() const;
  /// Notes for the user: agents that could not be placed, spawn areas that were enlarged.
  const std::vector<std::string>& notes() const;

  /// Number of agents of the scene that found no place.
  int unplaced() const;
  /// Counters of the latest steering decisions; zero without steering.
  const SteeringCounters& steering() const;
  /// Agents that entered and left so far; zero in a box of parts.
  const PopulationCounters& population() const;
  /// Agents without a path to their goal, as of now.
  std::vector<Stranding> strandings() const;

  /// Returns whether an avatar is in the scene now, also after changes since the latest step.
  bool is_present(uint32_t avatar) const;
  /// Inputs of the poses, as of the latest step: avatars, then obstacles.
  const BodyStates& bodies() const;

  /// Sets the contents of later frames to what these sinks need, and nothing else.
  void serve(std::span<Sink* const> sinks);

  /// Returns frame 0, the start, on the first call; later calls advance by scene().step_s. The
  /// frame's spans are valid until the next step.
  const Frame& step();
  RunEnd finish();

  /// Adds people or robots of a group, one per entry, for the next frame. They are spare agents of
  /// the scene (Group::spare). Returns the first id, 0 without entries; the others follow. Ids are
  /// never reused. Throws, like the following functions, InputError without effect; see
  /// CrowdChange.
  uint32_t add(const std::string& group, std::span<const AgentEntry> entries);
  /// Removes agents: the next frame ends their contacts.
  void remove(std::span<const uint32_t> ids);
  /// Sends agents to a goal at once, written as in a scene file, without a queue. Afterwards they
  /// do as `on_arrival` of their group says.
  void set_goal(std::span<const uint32_t> ids, const std::string& goal);
  /// Sets the speed at which each agent walks without hindrance (m/s, 0.1 to 4).
  void set_desired_speed(std::span<const uint32_t> ids, std::span<const double> desired_mps);
  /// One of the changes above. Sets the ids of added agents.
  void change(CrowdChange& change);

  /// Sets the pose of an externally controlled avatar from the next step on; it holds until the
  /// next call. Values outside the ground or joint limits are clamped. Returns the number of
  /// clamped values. Returns -1 without effect if the avatar is absent or not externally
  /// controlled, or the number of joints is wrong. Empty joints keep their positions.
  int set_pose(uint32_t avatar, const ExternalPose& pose);
  /// Lets an externally controlled person walk to a position (m, on the ground) in the next step.
  /// Feet stay planted, and the trunk turns away from others. Without a heading (unit vector)
  /// it faces where it goes; without a velocity it has that of the path since the latest frame.
  /// It stands in steps without a call. Returns as set_pose(), -1 also unless can_walk().
  int walk_to(uint32_t avatar, const Eigen::Vector2d& position_m,
              const std::optional<Eigen::Vector2d>& heading = {},
              const std::optional<Eigen::Vector2d>& velocity_mps = {});
  /// Returns whether walk_to() can move an avatar: it is externally controlled and has human legs.
  bool can_walk(uint32_t avatar) const;
  /// Pose from the next step on, without joints; null if the avatar is not externally controlled.
  const ExternalPose* external_pose(uint32_t avatar) const;

  /// Distance of two bodies in the latest frame, or of parts of them, by triangles: the nearest two
  /// of the chosen parts. Bodies are avatars, then obstacles; obstacles have one part. Independent
  /// of margins, filters and `exact`. Without SimulationOptions::postures, call it before the next
  /// set_pose(). Throws InputError for bodies that are equal, unknown or not in the scene, for
  /// unknown parts, and before the first step.
  PartDistance distance(uint32_t a, const PartChoice& part_a, uint32_t b,
                        const PartChoice& part_b) const;

  int64_t next_frame() const;
  /// State of the run as bytes, for resume(); see scenes/run/checkpoint.h for the file.
  std::vector<uint8_t> saved();
  /// Continues where saved() was called in a run of equal scene, seed and options that change
  /// results. Later frames, events and the hash are bitwise equal. Call it before the first step
  /// only. Throws InputError naming `name` for other bytes; this object must then not be used.
  void resume(std::span<const uint8_t> bytes, const std::string& name);

  FrameTimes& times();  ///< the runner adds kPublish and frame_ns here

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
