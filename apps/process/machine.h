// What a result says about the machine it was measured on.
#pragma once

#include <cstdint>
#include <string>

namespace throng {

/// The processor's name as the system tells it, "unknown" where it does not.
std::string cpu_name();

/// The most memory this process ever held.
uint64_t peak_rss_bytes();

}  // namespace throng
