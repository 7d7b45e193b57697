// One run of a scene: people placed, then step by step steering, gait, culling.
// One rule: the same scene, seed and options give the same frames for any number of threads.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/workers.h"
#include "crowd/crowd_counters.h"
#include "scenes/file/scene.h"
#include "scenes/motion/external_avatars.h"
#include "scenes/motion/motion_source.h"
#include "scenes/run/sink.h"

namespace throng {

struct BodyStates;  // scenes/run/postures.h
class BodyTables;   // scenes/run/body_tables.h

struct SimulationOptions {
  int threads = 1;
  /// How contacts are found. Its volume and exactness are the scene's, whatever stands here; its
  /// SIMD target is that of steering, too. A deadline changes the events (the clock's not
  /// repeatably).
  CullerOptions culler{};
  /// Another than kPipeline is the paper's, see PaperCuller: it changes the events, as far as
  /// spheres and boxes rule pairs out.
  Strategy strategy = Strategy::kPipeline;
  /// Fill Frame::postures; see serve(). Off, only avatars in a surviving pair get joint angles at
  /// all: a run that nobody draws or logs does not pay for the rest. Never changes the events.
  bool postures = true;
  /// Off, people walk and nobody is culled: no pairs, no events, and a hash of 0.
  bool culling = true;
  /// What moves the avatars; empty: what the scene asks for, see make_motion(). The scene of
  /// another world need not have groups.
  MotionFactory motion{};
  /// What several runs of the same bodies share; null: this one has its own. Never changes a
  /// result.
  std::shared_ptr<BodyTables> tables{};
};

class Simulation {
 public:
  /// Loads the models, places the people, fits the volumes. Throws InputError.
  Simulation(Scene scene, const SimulationOptions& options);
  ~Simulation();

  const RunInfo& info() const;
  const Scene& scene() const;
  /// What the user should know: people who could not be placed, spawn areas that were enlarged.
  const std::vector<std::string>& notes() const;

  /// People that the scene asks for but that found no place.
  int unplaced() const;
  /// Of the latest decision of steering; all zero where nobody steers.
  const SteeringCounters& steering() const;
  /// Who has entered and left so far; all zero in a box of parts.
  const PopulationCounters& population() const;
  /// The people who cannot reach a goal, as of now.
  std::vector<Stranding> strandings() const;

  /// What poses depend on, as of the latest step: avatars, then obstacles.
  const BodyStates& bodies() const;

  /// From the next step on, frames hold what these need, and leave out what none of them does.
  void serve(std::span<Sink* const> sinks);

  /// The first call delivers frame 0, people where they start; each later one advances by
  /// scene.step_s. The frame's spans hold until the next step.
  const Frame& step();
  /// Ends every pair that still touches.
  RunEnd finish();

  /// Moves an avatar of a driven group from the next step on; until then, and for as long as
  /// nothing new comes, it holds its pose. What lies outside the ground or the joints' limits is
  /// set to the nearest that does not; returns how many numbers were. -1, and nothing happens, if
  /// the avatar is not driven or the number of joints is not its model's (none leaves them as they
  /// are).
  int set_pose(uint32_t avatar, const ExternalPose& pose);
  /// Where it is from the next step on, its joints left out; null if the avatar is not driven.
  const ExternalPose* external_pose(uint32_t avatar) const;

  /// The number of the frame that step() delivers next.
  int64_t next_frame() const;
  /// Everything that later frames depend on, as bytes; see scenes/run/checkpoint.h for the file.
  std::vector<uint8_t> saved();
  /// Goes on where saved() was called in a run of the same scene, seed and options that change
  /// results: later frames, their events and the hash are the same to the bit. Only before the
  /// first step. Throws InputError naming `name` where the bytes cannot be such a run's; this
  /// object is then of no use.
  void resume(std::span<const uint8_t> bytes, const std::string& name);

  FrameTimes& times();  ///< the runner adds kPublish and frame_ns here

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace throng
