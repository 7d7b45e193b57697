// Scene holds a scene file after all checks.
// Invariant: a Scene that exists can be run; errors name file:line and a remedy.
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
#include "crowd/crowd_plan.h"
#include "crowd/steering/steering_rule.h"
#include "recordings/recording.h"
#include "scenes/file/pair_rules.h"
#include "scenes/file/part_volumes.h"
#include "scenes/separation/separation_rule.h"

namespace throng {

struct PartsBox {
  std::filesystem::path model;
  std::shared_ptr<const Model> body;
  int count = 0;
  int static_every = 0;  ///< every n-th part stands still; 0: none
  double edge_m = 0;
  double min_speed_mps = 0.5;
  double max_speed_mps = 1.5;
  double max_spin_radps = 3;
};

/// Recording whose people are the last group of the scene.
struct RecordedPeople {
  RecordingOptions options;
  std::shared_ptr<const Recording> recording;
  bool geometry = true;
  /// Steps are recorded frames alone; false: equal steps of at most 1/60 s.
  bool recorded_frames = false;
};

struct Scene : CrowdPlan {
  std::string name;
  std::string description;
  std::filesystem::path file;
  double step_s = 1.0 / 60.0;
  double duration_s = 10;
  std::optional<RecordedPeople> recorded;
  std::optional<PartsBox> box;  ///< set for `kind: box`; groups and obstacles are then empty
  SteeringRule steering;
  PartVolumes part_volume;
  bool exact = false;
  double proximity_m = 0;       ///< margin of proximity between parts, 0: off
  double closest_parts_m = 0;   ///< margin of the closest parts of two avatars, 0: off
  bool contact_points = false;  ///< report point, normal and depth of each contact; requires exact
  PairRules group_filter, part_filter;  ///< selected pairs of groups and of parts; empty: all
  std::optional<SeparationRule> separation;
  /// LCM channel with crowd_change_t messages that change the crowd during the run; empty: none.
  std::string change_channel;
  bool planted_feet = true;  ///< feet stay planted on curves and while turning
  /// Postures adapt to neighbours and walls; standing people breathe and sway.
  bool body_avoidance = true;
  std::vector<std::string> notes;  ///< deviations from the file, one line each
  uint64_t content_hash = 0;       ///< see content_hash_of(); independent of the file's location
};

/// Hash of the scene's name and of everything that shapes its frames. Excluded are the duration (a
/// longer run begins with the same frames), the description and file locations.
uint64_t content_hash_of(const Scene& scene);

/// Loads a scene from a path or by the name of a bundled scene. Throws InputError with file:line,
/// or with suggestions for an unknown name.
Scene load_scene(const std::string& path_or_name);

/// Reads a scene from the text of a scene file, with the same checks. Errors name `name`:line, and
/// a scene without the key `name` is called so. Files are looked up in the working directory.
Scene read_scene_text(const std::string& text, const std::string& name);

/// Reads a goal from text as in a scene file, for example `{min_m: [0, 0], max_m: [2, 2]}`. Checks
/// it against the ground of a scene. Throws InputError naming `name`, also for a goal with a queue
/// or capacity.
Goal read_goal_text(const std::string& text, const std::string& name, const Scene& scene);

/// Name and one-line description of a bundled scene; the list is sorted by name.
struct SceneEntry {
  std::string name;
  std::string description;
};
std::vector<SceneEntry> bundled_scenes();

/// Scales groups, sources and their rates to `total` people, by largest remainders: the sum is
/// exact. If spawn areas or the ground become too full, the plan grows by one factor about the
/// middle of the ground. Ground, areas, obstacle positions and walls grow; heights and other
/// obstacles keep their size. A box of parts keeps its density. Appends changes to `notes`. Returns
/// the factor by which lengths grew. Throws InputError if `total` is out of range.
double scale_to(Scene& scene, int total, std::vector<std::string>& notes);

}  // namespace throng
