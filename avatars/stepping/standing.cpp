#include "avatars/stepping/standing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/checksum.h"
#include "base/portable_math.h"
#include "base/random.h"

namespace throng {
namespace {

// Standing motion starts after kSettling_s, fades in over kComing_s and out over kGoing_s.
constexpr float kSettling_s = 1;
constexpr float kComing_s = kMaxStandingTime_s - kSettling_s;
constexpr float kGoing_s = 0.5f;

// A person shifts weight once per period, near its middle. Each person has its own period.
constexpr float kMinPeriod_s = 22, kMaxPeriod_s = 36;
constexpr float kEarliest = 0.2f, kLatest = 0.8f;
constexpr float kMinShift_s = 1.2f, kMaxShift_s = 2.2f;
// Weight is on one foot or the other, and at times between them.
constexpr float kMinSide_m = 0.02f, kMaxSide_m = 0.04f, kBetween_m = 0.008f;
constexpr float kBetweenShare = 0.25f;

constexpr int kWaves = 2;
constexpr float kWave_hz[kWaves] = {0.17f, 0.43f};
constexpr float kWave_m[kWaves] = {0.0022f, 0.001f};

constexpr float kMinBreath_hz = 12.0f / 60, kMaxBreath_hz = 18.0f / 60;
constexpr float kBreathesIn = 0.4f;  // share of a breath

struct Draws {
  float at[4];
};
/// SplitMix64, seeded with a person's bits.
Draws draws(uint64_t own_bits, uint64_t number) {
  const uint64_t bits = mixed(own_bits + number * 0x9e3779b97f4a7c15ull);
  Draws out;
  for (int i = 0; i < 4; ++i)
    out.at[i] = static_cast<float>(static_cast<int32_t>(bits >> (16 * i) & 0xffff)) * 0x1.0p-16f;
  return out;
}

float between(float low, float high, float share) { return low + share * (high - low); }

float smooth(float u) { return u * u * (3 - 2 * u); }
float smoother(float u) {
  u = std::clamp(u, 0.0f, 1.0f);
  return u * u * u * (10 + u * (6 * u - 15));
}

/// Returns the fractional part of a number of at least 0.
float fraction(double x) {
  return static_cast<float>(x - static_cast<double>(static_cast<int64_t>(x)));
}

/// Returns the place of the weight after a period's shift; branch-free, as it is unpredictable.
float place_m(const Draws& period, uint64_t number, uint64_t side) {
  const auto left = static_cast<float>(1 - 2 * static_cast<int>((number + side) & 1));
  const auto stands_between = static_cast<float>(period.at[1] < kBetweenShare);
  const float between_m = between(-kBetween_m, kBetween_m, period.at[0]);
  const float side_m = left * between(kMinSide_m, kMaxSide_m, period.at[0]);
  return side_m + stands_between * (between_m - side_m);
}

}  // namespace

QuietStanding quiet_standing(uint64_t seed, uint64_t id, double time_s) {
  // Numbers of periods begin at 2.
  const uint64_t bits = random_bits({seed, id, 0, Purpose::kStanding});
  const Draws own = draws(bits, 0), waves = draws(bits, 1);
  const float period_s = between(kMinPeriod_s, kMaxPeriod_s, own.at[0]);
  const double periods =
      time_s / static_cast<double>(period_s) + 3 + static_cast<double>(own.at[1]);
  const auto number = static_cast<uint64_t>(static_cast<int64_t>(periods));
  const Draws now = draws(bits, number);
  const uint64_t side = bits >> 63;
  const float to_m = place_m(now, number, side);
  const float from_m = place_m(draws(bits, number - 1), number - 1, side);
  const float since_s = (fraction(periods) - between(kEarliest, kLatest, now.at[2])) * period_s;
  const float shift_s = between(kMinShift_s, kMaxShift_s, now.at[3]);
  QuietStanding out;
  out.shift_m = from_m + smoother(since_s / shift_s) * (to_m - from_m);
  for (int i = 0; i < kWaves; ++i) {
    const float hz = kWave_hz[i] * between(0.85f, 1.15f, waves.at[i]);
    const float turn =
        fraction(time_s * static_cast<double>(hz) + static_cast<double>(waves.at[i + kWaves]));
    out.shift_m += kWave_m[i] * float_sin_cos(2 * std::numbers::pi_v<float> * turn).sin;
  }
  const float breath_hz = between(kMinBreath_hz, kMaxBreath_hz, own.at[2]);
  const float breath =
      fraction(time_s * static_cast<double>(breath_hz) + static_cast<double>(own.at[3]));
  out.breath = smooth(std::min(breath / kBreathesIn, 1.0f)) -
               smooth(std::max((breath - kBreathesIn) / (1 - kBreathesIn), 0.0f));
  return out;
}

float advance_standing_time(float standing_time_s, bool stands, float step_s) {
  if (stands) return std::min(standing_time_s + step_s, kMaxStandingTime_s);
  const float rest_s = standing_time_s - step_s * (kComing_s / kGoing_s);
  return rest_s > kSettling_s ? rest_s : 0;
}

float standing_share(float standing_time_s) {
  const float u = (standing_time_s - kSettling_s) * (1 / kComing_s);
  return u <= 0 ? 0 : smooth(std::min(u, 1.0f));
}

}  // namespace throng
