// Study options: the options of `throng run` that a study may set or vary.
// They are the rows of run_options() that affect results; outputs and speed belong to the study.
#pragma once

#include <string>
#include <vector>

#include "scenes/file/scene_fields.h"
#include "scenes/run/run_options.h"

namespace throng {

const std::vector<std::string>& study_option_names();

/// Reads options from a map without other keys. Throws InputError.
RunOptions read_study_options(const Fields& fields);

/// Reason why an option of `throng run` is not allowed in a study, phrased to follow "expected"; ""
/// for other words.
std::string reason_not_in_study(const std::string& name);

}  // namespace throng
