// The options of a run that a study may set or vary: those rows of run_options() that shape a
// result. Where results go and how fast they come is the study's own business.
#pragma once

#include <string>
#include <vector>

#include "scenes/file/scene_fields.h"
#include "scenes/run/run_options.h"

namespace throng {

/// "avatars", "seconds", ...
const std::vector<std::string>& study_option_names();

/// From a map that has no other keys. Throws InputError.
RunOptions read_study_options(const Fields& fields);

/// Why an option of `throng run` is none of a study, to follow "expected"; "" for any other word.
std::string reason_not_in_study(const std::string& name);

}  // namespace throng
