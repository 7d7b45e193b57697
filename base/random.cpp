#include "base/random.h"

#include <cmath>
#include <numbers>

#include "base/checksum.h"
#include "base/portable_math.h"

namespace throng {
namespace {

uint64_t mix(uint64_t x) { return mixed(x + 0x9e3779b97f4a7c15ull); }

}  // namespace

uint64_t random_bits(const RandomKey& key, uint32_t index) {
  const uint64_t use = (static_cast<uint64_t>(key.purpose) << 32) | index;
  return mix(mix(mix(mix(key.seed) ^ key.id) ^ key.step) ^ use);
}

double random_uniform(const RandomKey& key, uint32_t index) {
  return static_cast<double>(random_bits(key, index) >> 11) * 0x1.0p-53;
}

double random_uniform(const RandomKey& key, double low, double high, uint32_t index) {
  return low + (high - low) * random_uniform(key, index);
}

double random_normal(const RandomKey& key, double mean, double deviation, uint32_t index) {
  const double radius = std::sqrt(-2.0 * natural_log(1 - random_uniform(key, 2 * index)));
  const double angle = 2.0 * std::numbers::pi * random_uniform(key, 2 * index + 1);
  return mean + deviation * radius * sin_cos(angle).cos;
}

}  // namespace throng
