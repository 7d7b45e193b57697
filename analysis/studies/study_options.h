// The options of a run that a study may set or vary.
// One rule: only what shapes a result, by its name on the command line with "_" for "-"; where
// results go and how fast they come is the study's own business.
#pragma once

#include <string>
#include <vector>

#include "culling/culler.h"
#include "culling/strategies/strategy.h"
#include "scenes/file/scene_fields.h"
#include "scenes/run/run_choices.h"

namespace throng {

struct StudyOptions {
  RunChoices choices;
  CullerOptions culler;
  Strategy strategy = Strategy::kPipeline;
};

/// "avatars", "seconds", ...
const std::vector<std::string>& study_option_names();

/// From a map that has no other keys. Throws InputError.
StudyOptions read_study_options(const Fields& fields);

/// Why an option of `throng run` is none of a study, to follow "expected"; "" for any other word.
std::string why_no_study_option(const std::string& name);

}  // namespace throng
