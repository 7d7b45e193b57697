// The paper's figures: ours beside theirs.
// One rule: every number in them is measured or printed in the paper.
#pragma once

#include <vector>

#include "base/figure.h"
#include "bench/paper/experiment.h"

namespace throng::paper {

std::vector<Figure> figures_of(const PaperResult& result);

}  // namespace throng::paper
