// Contact statistics: definition, duration, partners and density of contacts.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "analysis/contacts/contact_sink.h"
#include "tests/crowd/crowd_world.h"

namespace throng::contact_test {
namespace {

/// Three people and a wall; a step is 0.1 s.
class Contacts : public testing::Test {
 protected:
  static uint32_t part(const std::string& name) {
    for (uint32_t i = 0; i < adult()->parts.size(); ++i)
      if (adult()->parts[i].name == name) return i;
    throw std::runtime_error("the adult has no " + name);
  }
  static const std::shared_ptr<const Model>& adult() {
    static const std::shared_ptr<const Model> model = load_model(adult_urdf());
    return model;
  }
  const uint32_t kHead = part("head");
  const uint32_t kHand = part("leftHand");
  static constexpr uint32_t kWall = 3;

  Contacts() {
    scene_.ground = {{-10, -10}, {10, 10}};
    scene_.obstacles = {box(0, 9, 4, 1)};
    run_.scene = &scene_;
    run_.step_s = 0.1;
    run_.models = {adult()};
    run_.model_of_avatar = {0, 0, 0};
    run_.groups = {"walkers"};
    run_.group_of_avatar = {0, 0, 0};
    roots_.resize(3);
    for (size_t id = 0; id < 3; ++id) roots_[id].position_m = {static_cast<double>(id), 0, 0};
    statistics_.emplace(run_);
  }

  static PairEvent begin(uint32_t a, uint32_t b, uint32_t part_a, uint32_t part_b) {
    return {PairKey(a, b, part_a, part_b), EventKind::kBegin};
  }
  static PairEvent end(uint32_t a, uint32_t b, uint32_t part_a, uint32_t part_b) {
    return {PairKey(a, b, part_a, part_b), EventKind::kEnd};
  }

  void frame(int64_t number, const std::vector<PairEvent>& events = {}) {
    Frame frame;
    frame.number = number;
    frame.roots = roots_;
    frame.events = events;
    frame.present = present_;
    statistics_->frame(frame);
  }
  void pass(int64_t first, int64_t last) {
    for (int64_t number = first; number <= last; ++number) frame(number);
  }
  void finish(const std::vector<PairEvent>& events = {}) {
    RunEnd run_end;
    run_end.events = events;
    statistics_->end(run_end);
  }

  Scene scene_;
  RunInfo run_;
  std::vector<RootPose> roots_;
  std::vector<uint8_t> present_;
  std::optional<ContactStatistics> statistics_;
};

TEST_F(Contacts, LastFromTheFirstTouchingPairOfPartsToTheLast) {
  frame(0);
  frame(1, {begin(0, 1, kHand, kHand)});
  frame(2, {begin(0, 1, kHead, kHand)});
  frame(3, {end(0, 1, kHand, kHand)});
  EXPECT_TRUE(statistics_->ended().empty()) << "another pair of parts still touches";
  pass(4, 5);
  frame(6, {end(0, 1, kHead, kHand)});
  ASSERT_EQ(statistics_->ended().size(), 1u);
  const Contact contact = statistics_->ended()[0];
  finish();
  EXPECT_DOUBLE_EQ(contact.begin_s, 0.1);
  EXPECT_NEAR(contact.duration_s, 0.5, 1e-9);
  EXPECT_EQ(contact.part_contacts, 2u);
  EXPECT_EQ(contact.first_part_a, kHand);
  EXPECT_FALSE(contact.is_truncated);
  EXPECT_EQ(statistics_->totals().contacts, 1u);
  EXPECT_NEAR(statistics_->totals().median_s, 0.5, 1e-6);
}

TEST_F(Contacts, ContinueIfOnlyTheirPartsChange) {
  frame(0);
  frame(1, {begin(0, 1, kHand, kHead)});
  frame(2, {begin(0, 1, kWholeBody, kWholeBody), end(0, 1, kHand, kHead)});
  frame(3, {end(0, 1, kWholeBody, kWholeBody)});
  finish();
  EXPECT_EQ(statistics_->totals().contacts, 1u);
  EXPECT_EQ(statistics_->parts().names.back(), "whole body");
}

TEST_F(Contacts, AreCountedApartIfTruncated) {
  frame(0, {begin(0, 1, kHand, kHand)});
  frame(1, {begin(1, 2, kHand, kHand)});
  frame(2, {end(0, 1, kHand, kHand)});
  finish({end(1, 2, kHand, kHand)});
  EXPECT_EQ(statistics_->truncated_count(), 2u) << "one exists in the first frame, one in the last";
  EXPECT_EQ(statistics_->complete_count(), 0u);
  EXPECT_EQ(statistics_->totals().contacts, 2u);
  ASSERT_EQ(statistics_->ended().size(), 1u);
  EXPECT_NEAR(statistics_->ended()[0].duration_s, 0.2, 1e-9) << "frames 1 and 2";
}

TEST_F(Contacts, CountForBothPeople) {
  frame(0);
  frame(1, {begin(0, 1, kHand, kHand), begin(1, 2, kHead, kHead)});
  frame(2, {end(0, 1, kHand, kHand)});
  frame(3, {begin(0, 1, kHand, kHand)});
  frame(4, {end(0, 1, kHand, kHand), end(1, 2, kHead, kHead)});
  pass(5, 9);
  finish();
  const auto& people = statistics_->people();
  EXPECT_EQ(people[0].contacts, 2u);
  EXPECT_EQ(people[1].contacts, 3u);
  EXPECT_EQ(people[1].partners, 2u);
  EXPECT_NEAR(people[0].touching_s, 0.2, 1e-9);
  EXPECT_NEAR(people[1].touching_s, 0.3, 1e-9);
  EXPECT_NEAR(people[0].present_s, 1.0, 1e-9);
  // Three contacts count six times; three people are present for 1 s.
  EXPECT_NEAR(statistics_->totals().per_person_min(), 6 / 3.0 * 60, 1e-6);
}

TEST_F(Contacts, CountEachPairOfPartsOnceInASymmetricMatrix) {
  frame(0);
  frame(1, {begin(0, 1, kHead, kHand), begin(0, 2, kHand, kHand), begin(1, 2, kHand, kHead)});
  frame(3, {end(0, 1, kHead, kHand), end(0, 2, kHand, kHand), end(1, 2, kHand, kHead)});
  finish();
  const PartMatrix parts = statistics_->parts();
  ASSERT_EQ(parts.names.size(), 15u);
  ASSERT_EQ(parts.counts.size(), 15u * 15);
  EXPECT_EQ(parts.counts[kHead * 15 + kHead], 0u);
  EXPECT_EQ(parts.counts[kHead * 15 + kHand], 2u);
  EXPECT_EQ(parts.counts[kHand * 15 + kHead], 2u);
  EXPECT_EQ(parts.counts[kHand * 15 + kHand], 1u);
  EXPECT_NEAR(parts.seconds[kHand * 15 + kHead], 0.4, 1e-9);
}

TEST_F(Contacts, ListContactsOfPartsByBegin) {
  frame(0, {begin(1, 2, kHead, kHead)});
  frame(1, {begin(0, 2, kHand, kHead), begin(0, 1, kHead, kHand)});
  frame(2, {end(0, 1, kHead, kHand), begin(2, kWall, kHand, 0)});
  frame(3, {begin(0, 1, kHead, kHand)});
  frame(6, {end(0, 2, kHand, kHead), end(0, 1, kHead, kHand), end(2, kWall, kHand, 0)});
  finish({end(1, 2, kHead, kHead)});
  std::vector<std::string> listed;
  statistics_->for_each_part_contact([&](const PartContact& contact) {
    listed.push_back(fmt::format("frame {} for {}: {} {}{}", contact.begin_frame, contact.frames,
                                 contact.pair.a(), contact.pair.b(),
                                 contact.is_truncated ? ", truncated" : ""));
  });
  EXPECT_THAT(listed, testing::ElementsAre("frame 0 for 7: 1 2, truncated", "frame 1 for 1: 0 1",
                                           "frame 1 for 5: 0 2", "frame 3 for 3: 0 1"));
}

TEST_F(Contacts, WithObstaclesAreCountedSeparately) {
  frame(0);
  frame(1, {begin(2, kWall, kHand, 0), begin(2, kWall, kHead, 0)});
  frame(2, {end(2, kWall, kHand, 0)});
  frame(3, {end(2, kWall, kHead, 0)});
  finish();
  EXPECT_EQ(statistics_->totals().contacts, 0u);
  EXPECT_EQ(statistics_->totals().obstacle_contacts, 1u);
  EXPECT_EQ(statistics_->people()[2].obstacle_contacts, 1u);
  EXPECT_EQ(statistics_->parts().obstacle_counts[kHead], 1u);
  EXPECT_EQ(statistics_->parts().obstacle_counts[kHand], 1u);
}

TEST_F(Contacts, AreCountedByMinute) {
  for (int64_t number = 0; number < 1200; ++number)
    frame(number, number == 700
                      ? std::vector{begin(0, 1, 0, 0)}
                      : (number == 701 ? std::vector{end(0, 1, 0, 0)} : std::vector<PairEvent>{}));
  finish();
  ASSERT_EQ(statistics_->minutes().size(), 2u);
  EXPECT_EQ(statistics_->minutes()[0].contacts, 0u);
  EXPECT_EQ(statistics_->minutes()[1].contacts, 1u);
  EXPECT_NEAR(statistics_->minutes()[1].person_s, 180, 1e-6);
}

TEST_F(Contacts, IgnoreTheTimeOfAbsentPeople) {
  present_ = {1, 0, 1};
  pass(0, 9);
  finish();
  EXPECT_DOUBLE_EQ(statistics_->people()[1].present_s, 0);
  EXPECT_NEAR(statistics_->totals().person_s, 2, 1e-9);
}

TEST_F(Contacts, StoreTheDensityAtTheirBegin) {
  frame(0);
  frame(1, {begin(0, 1, kHand, kHand)});
  frame(2, {end(0, 1, kHand, kHand)});
  ASSERT_EQ(statistics_->ended().size(), 1u);
  const double circle_m2 = std::numbers::pi * 4;
  // All three are within 2 m of both people.
  EXPECT_NEAR(statistics_->ended()[0].density_per_m2, 3 / circle_m2, 1e-9);
  EXPECT_EQ(statistics_->densities()[0].contacts, 1u) << "0.24 per m2 is free walking";
  EXPECT_EQ(statistics_->ended()[0].place_m, Eigen::Vector2d(0.5, 0));
}

/// Folder that a run of these people without contacts writes, its output and its notes.
struct Folder {
  Folder(const RunInfo& run, const std::vector<RootPose>& roots) {
    std::string name = (std::filesystem::temp_directory_path() / "throng-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create " + name);
    path = name;
    std::ofstream(path / "contact_parts.svg") << "stale";
    testing::internal::CaptureStderr();
    ContactSink sink(path);
    sink.begin(run);
    Frame frame;
    frame.roots = roots;
    sink.frame(run, frame);
    sink.end(run, {});
    captured = testing::internal::GetCapturedStderr();
    note = sink.notes().empty() ? "" : sink.notes().back();
    for (const auto& entry : std::filesystem::directory_iterator(path))
      names.push_back(entry.path().filename().string());
  }
  ~Folder() { std::filesystem::remove_all(path); }

  std::filesystem::path path;
  std::string captured, note;
  std::vector<std::string> names;
};

TEST_F(Contacts, GiveEmptyTablesWithoutPeople) {
  for (const bool has_model : {true, false}) {
    RunInfo empty_run = run_;
    empty_run.model_of_avatar.clear();
    empty_run.group_of_avatar.clear();
    if (!has_model) empty_run.models.clear();
    const Folder folder(empty_run, {});
    EXPECT_EQ(folder.captured, "");
    EXPECT_THAT(folder.note, testing::HasSubstr(has_gnuplot() ? "no data for it" : "no figures"));
    EXPECT_THAT(folder.names, testing::UnorderedElementsAre(
                                  "contacts.csv", "part_contacts.csv", "people.csv", "minutes.csv",
                                  "durations.csv", "parts.csv", "parts_seconds.csv", "density.csv",
                                  "touching.tij", "touching.graphml"));
    std::ifstream pairs(folder.path / "part_contacts.csv");
    const std::string text{std::istreambuf_iterator<char>(pairs), {}};
    EXPECT_EQ(text, "begin_s,duration_s,person_a,part_a,person_b,part_b,truncated\n");
  }
}

TEST_F(Contacts, GiveOneFigureIfNoPeopleTouch) {
  if (!has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const Folder folder(run_, roots_);
  EXPECT_EQ(folder.captured, "");
  EXPECT_THAT(folder.names, testing::Contains("contact_rates.svg"));
  EXPECT_THAT(folder.names, testing::Not(testing::Contains("contact_parts.svg")));
  EXPECT_THAT(folder.note, testing::HasSubstr("contact_parts.svg"));
  // contact_files() lists every file that can be written.
  EXPECT_THAT(contact_files(), testing::IsSupersetOf(folder.names));
}

TEST(LocalDensity, DividesByTheWalkablePartOfTheCircle) {
  Scene scene;
  scene.ground = {{0, -10}, {20, 10}};
  LocalDensity density(scene);
  const std::vector<Eigen::Vector2d> people = {{0.001, 0}, {10, 0}};
  density.place(people, {});
  const double circle_m2 = std::numbers::pi * 4;
  EXPECT_NEAR(density.around({10, 0}), 1 / circle_m2, 1e-9);
  EXPECT_NEAR(density.around({0.001, 0}), 2 / circle_m2, 0.04 * 2 / circle_m2)
      << "half of it is off the ground";
}

/// A corridor 1.8 m wide between walls of 0.2 m, in the middle of larger ground.
Scene thin_walled_corridor() {
  Scene scene;
  scene.ground = {{-10, -10}, {10, 10}};
  scene.obstacles = {box(0, -1, 20, 0.2), box(0, 1, 20, 0.2)};
  return scene;
}

TEST(LocalDensity, IgnoresGroundBehindAWall) {
  LocalDensity density(thin_walled_corridor());
  const std::vector<Eigen::Vector2d> people = {{0, 0}, {1, 0.3}};
  density.place(people, {});
  // Area of a circle of 2 m that is within 0.9 m of a line through its centre.
  const double visible_m2 = 2 * (0.9 * std::sqrt(4 - 0.81) + 4 * std::asin(0.45));
  EXPECT_NEAR(density.around({0, 0}), 2 / visible_m2, 0.05 * 2 / visible_m2);
}

TEST(LocalDensity, IgnoresPeopleBehindAWall) {
  LocalDensity density(thin_walled_corridor());
  const std::vector<Eigen::Vector2d> people = {{0, 0.7}, {0, 1.3}};
  density.place(people, {});
  const double alone = density.around({0, 0.7});
  density.place(std::span(people).first(1), {});
  EXPECT_EQ(density.around({0, 0.7}), alone);
}

TEST(LocalDensity, MovesAPersonOnAWallNextToIt) {
  LocalDensity density(thin_walled_corridor());
  const std::vector<Eigen::Vector2d> people = {{0, 0.93}, {0, 0.4}};
  density.place(people, {});
  const double next_to_wall = density.around({0, 0.899});
  EXPECT_NEAR(density.around(people[0]), next_to_wall, 0.05 * next_to_wall);
  EXPECT_GT(next_to_wall, 2 / (std::numbers::pi * 4)) << "both are counted, over less than the "
                                                         "circle";
}

TEST(LocalDensity, StartsEachLevelAboveItsBound) {
  EXPECT_EQ(DensityLevels::level_of(0.1), 0u);
  EXPECT_EQ(DensityLevels::level_of(0.5), 1u);
  EXPECT_EQ(DensityLevels::level_of(4), 3u);
  EXPECT_EQ(DensityLevels::level_of(9), 5u);
}

}  // namespace
}  // namespace throng::contact_test
