// Clothes, skin and hair of people in pictures, and colours of touching parts.
// Invariant: a person looks as on the page: both read viewer/page/src/palette.json, and the choice
// by id is that of the page's shaders.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>

#include "avatars/model/model.h"
#include "culling/pair.h"
#include "viewer/picture/shape.h"

namespace throng {

/// What a part of a body wears.
enum class Slot { kShirt, kTrousers, kSkin, kHair, kShoes };

/// All parts of a robot are shirts.
Slot slot_of(std::string_view part_name);

/// Returns the linear colour that an avatar wears in a slot.
Eigen::Vector3f clothes_rgb(Slot slot, uint32_t avatar);

/// Returns the linear colour of a part that touches another.
Eigen::Vector3f mark_rgb(PairLevel level);

/// Gives the second colour to the vertices of a head that have hair; other parts stay.
void add_hair(const Part& part, Shape& shape);

}  // namespace throng
