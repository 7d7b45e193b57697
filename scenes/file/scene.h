// A scene as its YAML file describes it, checked.
// One rule: a Scene that exists can be run; every complaint names file:line and the way out.
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
#include "recordings/walkable_wkt.h"
#include "scenes/file/pair_rules.h"
#include "scenes/file/part_volumes.h"
#include "scenes/separation/separation_rule.h"

namespace throng {

/// The paper's world instead of a crowd: loose parts of one body, in turn, that fly in a closed
/// box.
struct PartsBox {
  std::filesystem::path model;        ///< whose parts; as in a group
  std::shared_ptr<const Model> body;  ///< what `model` holds
  int count = 0;
  int static_every = 0;  ///< every n-th part stands still; 0: none does
  double edge_m = 0;
  double min_speed_mps = 0.5;
  double max_speed_mps = 1.5;
  double max_spin_radps = 3;
};

/// A recording whose people walk through the scene: all of the last group.
struct RecordedPeople {
  RecordingOptions options;
  std::shared_ptr<const Recording> recording;  ///< what `options.file` holds
  bool geometry = true;                        ///< the walkable area of the file becomes walls
  bool recorded_frames = false;  ///< a step is a recorded frame; otherwise at most 1/60 s
};

struct Scene : CrowdPlan {
  std::string name;
  std::string description;
  std::filesystem::path file;
  double step_s = 1.0 / 60.0;
  double duration_s = 10;
  std::vector<AreaPolygon> area;  ///< where people may be, of a recording; empty: on the ground
  std::optional<RecordedPeople> recorded;
  std::optional<PartsBox> box;  ///< then there are no groups and no obstacles
  SteeringRule steering;
  PartVolumes part_volume;
  bool exact = false;
  double proximity_m = 0;      ///< pairs of parts within it are listed with their distance; 0: none
  double closest_parts_m = 0;  ///< of each two people within it the nearest parts; 0: none
  bool contact_points = false;  ///< of what touches a point, its direction and depth; needs exact
  PairRules group_filter, part_filter;  ///< the pairs asked for, of groups and of parts; empty: all
  std::optional<SeparationRule> separation;  ///< of robots from people; needs proximity_m
  bool planted_feet = true;                  ///< feet stay where they are put on curves, too
  bool body_avoidance = true;  ///< bodies give way to what is near; who stands breathes and sways
  std::vector<std::string> notes;  ///< what is not as the file says; a line each
  uint64_t content_hash =
      0;  ///< of what the file says and of what it refers to, not of where it lies
};

/// Hash of everything in a scene that shapes its frames, and of its name; not of its duration (a
/// longer run begins with the shorter one's frames), its description, or where files lie.
uint64_t content_hash_of(const Scene& scene);

/// A path, or the name of a bundled scene. Throws InputError with file:line or a did-you-mean.
Scene load_scene(const std::string& path_or_name);

/// The bundled scenes (name and one-line description), sorted by name.
struct SceneEntry {
  std::string name;
  std::string description;
};
std::vector<SceneEntry> bundled_scenes();

/// Scales groups and sources (and their rates) in proportion to `total` people (by largest
/// remainders, so that the sum is exact). Where spawn areas or the ground become too full, the plan
/// grows by one factor about the middle of the ground: ground, areas, the places of obstacles, and
/// the lengths of those that span it (walls). Heights stay. A box of parts keeps its density. Says
/// on `notes` what it changed, and returns how many times longer the plan is. Throws InputError if
/// `total` is out of range.
double scale_to(Scene& scene, int total, std::vector<std::string>& notes);

}  // namespace throng
