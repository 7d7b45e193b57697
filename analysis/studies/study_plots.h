// Pictures of a study: each measured column against each parameter.
// One rule: a column that is the same in all runs has no picture; every run is a point, and their
// mean stands with one standard deviation to either side.
#pragma once

#include <vector>

#include "analysis/studies/study_table.h"
#include "base/figure.h"

namespace throng {

/// "people_by_avatars", ... A curve a scene.
std::vector<Figure> study_figures(const StudyTable& table);

}  // namespace throng
