// LCM within the process, for tests of what listens: no network, no loss.
// One rule: LCM's own headers stay behind it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "lcm_io/codec/channels.h"

namespace lcm {
class LCM;
}

namespace throng {

std::shared_ptr<lcm::LCM> memory_bus();

/// The bytes as they are, sound or not.
void publish(lcm::LCM& lcm, Channel channel, std::span<const uint8_t> bytes);

}  // namespace throng
