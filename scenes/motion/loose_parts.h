// A body taken apart: every part a model of its own, as the paper throws them into a box.
// One rule: a loose part's origin is the middle of its smallest sphere, so that it spins about its
// middle.
#pragma once

#include <memory>
#include <vector>

#include "avatars/model/model.h"

namespace throng {

/// One model a part, in the body's order, without joints; height_m is the sphere's diameter.
std::vector<std::shared_ptr<const Model>> loose_parts(const Model& body);

/// How far a loose part reaches from its origin.
double reach_m(const Model& loose_part);

}  // namespace throng
