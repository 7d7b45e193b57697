// The scene that a recording makes: its people, ground, walls and steps.
// One rule: what follows from the file is worked out here alone, whether a scene file names it or
// the command does.
#pragma once

#include <string>

#include "scenes/file/scene.h"

namespace throng {

/// A recording as it is, dressed in adults; its name is the file's. `recorded_frames`: see
/// RecordedPeople. Throws InputError.
Scene recorded_scene(const RecordingOptions& options, bool recorded_frames = false);

/// Reads scene.recorded->options.file and sets what follows: step, duration, walls, and the ground
/// unless the scene has one. `where` begins the errors of a scene that does not fit it.
void apply_recording(Scene& scene, bool has_ground, const std::string& where);

/// The group of the recorded people: adults without goals. Always the scene's last one.
Group recorded_group();

/// Sets how many they are and how tall, as far as the recording knows.
void take_people(const Recording& recording, Group& group);

}  // namespace throng
