#include "tests/lcm_io/memory_bus.h"

#include <lcm/lcm-cpp.hpp>
#include <string>

namespace throng {

std::shared_ptr<lcm::LCM> memory_bus() { return std::make_shared<lcm::LCM>("memq://"); }

void publish(lcm::LCM& lcm, Channel channel, std::span<const uint8_t> bytes) {
  lcm.publish(std::string(name_of(channel)), bytes.data(), static_cast<unsigned>(bytes.size()));
}

}  // namespace throng
