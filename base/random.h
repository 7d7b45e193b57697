// Counter-based random numbers: a value depends only on (seed, id, step, purpose).
// Invariant: no state, so results do not depend on the number of threads or the order of work.
#pragma once

#include <cstdint>

namespace throng {

/// What a number is drawn for; makes draws with the same (id, step) independent.
/// Append only: a changed value changes every published hash.
enum class Purpose : uint32_t {
  kSpawnPosition = 1,
  kSpawnHeading = 2,
  kHeight = 3,
  kDesiredSpeed = 4,
  kGaitPhase = 5,
  kGoal = 6,
  kSymmetryBreaking = 7,
  kBoxWorld = 8,
  kStyle = 9,
  kEmission = 10,
  kDelay = 11,
  kAge = 12,
  kFacing = 13,
  kStanding = 14,
  kPatience = 15,
  kSocialGroup = 16,
  kWaiting = 17,
  kStudy = 18,
  kLateralOffset = 19,
  kDetour = 20,
  kStandingPosture = 21,
};

struct RandomKey {
  uint64_t seed = 0;
  uint64_t id = 0;    ///< id of the avatar or object
  uint64_t step = 0;  ///< step or retry
  Purpose purpose = Purpose::kSpawnPosition;
};

/// Returns 64 random bits for the `index`-th draw under a key (SplitMix64 finaliser, Steele et al.
/// 2014).
uint64_t random_bits(const RandomKey& key, uint32_t index = 0);

/// Uniform in [0, 1), 53 bits.
double random_uniform(const RandomKey& key, uint32_t index = 0);

/// Uniform in [low, high).
double random_uniform(const RandomKey& key, double low, double high, uint32_t index = 0);

/// Normal with the given mean and standard deviation (Box-Muller; uses two draws).
double random_normal(const RandomKey& key, double mean, double deviation, uint32_t index = 0);

}  // namespace throng
