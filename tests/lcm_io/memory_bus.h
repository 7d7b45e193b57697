// LCM within the process, for tests of receivers: no network, no loss. Hides LCM's headers.
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

void publish(lcm::LCM& lcm, Channel channel, std::span<const uint8_t> bytes);

}  // namespace throng
