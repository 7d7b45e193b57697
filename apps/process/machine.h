// Functions that describe the machine of a measurement.
#pragma once

#include <cstdint>
#include <string>

namespace throng {

/// The processor's name, or "unknown".
std::string cpu_name();

/// Peak memory of this process in bytes.
uint64_t peak_rss_bytes();

}  // namespace throng
