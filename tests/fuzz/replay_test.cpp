// Every seed of the fuzzers and a fixed number of variations, without a fuzzer: rejected with an
// error or valid. scripts/fuzz.sh runs the fuzzers.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "base/random.h"
#include "lcm_io/log/log_check.h"
#include "tests/fuzz/targets.h"

namespace throng::fuzz::replay_test {
namespace {

/// THRONG_FUZZ_SEED sets the seed, THRONG_FUZZ_ROUNDS the number of variations.
uint64_t from_environment(const char* name, uint64_t fallback) {
  const char* value = std::getenv(name);
  return value != nullptr ? std::strtoull(value, nullptr, 10) : fallback;
}

/// A few bytes changed, cut, duplicated or copied from elsewhere.
Bytes varied(Bytes bytes, const RandomKey& key) {
  uint32_t draw = 0;
  const auto below = [&](size_t limit) {
    return random_bits(key, draw++) % std::max<size_t>(limit, 1);
  };
  for (size_t edits = 1 + below(4); edits > 0 && !bytes.empty(); --edits) {
    const auto at = static_cast<ptrdiff_t>(below(bytes.size()));
    const auto length =
        static_cast<ptrdiff_t>(below(std::min<size_t>(64, bytes.size() - static_cast<size_t>(at))));
    switch (below(5)) {
      case 0:
        bytes[static_cast<size_t>(at)] = static_cast<uint8_t>(below(256));
        break;
      case 1:
        bytes.erase(bytes.begin() + at, bytes.begin() + at + length);
        break;
      case 2: {
        const Bytes piece(bytes.begin() + at, bytes.begin() + at + length);
        bytes.insert(bytes.begin() + static_cast<ptrdiff_t>(below(bytes.size())), piece.begin(),
                     piece.end());
        break;
      }
      case 3:
        bytes.resize(bytes.size() - below(bytes.size() / 8));
        break;
      default:
        bytes[static_cast<size_t>(at)] ^= static_cast<uint8_t>(1u << below(8));
    }
  }
  return bytes;
}

class Replay : public testing::TestWithParam<Target> {};

TEST_P(Replay, RejectsInputsOrKeepsPromises) {
  const Target& target = GetParam();
  const uint64_t seed = from_environment("THRONG_FUZZ_SEED", 1);
  const uint64_t rounds = from_environment("THRONG_FUZZ_ROUNDS", 20);
  const std::vector<Bytes> seeds = seeds_of(target.name);
  int tried = 0, accepted = 0;
  for (size_t i = 0; i < seeds.size(); ++i) {
    // A long seed targets one crash; variations of it are rejected alike.
    const uint64_t variations = seeds[i].size() > 65'536 ? 0 : rounds;
    for (uint64_t round = 0; round <= variations; ++round) {
      SCOPED_TRACE(testing::Message()
                   << "input " << i << ", THRONG_FUZZ_SEED=" << seed << ", round " << round);
      const RandomKey key{seed, i, round, Purpose::kStyle};
      const Bytes input = round == 0 ? seeds[i] : varied(seeds[i], key);
      ASSERT_NO_THROW(accepted += target.run(input) ? 1 : 0);
      ++tried;
    }
  }
  // scripts/reliability.sh sums these lines.
  std::printf("[ inputs ] %s: %d tried, %d accepted\n", std::string(target.name).c_str(), tried,
              accepted);
  EXPECT_GT(accepted, 0) << "no input passes the first check";
  EXPECT_LT(accepted, tried) << "no input is rejected";
}

// A log of another version is rejected before the code that it is meant for. numbers_that_repeat
// joins pieces of the first log of add_logs() in seeds.cpp: messages 0, 5 to 15 and 13 to 16. The
// second message 13 has the stamp of a recorder, 1.7e15 us later. The first pass of repair_log()
// leaves damage in it.
TEST(FoundLogs, HaveThisVersion) {
  const std::filesystem::path folder = std::string(THRONG_SOURCE_DIR) + "/tests/fuzz/found/log";
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    EXPECT_NO_THROW(check_log(entry.path())) << entry.path();
}

INSTANTIATE_TEST_SUITE_P(Targets, Replay, testing::ValuesIn(kTargets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace throng::fuzz::replay_test
