// Contact points as rows of contact_points_t, both ways.
// One rule: what is read is what was written, to the bit.
#pragma once

#include <cstddef>
#include <span>

#include "culling/near.h"
#include "lcm_io/codec/channels.h"
#include "throng/contact_points_t.hpp"

namespace throng {

/// Behind header and count.
inline constexpr size_t kContactsPerMessage = (kMaxMessageBytes - kHeaderBytes - 4) / 50;

/// A message of these rows, no more than fit.
void set_contacts(contact_points_t& m, std::span<const ContactPoint> rows);
/// Of a message that was checked.
ContactPoint contact_at(const contact_points_t& m, size_t i);

}  // namespace throng
