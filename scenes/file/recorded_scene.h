// Recorded scenes take people, ground, walls and steps from a recording, for scene files and for
// `throng run FILE`.
#pragma once

#include <string>

#include "scenes/file/scene.h"

namespace throng {

/// Makes a scene from a recording with adult bodies; its name is the file's. `recorded_frames`: see
/// RecordedPeople. Throws InputError.
Scene recorded_scene(const RecordingOptions& options, bool recorded_frames = false);

/// Reads scene.recorded->options.file and sets step, duration, walls, and the ground if
/// `has_ground` is false. Throws InputError at `where` if the scene does not fit the recording.
void apply_recording(Scene& scene, bool has_ground, const std::string& where);

/// Group of the recorded people: adults without goals. Always the scene's last group.
Group recorded_group();

void take_people(const Recording& recording, Group& group);

}  // namespace throng
