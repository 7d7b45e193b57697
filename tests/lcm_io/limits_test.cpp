// Scenes with fields at their limits and beyond are rejected while loading, or their logs can be
// read.
#include "base/limits.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/errors.h"
#include "base/random.h"
#include "lcm_io/codec/encoder.h"
#include "lcm_io/codec/message_validation.h"
#include "scenes/scenes.h"
#include "synthetic_run.h"

namespace throng::limits_test {
namespace {

/// A scene and a robot; some fields, drawn by the seed, are at or beyond a limit.
class SceneAtLimits {
 public:
  explicit SceneAtLimits(uint64_t seed) : key_{seed, 0, 0, Purpose::kBoxWorld} {
    changed_ = 1 + static_cast<int>(bits() % 3);
    for (int i = 0; i < changed_; ++i) which_ |= uint64_t{1} << bits() % kFields;
  }

  void write(const std::filesystem::path& folder) {
    std::ofstream(folder / "m.tri", std::ios::binary)
        << fmt::format("4\n0 0 {0}\n1 0 {0}\n0 1 {0}\n0 0 {1}\n4\n0 2 1\n0 1 3\n0 3 2\n1 2 3\n",
                       number(0, "0", {"999990", "1000001", "-1000001", "9999990"}), "1");
    std::ofstream(folder / "r.urdf", std::ios::binary) << urdf();
    std::ofstream(folder / "s.yaml", std::ios::binary) << yaml();
  }
  int total() { return std::stoi(number(1, "0", {"1", "7", "40"})); }

 private:
  static constexpr int kFields = 16;

  uint64_t bits() { return random_bits(key_, index_++); }
  bool is_changed(int field) const { return (which_ >> field & 1) != 0; }
  std::string number(int field, const char* sound, const std::vector<std::string>& changed) {
    return is_changed(field) ? changed[bits() % changed.size()] : sound;
  }
  std::string yaml_name(int field, const char* sound) {
    return number(field, sound,
                  {std::string(120, 'x'), std::string(121, 'x'), "a\\0b", "\\0", "\\e[31m", "a\\nb",
                   "a\\tb", "\\x7f", "\\N", "\\u2028", "\\\"\\\\'<script>", "a\xff", "\xed\xa0\x80",
                   std::string(60, '\x61') + "\xe2\x82\xac", " ", "null", "\xf0\x9f\xa4\x96"});
  }
  std::string xml_name(int field, const char* sound) {
    return number(
        field, sound,
        {std::string(120, 'x'), std::string(121, 'x'), "&#10;", "a&#127;", "&#x85;", "&#0;b",
         "&#xd800;", "a\xff", "\xc3\xa9", "&quot;&lt;", "&#x1f916;", " ", "&#9;", "a&#27;[m"});
  }

  std::string urdf() {
    return fmt::format(
        "<robot name=\"{}\"><link name=\"{}\"><collision><geometry><box size=\"{} 1 "
        "1\"/></geometry>"
        "</collision></link><link name=\"b\"><collision><geometry><mesh filename=\"m.tri\" "
        "scale=\"{} 1 1\"/></geometry></collision></link><joint name=\"{}\" type=\"prismatic\">"
        "<parent link=\"{}\"/><child link=\"b\"/><origin xyz=\"0 0 {}\"/><axis xyz=\"0 0 "
        "1\"/><limit "
        "lower=\"{}\" upper=\"10000\" effort=\"1\" velocity=\"1\"/></joint></robot>",
        xml_name(2, "r"), link_name_ = xml_name(3, "a"),
        number(4, "1", {"1e-9", "0.001", "10000", "10001", "nan"}),
        number(5, "1", {"1e-6", "1e6", "-1e6", "1.1e6", "1e-7"}), xml_name(6, "j"), link_name_,
        number(7, "0", {"10000", "-10000", "10001", "4999"}),
        number(8, "9999", {"-10000", "-10001", "10000", "0"}));
  }

  std::string yaml() {
    const std::string far = number(9, "10", {"99990", "100000", "100001", "214750", "1e9"});
    return fmt::format(
        "name: \"{}\"\nstep_s: {}\nseed: {}\n"
        "ground: {{min_m: [-10, -10], max_m: [{}, 10]}}\n"
        "groups:\n  - {{name: \"{}\", model: r.urdf, count: 3, spawn: {{min_m: [-9, -9], max_m: "
        "[9, 9]}}, "
        "goals: [{{min_m: [-9, -9], max_m: [9, 9]}}]{}}}\n"
        "obstacles:\n  - {{name: \"{}\", kind: {}}}\n",
        yaml_name(10, "s"), number(11, "0.02", {"0.1", "0.0001", "0.11", "0"}),
        number(12, "1", {"9223372036854775807", "9223372036854775808", "0", "-1"}), far,
        yaml_name(13, "g"),
        number(14, ", height_m: 2",
               {"", ", height_m: 100", ", height_m: 0.01", ", height_m: 101",
                ", control_channel: A_B"}),
        yaml_name(15, "o"),
        is_changed(0)
            ? "mesh, position_m: [5, 5], file: m.tri"
            : number(9, "box, position_m: [5, 5], size_m: [1, 1, 1]",
                     {"box, position_m: [5, 5], size_m: [1e-9, 1, 10000]",
                      "cylinder, position_m: [5, 5], diameter_m: 1e-9, height_m: 1e4",
                      "box, position_m: [99, 5], bottom_m: 1000, size_m: [1, 1, 10001]"}));
  }

  RandomKey key_;
  uint32_t index_ = 0;
  int changed_ = 0;
  uint64_t which_ = 0;
  std::string link_name_;
};

std::vector<uint8_t> encoded(const run_description_t& description) {
  std::vector<uint8_t> bytes(static_cast<size_t>(description.getEncodedSize()));
  description.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

void expect_read_back(const Simulation& simulation) {
  const std::vector<uint8_t> bytes = encode_description(simulation.info());
  run_description_t got;
  ASSERT_EQ(decode(bytes, got), "");
  EXPECT_EQ(encoded(got), bytes);
  const Scene& scene = simulation.scene();
  EXPECT_EQ(got.scene, scene.name);
  EXPECT_EQ(got.groups, simulation.info().groups);
  ASSERT_EQ(got.obstacles.size(), scene.obstacles.size());
  for (size_t i = 0; i < got.obstacles.size(); ++i)
    EXPECT_EQ(got.obstacles[i].name, scene.obstacles[i].name);
  for (size_t m = 0; m < got.models.size(); ++m) {
    const Model& model = *simulation.info().models[m];
    EXPECT_EQ(got.models[m].name, model.name);
    EXPECT_EQ(got.models[m].height_m, static_cast<double>(model.height_m));
    for (size_t p = 0; p < model.parts.size(); ++p)
      EXPECT_EQ(got.models[m].parts[p].name, model.parts[p].name);
    for (size_t j = 0; j < model.robot.joints.size(); ++j)
      EXPECT_EQ(got.models[m].joints[j].name, model.robot.joints[j].name);
  }
}

/// Expects sound messages of two frames, without clamped values.
void expect_sound_messages(Simulation& simulation) {
  MessageList list;
  EncoderOptions options;
  options.part_poses = true;
  RunEncoder encoder(options, list);
  encoder.begin(simulation.info());
  for (int chunk = 0; chunk < encoder.target_state().description_chunks(); ++chunk)
    encoder.target_state().send_description_chunk(chunk);
  for (int i = 0; i < 2; ++i) encoder.frame(simulation.info(), simulation.step());
  encoder.end(simulation.info(), simulation.finish());
  for (const MessageList::Message& message : list.messages)
    ASSERT_EQ(check_message(message.channel, message.bytes), "") << name_of(message.channel);
  EXPECT_EQ(encoder.target_state().clamped(), 0);
}

TEST(Limits, MakeEveryLoadedSceneLoggable) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "throng_limits_test";
  std::filesystem::create_directories(folder);
  int rejected = 0, read_back = 0;
  for (uint64_t seed = 1; seed <= 600; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    SceneAtLimits changed(seed);
    changed.write(folder);
    std::unique_ptr<Simulation> simulation;
    try {
      Scene scene = load_scene((folder / "s.yaml").string());
      std::vector<std::string> notes;
      if (const int total = changed.total(); total > 0) scale_to(scene, total, notes);
      simulation = std::make_unique<Simulation>(std::move(scene), SimulationOptions{});
    } catch (const InputError& error) {
      ++rejected;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      continue;
    }
    ++read_back;
    expect_read_back(*simulation);
    expect_sound_messages(*simulation);
    if (testing::Test::HasFailure()) break;
  }
  std::filesystem::remove_all(folder);
  EXPECT_GT(rejected, 100);
  EXPECT_GT(read_back, 100);
}

std::string rejection_of(Scene scene, int total) {
  std::vector<std::string> notes;
  try {
    scale_to(scene, total, notes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Limits, HoldForScaledPlans) {
  Scene street = load_scene("plaza");
  street.ground = {{-50'000, -2}, {50'000, 2}};
  street.obstacles.clear();
  for (Group& group : street.groups) group.spawn = street.ground;
  EXPECT_EQ(rejection_of(street, 400'000), "accepted");
  EXPECT_THAT(rejection_of(street, 8'000'000),
              testing::HasSubstr("expected a ground within 100000 m of the origin, found "));
  Scene box = load_scene("paper_15");
  EXPECT_EQ(rejection_of(box, 16'000'000), "accepted");
  box.box->edge_m = 900;
  EXPECT_THAT(rejection_of(box, 30),
              testing::HasSubstr("expected a box of at most 1000 m, found "));
}

TEST(Limits, CoverTheNumbersOfGroupsAndModels) {
  SyntheticRun run({.avatars = 3});
  RunInfo info = run.info();
  info.groups.resize(kMaxGroups, "g");
  info.control_channels.resize(kMaxGroups);
  info.group_of_avatar[1] = kMaxGroups - 1;
  run_description_t got;
  EXPECT_EQ(decode(encode_description(info), got), "");
  EXPECT_EQ(got.group_of_avatar[1], kMaxGroups - 1);
  info.groups.emplace_back("another");
  info.control_channels.emplace_back();
  info.group_of_avatar[1] = kMaxGroups;
  EXPECT_THROW(encode_description(info), InputError);
  RunInfo scaled = run.info();
  scaled.scale_of_avatar[0] = 1.001f * kMaxScale;
  EXPECT_THROW(encode_description(scaled), InputError);
}

}  // namespace
}  // namespace throng::limits_test
