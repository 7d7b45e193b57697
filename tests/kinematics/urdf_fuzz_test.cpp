// Damaged URDFs: parse_urdf() throws InputError or returns a valid robot with finite poses.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "base/errors.h"
#include "base/random.h"
#include "tests/kinematics/finite_poses.h"

namespace throng::urdf_fuzz_test {
namespace {

/// THRONG_FUZZ_SEED repeats or varies a run; THRONG_FUZZ_ROUNDS lengthens it.
uint64_t from_environment(const char* name, uint64_t fallback) {
  const char* value = std::getenv(name);
  return value ? std::strtoull(value, nullptr, 10) : fallback;
}

class Mutator {
 public:
  Mutator(uint64_t seed, uint64_t round) : key_{seed, round, 0, Purpose::kSpawnPosition} {}

  std::string mutated(std::string text) {
    for (uint64_t edits = 1 + below(4); edits > 0; --edits) edit(text);
    return text;
  }

 private:
  uint64_t below(uint64_t limit) {
    return random_bits(key_, draw_++) % std::max<uint64_t>(limit, 1);
  }

  void edit(std::string& text) {
    static const std::vector<std::string> pieces = {"nan",
                                                    "inf",
                                                    "-1",
                                                    "0",
                                                    "1e308",
                                                    "1e-320",
                                                    "\"",
                                                    "'",
                                                    "<",
                                                    ">",
                                                    "/>",
                                                    "</link>",
                                                    "<link name=\"a\"/>",
                                                    "<link>",
                                                    "&",
                                                    "&#x0;",
                                                    "&amp;",
                                                    "<!--",
                                                    "-->",
                                                    "<![CDATA[",
                                                    "<?",
                                                    std::string(1, '\0'),
                                                    "\xff\xfe",
                                                    "type=\"floating\"",
                                                    "<mimic joint=\"motor\"/>",
                                                    "<parent link=\"palm\"/>",
                                                    ",",
                                                    " "};
    const size_t at = below(text.size() + 1);
    const size_t length = below(1 + std::min<size_t>(text.size() - at, 1 + below(80)));
    switch (below(6)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, pieces[below(pieces.size())]);
        break;
      case 2:
        text.replace(at, length, pieces[below(pieces.size())]);
        break;
      case 3:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 4:
        text.insert(below(text.size() + 1), text.substr(at, length));
        break;
      default:
        replace_a_value(text, at);
    }
  }

  /// Replaces one attribute's value with another's: names collide, numbers change.
  void replace_a_value(std::string& text, size_t at) {
    const auto value_after = [&](size_t from) {
      const size_t open = text.find('"', from);
      const size_t close = open == std::string::npos ? open : text.find('"', open + 1);
      return std::pair{open, close};
    };
    const auto [open, close] = value_after(at);
    const auto [from_open, from_close] = value_after(below(text.size() + 1));
    if (close == std::string::npos || from_close == std::string::npos) return;
    text.replace(open, close - open, text.substr(from_open, from_close - from_open));
  }

  RandomKey key_;
  uint32_t draw_ = 0;
};

void expect_sound(const Robot& robot) {
  ASSERT_EQ(robot.links.size(), robot.joints.size() + 1);
  for (size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& joint = robot.joints[i];
    ASSERT_EQ(joint.child_link, static_cast<int>(i) + 1);
    ASSERT_GE(joint.parent_link, 0);
    ASSERT_LT(joint.parent_link, joint.child_link);
    ASSERT_LT(std::abs(joint.axis.norm() - 1), 1e-9);
    ASSERT_LE(joint.lower, joint.upper);
    ASSERT_TRUE(joint.parent_from_joint.matrix().allFinite());
  }
}

TEST(DamagedUrdf, IsRejectedOrValid) {
  const uint64_t seed = from_environment("THRONG_FUZZ_SEED", 1);
  const uint64_t rounds = from_environment("THRONG_FUZZ_ROUNDS", 2000);
  const std::filesystem::path fixtures =
      std::filesystem::path(THRONG_SOURCE_DIR) / "tests/kinematics/fixtures";
  int accepted = 0;
  for (const char* name : {"wheels.urdf", "skew_arm.urdf", "mimic_hand.urdf"}) {
    const std::string text = read_urdf_text(fixtures / name);
    for (uint64_t round = 0; round < rounds; ++round) {
      SCOPED_TRACE(std::string(name) + ", THRONG_FUZZ_SEED=" + std::to_string(seed) + ", round " +
                   std::to_string(round));
      try {
        const Robot robot = parse_urdf(Mutator(seed, round).mutated(text), "damaged.urdf");
        ++accepted;
        expect_sound(robot);
        ASSERT_TRUE(has_finite_poses(robot));
      } catch (const InputError& error) {
        const std::string message = error.what();
        ASSERT_NE(message.find("expected"), std::string::npos);
        ASSERT_EQ(message.find('\n'), std::string::npos) << message;
      }
    }
  }
  // Otherwise the damage is so heavy that nothing passes the first check.
  EXPECT_GT(accepted, 100) << "seed " << seed;
}

}  // namespace
}  // namespace throng::urdf_fuzz_test
